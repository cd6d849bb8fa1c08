#include "stochastic_platoon/configuration/configuration_error.hpp"

#include <utility>

namespace platoon {

namespace {

std::string listed(const std::vector<std::string>& problems) {
  if (problems.size() == 1) return problems.front();
  std::string text = std::to_string(problems.size()) + " errors:";
  for (const std::string& problem : problems) text += "\n  " + problem;
  return text;
}

}  // namespace

ConfigurationError::ConfigurationError(std::vector<std::string> problems)
    : std::runtime_error(listed(problems)), problems_(std::move(problems)) {}

}  // namespace platoon
