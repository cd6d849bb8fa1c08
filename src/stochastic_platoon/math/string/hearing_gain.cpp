#include "stochastic_platoon/math/string/hearing_gain.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <complex>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

HearingGain::HearingGain(const PlatoonModel& model)
    : model_(model), reach_(farthest_ahead(model)), period_(type_order(model).size()) {
  for (std::size_t p = 0; p < period_; ++p) {
    const std::size_t follower = first() + p;
    loops_.emplace_back(vehicle(model, follower), follower, model.sample_period);
    losses_.emplace_back();
    for (const Input& input : vehicle(model, follower).inputs)
      losses_.back().emplace_back(input.link.loss.value_or(LossModel()));
  }
}

double HearingGain::operator()(double w) const {
  const CirclePoint point(w);
  const std::complex<double> z = std::polar(1.0, w), moved = 1.0 - std::conj(z);
  const auto r = static_cast<Eigen::Index>(reach_);
  Eigen::MatrixXcd product = Eigen::MatrixXcd::Identity(r, r);
  for (std::size_t p = 0; p < period_; ++p) {
    const std::size_t follower = first() + p;
    const VehicleModel& own = vehicle(model_, follower);
    const HearingLoop::Value value = loops_[p].at(point);
    Eigen::MatrixXcd companion = Eigen::MatrixXcd::Zero(r, r);
    companion.diagonal(-1).setOnes();
    for (std::size_t j = 0; j < own.inputs.size(); ++j) {
      const Input& input = own.inputs[j];
      const std::size_t source = source_of(input, follower);
      if (source == 0) continue;
      std::complex<double> sent = std::pow(std::conj(z), static_cast<double>(input.link.delay));
      const double period = model_.sample_period;
      if (input.signal == InputSignal::speed) sent *= moved / period;
      if (input.signal == InputSignal::acceleration) sent *= moved * moved / (period * period);
      if (input.signal == InputSignal::input) sent *= loops_[(source - 1) % period_].at(point).sent;
      if (input.link.loses()) sent *= static_cast<std::complex<double>>(losses_[p][j].at(point).passed);
      companion(0, static_cast<Eigen::Index>(follower - source) - 1) +=
          input.gain * sent * (input.signal == InputSignal::position ? value.of_position : value.of_input);
    }
    product = companion * product;
  }
  return reach_ == 1 ? std::abs(product(0, 0)) : product.eigenvalues().cwiseAbs().maxCoeff();
}

HearingGain::Peak HearingGain::peak() const {
  constexpr int kPoints = 4000;
  constexpr double kRounding = 1e-12;  // of a gain
  const double pi = boost::math::double_constants::pi;
  const auto at = [pi](int j) { return pi * std::exp(std::log(1e-5) * (1.0 - static_cast<double>(j) / kPoints)); };
  std::vector<double> gains;
  for (int j = 0; j <= kPoints; ++j) {
    check_interruption();
    gains.push_back((*this)(at(j)));
  }
  Peak best{0.0, 0.0};
  for (int j = 0; j <= kPoints; ++j) {
    const auto n = static_cast<std::size_t>(j);
    const double before = gains[j > 0 ? n - 1 : n], behind = gains[j < kPoints ? n + 1 : n];
    best = gains[n] > best.gain ? Peak{gains[n], at(j)} : best;
    const bool is_top = gains[n] >= before && gains[n] >= behind;
    if (!is_top || gains[n] - std::min(before, behind) < kRounding) continue;
    double left = at(std::max(j - 1, 0)), right = at(std::min(j + 1, kPoints));
    for (int round = 0; round < 80; ++round) {
      const double one = left + (right - left) / 3.0, other = right - (right - left) / 3.0;
      ((*this)(one) < (*this)(other) ? left : right) = (*this)(one) < (*this)(other) ? one : other;
    }
    const double w = 0.5 * (left + right), gain = (*this)(w);
    if (gain > best.gain) best = {gain, w};
  }
  return best;
}

}  // namespace platoon
