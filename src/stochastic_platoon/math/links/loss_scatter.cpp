#include "stochastic_platoon/math/links/loss_scatter.hpp"

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/complex_product.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/memory_weights.hpp"

namespace platoon {

namespace {

using DoubleComplex = std::complex<double>;

Quadrature equal_nodes(std::size_t count) {
  const std::size_t half = count / 2;
  Quadrature rule;
  rule.weight.assign(half, 1.0 / static_cast<double>(half));
  for (std::size_t k = 0; k < half; ++k)
    rule.node.push_back(boost::math::long_double_constants::pi * (static_cast<long double>(k) + 0.5L) /
                        static_cast<long double>(half));
  return rule;
}

}  // namespace

SpectralNodes::SpectralNodes(std::size_t number) : SpectralNodes(equal_nodes(number)) {
  equally_spaced = true;
}

SpectralNodes::SpectralNodes(Quadrature quadrature)
    : rule(std::move(quadrature)),
      equally_spaced(false),
      weight(Eigen::Map<const Eigen::ArrayXd>(rule.weight.data(), count())) {
  for (const long double w : rule.node) points.emplace_back(w);
}

LossScatter::LossScatter(const LossFilter& losses, const SpectralNodes& nodes)
    : slope_(losses.slope()), weight_(nodes.weight), of_constant_drive_(nodes.count()), innovation_(nodes.count()) {
  if (losses.kernel() != nullptr) {
    add_chain(*losses.kernel(), nodes);
    return;
  }
  returned_.resize(nodes.count());
  for (Eigen::Index k = 0; k < nodes.count(); ++k) {
    const CirclePoint& point = nodes.points[static_cast<std::size_t>(k)];
    effects_.push_back(losses.at(point));
    const LossFilter::RankOne values = losses.rank_one(point);
    innovation_(k) = values.innovation;
    returned_(k) = losses.loss_factor() * values.returned;
  }
  const auto at_rest = static_cast<double>(losses.registers().front());  // 1 / F
  of_constant_drive_ = returned_ / (at_rest * at_rest);
}

void LossScatter::add_chain(const LossKernel& kernel, const SpectralNodes& nodes) {
  memories_ = kernel.memories();
  itself_ = kernel.itself();
  const auto memories = static_cast<Eigen::Index>(memories_.size());
  for (Eigen::MatrixXcd* values : {&recalling_, &remembered_, &mirrored_}) values->resize(nodes.count(), memories);
  for (Eigen::MatrixXd* values : {&outward_, &odd_outward_}) values->resize(nodes.count(), itself_.size());
  for (Eigen::MatrixXd* values : {&scattered_, &odd_scattered_}) values->resize(itself_.size(), nodes.count());
  const LossKernel::Value constant = kernel.at(0.0);
  for (Eigen::Index k = 0; k < nodes.count(); ++k) {
    check_interruption();
    const double w = nodes.points[static_cast<std::size_t>(k)].frequency;
    const LossKernel::Value value = kernel.at(w);
    effects_.push_back(LossFilter::Value::of_missing(value.missing()));
    innovation_(k) = std::norm(value.surprise);
    of_constant_drive_(k) = kernel.kernel(value, w, constant, 0.0);
    recalling_.row(k) = value.recalling.transpose();
    remembered_.row(k) = value.remembered.transpose();
    mirrored_.row(k) = value.mirrored.transpose();
    outward_.row(k) = 2.0 * value.outward.real().transpose();
    odd_outward_.row(k) = -2.0 * value.outward.imag().transpose();
    scattered_.col(k) = value.scattered.real();
    odd_scattered_.col(k) = value.scattered.imag();
  }
  if (memories_.empty()) return;
  if (nodes.equally_spaced)
    add_decay(2 * nodes.count());
  else
    add_memory(nodes);
}

// Terms whose t differ by n are equal on these nodes.
void LossScatter::add_decay(Eigen::Index n) {
  turn_.resize(n / 2);
  for (Eigen::Index t = 0; t < turn_.size(); ++t)
    turn_(t) = std::polar(1.0, -boost::math::double_constants::pi * static_cast<double>(t) / static_cast<double>(n));
  decay_.resize(n, recalling_.cols());
  for (Eigen::Index m = 0; m < decay_.cols(); ++m) {
    const DoubleComplex value = memories_[static_cast<std::size_t>(m)], all = std::pow(value, static_cast<double>(n));
    DoubleComplex power = 1.0 / (1.0 - all);
    decay_(0, m) = all * power;
    for (Eigen::Index t = 1; t < n; ++t) decay_(t, m) = power = product(power, value);
  }
}

void LossScatter::add_memory(const SpectralNodes& nodes) {
  const std::vector<long double>& node = nodes.rule.node;
  const Eigen::Index count = nodes.count(), terms = recalling_.cols();
  kernel_ = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index first = 0, end = 0; first < terms; first = end) {  // terms of one lambda share its weights
    const DoubleComplex value = memories_[static_cast<std::size_t>(first)];
    while (end < terms && memories_[static_cast<std::size_t>(end)] == value) ++end;
    const MemoryWeights memory(nodes.rule, value), mirrored(nodes.rule, std::conj(value));
    for (Eigen::Index r = 0; r < count; ++r) {
      const std::vector<DoubleComplex> ahead = memory.at(node[static_cast<std::size_t>(r)]),
                                       behind = mirrored.at(-node[static_cast<std::size_t>(r)]);
      for (Eigen::Index c = 0; c < count; ++c) {
        DoubleComplex at_node = 0.0, at_mirror = 0.0;
        for (Eigen::Index m = first; m < end; ++m) {
          at_node += product(recalling_(r, m), remembered_(c, m));
          at_mirror += product(recalling_(r, m), mirrored_(c, m));
        }
        const auto k = static_cast<std::size_t>(c);
        kernel_(c, r) += real_product(at_node, ahead[k]) + real_product(at_mirror, std::conj(behind[k]));
      }
    }
  }
}

