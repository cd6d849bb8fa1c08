#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace platoon {

/// The YAML document in a file of at most 256 MB. Throws ConfigurationError, starting with `what`, the kind of file, if
/// it is missing, is not YAML, or holds several documents.
YAML::Node load_yaml(const std::string& file, const std::string& what = "model");

}  // namespace platoon
