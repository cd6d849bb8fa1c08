#include "stochastic_platoon/run/configuration/model_file.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/design_section.hpp"
#include "stochastic_platoon/run/configuration/fraction.hpp"
#include "stochastic_platoon/run/configuration/inputs_section.hpp"
#include "stochastic_platoon/run/configuration/leader_section.hpp"
#include "stochastic_platoon/run/configuration/limits_section.hpp"
#include "stochastic_platoon/run/configuration/link_section.hpp"
#include "stochastic_platoon/run/configuration/spacing_section.hpp"

namespace platoon {

namespace {

// ROS stamps count nanoseconds and end after 136 years.
const Allowed kSamplePeriod{"a finite number >= 1e-9", 1e-9, 1e6};

std::optional<ClosedLoop> read_given_loop(Section section) {
  const std::size_t before = section.problems();
  const Eigen::MatrixXd a = section.matrix("A");
  const Eigen::VectorXd b = section.numbers("B", kLongestRow);
  const Eigen::VectorXd c = section.numbers("C", kLongestRow);
  section.reject_unknown_keys();
  if (section.problems() > before) return std::nullopt;
  try {
    return closed_loop_from(StateSpace(a, b, c.transpose()));
  } catch (const std::invalid_argument& error) {
    section.report(error.what());
    return std::nullopt;
  }
}

InitialPosition read_initial_position(Section section) {
  InitialPosition position;
  position.mean = section.number("mean", kAnyFinite);
  position.variance = section.number("variance", kNotNegative);
  section.reject_unknown_keys();
  return position;
}

// Reads the loop of a vehicle whose other values are known. Keys that a type omits are as in `base`, the default
// vehicle; `base` is null for that vehicle itself.
void read_loop(Section& section, const VehicleModel* base, double sample_period, VehicleModel& vehicle) {
  const std::size_t before = section.problems();
  const bool designed = section.has("plant") || section.has("controller");
  if (section.has("closed_loop")) {
    for (const char* key : {"plant", "controller"}) {
      if (section.has(key)) section.reject(key, "given", "absent beside closed_loop, which replaces it");
    }
    vehicle.design.reset();
    if (!section.has("limits")) vehicle.limits = {};
    const std::optional<ClosedLoop> given = read_given_loop(section.section("closed_loop"));
    if (given) vehicle.loop = *given;
    return;
  }
  if (base == nullptr || designed) {
    vehicle.design = read_design(section, vehicle.design, sample_period);
  } else if (vehicle.headway == base->headway || !vehicle.design) {
    return;
  }
  if (section.problems() > before) return;
  try {
    vehicle.loop = close_loop(*vehicle.design, vehicle.headway);
  } catch (const std::invalid_argument& error) {
    const std::string key = base == nullptr || designed ? "plant, controller" : "time_headway";
    section.report(key + ": " + error.what());
  }
}

VehicleModel read_vehicle(Section& section, const VehicleModel* base, double sample_period, bool allow_unstable) {
  VehicleModel vehicle = base != nullptr ? *base : VehicleModel(close_loop(placeholder_design(), 1.0), 1.0);
  const auto number = [&](const char* key, const Allowed& allowed, double& value) {
    if (base == nullptr || section.has(key)) value = section.number(key, allowed);
  };
  read_spacing(section, base, sample_period, vehicle);
  number("standstill_distance", kNotNegative, vehicle.standstill_distance);
  if (section.has("vehicle_length")) vehicle.length = section.number("vehicle_length", kNotNegative);
  if (section.has("limits")) read_limits(section.section("limits"), vehicle.limits);
  const GivenInputs given = section.has("inputs") ? read_inputs(section, vehicle, allow_unstable) : GivenInputs{};
  if (!given.noise_variance) number("noise_variance", kNotNegative, vehicle.position().noise_variance);
  if (base == nullptr || section.has("initial_position"))
    vehicle.initial_position = read_initial_position(section.section("initial_position"));
  read_loop(section, base, sample_period, vehicle);
  if (!given.channel && section.has("channel"))
    vehicle.position().link = read_link(section.section("channel"), vehicle.position().link, allow_unstable);
  return vehicle;
}

Inherited inherited_by(Section& type, const VehicleModel& base) {
  const bool own_loop = type.has("closed_loop"), inputs = !type.has("inputs");
  const bool losses = inputs && base.varied_link().loss, of_position = &base.varied_link() == &base.position().link;
  Inherited inherited{!type.has("time_headway") && !type.has("time_headway_seconds") && !type.has("spacing"),
                      !own_loop && !type.has("plant"),
                      !own_loop && !type.has("controller"),
                      losses,
                      losses,
                      inputs,
                      inputs && !type.has("noise_variance"),
                      inputs && !type.has("channel")};
  if (!losses || !of_position || !type.has("channel")) return inherited;
  Section channel = type.section("channel");
  if (!channel.has("loss")) return inherited;
  Section loss = channel.section("loss");
  const bool has_own = loss.has("trace") || loss.has("runs") || loss.has("by_distance") || loss.has("markov");
  inherited.loss_probability = !has_own && !loss.has("probability");
  inherited.mean_burst = !has_own && !loss.has("mean_burst");
  return inherited;
}

void read_types(Section types, PlatoonModel& model) {
  const VehicleModel base = model.default_vehicle();
  std::vector<std::string> names = types.keys();
  std::sort(names.begin(), names.end());  // the order of JSON keys
  for (const std::string& name : names) {
    if (name == "default") {
      types.reject(name, "given", "of another name: default is the vehicle outside vehicle_types");
      continue;
    }
    Section type = types.section(name);
    for (const char* key : {"sample_period", "leader", "allow_unstable", "safe_gap", "start"}) {
      if (type.has(key)) type.reject(key, "given", "absent, as all vehicles share it");
    }
    model.types.push_back({name, read_vehicle(type, &base, model.sample_period, model.allow_unstable), {}});
    model.types.back().inherited = inherited_by(type, base);
    type.reject_unknown_keys();
  }
}

void read_string(Section& document, PlatoonModel& model) {
  const std::vector<std::string> names = document.texts("string");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto type = std::find_if(model.types.begin(), model.types.end(),
                                   [&](const VehicleType& candidate) { return candidate.name == names[i]; });
    model.string.push_back(static_cast<std::size_t>(type - model.types.begin()));
    if (type != model.types.end()) continue;
    std::string allowed;
    for (const VehicleType& candidate : model.types) allowed += (allowed.empty() ? "" : ", ") + candidate.name;
    document.reject("string[" + std::to_string(i) + "]", names[i], "one of the vehicle types " + allowed);
  }
}

void check_assumptions(const PlatoonModel& model, Section& document) {
  const bool plain = hears_predecessors_only(model);
  const std::size_t farthest = farthest_ahead(model);
  const std::vector<std::size_t> order = type_order(model);
  for (const VehicleType& type : model.types) {
    const bool is_default = &type == &model.types.front();
    // Places at which fewer vehicles are ahead than it hears, and all others.
    std::vector<std::size_t> places;
    for (std::size_t i = 1; i <= farthest + order.size(); ++i) {
      if (&type - model.types.data() == static_cast<std::ptrdiff_t>(order[(i - 1) % order.size()])) places.push_back(i);
    }
    const bool is_in_string = !places.empty();
    for (std::size_t i = 1; i <= farthest && !is_in_string; ++i) places.push_back(i);
    for (const std::string& problem :
         plain ? violated_assumptions(type.vehicle.loop, type.vehicle.headway, model.allow_unstable)
               : violated_assumptions(type.vehicle, model.sample_period, places, model.allow_unstable)) {
      if (is_default) document.report_whole(problem);
      if (!is_default) document.report("vehicle_types/" + type.name + ": " + problem);
    }
  }
}

nlohmann::json to_json(const Eigen::MatrixXd& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(to_list(matrix.row(i)));
  return rows;
}

}  // namespace

