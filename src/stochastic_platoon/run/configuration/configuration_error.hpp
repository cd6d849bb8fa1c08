#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace platoon {

/// All problems of a configuration; each names the key, the value and the allowed values.
class ConfigurationError : public std::runtime_error {
public:
  explicit ConfigurationError(std::vector<std::string> problems);
  const std::vector<std::string>& problems() const { return problems_; }

private:
  std::vector<std::string> problems_;
};

/// The problems of several steps, for one ConfigurationError.
class ProblemCollector {
public:
  void add(const std::string& problem) { all_.push_back(problem); }
  void add(const std::vector<std::string>& problems) { all_.insert(all_.end(), problems.begin(), problems.end()); }

  /// The result of a step; none if it throws a ConfigurationError, whose problems are added.
  template <typename Step>
  auto result_of(const Step& step) -> std::optional<decltype(step())> {
    try {
      return step();
    } catch (const ConfigurationError& error) {
      add(error.problems());
      return std::nullopt;
    }
  }

  /// The same for a step without a result.
  template <typename Step>
  void check(const Step& step) {
    result_of([&step] { return step(), true; });
  }

  const std::vector<std::string>& all() const { return all_; }

  /// Throws a ConfigurationError with all problems if there are any.
  void require_none() const;

private:
  std::vector<std::string> all_;
};

/// The first twenty problems, and the number of further ones.
std::vector<std::string> abbreviated(std::vector<std::string> problems);

}  // namespace platoon
