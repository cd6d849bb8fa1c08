#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

namespace platoon {

/// The node as text on one line that a terminal may show, shortened.
std::string shown(const YAML::Node& node);

/// true, True, false or False. None for any other text.
std::optional<bool> parsed_boolean(const YAML::Node& node);

/// The whole text as a finite number; spaces around it do not count. None for any other text.
std::optional<double> parsed_number(const YAML::Node& node);

/// The same as an integer; 1e9 is one, too.
std::optional<std::int64_t> parsed_integer(const YAML::Node& node);

/// A list of finite numbers that is not empty.
std::optional<Eigen::VectorXd> parsed_numbers(const YAML::Node& node);

/// Whether a text may become part of JSON, which must be UTF-8, and of the name of a file, which has no zero byte.
bool is_text(const std::string& text);

/// Whether a text is digits alone.
bool is_digits(const std::string& text);

/// Whether the node would be a number with a decimal point in the place of its comma.
bool has_decimal_comma(const YAML::Node& node);

}  // namespace platoon
