#include "stochastic_platoon/run/configuration/yaml_value.hpp"

#include <boost/algorithm/string/trim.hpp>
#include <cmath>
#include <locale>
#include <nlohmann/json.hpp>
#include <sstream>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

std::string whole_text(const YAML::Node& node) {
  if (!node || node.IsNull()) return "(nothing)";
  if (node.IsScalar()) return node.Scalar().empty() ? "(empty)" : node.Scalar();
  YAML::Emitter emitter;
  emitter << YAML::Flow << node;
  return emitter.c_str();
}

// The text of a file must not control the terminal that shows it.
std::string on_one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\n';
    if (!space || line.empty() || line.back() != ' ') line += space ? ' ' : c;
  }
  return printable(line);
}

}  // namespace

std::string shown(const YAML::Node& node) {
  return on_one_line(shortened(whole_text(node)));
}

std::optional<bool> parsed_boolean(const YAML::Node& node) {
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  if (text == "true" || text == "True") return true;
  return text == "false" || text == "False" ? std::optional(false) : std::nullopt;
}

std::optional<double> parsed_number(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  const std::optional<double> value = number_in(boost::algorithm::trim_copy(node.Scalar()));
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> parsed_integer(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  std::istringstream stream(node.Scalar());
  stream.imbue(std::locale::classic());
  std::int64_t value;
  if (stream >> value && (stream >> std::ws).eof()) return value;
  if (node.Scalar().find_first_of("eE") == std::string::npos) return std::nullopt;
  const std::optional<double> number = parsed_number(node);
  constexpr double kEveryWholeNumberBelow = 9007199254740992.0;
  if (!number || std::abs(*number) >= kEveryWholeNumberBelow || *number != std::floor(*number)) return std::nullopt;
  return static_cast<std::int64_t>(*number);
}

std::optional<Eigen::VectorXd> parsed_numbers(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() == 0) return std::nullopt;
  Eigen::VectorXd values(static_cast<Eigen::Index>(node.size()));
  for (std::size_t i = 0; i < node.size(); ++i) {
    const std::optional<double> value = parsed_number(node[i]);
    if (!value) return std::nullopt;
    values(static_cast<Eigen::Index>(i)) = *value;
  }
  return values;
}

bool is_text(const std::string& text) {
  if (text.find('\0') != std::string::npos) return false;  // the system ends names there
  try {
    nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

bool is_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

bool has_decimal_comma(const YAML::Node& node) {
  std::string text = node.IsScalar() ? node.Scalar() : "";
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos) text[comma] = '.';
  return comma != std::string::npos && number_in(text);
}

}  // namespace platoon
