#pragma once

#include <vector>

#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/statistics/agreement.hpp"

namespace platoon {

/// The agreement of many cells, one value of each list per cell. `fourth_moment`: empty for normal values.
inline Agreement agreement_of(const std::vector<Moments>& measured, const std::vector<double>& mean,
                              const std::vector<double>& variance, double rounding = 0.0,
                              const std::vector<double>& fourth_moment = {}) {
  LargestScores scores;
  for (std::size_t c = 0; c < measured.size(); ++c) {
    scores.add(
        {measured[c], mean.at(c), variance.at(c), rounding, {}, fourth_moment.empty() ? kNaN : fourth_moment.at(c)});
  }
  return scores.agreement();
}

}  // namespace platoon
