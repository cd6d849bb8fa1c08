#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The document for parse_configuration(): the model file that `model` names, by default the paper's example, and the
/// given settings (see settings()); all other settings keep their defaults. Throws ConfigurationError if the file
/// cannot be read or a setting is unknown.
YAML::Node configuration_document(const std::map<std::string, std::string>& given);

/// The same for the model of a document (see load_model()); `model` is then not a setting.
YAML::Node configuration_document(const YAML::Node& model, const std::map<std::string, std::string>& given);

/// The document of a model file, after resolve_tables() for its folder. Throws ConfigurationError if it cannot be read.
YAML::Node load_model(const std::string& file);

/// Makes the paths of the tables that a model names (recorded drives and losses) relative to `folder`; a drive of a
/// bare name may be a shipped one.
void resolve_tables(const YAML::Node& model, const std::string& folder);

/// The document of a configuration with the given settings changed; a non-empty `model` names another model file.
/// Throws as above.
YAML::Node configuration_document(const Configuration& base, const std::map<std::string, std::string>& given);

/// Sets one value of a document. `name` is a setting, or a path into the model file (channel/delay;
/// controller/numerator/0 is the first entry of a list); a key with a setting of its own is set as that setting is.
/// Throws ConfigurationError if the path leads through a value that is neither a mapping nor a list of that length;
/// parse_configuration() checks whether the key exists.
void override_value(YAML::Node& document, const std::string& name, const YAML::Node& value);

/// Sets several, mappings and lists before single values: a delay beside `inputs` is the delay of these inputs. Throws
/// ConfigurationError with the faults of all.
void override_values(YAML::Node& document, const std::vector<std::pair<std::string, YAML::Node>>& values);

}  // namespace platoon
