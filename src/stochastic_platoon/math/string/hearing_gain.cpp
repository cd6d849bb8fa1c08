#include "stochastic_platoon/math/string/hearing_gain.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/tools/minima.hpp>
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

// Over a pattern, of the companion matrices.
Eigen::MatrixXcd HearingGain::product(double w) const {
  const CirclePoint point(w);
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
      const HearingLoop::Complex of_source =
          input.signal == InputSignal::input ? loops_[(source - 1) % period_].at(point).sent : 0.0L;
      companion(0, static_cast<Eigen::Index>(follower - source) - 1) += static_cast<std::complex<double>>(
          value.of(input) * sent_value(input, point, of_source, model_.sample_period) * losses_[p][j].at(point).passed);
    }
    product = companion * product;
  }
  return product;
}

double HearingGain::operator()(double w) const {
  const Eigen::MatrixXcd of_pattern = product(w);
  return reach_ == 1 ? std::abs(of_pattern(0, 0)) : of_pattern.eigenvalues().cwiseAbs().maxCoeff();
}

bool HearingGain::falls_apart() const {
  constexpr double kLow = 1e-10;      // [rad/sample], near enough to 0 for every headway
  constexpr double kRounding = 1e-7;  // bounds the rounding of an eigenvalue, defective ones included
  return (product(kLow).eigenvalues().cwiseAbs().array() > 1.0 - kRounding).count() > 1;
}

HearingGain::Peak HearingGain::peak() const {
  constexpr int kPoints = 4000;
  constexpr double kRounding = 1e-12;  // gains that differ by less are equal
  constexpr int kBits = 26;            // of the frequency of a maximum: no more are seen in the gain
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
    const auto found = boost::math::tools::brent_find_minima(
        [this](double w) { return -(*this)(w); }, at(std::max(j - 1, 0)), at(std::min(j + 1, kPoints)), kBits);
    if (-found.second > best.gain) best = {-found.second, found.first};
  }
  return best;
}

}  // namespace platoon