// On equally spaced nodes a circular convolution with the powers of lambda_m.
Eigen::ArrayXcd LossScatter::delayed(Eigen::Index memory, const Eigen::ArrayXcd& ahead,
                                     const Eigen::ArrayXcd& behind) const {
  const Eigen::Index half = ahead.size();
  Eigen::VectorXcd values(2 * half), lags(2 * half);
  values << ahead.matrix(), behind.matrix().reverse();
  fft_.inv(lags, values);
  lags.array() *= decay_.col(memory).array();
  fft_.fwd(values, lags);
  return values.head(half);
}

// The sequence r of the lags is real. With n = 2 half and Y_m the value at node 2m, which for 2m >= half is the
// conjugate of the one at node n - 1 - 2m, r(t) - i r(t + half) = e^{j pi t / n} (inverse transform of Y)(t).
Eigen::ArrayXcd LossScatter::delayed_hermitian(Eigen::Index memory, const Eigen::ArrayXcd& ahead) const {
  const Eigen::Index half = ahead.size(), even = (half + 1) / 2;
  Eigen::VectorXcd values(half), lags(half);
  for (Eigen::Index m = 0; m < half; ++m) values(m) = m < even ? ahead(2 * m) : std::conj(ahead(2 * (half - m) - 1));
  fft_.inv(lags, values);
  for (Eigen::Index t = 0; t < half; ++t) {
    const DoubleComplex lag = product(std::conj(turn_(t)), lags(t));
    lags(t) = product(turn_(t), {lag.real() * decay_(t, memory).real(), lag.imag() * decay_(t + half, memory).real()});
  }
  fft_.fwd(values, lags);
  Eigen::ArrayXcd result(half);
  for (Eigen::Index m = 0; m < half; ++m) {
    if (m < even)
      result(2 * m) = values(m);
    else
      result(2 * (half - m) - 1) = std::conj(values(m));
  }
  return result;
}

// sum_m 2 Re a_m < b_m(nu) driven(nu) y_m / (1 - y_m) >_nu, with driven(-nu) = driven(nu), or minus it if it is odd.
Eigen::ArrayXd LossScatter::recalled(const Eigen::ArrayXd& driven, bool is_odd) const {
  const DoubleComplex i(0.0, 1.0);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(driven.size());
  for (Eigen::Index m = 0; m < decay_.cols(); ++m) {
    const Eigen::ArrayXcd ahead = remembered_.col(m).array() * driven;
    Eigen::ArrayXcd memory;
    if (memories_[static_cast<std::size_t>(m)].imag() == 0.0) {
      memory = is_odd ? Eigen::ArrayXcd(i * delayed_hermitian(m, -i * ahead)) : delayed_hermitian(m, ahead);
    } else {
      memory = delayed(m, ahead, (is_odd ? -1.0 : 1.0) * mirrored_.col(m).array() * driven);
    }
    sum += 2.0 * (recalling_.col(m).array() * memory).real();
  }
  return sum;
}

Eigen::MatrixXd LossScatter::drives(const Eigen::Ref<const Eigen::MatrixXd>& sent) const {
  if (returned_.size() > 0) return (innovation_ * weight_).matrix().transpose() * sent;
  return sent.array().colwise() * innovation_;
}

Eigen::MatrixXd LossScatter::operator()(const Eigen::Ref<const Eigen::MatrixXd>& drives) const {
  if (returned_.size() > 0) return returned_.matrix() * drives;
  const Eigen::MatrixXd weighted = drives.array().colwise() * weight_, inward = scattered_ * weighted;
  Eigen::MatrixXd result = outward_ * inward;
  result.rowwise() -= itself_ * inward;
  if (kernel_.size() > 0) {
    result.noalias() += kernel_.transpose() * weighted;
  } else if (decay_.size() > 0) {
    for (Eigen::Index j = 0; j < drives.cols(); ++j) result.col(j) += recalled(drives.col(j), false).matrix();
  }
  return result;
}

// The real part of a cross spectrum is even, as a spectrum is, and the imaginary part odd.
Eigen::ArrayXcd LossScatter::of_cross_spectrum(const Eigen::ArrayXcd& sent) const {
  if (kernel_.size() > 0) throw std::invalid_argument("nodes: must be equally spaced for a cross spectrum");
  Eigen::ArrayXcd result = (*this)(drives(sent.real().matrix())).array().cast<DoubleComplex>();
  if (returned_.size() > 0 || (sent.imag() == 0.0).all()) return result;
  const Eigen::ArrayXd odd = innovation_ * sent.imag();
  const Eigen::VectorXd inward = odd_scattered_ * (weight_ * odd).matrix();
  result.imag() = (odd_outward_ * inward).array() + recalled(odd, true);
  return result;
}

}  // namespace platoon
