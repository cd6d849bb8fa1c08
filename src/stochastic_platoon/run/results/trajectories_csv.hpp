#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// All vehicles of one realization of a run.
struct TrajectoryColumns {
  std::vector<double> seconds;  ///< of steps -1, 0, ..., to ten digits [s]
  /// By name ("position", ..., "jerk"): vehicles 0, 1, ... in turn, each with a value per step; NaN where none exists.
  /// Inputs of a vehicle that hears others than its predecessor, apart from its first position, follow as "received_n"
  /// with their place n in the model file.
  std::vector<std::pair<std::string, std::vector<double>>> quantities;
};

/// One realization of a run, with changed draws if there are any. Throws ConfigurationError if the run has no such
/// realization.
TrajectoryColumns trajectory_columns(const Configuration& configuration, std::uint64_t realization,
                                     const std::shared_ptr<const ChangedDraws>& changes = nullptr);

/// The content of trajectories.csv: the same, with a row per vehicle and step; values that do not exist are empty.
std::string trajectories_csv(const Configuration& configuration, std::uint64_t realization,
                             const std::shared_ptr<const ChangedDraws>& changes = nullptr);

}  // namespace platoon
