#include "stochastic_platoon/math/string/signal_moments.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/links/string_responses.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"

namespace platoon {

namespace {

using Sequence = VehicleResponse::Sequence;

/// What a source of variance 1 with this response adds to the variance of a signal, and to its covariance with the step
/// before, at every step from 0 on: sums over the steps for a noise, and the last term of each for one value at step
/// -1.
struct ResponseProducts {
  Sequence variance, covariance;

  ResponseProducts(const Sequence& response, bool is_noise) {
    check_interruption();
    for (std::size_t a = 1; a < response.size(); ++a) {
      variance.push_back(response[a] * response[a]);
      covariance.push_back(response[a - 1] * response[a]);
    }
    if (!is_noise) return;
    for (Sequence* sums : {&variance, &covariance}) {
      for (std::size_t k = 1; k < sums->size(); ++k) (*sums)[k] += (*sums)[k - 1];
    }
  }

  void add(const ResponseProducts& other) {
    for (std::size_t k = 0; k < variance.size(); ++k) variance[k] += other.variance[k];
    for (std::size_t k = 0; k < covariance.size(); ++k) covariance[k] += other.covariance[k];
  }
};

/// The variances of signals, one list of signals per follower, as sums over the sources of a string whose links do not
/// lose.
class SourceMoments {
public:
  SourceMoments(const PlatoonModel& model, const SignalLists& signals, std::size_t steps)
      : signals_(signals), steps_(steps), responses_(model, signals.size(), steps) {}

  void operator()(std::vector<SignalMoments>& moments) const {
    for (SignalMoments& each : moments) each.variance.assign(signals_.size() * steps_, 0.0);
    for (std::size_t i = 1; i <= std::min(signals_.size(), responses_.different().count()); ++i) {
      for (const StringResponses::Source& source : responses_.sources(i)) add(source, moments);
    }
  }

private:
  // A follower hears a source, and those whole patterns farther back from the same distance: it has their shares, too.
  void add(const StringResponses::Source& source, std::vector<SignalMoments>& moments) const {
    const DifferentFollowers& different = responses_.different();
    const std::size_t period = source.follower > different.alone ? different.period : signals_.size();
    std::vector<std::vector<ResponseProducts>> sums(period);  // of the last followers, one entry per signal
    responses_.visit(source, [&](std::size_t i, const Sequence& predecessor, const StringResponses::Response& of) {
      std::vector<ResponseProducts>& before = sums[i % period];
      for (std::size_t s = 0; s < moments.size(); ++s) {
        const ResponseProducts share(signal_values(signals_[i - 1][s], predecessor, of.own), source.input.has_value());
        if (before.size() == s) {
          before.push_back(share);
        } else {
          before[s].add(share);
        }
        add_to(moments[s].variance, i, before[s].variance, source.variance);
        if (!moments[s].covariance_with_previous.empty())
          add_to(moments[s].covariance_with_previous, i, before[s].covariance, source.variance);
      }
    });
  }

  void add_to(std::vector<double>& cells, std::size_t i, const Sequence& sums, double variance) const {
    for (std::size_t k = 0; k < steps_; ++k)
      cells[(i - 1) * steps_ + k] += static_cast<double>(static_cast<long double>(variance) * sums[k]);
  }

