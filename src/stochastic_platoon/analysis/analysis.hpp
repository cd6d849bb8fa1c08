#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/theory/critical_headway.hpp"
#include "stochastic_platoon/theory/error_moments.hpp"
#include "stochastic_platoon/theory/norms.hpp"
#include "stochastic_platoon/theory/string_stability.hpp"
#include "stochastic_platoon/theory/theorem_two.hpp"

namespace platoon {

/// All that the theory says of a platoon (paper, sections 4 and 5).
struct Analysis {
  StringStability stability;
  std::optional<StableHeadways>
      headways;  ///< none where the closed loop itself was given: it has no other headway
  std::vector<double> stationary_variance;  ///< [m^2], one per follower; NaN where there is none
  ErrorMoments moments;
  ErrorNorms norms;                        ///< L_2 of the means, L_infinity of the variances
  std::optional<TheoremTwoBounds> bounds;  ///< none where the loop is unstable
  double rounding = 0.0;         ///< [m] to which the vehicles' own arithmetic keeps a position of 1 m
  double integral_defect = 0.0;  ///< by how much T(1) = 1 and dT/dz(1) = -h are missed: no verdict is finer
};

Analysis analyze(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

/// One headway of a sweep, or one point of a map over headway and gain.
struct SweepPoint {
  double headway;
  double gain;  ///< leading coefficient of the controller's numerator, as the model file gives it
  StringStability stability;
};

/// Stability at each headway, and at each gain in `gains` (empty: the model's own). Throws
/// std::invalid_argument where the closed loop itself was given.
std::vector<SweepPoint> sweep(const PlatoonModel& model, const std::vector<double>& headways,
                              const std::vector<double>& gains);

/// For a person: the verdict first, then why.
std::string report(const PlatoonModel& model, const Analysis& analysis);

/// For programs; what does not exist is null.
nlohmann::json to_json(const PlatoonModel& model, const Analysis& analysis);
nlohmann::json to_json(const std::vector<SweepPoint>& points);

/// headway,gain,spectral_radius,peak_gain,string_stable: a row per point.
std::string to_csv(const std::vector<SweepPoint>& points);

}  // namespace platoon
