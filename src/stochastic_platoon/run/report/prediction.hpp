#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/effective_sample.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// For files and messages: "exact" or "none".
inline const char* name_of_theory(bool exists) {
  return exists ? "exact" : "none";
}

/// The reason of a verdict where there is no theory.
inline std::string reason_without_theory(const std::string& reason) {
  return "none, as " + reason;
}

/// The theory's prediction for a configuration: one cell per cell of the measurement, that is, per follower and step
/// (see cell()), or the stationary values, one per follower, for averages over time.
///
/// Without a theory every value is NaN. In a string with external vehicles the theory covers the followers before the
/// first of them; the stability is that of these followers, continued to an infinite string.
struct Prediction {
  StringStability stability;
  std::vector<double> stationary_variance;  ///< [m^2], one per follower; NaN if there is none
  std::vector<double> mean;                 ///< [m], one per cell
  std::vector<double> variance;             ///< [m^2], one per cell
  /// [m], one per cell, at least that of rounding_bounds(). Over time: what the burn-in leaves of the start, where the
  /// theory has no variance, and 0 elsewhere.
  std::vector<double> rounding = {};
  /// [m^4], one per cell: see linked_error_moments(); infinite where it is unknown and the variance is not judged.
  /// Empty over time, without losses, and for losses in bursts.
  std::vector<double> fourth_cumulant = {};
  std::size_t remainders = 0;  ///< cells of unknown fourth cumulant
  std::size_t followers_with_theory = 0;
  std::vector<ErrorCorrelation> error_correlation = {};  ///< over time: one per follower
  /// The moments of each requested signal, one cell per follower and step; empty over time and without a theory.
  std::vector<SignalMoments> signals = {};
  std::vector<double> signal_rounding = {};      ///< see platoon::signal_rounding(), one per requested signal
  bool normal = true;                            ///< see has_normal_errors()
  std::vector<double> collision_bound = {};      ///< see collision_bounds(), one per follower; only of normal gaps
  std::vector<std::string> contradictions = {};  ///< see contradictions()
  std::vector<std::string> warnings = {};        ///< see plausibility_warnings()
  std::string warning = {};  ///< the reason why a run with a theory is not compared with all of it; empty: none
  bool means_only = false;   ///< despite the reason its means are compared

  bool has_theory() const { return followers_with_theory > 0; }
};

/// A verdict with its figures, the same in all files: null where there is none, `string_stable` if it is undecided.
nlohmann::json to_json(const StringStability& stability);

/// The line of a report for figures that must agree and do not.
std::string contradiction_line(const std::string& contradiction);

Prediction predict(const Configuration& configuration);

}  // namespace platoon
