#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/numerics/stable_intervals.hpp"
#include "stochastic_platoon/math/string/string_theory.hpp"

namespace platoon {

/// The margins of a platoon as functions of one varied value: StringTheory::gain_margin() and loss_margin().
struct VariedMargins {
  StabilityMargin gain, losses;
  double accuracy;  ///< of a border, relative

  std::vector<StableInterval> intervals(const std::vector<double>& places) const {
    return stable_intervals(losses, places, gain, accuracy);
  }
};

/// `model_at`: the platoon at a value; `known`: a value with a loop. A value without a loop of double integral action
/// counts as unstable, as one does whose margin no spectrum resolves. The latest theory is kept, as both margins need
/// it.
inline VariedMargins varied_margins(std::function<PlatoonModel(double)> model_at, double known) {
  struct Varied {
    std::function<PlatoonModel(double)> model_at;
    std::unique_ptr<const StringTheory> known, last;
    double value = std::numeric_limits<double>::quiet_NaN();  // of `last`
  };
  std::unique_ptr<const StringTheory> theory = StringTheory::of(model_at(known));
  const double accuracy = theory->border_accuracy();
  const auto varied = std::make_shared<Varied>(Varied{std::move(model_at), std::move(theory), nullptr});
  const auto margin = [varied](double (*of)(const StringTheory&)) {
    return [varied, of](double value) {
      try {
        if (value != varied->value) {
          varied->value = std::numeric_limits<double>::quiet_NaN();
          varied->last = StringTheory::of(varied->model_at(value), false, varied->known.get());
          varied->value = value;
        }
        return of(*varied->last);
      } catch (const std::invalid_argument&) {
        return -1.0;
      }
    };
  };
  return {margin([](const StringTheory& found) { return found.gain_margin(); }),
          margin([](const StringTheory& found) { return found.loss_margin(); }), accuracy};
}

}  // namespace platoon
