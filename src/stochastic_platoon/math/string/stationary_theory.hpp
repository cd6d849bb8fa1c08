#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/links/linked_string.hpp"
#include "stochastic_platoon/math/links/settled_spectra.hpp"
#include "stochastic_platoon/math/string/hearing_limit.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"
#include "stochastic_platoon/math/string/stationary_signals.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

/// The spectra along a string by the theory that covers it, as walks from vehicle to vehicle: LinkedWalk where vehicles
/// hear their predecessors, HearingWalk, which carries cross spectra, where they hear any vehicles ahead. Both have
///
///     added()            what each input of the next follower adds to the spectrum of its position
///     pass(spectrum)     passes the next follower, which adds this spectrum in all
///     error_variance()   of the tracking error of the follower that was passed last
///     moments(signal)    the variances of a signal of it, and of the change of the signal from step to step
class StationaryTheory {
public:
  /// `model` must outlive the object. `cross_spectra`: also where vehicles hear their predecessors, as the control
  /// inputs need. Throws std::invalid_argument for a model without theory: see no_theory().
  explicit StationaryTheory(const PlatoonModel& model, bool cross_spectra = false) : model_(model) {
    if (hears_predecessors_only(model) && !cross_spectra) pattern_.emplace(model);
    stable_ = pattern_ ? pattern_->mean_square_stable() : !std::isnan(stationary_means(model, 1).front());
  }

  const PlatoonModel& model() const { return model_; }
  bool mean_square_stable() const { return stable_; }

  /// The pattern of a string that has LinkedWalks; null if it has HearingWalks.
  const LinkedPattern* pattern() const { return pattern_ ? &*pattern_ : nullptr; }

  /// values(walk) of this number of followers, on nodes that are refined until the values settle.
  template <class Values>
  std::vector<double> settled(std::size_t followers, const Values& values) const {
    if (!pattern_)
      return settled_hearing(model_, [&](const HearingSpectra& spectra) { return values(HearingWalk(spectra)); });
    return settled_values(*pattern_, followers, [&](const StringSpectra& spectra) {
      return values(LinkedWalk(spectra, metres_per_step(model_)));
    });
  }

  /// The same with a walk through one pattern of an endless string, which must be string stable.
  template <class Values>
  std::vector<double> settled_behind_endless(const Values& values) const {
    if (!pattern_)
      return settled_hearing(model_, [&](const HearingSpectra& spectra) {
        return values(walk_behind_endless(spectra, type_order(model_).size(), loses(model_)));
      });
    return settled_values(*pattern_, std::nullopt, [&](const StringSpectra& spectra) {
      return values(LinkedWalk::behind_endless(spectra, metres_per_step(model_)));
    });
  }

private:
  const PlatoonModel& model_;
  std::optional<LinkedPattern> pattern_;
  bool stable_ = false;
};

/// The functions of the same names for a platoon, by a given theory.
std::vector<double> stationary_variances(const StationaryTheory& theory, std::size_t followers);
std::vector<std::vector<double>> stationary_variances_by_input(const StationaryTheory& theory, std::size_t followers);
std::vector<StationarySignal> stationary_signals(const StationaryTheory& theory, const std::vector<std::string>& names,
                                                 std::size_t followers, bool string_stable);

}  // namespace platoon
