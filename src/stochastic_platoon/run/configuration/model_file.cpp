#include "stochastic_platoon/run/configuration/model_file.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/fraction.hpp"
#include "stochastic_platoon/run/configuration/leader_section.hpp"
#include "stochastic_platoon/run/configuration/link_section.hpp"

namespace platoon {

namespace {

// ROS stamps count nanoseconds and end after 136 years.
const Allowed kSamplePeriod{"a finite number >= 1e-9", std::numeric_limits<double>::quiet_NaN(), 1e-9, 1e6};

std::optional<ClosedLoop> read_given_loop(Section section, const std::string& name,
                                          std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  const Eigen::MatrixXd a = section.matrix("A");
  const Eigen::VectorXd b = section.numbers("B", kLongestRow);
  const Eigen::VectorXd c = section.numbers("C", kLongestRow);
  section.reject_unknown_keys();
  if (problems.size() > before) return std::nullopt;
  try {
    return closed_loop_from(StateSpace(a, b, c.transpose()));
  } catch (const std::invalid_argument& error) {
    problems.push_back(name + "/" + error.what());
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

// The closed loop and, unless it was given directly, its plant and controller.
struct Loop {
  ClosedLoop closed;
  std::optional<LoopDesign> design;
};

// The values read for one vehicle; `loop` is empty after a reported problem.
struct VehicleParts {
  double headway, standstill_distance, noise_variance;
  InitialPosition initial_position;
  std::optional<Loop> loop;
  LinkModel link;

  VehicleModel vehicle() const {
    return {loop->closed, headway, standstill_distance, noise_variance, initial_position, loop->design, link};
  }
};

std::optional<Loop> formed(const LoopDesign& design, double headway, const std::string& name,
                           std::vector<std::string>& problems) {
  try {
    return Loop{close_loop(design, headway), design};
  } catch (const std::invalid_argument& error) {
    problems.push_back(name + ": " + error.what());
    return std::nullopt;
  }
}

std::optional<Loop> read_designed_loop(Section& vehicle, double headway, const std::optional<LoopDesign>& base,
                                       std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  const auto plant = [&]() -> TransferFunction {
    if (base && !vehicle.has("plant")) return base->plant;
    Section section = vehicle.section("plant");
    return read_fraction(section);
  };
  LoopDesign design =
      base.value_or(LoopDesign{{Polynomial::Ones(1), Polynomial::Ones(1)}, {Polynomial::Ones(1), Polynomial::Ones(1)}});
  design.plant = plant();
  if (!base || vehicle.has("controller")) {
    Section section = vehicle.section("controller");
    design.divide_by_one_plus_headway =
        section.has("divide_by_one_plus_headway") && section.boolean("divide_by_one_plus_headway");
    design.controller = read_fraction(section);
  }
  if (problems.size() > before) return std::nullopt;
  return formed(design, headway, vehicle.name("plant, controller"), problems);
}

// Keys that a type omits are as in `base`, the vehicle of the type default; `base` is null for that vehicle itself.
std::optional<Loop> read_loop(Section& vehicle, double headway, const VehicleParts* base,
                              std::vector<std::string>& problems) {
  const bool designed = vehicle.has("plant") || vehicle.has("controller");
  if (vehicle.has("closed_loop")) {
    for (const char* key : {"plant", "controller"}) {
      if (vehicle.has(key)) vehicle.reject(key, "given", "absent beside closed_loop, which stands in its place");
    }
    const std::optional<ClosedLoop> given =
        read_given_loop(vehicle.section("closed_loop"), vehicle.name("closed_loop"), problems);
    return given ? std::optional<Loop>(Loop{*given, std::nullopt}) : std::nullopt;
  }
  if (base == nullptr) return read_designed_loop(vehicle, headway, std::nullopt, problems);
  if (!base->loop) return std::nullopt;  // already reported
  if (designed) return read_designed_loop(vehicle, headway, base->loop->design, problems);
  if (headway == base->headway || !base->loop->design) return base->loop;
  return formed(*base->loop->design, headway, vehicle.name("time_headway"), problems);
}

VehicleParts read_vehicle(Section& vehicle, const VehicleParts* base, bool allow_unstable,
                          std::vector<std::string>& problems) {
  const auto number = [&](const char* key, const Allowed& allowed, double VehicleParts::*of_base) {
    return base != nullptr && !vehicle.has(key) ? base->*of_base : vehicle.number(key, allowed);
  };
  VehicleParts parts{number("time_headway", kPositive, &VehicleParts::headway),
                     number("standstill_distance", kNotNegative, &VehicleParts::standstill_distance),
                     number("noise_variance", kNotNegative, &VehicleParts::noise_variance),
                     {},
                     {},
                     base != nullptr ? base->link : LinkModel()};
  parts.initial_position = base != nullptr && !vehicle.has("initial_position")
                               ? base->initial_position
                               : read_initial_position(vehicle.section("initial_position"));
  parts.loop = read_loop(vehicle, parts.headway, base, problems);
  if (vehicle.has("channel")) parts.link = read_link(vehicle.section("channel"), parts.link, allow_unstable);
  return parts;
}

// One type of vehicle: its name and its values.
struct TypeParts {
  std::string name, path;
  VehicleParts parts;
  Inherited inherited;
};

Inherited inherited_by(Section& type, const LinkModel& base) {
  const bool own_loop = type.has("closed_loop");
  Inherited inherited{!type.has("time_headway"), !own_loop && !type.has("plant"), !own_loop && !type.has("controller"),
                      base.loss.has_value()};
  if (!base.loss || !type.has("channel")) return inherited;
  Section channel = type.section("channel");
  if (channel.has("loss")) inherited.loss_probability = !channel.section("loss").has("probability");
  return inherited;
}

std::vector<TypeParts> read_types(Section types, const VehicleParts& base, bool allow_unstable,
                                  std::vector<std::string>& problems) {
  std::vector<TypeParts> found;
  std::vector<std::string> names = types.keys();
  std::sort(names.begin(), names.end());  // the order of JSON keys
  for (const std::string& name : names) {
    if (name == "default") types.reject(name, "given", "of another name: default is the vehicle outside vehicle_types");
    Section type = types.section(name);
    for (const char* key : {"sample_period", "leader", "allow_unstable"}) {
      if (type.has(key)) type.reject(key, "given", "absent, as all vehicles share it");
    }
    found.push_back({name, types.name(name), read_vehicle(type, &base, allow_unstable, problems), {}});
    found.back().inherited = inherited_by(type, base.link);
    type.reject_unknown_keys();
  }
  return found;
}

std::vector<std::size_t> read_string(Section& document, const std::vector<TypeParts>& types) {
  std::vector<std::size_t> string;
  const std::vector<std::string> names = document.texts("string");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto type = std::find_if(types.begin(), types.end(),
                                   [&](const TypeParts& candidate) { return candidate.name == names[i]; });
    string.push_back(names[i] == "default" ? 0 : static_cast<std::size_t>(type - types.begin()) + 1);
    if (names[i] == "default" || type != types.end()) continue;
    std::string allowed = "default";
    for (const TypeParts& candidate : types) allowed += candidate.name == "default" ? "" : ", " + candidate.name;
    document.reject("string[" + std::to_string(i) + "]", names[i], "one of the vehicle types " + allowed);
  }
  return string;
}

void check_assumptions(const VehicleParts& parts, const std::string& path, bool allow_unstable,
                       std::vector<std::string>& problems) {
  const std::string place = path.empty() ? "" : path + ": ";
  for (const std::string& problem : violated_assumptions(parts.loop->closed, parts.headway, allow_unstable))
    problems.push_back(place + problem);
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

std::optional<PlatoonModel> read_model(Section document, std::vector<std::string>& problems) {
  if (!document.is_mapping()) return std::nullopt;
  const std::size_t before = problems.size();
  const double sample_period = document.number("sample_period", kSamplePeriod);
  const bool allow_unstable = document.has("allow_unstable") && document.boolean("allow_unstable");
  const LeaderContent leader = read_leader(document.section("leader"), sample_period, problems);
  const VehicleParts own = read_vehicle(document, nullptr, allow_unstable, problems);
  const std::vector<TypeParts> types =
      document.has("vehicle_types") ? read_types(document.section("vehicle_types"), own, allow_unstable, problems)
                                    : std::vector<TypeParts>();
  const std::vector<std::size_t> string =
      document.has("string") ? read_string(document, types) : std::vector<std::size_t>();
  document.reject_unknown_keys();
  if (problems.size() == before) {
    check_assumptions(own, "", allow_unstable, problems);
    for (const TypeParts& type : types) check_assumptions(type.parts, type.path, allow_unstable, problems);
  }
  if (problems.size() > before) return std::nullopt;
  PlatoonModel model{own.loop->closed,
                     own.headway,
                     own.standstill_distance,
                     sample_period,
                     own.noise_variance,
                     leader.profile,
                     own.initial_position,
                     allow_unstable,
                     own.loop->design,
                     leader.recorded,
                     own.link,
                     {},
                     string};
  for (const TypeParts& type : types) model.types.push_back({type.name, type.parts.vehicle(), type.inherited});
  return model;
}

PlatoonModel parse_model(const YAML::Node& document) {
  std::vector<std::string> problems;
  const std::optional<PlatoonModel> model = read_model(Section(document, "", problems), problems);
  if (!problems.empty()) throw ConfigurationError(problems);
  return *model;
}

namespace {

nlohmann::json to_json(const VehicleModel& vehicle) {
  nlohmann::json document = {
      {"time_headway", vehicle.headway},
      {"standstill_distance", vehicle.standstill_distance},
      {"noise_variance", vehicle.noise_variance},
      {"initial_position", {{"mean", vehicle.initial_position.mean}, {"variance", vehicle.initial_position.variance}}}};
  if (vehicle.design) {
    document["plant"] = to_json(vehicle.design->plant);
    document["controller"] = to_json(vehicle.design->controller);
    document["controller"]["divide_by_one_plus_headway"] = vehicle.design->divide_by_one_plus_headway;
  } else {
    document["closed_loop"] = to_json(vehicle.loop.realization);
  }
  return document;
}

// A type inherits omitted keys, so that all link keys that may differ are written.
nlohmann::json full_link(const LinkModel& link, const LinkModel& base) {
  nlohmann::json document = to_json(link);
  document["noise_filter"] = to_json(link.noise_filter);
  document["quantisation_step"] = link.quantisation_step;
  document["delay"] = link.delay;
  if (!link.loss && base.loss) throw std::logic_error("a type cannot take away a loss");
  return document;
}

}  // namespace

// An absent key has the paper's value, so that the text of the paper's platoon never changes.
nlohmann::json to_json(const PlatoonModel& model) {
  nlohmann::json speed = nlohmann::json::array();
  for (const SpeedChange& change : model.leader.changes()) {
    speed.push_back({{"from_step", change.from_step}, {"value", change.value}});
  }
  nlohmann::json document = to_json(vehicle(model, 0));
  document["sample_period"] = model.sample_period;
  document["leader"] = model.recorded_leader.empty() ? nlohmann::json{{"speed", speed}}
                                                     : nlohmann::json{{"positions", model.recorded_leader}};
  document["allow_unstable"] = model.allow_unstable;
  const nlohmann::json link = to_json(model.link);
  if (!link.empty()) document["channel"] = link;
  for (const VehicleType& type : model.types) {
    nlohmann::json& written = document["vehicle_types"][type.name] = to_json(type.vehicle);
    written["channel"] = full_link(type.vehicle.link, model.link);
    // Inherited values stay inherited in every copy of the model.
    if (type.inherited.headway) written.erase("time_headway");
    if (type.inherited.plant) written.erase("plant");
    if (type.inherited.controller) written.erase("controller");
    if (type.inherited.plant && type.inherited.controller) written.erase("closed_loop");
    if (type.inherited.loss_probability) written["channel"]["loss"].erase("probability");
  }
  for (const std::size_t type : model.string)
    document["string"].push_back(type == 0 ? "default" : model.types.at(type - 1).name);
  return document;
}

}  // namespace platoon
