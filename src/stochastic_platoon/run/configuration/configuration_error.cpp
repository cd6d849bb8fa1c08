#include "stochastic_platoon/run/configuration/configuration_error.hpp"

#include <cstddef>
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

void ProblemCollector::require_none() const {
  if (!all_.empty()) throw ConfigurationError(all_);
}

std::vector<std::string> abbreviated(std::vector<std::string> problems) {
  constexpr std::size_t kMost = 20;
  if (problems.size() <= kMost) return problems;
  const std::size_t more = problems.size() - kMost;
  problems.resize(kMost);
  problems.push_back("and " + std::to_string(more) + " more");
  return problems;
}

}  // namespace platoon
