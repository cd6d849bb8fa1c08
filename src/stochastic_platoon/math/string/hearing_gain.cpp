#include "stochastic_platoon/math/string/hearing_gain.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

HearingGain::HearingGain(const PlatoonModel& model)
    : model_(model), reach_(farthest_ahead(model)), period_(type_order(model).size()), slowest_(1.0) {
  constexpr double kSlowest = 1e-11;  // below it, rounding hides the distance of a gain from 1
  for (std::size_t p = 0; p < period_; ++p) {
    const std::size_t follower = first() + p;
    const VehicleModel& own = vehicle(model, follower);
    loops_.emplace_back(own, follower, model.sample_period);
    losses_.emplace_back();
    slowest_ = std::min(slowest_, 1.0 / (1.0 + own.headway));
    for (const std::complex<double>& w : frequencies_of(loops_.back().poles()))
      slowest_ = std::min(slowest_, std::abs(w));
    for (const Input& input : own.inputs) {
      losses_.back().emplace_back(input.link.loss.value_or(LossModel()));
      if (input.link.loses()) slowest_ = std::min(slowest_, 1.0 / input.link.loss->mean_burst.value_or(1.0));
    }
  }
  slowest_ = std::max(slowest_, kSlowest);
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

// Ascending: 800 frequencies a decade, but at least 8 in a turn of the longest delay.
std::vector<double> HearingGain::grid() const {
  constexpr int kPoints = 4000;
  constexpr double kLowest = 1e-5, kFarBelow = 1e-3;
  const double pi = boost::math::double_constants::pi;
  const auto at = [pi](int j) { return pi * std::exp(std::log(kLowest) * (1.0 - static_cast<double>(j) / kPoints)); };
  const double low = std::min(at(0), kFarBelow * slowest_),
               most = 0.25 * pi / static_cast<double>(std::max<std::int64_t>(longest_delay(model_), 1));
  std::vector<double> frequencies{at(kPoints)};
  for (int j = kPoints; frequencies.back() > low; --j) {
    const double from = at(j), to = at(j - 1), parts = std::ceil((from - to) / most);
    for (double part = 1.0; part < parts; ++part) frequencies.push_back(from + (to - from) * part / parts);
    frequencies.push_back(to);
  }
  std::reverse(frequencies.begin(), frequencies.end());
  return frequencies;
}

HearingGain::Peak HearingGain::peak() const {
  constexpr double kRounding = 1e-12;  // gains that differ by less are equal
  constexpr int kBits = 26;            // of the frequency of a maximum: no more are seen in the gain
  const std::vector<double> at = grid();
  std::vector<double> gains;
  for (const double w : at) {
    check_interruption();
    gains.push_back((*this)(w));
  }
  const std::size_t last = at.size() - 1,
                    top = static_cast<std::size_t>(std::max_element(gains.begin(), gains.end()) - gains.begin());
  Peak best{gains[top], at[top]};
  for (std::size_t n = 0; n <= last; ++n) {
    const std::size_t left = n > 0 ? n - 1 : n, right = std::min(n + 1, last);
    const double rise = gains[n] - std::min(gains[left], gains[right]);
    const bool is_top = gains[n] >= gains[left] && gains[n] >= gains[right];
    if (!is_top || rise < kRounding || gains[n] + rise < best.gain) continue;  // the maximum is within less than a rise
    check_interruption();
    const auto found =
        boost::math::tools::brent_find_minima([this](double w) { return -(*this)(w); }, at[left], at[right], kBits);
    if (-found.second > best.gain) best = {-found.second, found.first};
  }
  return best;
}

std::int64_t longest_delay(const PlatoonModel& model) {
  std::int64_t longest = 0;
  for (const VehicleType& type : model.types) {
    const std::int64_t of_plant = type.vehicle.design ? type.vehicle.design->plant.exact().delay : 0;
    for (const Input& input : type.vehicle.inputs) longest = std::max(longest, of_plant + input.link.delay);
  }
  return longest;
}

}  // namespace platoon
