#pragma once

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

/// The first twenty problems, and the number of further ones.
std::vector<std::string> abbreviated(std::vector<std::string> problems);

}  // namespace platoon
