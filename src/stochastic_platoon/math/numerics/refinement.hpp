#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

/// The largest relative change from a to b, ignoring entries of b that are 0 or not finite.
inline double largest_change(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(b[i]) || b[i] == 0.0) continue;
    const double change = std::abs(a[i] - b[i]) / b[i];
    largest = std::isnan(change) ? std::numeric_limits<double>::infinity() : std::max(largest, change);
  }
  return largest;
}

/// values(refinement) of a quadrature, refined until the values settle, at most four times.
template <class Values>
std::vector<double> refined(const Values& values) {
  std::vector<double> coarse = values(0);
  double before = std::numeric_limits<double>::infinity();
  for (int refinement = 1; refinement <= 4; ++refinement) {
    std::vector<double> fine = values(refinement);
    const double change = largest_change(coarse, fine);
    if (is_converged(change, before)) return fine;
    coarse.swap(fine);
    before = change;
  }
  return coarse;
}

}  // namespace platoon
