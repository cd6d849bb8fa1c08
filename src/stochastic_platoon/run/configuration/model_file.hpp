#pragma once

#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads a model file (the file itself, or its copy on the parameter server); both have the same schema and the same
/// messages. Reports all problems: missing and unknown keys, wrong types, numbers that are not finite or out of range,
/// and the violated_assumptions() of the closed loop. Returns no model if there is a problem.
std::optional<PlatoonModel> read_model(Section document);

/// The same for a whole document. Throws ConfigurationError with all problems.
PlatoonModel parse_model(const YAML::Node& document);

/// The model with the keys of the model file: all that the results of a run depend on.
nlohmann::json to_json(const PlatoonModel& model);

/// {A: [[..]], B: [..], C: [..]}, as under the key closed_loop.
nlohmann::json to_json(const StateSpace& loop);

}  // namespace platoon
