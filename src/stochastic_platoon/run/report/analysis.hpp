#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/paper/norms.hpp"
#include "stochastic_platoon/math/paper/theorem_two.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/critical_loss.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"

namespace platoon {

/// All that the theory says of a platoon (paper, sections 4 and 5). Without a theory (losses in bursts) it has
/// only `theory`.
struct Analysis {
  StringStability stability;
  std::optional<StableHeadways> headways;   ///< none where the closed loop itself was given: it has no other headway
  std::vector<double> stationary_variance;  ///< [m^2], one per follower; NaN where there is none
  ErrorMoments moments;
  ErrorNorms norms;                          ///< L_2 of the means, L_infinity of the variances
  std::optional<TheoremTwoBounds> bounds;    ///< none where the loop is unstable, or the platoon not the paper's
  double rounding = 0.0;                     ///< [m] to which the vehicles' own arithmetic keeps a position of 1 m
  double integral_defect = 0.0;              ///< by how much T(1) = 1 and dT/dz(1) = -h are missed: no verdict is finer
  std::optional<StableLosses> losses = {};   ///< none without a loss stage
  std::vector<double> stationary_mean = {};  ///< [m], one per follower: what delays and losses leave
  Theory theory = Theory::exact;
};

/// Hears what is computed next.
using StageObserver = std::function<void(const char* stage)>;

Analysis analyze(
    const PlatoonModel& model, std::size_t followers, std::int64_t steps,
    const StageObserver& begins = [](const char*) {});

/// One point of a sweep or a map over headway, gain and loss probability of the default vehicle.
struct SweepPoint {
  double headway;
  double gain;  ///< leading coefficient of the controller's numerator, as the model file gives it; NaN without one
  StringStability stability;
  std::optional<double> loss = {};  ///< probability, where the link has a loss stage
};

/// What a sweep goes over; an empty list is the model's own value.
struct SweepAxes {
  std::vector<double> headways, gains, losses;
};

/// Stability at every combination. Throws std::invalid_argument where headways or gains are given and the closed
/// loop itself was given, and for losses in bursts.
std::vector<SweepPoint> sweep(const PlatoonModel& model, const SweepAxes& axes);

/// For a person: the verdict first, then why.
std::string report(const PlatoonModel& model, const Analysis& analysis);

/// For programs; what does not exist is null.
nlohmann::json to_json(const PlatoonModel& model, const Analysis& analysis);
nlohmann::json to_json(const std::vector<SweepPoint>& points);

/// headway,gain,spectral_radius,peak_gain,string_stable: a row per point; with a loss stage
/// headway,gain,loss,spectral_radius,peak_gain,loss_gain,string_stable.
std::string to_csv(const std::vector<SweepPoint>& points);

}  // namespace platoon
