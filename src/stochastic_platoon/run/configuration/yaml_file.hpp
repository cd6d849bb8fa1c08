#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace platoon {

/// The YAML document in a text, whose name starts messages. Throws ConfigurationError if it is not YAML, or holds
/// several documents.
YAML::Node parse_yaml(const std::string& text, const std::string& name);

/// The same for a file of at most 256 MB; its messages start with `what`, the kind of file.
YAML::Node load_yaml(const std::string& file, const std::string& what = "model");

}  // namespace platoon
