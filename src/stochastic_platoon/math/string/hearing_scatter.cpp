#include "stochastic_platoon/math/string/hearing_scatter.hpp"

#include <boost/math/constants/constants.hpp>
#include <cmath>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

HearingScatter::HearingScatter(const LossModel& loss, std::size_t n) : kernel_(loss), forgets_(loss.predictor.empty()) {
  const auto half = static_cast<Eigen::Index>(n / 2);
  const LossKernel::Value rest = kernel_.at(0.0);
  passed_at_rest_ = 1.0 - rest.missing().real();
  passed_.resize(half);
  drive_.resize(half);
  of_steady_.resize(half);
  const auto memories = static_cast<Eigen::Index>(kernel_.memories().size());
  outward_.resize(rest.outward.size(), half);
  scattered_.resize(rest.scattered.size(), half);
  recalling_.resize(memories, half);
  inward_.resize(memories, half);
  mirrored_.resize(memories, half);
  for (Eigen::Index k = 0; k < half; ++k) {
    check_interruption();
    const double w = 2.0 * boost::math::double_constants::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    const LossKernel::Value value = kernel_.at(w);
    passed_(k) = 1.0 - value.missing();
    drive_(k) = std::norm(value.surprise);
    of_steady_(k) = kernel_.kernel(value, w, rest, 0.0);
    outward_.col(k) = value.outward;
    scattered_.col(k) = value.scattered;
    if (memories == 0) continue;
    recalling_.col(k) = value.recalling;
    inward_.col(k) = value.remembered;
    mirrored_.col(k) = value.mirrored;
  }
  itself_ = (kernel_.itself().cast<std::complex<double>>() * scattered_).real().array().transpose();
}

Eigen::ArrayXcd HearingScatter::operator()(const Eigen::ArrayXcd& sent) const {
  const Eigen::ArrayXcd f = drive_ * sent;
  const double share = 1.0 / static_cast<double>(f.size());  // a mean over +-nu is that of real parts
  const Eigen::VectorXcd ahead = ((scattered_ * f.matrix()).real() * share).cast<std::complex<double>>(),
                         behind = ((scattered_ * f.conjugate().matrix()).real() * share).cast<std::complex<double>>();
  Eigen::ArrayXcd result = (outward_.transpose() * ahead).array() +
                           (outward_.transpose() * behind).array().conjugate() -
                           std::complex<double>(share * (itself_ * f.real()).sum());
  if (recalling_.rows() > 0) result += remembered(f) + remembered(f.conjugate()).conjugate();
  return result;
}

// Sum over m of a_m(w) < b_m(nu) y_m / (1 - y_m) f(nu) >_nu, y_m = lambda_m e^{j (nu - w)}, a convolution over the
// whole circle: of its terms lambda^t e^{j t (nu - w)}, those whose t differ by n are equal on these nodes.
Eigen::ArrayXcd HearingScatter::remembered(const Eigen::ArrayXcd& driven) const {
  const Eigen::Index half = driven.size(), n = 2 * half;
  Eigen::ArrayXcd sum = Eigen::ArrayXcd::Zero(half);
  std::vector<std::complex<double>> whole(static_cast<std::size_t>(n)), lags, circle;
  for (Eigen::Index m = 0; m < recalling_.rows(); ++m) {
    for (Eigen::Index k = 0; k < half; ++k) {
      whole[static_cast<std::size_t>(k)] = inward_(m, k) * driven(k);
      whole[static_cast<std::size_t>(n - 1 - k)] = mirrored_(m, k) * std::conj(driven(k));
    }
    fft_.inv(lags, whole);
    const std::complex<double> lambda = kernel_.memories()[static_cast<std::size_t>(m)];
    const std::complex<double> round = 1.0 / (1.0 - std::pow(lambda, static_cast<double>(n)));
    std::complex<double> factor = round;
    for (std::size_t t = 1; t < lags.size(); ++t) lags[t] *= (factor *= lambda);
    lags[0] *= factor * lambda;
    fft_.fwd(circle, lags);
    for (Eigen::Index k = 0; k < half; ++k) sum(k) += recalling_(m, k) * circle[static_cast<std::size_t>(k)];
  }
  return sum;
}

}  // namespace platoon