nlohmann::json to_json(const StateSpace& loop) {
  return {{"A", to_json(loop.a())}, {"B", to_list(loop.b())}, {"C", to_list(loop.c())}};
}

std::optional<PlatoonModel> read_model(Section document) {
  if (!document.is_mapping()) return std::nullopt;
  const std::size_t before = document.problems();
  const double sample_period = document.number("sample_period", kSamplePeriod);
  const bool allow_unstable = document.has("allow_unstable") && document.boolean("allow_unstable");
  const bool steady = starts_steady(document);
  LeaderContent leader = read_leader(document.section("leader"), sample_period, steady);
  PlatoonModel model(read_vehicle(document, nullptr, sample_period, allow_unstable), leader.profile, sample_period);
  model.recorded_leader = std::move(leader.recorded);
  model.allow_unstable = allow_unstable;
  if (document.has("start")) model.start = steady ? Start::steady : Start::rest;
  if (document.has("safe_gap")) model.safe_gap = document.number("safe_gap", kNotNegative);
  if (document.has("vehicle_types")) read_types(document.section("vehicle_types"), model);
  if (document.has("string")) read_string(document, model);
  document.reject_unknown_keys();
  if (document.problems() == before) check_hearing(model, document);
  if (document.problems() == before) check_limits(model, document);
  if (document.problems() == before) check_assumptions(model, document);
  return document.problems() == before ? std::optional<PlatoonModel>(std::move(model)) : std::nullopt;
}