  const SignalLists& signals_;  ///< per follower
  std::size_t steps_;
  StringResponses responses_;
};

// Means in a string whose vehicles hear their predecessors only.
void add_linked_means(const PlatoonModel& model, const SignalLists& signals, std::size_t steps,
                      std::vector<SignalMoments>& moments) {
  const StringResponses responses(model, signals.size(), steps, StringResponses::Pass::innovations);
  responses.visit_means([&](std::size_t i, const Sequence& predecessor, const StringResponses::Response& of) {
    for (std::size_t s = 0; s < moments.size(); ++s) {
      add_means(signals[i - 1][s], vehicle(model, i).standstill_distance, predecessor, of.own, moments[s].mean);
    }
  });
}

// Means in any string: the motion without noise.
void add_quiet_means(PlatoonModel model, const std::vector<std::string>& names, std::size_t followers,
                     std::size_t steps, std::vector<SignalMoments>& moments) {
  for (VehicleType& type : model.types) {
    for (Input& input : type.vehicle.inputs) {
      input.noise_variance = 0.0;
      input.link.quantisation_step = 0.0;
    }
    type.vehicle.initial_position.variance = 0.0;
  }
  for_each_trajectory(model, 1, followers, static_cast<std::int64_t>(steps), 0, names, [&](const Trajectory& of) {
    if (of.received.empty()) return;  // vehicle 0
    for (std::size_t s = 0; s < moments.size(); ++s) {
      const std::vector<double>& values = names.empty() ? of.signals[0] : of.signals[s + 1];
      moments[s].mean.insert(moments[s].mean.end(), values.begin(), values.end());
    }
  });
}

std::vector<SignalMoments> tables(const PlatoonModel& model, const std::vector<std::string>& names,
                                  std::size_t followers, std::size_t steps) {
  const SignalLists signals = signal_lists(model, names, followers);
  std::vector<SignalMoments> moments(signals.front().size(), {static_cast<std::int64_t>(steps), followers});
  for (std::size_t s = 0; s < names.size(); ++s) {
    if (names[s] == kGap) moments[s].covariance_with_previous.assign(followers * steps, 0.0);
  }
  if (hears_predecessors_only(model))
    add_linked_means(model, signals, steps, moments);
  else
    add_quiet_means(model, names, followers, steps, moments);
  SourceMoments(model, signals, steps)(moments);
  return moments;
}

void require_size(std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
}

// The model, its vehicles with their control input if that is among the signals. Throws as signal_moments() does.
PlatoonModel model_for(PlatoonModel model, const std::vector<std::string>& names, std::size_t followers,
                       std::int64_t steps) {
  require_size(followers, steps);
  if (const auto reason = no_theory(model)) throw std::invalid_argument("no theory, as " + *reason);
  for (const std::size_t t : type_order(model)) {
    if (std::count(names.begin(), names.end(), kInput) == 0) break;
    VehicleModel& of = model.types[t].vehicle;
    if (!of.loop.parts) throw std::invalid_argument(std::string("signals: input: must be absent unless ") + kWithInput);
    of.design->sends_input = true;
  }
  return model;
}

}  // namespace

std::vector<SignalMoments> signal_moments(const PlatoonModel& model, const std::vector<std::string>& names,
                                          std::size_t followers, std::int64_t steps) {
  PlatoonModel computed = model_for(model, names, followers, steps);
  if (names.empty()) return {};
  const auto count = static_cast<std::size_t>(steps);
  if (needs_chain_moments(model)) return chain_moments(computed, signal_lists(model, names, followers), steps);
  if (!hears_predecessors_only(model)) return tables(computed, names, followers, count);
  for (const VehicleModel& vehicle : pattern(model)) unit_equilibrium(vehicle.loop.realization);
  const bool moves = start_slope(model) != 0.0;
  if (moves) computed = in_moving_frame(std::move(computed));
  std::vector<SignalMoments> found = loses(model)
                                         ? linked_moments(computed, signal_lists(model, names, followers), steps)
                                         : tables(computed, names, followers, count);
  for (std::size_t s = 0; moves && s < names.size(); ++s) {
    for (std::size_t c = 0; c < found[s].mean.size(); ++c) {
      const std::size_t follower = c / count + 1;
      found[s].mean[c] += steady_value(model, signals_of(model, {names[s]}, follower).requested.front(), follower);
    }
  }
  return found;
}

StringMoments string_moments(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
                             std::int64_t steps, std::vector<double>* fourth_cumulants) {
  if (names.empty() || !needs_chain_moments(model))
    return {error_moments(model, followers, steps, fourth_cumulants), signal_moments(model, names, followers, steps)};
  SignalLists signals = signal_lists(model, names, followers);
  for (std::size_t i = 1; i <= followers; ++i) signals[i - 1].insert(signals[i - 1].begin(), tracking_error(model, i));
  std::vector<SignalMoments> all = chain_moments(model_for(model, names, followers, steps), signals, steps);
  StringMoments moments{std::move(all.front()), {}};
  moments.signals.assign(std::make_move_iterator(all.begin() + 1), std::make_move_iterator(all.end()));
  return moments;
}

SignalMoments hearing_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  require_size(followers, steps);
  if (loses(model)) throw std::invalid_argument("links: lose: must not lose for the moments of every step");
  return tables(model, {}, followers, static_cast<std::size_t>(steps)).front();
}

}  // namespace platoon
