#pragma once

#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

namespace platoon {

/// The pattern of a platoon as a function of one varied value, and its margins. Keeps the pattern at the last place, as
/// both margins need it.
template <class Pattern>
class VariedPattern {
public:
  using Former = Pattern (*)(const PlatoonModel&, const Pattern& known);
  using Margin = double (*)(const Pattern&);

  /// Margins as linked_gain_margin() and linked_loss_margin().
  VariedPattern(std::function<PlatoonModel(double)> model_at, double known, Former former, Margin gain_margin,
                Margin loss_margin)
      : model_at_(std::move(model_at)),
        former_(former),
        gain_(gain_margin),
        losses_(loss_margin),
        known_(former(model_at_(known), {})) {}

  StabilityMargin gain() {
    return [this](double place) { return of(gain_, place); };
  }
  StabilityMargin losses() {
    return [this](double place) { return of(losses_, place); };
  }

private:
  // A value without a loop of double integral action counts as unstable.
  double of(Margin margin, double place) {
    try {
      if (place != place_) {
        place_ = std::numeric_limits<double>::quiet_NaN();
        last_ = former_(model_at_(place), known_);
        place_ = place;
      }
      return margin(last_);
    } catch (const std::invalid_argument&) {
      return -1.0;
    }
  }

  std::function<PlatoonModel(double)> model_at_;
  Former former_;
  Margin gain_, losses_;
  Pattern known_, last_;
  double place_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace platoon
