#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/statistics/moments.hpp"

namespace platoon {

/// How far a measured mean and variance lie from the theory, in standard errors of the estimators.
struct Scores {
  double mean;
  double variance;
};

/// (mean - theory) / sqrt(v / n) and (variance - theory) / (v sqrt(2 / (n - 1))), v the theoretical variance.
/// Where theory has no variance, a measurement equal to it up to rounding scores 0 and any other infinity.
Scores scores(const Moments& measured, double theoretical_mean, double theoretical_variance);

/// The largest scores in modulus over many cells.
struct Agreement {
  double max_abs_z_mean = 0.0;
  double max_abs_z_variance = 0.0;
};

/// Throws std::invalid_argument when the three sizes differ.
Agreement agreement(const std::vector<Moments>& measured, const std::vector<double>& theoretical_mean,
                    const std::vector<double>& theoretical_variance);

/// The score that the largest of `comparisons` standard normals exceeds in modulus with probability of at
/// most 0.001 (Bonferroni): beyond it measurement and theory disagree.
double largest_plausible_score(std::size_t comparisons);

}  // namespace platoon
