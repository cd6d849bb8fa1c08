#pragma once

#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads a model file (the file itself, or its copy on the parameter server): the one schema and the one set
/// of messages. All that is wrong goes into `problems`: missing and unknown keys, wrong types, numbers that
/// are not finite or out of range, and the violated_assumptions() of the closed loop. Then there is no model.
std::optional<PlatoonModel> read_model(Section document, std::vector<std::string>& problems);

/// The same for a whole document. Throws ConfigurationError with all that is wrong.
PlatoonModel parse_model(const YAML::Node& document);

/// The model in the words of the model file: what a run's figures depend on.
nlohmann::json to_json(const PlatoonModel& model);

/// {A: [[..]], B: [..], C: [..]}, as under the key closed_loop.
nlohmann::json to_json(const StateSpace& loop);

}  // namespace platoon
