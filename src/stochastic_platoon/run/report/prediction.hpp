#pragma once

#include <vector>

#include "stochastic_platoon/math/string/effective_sample.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// What is known of a platoon's errors without running it.
enum class Theory {
  exact,  ///< mean and variance of every (i, k)
  none,
};

/// "exact" or "none".
const char* to_string(Theory theory);

/// Which theory there is for a platoon.
Theory theory_of(const PlatoonModel& model);

/// What the theory predicts for a configuration: a cell for each cell of the measurement, that is one per
/// follower and step (see cell()), or the stationary values, one per follower, where averages are over time.
///
/// Without a theory every value is NaN. In a string with external vehicles the followers
/// before the first of them have a theory; what the stability says is of these, continued for ever.
struct Prediction {
  StringStability stability;
  std::vector<double> stationary_variance;  ///< [m^2], one per follower; NaN where there is none
  std::vector<double> mean;                 ///< [m], one per cell
  std::vector<double> variance;             ///< [m^2], one per cell
  std::vector<double> rounding = {};        ///< [m], one per cell: see rounding_bounds(); empty over time
  /// [m^4], one per cell: see linked_error_moments(); empty over time, and where nothing is lost
  std::vector<double> fourth_cumulant = {};
  Theory theory = Theory::exact;  ///< none where no follower has one
  std::size_t followers_with_theory = 0;
  std::vector<ErrorCorrelation> error_correlation = {};  ///< over time: one per follower
};

Prediction predict(const Configuration& configuration);

}  // namespace platoon
