#include "stochastic_platoon/math/bursts/burst_scatter.hpp"

#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/numerics/complex_product.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/memory_weights.hpp"

namespace platoon {

namespace {

using DoubleComplex = std::complex<double>;

}  // namespace

BurstScatter::BurstScatter(const BurstLink& link, const Eigen::ArrayXd& node, const Eigen::ArrayXd& weight,
                           const Quadrature* rule)
    : passed(node.size()),
      margin(node.size()),
      surprise(node.size()),
      moving(node.size()),
      memories_(link.memories()),
      weight_(weight),
      itself_(link.itself()) {
  const auto memories = static_cast<Eigen::Index>(memories_.size());
  for (Eigen::MatrixXcd* values : {&recalling_, &remembered_, &mirrored_}) values->resize(node.size(), memories);
  outward_.resize(node.size(), itself_.size());
  scattered_.resize(itself_.size(), node.size());
  const BurstLink::Value constant = link.at(0.0);
  for (Eigen::Index k = 0; k < node.size(); ++k) {
    const BurstLink::Value value = link.at(node(k));
    passed(k) = value.passed();
    margin(k) = value.margin();
    surprise(k) = std::norm(value.surprise);
    moving(k) = link.slope() * link.slope() * link.kernel(value, node(k), constant, 0.0);
    recalling_.row(k) = value.recalling.transpose();
    remembered_.row(k) = value.remembered.transpose();
    mirrored_.row(k) = value.mirrored.transpose();
    outward_.row(k) = 2.0 * value.outward.real().transpose();
    scattered_.col(k) = value.scattered.real();
  }
  if (rule != nullptr && !memories_.empty()) add_kernel(node, *rule);
}

void BurstScatter::add_kernel(const Eigen::ArrayXd& node, const Quadrature& rule) {
  const Eigen::Index count = node.size(), terms = recalling_.cols();
  kernel_ = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index first = 0, end = 0; first < terms; first = end) {  // terms of one lambda share its weights
    const DoubleComplex value = memories_[static_cast<std::size_t>(first)];
    while (end < terms && memories_[static_cast<std::size_t>(end)] == value) ++end;
    const MemoryWeights memory(rule, value), mirrored(rule, std::conj(value));
    for (Eigen::Index r = 0; r < count; ++r) {
      const std::vector<DoubleComplex> ahead = memory.at(node(r)), behind = mirrored.at(-node(r));
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

// < b_m(nu) driven(nu) y_m / (1 - y_m) >_nu: on equally spaced nodes a circular convolution with the powers of
// lambda_m.
Eigen::ArrayXd BurstScatter::recalled(const Eigen::ArrayXd& driven) const {
  const Eigen::Index half = driven.size(), n = 2 * half;
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(half);
  Eigen::VectorXcd values(n), lags(n);
  for (std::size_t m = 0; m < memories_.size(); ++m) {
    const auto column = static_cast<Eigen::Index>(m);
    values.head(half) = (remembered_.col(column).array() * driven).matrix();
    values.tail(half) = (mirrored_.col(column).array() * driven).matrix().reverse();
    fft_.inv(lags, values);
    DoubleComplex power = std::pow(memories_[m], static_cast<double>(n));
    const DoubleComplex all = 1.0 - power;
    for (Eigen::Index t = 0; t < n; ++t) {
      lags(t) *= power / all;
      power = t == 0 ? memories_[m] : power * memories_[m];
    }
    fft_.fwd(values, lags);
    sum += 2.0 * (recalling_.col(column).array() * values.head(half).array()).real();
  }
  return sum;
}

Eigen::MatrixXd BurstScatter::operator()(const Eigen::Ref<const Eigen::MatrixXd>& driven) const {
  const Eigen::MatrixXd weighted = driven.array().colwise() * weight_, inward = scattered_ * weighted;
  Eigen::MatrixXd result = outward_ * inward;
  result.rowwise() -= itself_ * inward;
  if (kernel_.size() > 0) {
    result.noalias() += kernel_.transpose() * weighted;
  } else if (!memories_.empty()) {
    for (Eigen::Index j = 0; j < driven.cols(); ++j) result.col(j) += recalled(driven.col(j)).matrix();
  }
  return result;
}

}  // namespace platoon
