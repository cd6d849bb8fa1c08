#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace platoon {

/// All problems of a configuration at once; each names the key, the value and what is allowed.
class ConfigurationError : public std::runtime_error {
public:
  explicit ConfigurationError(std::vector<std::string> problems);
  const std::vector<std::string>& problems() const { return problems_; }

private:
  std::vector<std::string> problems_;
};

/// The first twenty of so many problems, and how many there are beyond.
std::vector<std::string> abbreviated(std::vector<std::string> problems);

}  // namespace platoon
