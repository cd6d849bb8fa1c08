#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/linked_string.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"

namespace platoon {

/// The margins of a platoon's pattern as functions of one varied value: gain_margin() and loss_margin().
struct VariedMargins {
  StabilityMargin gain, losses;
  double accuracy = 1e-12;  ///< of a border, relative

  std::vector<StableInterval> intervals(const std::vector<double>& places) const {
    return stable_intervals(losses, places, gain, accuracy);
  }
};

/// `model_at`: the platoon at a value; `known`: a value with a loop. A value without a loop of double integral action
/// counts as unstable, as one does whose margin no spectrum resolves. The pattern of a string that hears predecessors
/// is kept, as both margins need it.
inline VariedMargins varied_margins(std::function<PlatoonModel(double)> model_at, double known) {
  if (!hears_predecessors_only(model_at(known))) {
    const auto margin = [&model_at](double (*of)(const PlatoonModel&)) {
      return [model_at, of](double value) {
        try {
          return of(model_at(value));
        } catch (const std::invalid_argument&) {
          return -1.0;
        }
      };
    };
    return {margin(hearing_gain_margin), margin(hearing_loss_margin),
            1e-7};  // each takes a verdict of the whole string
  }
  struct Varied {
    std::function<PlatoonModel(double)> model_at;
    LinkedPattern known, last;
    double value = std::numeric_limits<double>::quiet_NaN();  // of `last`
  };
  const LinkedPattern pattern(model_at(known));
  const auto varied = std::make_shared<Varied>(Varied{std::move(model_at), pattern, {}});
  const auto margin = [varied](double (*of)(const LinkedPattern&)) {
    return [varied, of](double value) {
      try {
        if (value != varied->value) {
          varied->value = std::numeric_limits<double>::quiet_NaN();
          varied->last = LinkedPattern(varied->model_at(value), varied->known);
          varied->value = value;
        }
        return of(varied->last);
      } catch (const std::invalid_argument&) {
        return -1.0;
      }
    };
  };
  return {margin([](const LinkedPattern& found) { return found.gain_margin(); }),
          margin([](const LinkedPattern& found) { return loss_margin(found); })};
}

}  // namespace platoon
