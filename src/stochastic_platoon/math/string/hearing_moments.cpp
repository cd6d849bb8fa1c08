#include "stochastic_platoon/math/string/hearing_moments.hpp"

#include <algorithm>
#include <stdexcept>

#include "stochastic_platoon/math/links/linked_responses.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"

namespace platoon {

namespace {

using Sequence = MeanVehicle::Sequence;

/// One follower as an operator on the deviations of those ahead.
class Hearer {
public:
  Hearer(const PlatoonModel& model, std::size_t follower)
      : own_(vehicle(model, follower)),
        follower_(follower),
        period_(model.sample_period),
        response_(own_, follower, model.sample_period) {}

  /// `all`: vehicles 0 .. follower - 1. `noise`: on one input, from step -1 on; empty: none.
  Motion operator()(const std::vector<Motion>& all, std::size_t noisy = 0, const Sequence& noise = {}) const {
    check_interruption();
    const std::size_t count = all.front().position.size();
    Motion used{Sequence(count, 0.0L), Sequence(count, 0.0L)};
    for (std::size_t j = 0; j < own_.inputs.size(); ++j) {
      const Input& input = own_.inputs[j];
      const Motion& source = all[source_of(input, follower_)];
      Sequence& sum = input.signal == InputSignal::position ? used.position : used.input;
      const auto delay = static_cast<std::size_t>(input.delay());
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t at = k > delay ? k - delay : 0;
        long double value = sent(input, source, at);
        if (!noise.empty() && j == noisy && k >= delay) value += noise[at];
        sum[k] += input.gain * value;
      }
    }
    return response_(used);
  }

  /// The motion from an own initial position of 1.
  Motion placed(std::size_t count) const { return response_.free_motion(count); }

private:
  long double sent(const Input& input, const Motion& source, std::size_t at) const {
    const auto y = [&](std::size_t back) { return source.position[at > back ? at - back : 0]; };
    switch (input.signal) {
      case InputSignal::position:
        return y(0);
      case InputSignal::speed:
        return (y(0) - y(1)) / period_;
      case InputSignal::acceleration:
        return (y(0) - 2.0L * y(1) + y(2)) / (period_ * period_);
      default:
        return source.input[at];
    }
  }

  const VehicleModel& own_;
  std::size_t follower_;
  long double period_;
  VehicleResponse response_;
};

class HearingTables {
public:
  HearingTables(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
                std::size_t steps)
      : model_(model), names_(names), followers_(followers), steps_(steps), moments_(names.size() + 1) {
    for (std::size_t i = 1; i <= followers; ++i) hearers_.emplace_back(model, i);
    for (std::size_t s = 0; s < moments_.size(); ++s) {
      moments_[s].variance.assign(followers * steps, 0.0);
      if (s > 0 && names[s - 1] == kGap) moments_[s].covariance_with_previous.assign(followers * steps, 0.0);
    }
  }

  std::vector<SignalMoments> operator()() {
    add_means();
    const std::size_t period = type_order(model_).size(), alone = farthest_ahead(model_);
    for (std::size_t source = 1; source <= std::min(followers_, alone + period); ++source)
      add_sources(source, source > alone ? period : 0);
    return std::move(moments_);
  }

private:
  void add_means() {
    PlatoonModel quiet = model_;
    for (VehicleType& type : quiet.types) {
      for (Input& input : type.vehicle.inputs) {
        input.noise_variance = 0.0;
        input.link.quantisation_step = 0.0;
      }
      type.vehicle.initial_position.variance = 0.0;
    }
    for_each_trajectory(quiet, 1, followers_, static_cast<std::int64_t>(steps_), 0, names_,
                        [this](const Trajectory& of) {
                          for (std::size_t s = 0; s < of.signals.size(); ++s)
                            moments_[s].mean.insert(moments_[s].mean.end(), of.signals[s].begin(), of.signals[s].end());
                        });
  }

  // The noises and the initial position of a follower; with a `period`, also of those whole patterns behind it.
  void add_sources(std::size_t source, std::size_t period) {
    const VehicleModel& own = vehicle(model_, source);
    for (std::size_t j = 0; j < own.inputs.size(); ++j) {
      const Input& input = own.inputs[j];
      const double step = input.link.quantisation_step;
      if (input.noise_variance > 0.0)
        add(source, period, j, filtered_impulse(input.link.noise_filter, steps_), input.noise_variance);
      if (step > 0.0) {
        Sequence impulse(steps_ + 1, 0.0L);
        impulse[1] = 1.0L;
        add(source, period, j, impulse, step * step / 12.0);
      }
    }
    if (own.initial_position.variance > 0.0) add(source, period, 0, {}, own.initial_position.variance);
  }

  // Adds one kind of source: a noise on an input, or without noise the initial position.
  void add(std::size_t source, std::size_t period, std::size_t input, const Sequence& noise, double variance) {
    const Motion still{Sequence(steps_ + 1, 0.0L), Sequence(steps_ + 1, 0.0L)};
    std::vector<Motion> all(source, still);
    for (std::size_t i = source; i <= followers_; ++i) {
      if (i == source && noise.empty()) {
        all.push_back(hearers_[i - 1].placed(steps_ + 1));
      } else {
        all.push_back(hearers_[i - 1](all, input, i == source ? noise : Sequence()));
      }
      const FollowerSignals of = signals_of(model_, names_, i);
      for (std::size_t s = 0; s < moments_.size(); ++s) {
        const Signal& signal = s == 0 ? of.error : of.requested[s - 1];
        const ResponseProducts products(signal_values(signal, all[i - 1].position, all[i]), !noise.empty());
        add_products(products.variance, i, period, variance, moments_[s].variance);
        if (!moments_[s].covariance_with_previous.empty())
          add_products(products.covariance, i, period, variance, moments_[s].covariance_with_previous);
      }
    }
  }

  // A follower hears a source, and those whole patterns farther back from the same distance.
  void add_products(const Sequence& products, std::size_t follower, std::size_t period, double variance,
                    std::vector<double>& cells) const {
    for (std::size_t i = follower; i <= followers_; i += period) {
      for (std::size_t k = 0; k < steps_; ++k)
        cells[(i - 1) * steps_ + k] += static_cast<double>(static_cast<long double>(variance) * products[k]);
      if (period == 0) break;
    }
  }

  const PlatoonModel& model_;
  const std::vector<std::string>& names_;
  std::size_t followers_, steps_;
  std::vector<Hearer> hearers_;
  std::vector<SignalMoments> moments_;
};

}  // namespace

std::vector<SignalMoments> hearing_moments(const PlatoonModel& model, const std::vector<std::string>& names,
                                           std::size_t followers, std::int64_t steps) {
  if (any_link(model, [](const LinkModel& link) { return link.loses(); }))
    throw std::invalid_argument("links: lose: must not lose for the moments of every step");
  return HearingTables(model, names, followers, static_cast<std::size_t>(steps))();
}

}  // namespace platoon
