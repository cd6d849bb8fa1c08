#include "stochastic_platoon/run/configuration/single_number.hpp"

#include <vector>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"

namespace platoon {

namespace {

template <typename Read>
auto read_alone(const std::string& key, const std::string& text, const Read& read) {
  YAML::Node document;
  document[key] = text;
  std::vector<std::string> problems;
  Section section(document, "", problems);
  const auto value = read(section);
  if (!problems.empty()) throw ConfigurationError(problems);
  return value;
}

}  // namespace

double number_of(const std::string& key, const std::string& text, const Allowed& allowed) {
  return read_alone(key, text, [&](Section& section) { return section.number(key, allowed); });
}

std::int64_t integer_of(const std::string& key, const std::string& text, std::int64_t least, std::int64_t most) {
  return read_alone(key, text, [&](Section& section) { return section.integer(key, least, most); });
}

}  // namespace platoon
