#include "stochastic_platoon/math/bursts/burst_scatter.hpp"

#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/memory_weights.hpp"

namespace platoon {

namespace {

using DoubleComplex = std::complex<double>;

/// Re(a b) without the checks of std::complex for infinities.
double real_product(DoubleComplex a, DoubleComplex b) {
  return a.real() * b.real() - a.imag() * b.imag();
}

}  // namespace

BurstScatter::BurstScatter(const BurstLink& link, const Eigen::ArrayXd& node, const Eigen::ArrayXd& weight,
                           const Quadrature* rule)
    : passed(node.size()),
      margin(node.size()),
      surprise(node.size()),
      moving(node.size()),
      memory_(link.memory()),
      odds_(link.odds()),
      weight_(weight),
      deviation_(node.size()),
      outward_(node.size(), 2 * link.registers()),
      scattered_(2 * link.registers(), node.size()) {
  const BurstLink::Value constant = link.at(0.0);
  for (Eigen::Index k = 0; k < node.size(); ++k) {
    const BurstLink::Value value = link.at(node(k));
    passed(k) = value.passed();
    margin(k) = value.margin();
    surprise(k) = std::norm(value.surprise);
    moving(k) = link.slope() * link.slope() * link.kernel(value, node(k), constant, 0.0);
    deviation_(k) = value.deviation;
    outward_.row(k) = 2.0 * value.outward.real().transpose();
    scattered_.col(k) = value.scattered.real();
  }
  itself_ = Eigen::RowVectorXd::Unit(scattered_.rows(), link.registers());
  if (rule != nullptr && memory_ != 0.0) add_kernel(node, *rule);
}

void BurstScatter::add_kernel(const Eigen::ArrayXd& node, const Quadrature& rule) {
  const MemoryWeights memory(rule, memory_);
  const Eigen::Index count = node.size();
  kernel_.resize(count, count);
  for (Eigen::Index r = 0; r < count; ++r) {
    check_interruption();
    const std::vector<DoubleComplex> ahead = memory.at(node(r)), behind = memory.at(-node(r));
    for (Eigen::Index c = 0; c < count; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const DoubleComplex a = ahead[k], b = behind[k], d = deviation_(c);
      // conj(d) a + d conj(b)
      const DoubleComplex sum(d.real() * (a.real() + b.real()) + d.imag() * (a.imag() + b.imag()),
                              d.real() * (a.imag() - b.imag()) - d.imag() * (a.real() - b.real()));
      kernel_(c, r) = odds_ * real_product(deviation_(r), sum);
    }
  }
}

// < conj(D(nu)) driven(nu) y / (1 - y) >_nu: on equally spaced nodes a circular convolution with the powers of lambda.
Eigen::ArrayXd BurstScatter::remembered(const Eigen::ArrayXd& driven) const {
  check_interruption();
  const Eigen::Index half = driven.size(), n = 2 * half;
  Eigen::VectorXcd values(n), lags(n);
  values.head(half) = (deviation_.conjugate() * driven).matrix();
  values.tail(half) = values.head(half).reverse().conjugate();
  fft_.inv(lags, values);
  double power = std::pow(memory_, static_cast<double>(n));
  const double all = 1.0 - power;
  for (Eigen::Index t = 0; t < n; ++t) {
    lags(t) *= power / all;
    power = t == 0 ? memory_ : power * memory_;
  }
  fft_.fwd(values, lags);
  return 2.0 * odds_ * (deviation_ * values.head(half).array()).real();
}

Eigen::MatrixXd BurstScatter::operator()(const Eigen::Ref<const Eigen::MatrixXd>& driven) const {
  const Eigen::MatrixXd weighted = driven.array().colwise() * weight_, inward = scattered_ * weighted;
  Eigen::MatrixXd result = outward_ * inward;
  result.rowwise() -= itself_ * inward;
  if (kernel_.size() > 0) {
    result.noalias() += kernel_.transpose() * weighted;
  } else if (memory_ != 0.0) {
    for (Eigen::Index j = 0; j < driven.cols(); ++j) result.col(j) += remembered(driven.col(j)).matrix();
  }
  return result;
}

}  // namespace platoon
