#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/report/robustness.hpp"

namespace platoon {

/// One point of a stability map over headway, gain, loss probability and mean burst of the default vehicle.
struct MapPoint {
  double headway;
  double gain;  ///< leading coefficient of the controller's numerator, as in the model file; NaN without a controller
  StringStability stability;
  std::optional<double> loss = {};   ///< loss probability, if the link has a loss stage
  std::optional<double> burst = {};  ///< mean burst, if the map varies it
  Robustness robustness = {};
};

/// The values along each axis; an empty list stands for the model's own value.
struct MapAxes {
  std::vector<double> headways, gains, losses, bursts = {};
};

/// Stability at every combination, of vehicles with limits that of the same cars without. Losses in bursts keep their
/// mean burst where the map does not vary it; a combination of probability and mean burst for which no Markov chain
/// exists is undecided. Throws std::invalid_argument for a value that the model file does not allow, where there is no
/// theory (see no_theory()), and for headways or gains if the closed loop was given directly.
std::vector<MapPoint> stability_map(const PlatoonModel& model, const MapAxes& axes);

/// JSON for programs; missing values are null. `sample_period` [s]: of the margins in seconds.
nlohmann::json to_json(const std::vector<MapPoint>& points, double sample_period);

/// One row per point: headway,gain,spectral_radius,peak_gain,string_stable; with a loss stage
/// headway,gain,loss,spectral_radius,peak_gain,loss_gain,string_stable, and with varied bursts mean_burst after loss.
/// With a `sample_period` [s], the figures of the robustness follow, by their names in the JSON.
std::string to_csv(const std::vector<MapPoint>& points, std::optional<double> sample_period = {});

/// The same as a table for people; "-" for missing values.
std::string report(const std::vector<MapPoint>& points);

}  // namespace platoon
