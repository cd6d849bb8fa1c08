#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/run_options.hpp"

namespace platoon {

/// All that a node or a tool is told: the model and the run.
///
/// It travels as one JSON text: `configure` prints it, the parameter `configuration` holds it, the topic
/// `configuration` and bags carry it.
struct Configuration {
  PlatoonModel model;
  RunOptions run;
};

/// Parses {version: .., model: .., run: ..}. Throws ConfigurationError with all that is wrong in both, or when
/// it was made by another version of this package.
Configuration parse_configuration(const YAML::Node& document);
/// The same from text. Throws ConfigurationError when that is no YAML (JSON is).
Configuration parse_configuration(const std::string& text);

/// As a document for parse_configuration.
nlohmann::json to_json(const Configuration& configuration);

/// The document for parse_configuration: the model file, and the settings (see settings()) that are given;
/// those that are not keep their defaults. `model` names the file. Throws ConfigurationError when the file
/// cannot be read or a setting is unknown.
YAML::Node configuration_document(const std::map<std::string, std::string>& given);

/// The document of a configuration with some settings changed: those given, and the model file where `model`
/// is not empty. Throws as above.
YAML::Node configuration_document(const Configuration& base, const std::map<std::string, std::string>& given);

/// Changes a document: `name` is a setting, or a path into the model file (channel/delay; controller/numerator/0 is
/// the first of a list). Throws ConfigurationError where the path leads through what is neither a mapping nor a list
/// of that length; whether there is such a key parse_configuration() says.
void override_value(YAML::Node& document, const std::string& name, const YAML::Node& value);

/// The run's identity: a 64 bit digest (FNV-1a) of the configuration with its launch and this package's
/// version. Every message carries it; 0 is no run's.
std::uint64_t run_identity(const Configuration& configuration);

/// What the statistics are a function of, beside the set of realizations: version, model with the bits of its
/// closed loop, seed, followers, steps.
nlohmann::json statistics_identity(const Configuration& configuration);

}  // namespace platoon
