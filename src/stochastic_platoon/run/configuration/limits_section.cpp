#include "stochastic_platoon/run/configuration/limits_section.hpp"

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/limited_vehicle.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

std::string to_text(const Interval& interval) {
  return formatted("[%g, %g]", interval.lower, interval.upper);
}

void read_interval(Section& section, const char* key, std::optional<Interval>& interval) {
  if (!section.has(key)) return;
  const std::size_t before = section.problems();
  const Eigen::VectorXd values = section.numbers(key);
  if (section.problems() > before) return;
  const char* const allowed = "two numbers, [lower, upper], with lower <= 0 <= upper and lower < upper";
  if (values.size() != 2) return section.reject(key, std::to_string(values.size()) + " numbers", allowed);
  interval = Interval{values(0), values(1)};
  if (!(values(0) < values(1)) || !interval->contains(0.0)) section.reject(key, to_text(*interval), allowed);
}

}  // namespace

void read_limits(Section section, VehicleLimits& limits) {
  if (!section.is_mapping()) return;
  read_interval(section, "input", limits.input);
  read_interval(section, "speed", limits.speed);
  section.reject_unknown_keys();
}

nlohmann::json to_json(const VehicleLimits& limits) {
  nlohmann::json document = nlohmann::json::object();
  if (limits.input) document["input"] = {limits.input->lower, limits.input->upper};
  if (limits.speed) document["speed"] = {limits.speed->lower, limits.speed->upper};
  return document;
}

void check_limits(PlatoonModel& model, Section& document) {
  const double speed = start_slope(model) / model.sample_period;
  for (VehicleType& type : model.types) {
    VehicleModel& vehicle = type.vehicle;
    if (!vehicle.limits.any()) continue;
    const std::size_t before = document.problems();
    const auto report = [&](const std::string& problem) {
      const bool is_default = &type == &model.types.front();
      document.report((is_default ? "" : "vehicle_types/" + type.name + "/") + problem);
    };
    if (!vehicle.design) {
      report("limits: given: must be absent beside closed_loop: only a vehicle given by plant and controller has them");
    } else if (vehicle.limits.speed && !actuator_lag(*vehicle.design)) {
      report("limits/speed: " + to_text(*vehicle.limits.speed) +
             ": must be absent for a plant without actuator_lag, which has no speed in its state");
    } else if (vehicle.limits.speed && !vehicle.limits.speed->contains(speed)) {
      report("limits/speed: " + to_text(*vehicle.limits.speed) +
             formatted(": must contain the leader's first speed, %g m/s, as all vehicles start with it (start: steady)",
                       speed));
    }
    if (document.problems() > before) continue;
    vehicle.design->sends_input = true;
    vehicle.loop = close_loop(*vehicle.design, vehicle.headway);
  }
}

bool starts_steady(Section& document) {
  if (document.has("start")) return document.choice("start", {"rest", "steady"}) == "steady";
  if (document.has("limits")) return true;
  if (!document.has("vehicle_types")) return false;
  Section types = document.section("vehicle_types");
  for (const std::string& name : types.keys()) {
    if (types.section(name).has("limits")) return true;
  }
  return false;
}

}  // namespace platoon
