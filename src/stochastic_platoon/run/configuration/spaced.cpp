#include "stochastic_platoon/run/configuration/spaced.hpp"

#include <cmath>
#include <locale>
#include <sstream>

#include "stochastic_platoon/run/configuration/yaml_value.hpp"

namespace platoon {

double Spaced::at(std::uint64_t index) const {
  if (count == 1) return from;
  return from + (to - from) * static_cast<double>(index) / static_cast<double>(count - 1);
}

std::optional<Spaced> parse_spaced(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double from = 0.0, to = 0.0;
  char first = 0, second = 0;
  std::string rest;
  if (!(stream >> from >> first >> to >> second) || !std::getline(stream, rest, '\0')) return std::nullopt;
  const std::optional<std::int64_t> count = parsed_integer(YAML::Node(rest));
  const bool valid = first == ':' && second == ':' && std::isfinite(from) && std::isfinite(to) && from <= to;
  if (!valid || count.value_or(0) < 1) return std::nullopt;
  return Spaced{from, to, static_cast<std::uint64_t>(*count)};
}

}  // namespace platoon
