#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/configuration/configuration_error.hpp"
#include "stochastic_platoon/configuration/model_file.hpp"
#include "stochastic_platoon/configuration/run_options.hpp"

namespace platoon {

/// All that a node or a tool is told: the model and the run.
struct Configuration {
  PlatoonModel model;
  RunOptions run;
};

/// Parses {model: .., run: ..}. Throws ConfigurationError with all that is wrong in both.
Configuration parse_configuration(const YAML::Node& document);

/// The document for parse_configuration: the model file with `headway` and `noise_variance` put in its place
/// where they are not empty, and the run's settings. Settings are named as the launch arguments; those not
/// given keep their defaults (default_settings()). Throws ConfigurationError when the file cannot be read or
/// a setting is unknown.
YAML::Node configuration_document(const std::map<std::string, std::string>& settings);

/// The document of a configuration with some settings changed: those given, `model`, `headway` and
/// `noise_variance` where they are not empty. Throws as above.
YAML::Node configuration_document(const Configuration& base,
                                  const std::map<std::string, std::string>& settings);

/// Every setting with its default, as text: what platoon.launch documents.
std::map<std::string, std::string> default_settings();

/// As a document for parse_configuration.
nlohmann::json to_json(const Configuration& configuration);

/// What the statistics are a function of, beside the set of realizations: model, seed, followers, steps.
nlohmann::json statistics_identity(const Configuration& configuration);

}  // namespace platoon
