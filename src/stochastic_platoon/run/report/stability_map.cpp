#include "stochastic_platoon/run/report/stability_map.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/csv_text.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"

namespace platoon {

namespace {

StringStability stability_of(const PlatoonModel& model) {
  const bool exists = !any_link(model, [](const LinkModel& link) {
    return link.loss && link.loss->mean_burst && !(*link.loss->mean_burst >= link.loss->least_burst());
  });
  const std::optional<std::string> reason = exists ? no_theory(model) : "no chain of losses has so short bursts";
  if (!reason) return string_stability(model);
  StringStability unknown;
  unknown.spectral_radius = kNaN;
  unknown.undecided = true;
  unknown.reason = *reason;
  return unknown;
}

// Throws unless all values are finite and satisfy the condition that `allowed` states.
template <typename Condition>
void require_all(const char* name, const std::vector<double>& values, const char* allowed, const Condition& condition) {
  for (const double value : values) {
    if (!std::isfinite(value) || !condition(value))
      throw std::invalid_argument(formatted("%s: %g: must be %s", name, value, allowed));
  }
}

}  // namespace

std::vector<MapPoint> stability_map(const PlatoonModel& model, const MapAxes& axes) {
  if (has_limits(model)) return stability_map(without_limits(model, 0), axes);
  const auto above_zero = [](double value) { return value > 0.0; };
  require_all("headway", axes.headways, "a finite number > 0", above_zero);
  require_all("gain", axes.gains, "a finite number > 0", above_zero);
  require_all("loss", axes.losses, "from 0 to below 1", [](double value) { return value >= 0.0 && value < 1.0; });
  require_all("mean_burst", axes.bursts, "a finite number >= 1", [](double value) { return value >= 1.0; });
  if (!model.default_vehicle().design && !(axes.headways.empty() && axes.gains.empty())) {
    throw std::invalid_argument("closed_loop: given: must be plant and controller for a stability map over headways");
  }
  if (model.default_vehicle().constant_spacing && !axes.headways.empty())
    throw std::invalid_argument("headway: given: must be absent beside spacing: constant");
  if (const auto reason = no_theory(model))
    throw std::invalid_argument("mean_burst: no stability map without a theory: " + *reason);
  const std::optional<LossModel>& own_loss = model.default_vehicle().varied_link().loss;
  if (own_loss && own_loss->markov && !(axes.losses.empty() && axes.bursts.empty()))
    throw std::invalid_argument("markov: given: must be absent for a stability map over losses or mean bursts");
  const auto or_own = [](const std::vector<double>& values, double own) {
    return values.empty() ? std::vector<double>{own} : values;
  };
  const VehicleModel& own = model.default_vehicle();
  std::vector<MapPoint> points;
  for (const double gain : or_own(axes.gains, own.design ? own.design->controller.gain() : kNaN)) {
    for (const double loss : or_own(axes.losses, own.varied_link().loss ? own.varied_link().loss->probability : kNaN)) {
      for (const double burst : or_own(axes.bursts, kNaN))
        for (const double headway : or_own(axes.headways, own.headway)) {
          PlatoonModel varied = model;
          if (!axes.gains.empty()) varied = with_gain(std::move(varied), gain);
          if (!axes.headways.empty()) varied = with_headway(std::move(varied), headway);
          if (!axes.losses.empty()) varied = with_loss(with_loss_stage(std::move(varied)), loss);
          if (!std::isnan(burst)) varied = with_mean_burst(std::move(varied), burst);
          points.push_back({headway, gain, stability_of(varied), {}, {}});
          if (varied.default_vehicle().varied_link().loss) points.back().loss = loss;
          if (!axes.bursts.empty()) points.back().burst = burst;
          if (!points.back().stability.undecided) points.back().robustness = robustness(varied);
        }
    }
  }
  return points;
}

nlohmann::json to_json(const std::vector<MapPoint>& points, double sample_period) {
  nlohmann::json list = nlohmann::json::array();
  for (const MapPoint& point : points) {
    nlohmann::json document = to_json(point.stability);
    document.update(to_json(point.robustness, sample_period));
    document.update({{"headway", point.headway},
                     {"gain", number(point.gain)},
                     {"loss", number(point.loss)},
                     {"mean_burst", number(point.burst)}});
    list.push_back(std::move(document));
  }
  return list;
}

std::string to_csv(const std::vector<MapPoint>& points, std::optional<double> sample_period) {
  const bool lossy = !points.empty() && points.front().loss;
  const bool in_bursts = !points.empty() && points.front().burst;
  CsvText csv("headway,gain");
  if (lossy) csv.add("loss");
  if (in_bursts) csv.add("mean_burst");
  csv.add("spectral_radius,peak_gain");
  if (lossy) csv.add("loss_gain");
  csv.add("string_stable");
  if (sample_period) csv.add("phase_margin,delay_margin,sensitivity_peak,critical_delay");
  csv.end_row();
  // A value is missing without a controller or for an unstable vehicle.
  const auto known = [](std::optional<double> value) { return value && std::isnan(*value) ? std::nullopt : value; };
  for (const MapPoint& point : points) {
    const StringStability& stability = point.stability;
    csv.add(known(point.headway), known(point.gain));
    if (lossy) csv.add(known(point.loss));
    if (in_bursts) csv.add(known(point.burst));
    csv.add(known(stability.spectral_radius), known(stability.peak_gain));
    if (lossy) csv.add(known(stability.loss_gain));
    csv.add(stability.undecided ? "" : stability.string_stable ? "1" : "0");
    const nlohmann::json figures = to_json(point.robustness, sample_period.value_or(kNaN));
    for (const char* figure : {"phase_margin", "delay_margin", "sensitivity_peak", "critical_delay"}) {
      const nlohmann::json& value = figures.at(figure);
      if (sample_period) csv.add(value.is_null() ? std::nullopt : std::optional<double>(value.get<double>()));
    }
    csv.end_row();
  }
  return csv.text();
}

std::string report(const std::vector<MapPoint>& points) {
  if (points.empty()) return "";
  const bool lossy = points.front().loss.has_value(), in_bursts = points.front().burst.has_value();
  std::string text = std::string("\n   headway        gain") + (lossy ? "        loss" : "") +
                     (in_bursts ? "  mean burst" : "") + "      rho(A)   peak gain" + (lossy ? "   loss gain" : "") +
                     "   string stable\n";
  const auto column = [](double value) {
    return std::isnan(value) ? std::string("           -") : formatted(" %11.9g", value);
  };
  for (const MapPoint& point : points) {
    text += formatted("%10.6g", point.headway) + column(point.gain);
    if (lossy) text += column(*point.loss);
    if (in_bursts) text += column(*point.burst);
    text += column(point.stability.spectral_radius) + column(point.stability.peak_gain);
    if (lossy) text += column(point.stability.loss_gain.value_or(std::nan("")));
    const std::optional<bool> stable = point.stability.decision();
    text += std::string("   ") + (!stable ? "undecided" : *stable ? "yes" : "no") + "\n";
  }
  return text;
}

}  // namespace platoon
