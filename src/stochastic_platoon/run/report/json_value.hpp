#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace platoon {

/// The number, or null if there is none or it is not finite.
inline nlohmann::json number(std::optional<double> value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

/// The truth value, or null if it is undecided.
inline nlohmann::json truth(std::optional<bool> value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace platoon
