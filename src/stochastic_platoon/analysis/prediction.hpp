#pragma once

#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/theory/string_stability.hpp"

namespace platoon {

/// What the paper predicts for a configuration: a cell for each cell of the measurement, that is one per
/// follower and step (see cell()), or the stationary values, one per follower, where averages are over time.
struct Prediction {
  StringStability stability;
  std::vector<double> stationary_variance;  ///< [m^2], one per follower; NaN where there is none
  std::vector<double> mean;                 ///< [m], one per cell
  std::vector<double> variance;             ///< [m^2], one per cell
  std::vector<double> rounding = {};        ///< [m], one per cell: see rounding_bounds(); empty over time
};

Prediction predict(const Configuration& configuration);

}  // namespace platoon
