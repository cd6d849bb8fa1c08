#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/run_options.hpp"

namespace platoon {

/// The configuration of every node and tool: the model and the run.
///
/// It is passed on as one JSON text: `configure` prints it, the parameter `configuration` holds it, the topic
/// `configuration` and bags carry it.
struct Configuration {
  PlatoonModel model;
  RunOptions run;
};

/// Parses {version: .., model: .., run: ..}. Throws ConfigurationError with all problems of both, or if another version
/// of this package wrote the document.
Configuration parse_configuration(const YAML::Node& document);
/// The same from text. Throws ConfigurationError if the text is not YAML (JSON is).
Configuration parse_configuration(const std::string& text);

/// The cells of the run's statistics.
SignalCells cells_of(const Configuration& configuration);

/// JSON for parse_configuration().
nlohmann::json to_json(const Configuration& configuration);

/// The document for parse_configuration(): the model file, named by `model`, and the given settings (see settings());
/// all other settings keep their defaults. Throws ConfigurationError if the file cannot be read or a setting is
/// unknown.
YAML::Node configuration_document(const std::map<std::string, std::string>& given);

/// The same for the model of a document (see load_model()); `model` is then no setting.
YAML::Node configuration_document(const YAML::Node& model, const std::map<std::string, std::string>& given);

/// The document of a model file, with the paths of the tables that it names. Throws ConfigurationError if it cannot be
/// read.
YAML::Node load_model(const std::string& file);

/// The document of a configuration with the given settings changed; a non-empty `model` names another model file.
/// Throws as above.
YAML::Node configuration_document(const Configuration& base, const std::map<std::string, std::string>& given);

/// Sets one value of a document. `name` is a setting, or a path into the model file (channel/delay;
/// controller/numerator/0 is the first entry of a list); a key with a setting of its own is set as that setting is.
/// Throws ConfigurationError if the path leads through a value that is neither a mapping nor a list of that length;
/// parse_configuration() checks whether the key exists.
void override_value(YAML::Node& document, const std::string& name, const YAML::Node& value);

/// The run's identity: a 64 bit digest (FNV-1a) of the configuration with its launch and this package's version, never
/// 0. Every message carries it.
std::uint64_t run_identity(const Configuration& configuration);

/// The inputs of the statistics, except the set of realizations: version, model with the bits of its closed loop, seed,
/// followers, steps.
nlohmann::json statistics_identity(const Configuration& configuration);

}  // namespace platoon
