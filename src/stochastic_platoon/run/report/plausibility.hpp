#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// Mean and variance of a signal at every (i, k), see cell(); NaN where they are unknown.
struct SignalFigures {
  std::string name;  ///< "speed" or "acceleration"; others give no warning
  std::vector<double> mean, variance;
};

constexpr double kFastestCar = 60.0;  ///< [m/s]
constexpr double kHardest = 10.0;     ///< [m/s^2]: no road vehicle brakes or accelerates more
constexpr double kReversing = -0.1;   ///< [m/s]: slower is backwards, beyond the noise of a standing vehicle

/// A sentence for each property of the platoon that no road vehicle has, with its value and unit; empty if there is
/// none:
///
/// - a speed of the leader above 60 m/s, below -0.1 m/s, or beyond its limits; a recorded acceleration beyond them,
/// - an unstable mode that plant and controller cancel, which `allow_unstable` admits,
/// - a headway below 0.05 s or above 10 s,
/// - a standstill distance below the length of the vehicle ahead,
/// - an acceleration with |mean| + 2.58 sigma above 10 m/s^2 at any step, which one realization in a hundred exceeds,
/// - a speed with mean - 2.58 sigma below -0.1 m/s: the vehicle reverses.
///
/// Accelerations and speeds come from the theory: from `known`, figures at all steps of the run, or else for as many of
/// the first followers, and behind losses with memory of the first steps, as it takes milliseconds. Without a theory
/// they are left out, as are external vehicles and those behind them; see motion_warnings().
std::vector<std::string> plausibility_warnings(const Configuration& configuration,
                                               const std::vector<SignalFigures>& known = {});

/// The names with those of the signals that give warnings, unless the run has so many steps and followers that their
/// figures would take longer than milliseconds.
std::vector<std::string> with_motion(std::vector<std::string> names, const RunOptions& run);

/// The first signals with their names, of the first followers.
std::vector<SignalFigures> signal_figures(const std::vector<std::string>& names,
                                          const std::vector<SignalMoments>& signals, std::size_t followers,
                                          std::int64_t steps);

/// The sentences about accelerations and speeds, for measured or theoretical figures over this number of steps.
std::vector<std::string> motion_warnings(const PlatoonModel& model, const std::vector<SignalFigures>& signals,
                                         std::int64_t steps);

/// "Warning: ...", a line for each sentence.
std::string warning_lines(const std::vector<std::string>& warnings);

}  // namespace platoon
