#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/links/linked_string.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"

namespace platoon {

/// The margins of a platoon's pattern as functions of one varied value: gain_margin() and loss_margin().
struct VariedMargins {
  StabilityMargin gain, losses;
};

/// `model_at`: the platoon at a value; `known`: a value with a loop. A value without a loop of double integral action
/// counts as unstable. A string that hears others than predecessors must not lose. The pattern at the last value is
/// kept, as both margins need it.
inline VariedMargins varied_margins(std::function<PlatoonModel(double)> model_at, double known) {
  if (!hears_predecessors_only(model_at(known))) {
    const auto margin = [model_at](double value) {
      try {
        return hearing_gain_margin(model_at(value));
      } catch (const std::invalid_argument&) {
        return -1.0;
      }
    };
    return {margin, [](double) { return 1.0; }};
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