PlatoonModel parse_model(const YAML::Node& document) {
  std::vector<std::string> problems;
  const std::optional<PlatoonModel> model = read_model(Section(document, "", problems));
  if (!problems.empty()) throw ConfigurationError(problems);
  return *model;
}

namespace {

nlohmann::json to_json(const VehicleModel& vehicle) {
  nlohmann::json document = {
      {"standstill_distance", vehicle.standstill_distance},
      {"initial_position", {{"mean", vehicle.initial_position.mean}, {"variance", vehicle.initial_position.variance}}}};
  if (vehicle.constant_spacing) {
    document["spacing"] = "constant";
  } else {
    document["time_headway"] = vehicle.headway;
  }
  if (vehicle.own_acceleration != 0.0) document["own_acceleration"] = vehicle.own_acceleration;
  if (vehicle.hears_predecessor_only()) document["noise_variance"] = vehicle.position().noise_variance;
  if (vehicle.design) {
    document["plant"] = to_json(vehicle.design->plant);
    document["controller"] = controller_json(*vehicle.design);
  } else {
    document["closed_loop"] = to_json(vehicle.loop.realization);
  }
  if (vehicle.length > 0.0) document["vehicle_length"] = vehicle.length;
  if (vehicle.limits.any()) document["limits"] = to_json(vehicle.limits);
  return document;
}

}  // namespace

// An absent key has the paper's value, so that the text of the paper's platoon never changes.
nlohmann::json to_json(const PlatoonModel& model) {
  nlohmann::json speed = nlohmann::json::array();
  for (const SpeedChange& change : model.leader.changes()) {
    speed.push_back({{"from_step", change.from_step}, {"value", change.value}});
  }
  nlohmann::json document = to_json(model.default_vehicle());
  document["sample_period"] = model.sample_period;
  document["leader"] = model.recorded_leader.empty() ? nlohmann::json{{"speed", speed}}
                                                     : nlohmann::json{{"positions", model.recorded_leader}};
  document["allow_unstable"] = model.allow_unstable;
  if (model.safe_gap) document["safe_gap"] = *model.safe_gap;
  if (model.start) document["start"] = *model.start == Start::steady ? "steady" : "rest";
  const VehicleModel& own = model.default_vehicle();
  const LinkModel& base = own.position().link;
  const nlohmann::json link = to_json(base);
  const bool plain = hears_predecessors_only(model) && own.hears_predecessor_only();
  if (!link.empty() && own.hears_predecessor_only()) document["channel"] = link;
  if (own.radio() != nullptr || !plain) document["inputs"] = inputs_json(own);
  for (std::size_t i = 1; i < model.types.size(); ++i) {
    const VehicleType& type = model.types[i];
    nlohmann::json& written = document["vehicle_types"][type.name] = to_json(type.vehicle);
    const Input &heard = type.vehicle.position(), &of_default = own.position();
    if (type.inherited.noise_variance && heard.noise_variance == of_default.noise_variance)
      written.erase("noise_variance");
    if (type.vehicle.hears_predecessor_only() && !(type.inherited.channel && heard.link == of_default.link))
      written["channel"] = to_json(heard.link, true);
    if (type.vehicle.own_acceleration != own.own_acceleration)
      written["own_acceleration"] = type.vehicle.own_acceleration;
    if (own.constant_spacing && !type.vehicle.constant_spacing) written["spacing"] = "headway";
    if (type.vehicle.length != model.default_vehicle().length) written["vehicle_length"] = type.vehicle.length;
    // Inherited values stay inherited in every copy of the model.
    if (type.inherited.headway) written.erase("time_headway");
    if (type.inherited.plant) written.erase("plant");
    if (type.inherited.controller) written.erase("controller");
    if (type.inherited.plant && type.inherited.controller) written.erase("closed_loop");
    if (!plain || !type.vehicle.hears_predecessor_only()) {
      if (!type.inherited.inputs || type.vehicle.inputs != own.inputs) written["inputs"] = inputs_json(type.vehicle);
      continue;
    }
    const Input *const radio = type.vehicle.radio(), *const other = own.radio();
    const bool same_radio = radio != nullptr && other != nullptr ? *radio == *other : radio == other;
    if (!type.inherited.inputs || !same_radio || (base.loss && !type.vehicle.position().link.loss)) {
      written["inputs"] = inputs_json(type.vehicle);
      continue;
    }
    if (radio != nullptr || !written.contains("channel")) continue;
    if (type.inherited.loss_probability) {
      written["channel"]["loss"].erase("probability");
      written["channel"]["loss"].erase("runs");
    }
    if (type.inherited.mean_burst) written["channel"]["loss"].erase("mean_burst");
  }
  for (const std::size_t type : model.string) document["string"].push_back(model.types.at(type).name);
  return document;
}

}  // namespace platoon
