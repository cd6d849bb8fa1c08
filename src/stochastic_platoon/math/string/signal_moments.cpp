#include "stochastic_platoon/math/string/signal_moments.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/links/linked_responses.hpp"
#include "stochastic_platoon/math/links/mean_vehicle.hpp"
#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/string/hearing_moments.hpp"

namespace platoon {

namespace {

using Sequence = MeanVehicle::Sequence;

class SignalTables {
public:
  SignalTables(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
               std::size_t steps)
      : responses_(model, followers, steps), followers_(followers), steps_(steps), moments_(names.size()) {
    for (std::size_t i = 1; i <= followers; ++i) signals_.push_back(signals_of(model, names, i).requested);
    for (std::size_t s = 0; s < names.size(); ++s) {
      moments_[s].variance.assign(followers * steps, 0.0);
      if (names[s] == kGap) moments_[s].covariance_with_previous.assign(followers * steps, 0.0);
    }
  }

  std::vector<SignalMoments> operator()() {
    responses_.visit_means([this](std::size_t i, const Sequence& predecessor, const MeanVehicle::Passed& passed) {
      for (std::size_t s = 0; s < moments_.size(); ++s) {
        const Signal& signal = signals_[i][s];
        const double apart = signal.relative ? responses_.model(i).standstill_distance - signal.offset : 0.0;
        const Sequence values = signal_values(signal, predecessor, passed.own);
        for (std::size_t a = 1; a < values.size(); ++a)
          moments_[s].mean.push_back(static_cast<double>(values[a] + static_cast<long double>(apart)));
      }
    });
    for (std::size_t place = 0; place < std::min(responses_.period(), followers_); ++place) add_sources(place);
    return std::move(moments_);
  }

private:
  // Adds the noises and the initial positions of the vehicles at `place` and its repetitions.
  void add_sources(std::size_t place) {
    const VehicleModel& vehicle = responses_.model(place);
    for (std::size_t link = 0; link < vehicle.inputs.size(); ++link)
      add_noise(place, link, vehicle.inputs[link].link, vehicle.inputs[link].noise_variance);
    const double placed = vehicle.initial_position.variance;
    if (placed > 0.0) add_source(place, responses_.vehicle(place).free_motion(steps_), placed, false);
  }

  void add_noise(std::size_t place, std::size_t link, const LinkModel& model, double variance) {
    if (variance == 0.0) return;
    const Sequence sent =
        model.has_white_noise() ? responses_.impulse() : responses_.filtered_impulse(model.noise_filter);
    add_source(place, responses_.vehicle(place).over_link(link, sent).own, variance, true);
  }

  // A follower has the shares of the sources 0, M, 2 M, ... vehicles nearer to the front, M the length of the pattern.
  void add_source(std::size_t place, Motion motion, double variance, bool is_noise) {
    const std::size_t period = responses_.period();
    std::vector<std::vector<ResponseProducts>> sums(period);  // of the last M followers, one entry per signal
    const auto add = [&](std::size_t i, const Sequence& predecessor, const MeanVehicle::Passed& passed) {
      std::vector<ResponseProducts>& before = sums[i % period];
      for (std::size_t s = 0; s < moments_.size(); ++s) {
        const ResponseProducts share(signal_values(signals_[i][s], predecessor, passed.own), is_noise);
        if (before.size() == s) {
          before.push_back(share);
        } else {
          before[s].add(share);
        }
        add_to(moments_[s].variance, i, before[s].variance, variance);
        if (!moments_[s].covariance_with_previous.empty())
          add_to(moments_[s].covariance_with_previous, i, before[s].covariance, variance);
      }
    };
    responses_.visit_downstream(place, std::move(motion), add);
  }

  void add_to(std::vector<double>& cells, std::size_t i, const Sequence& sums, double variance) const {
    for (std::size_t k = 0; k < steps_; ++k)
      cells[i * steps_ + k] += static_cast<double>(static_cast<long double>(variance) * sums[k]);
  }

  LinkedResponses responses_;
  std::size_t followers_, steps_;
  std::vector<std::vector<Signal>> signals_;  ///< per follower
  std::vector<SignalMoments> moments_;
};

}  // namespace

std::vector<SignalMoments> signal_moments(const PlatoonModel& model, const std::vector<std::string>& names,
                                          std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  if (!has_normal_errors(model))
    throw std::invalid_argument("model: has losses or quantisation: must have normal errors for signal_moments()");
  if (!hears_predecessors_only(model)) {
    std::vector<SignalMoments> all = hearing_moments(model, names, followers, steps);
    all.erase(all.begin());
    return all;
  }
  for (const VehicleModel& vehicle : pattern(model)) unit_equilibrium(vehicle.loop.realization);
  const bool moves = start_slope(model) != 0.0, has_input = std::count(names.begin(), names.end(), kInput) > 0;
  PlatoonModel computed = moves ? in_moving_frame(model) : model;
  for (VehicleType& type : computed.types) {
    if (!has_input) break;
    if (!type.vehicle.loop.parts) throw std::invalid_argument("signal input: must be of vehicles by parts");
    type.vehicle.design->sends_input = true;
  }
  std::vector<SignalMoments> found = SignalTables(computed, names, followers, static_cast<std::size_t>(steps))();
  for (std::size_t s = 0; moves && s < names.size(); ++s) {
    for (std::size_t c = 0; c < found[s].mean.size(); ++c) {
      const std::size_t follower = c / static_cast<std::size_t>(steps) + 1;
      found[s].mean[c] += steady_value(model, signals_of(model, {names[s]}, follower).requested.front(), follower);
    }
  }
  return found;
}

}  // namespace platoon
