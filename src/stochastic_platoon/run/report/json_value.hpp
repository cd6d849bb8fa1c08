#pragma once

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

/// The number, or null if there is none or it is not finite.
inline nlohmann::json number(std::optional<double> value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

/// A list of numbers.
inline nlohmann::json numbers(const std::vector<double>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

/// Rows of `length` numbers each.
inline nlohmann::json rows(const std::vector<double>& values, std::size_t length) {
  nlohmann::json list = nlohmann::json::array();
  for (auto row = values.begin(); row != values.end(); row += static_cast<std::ptrdiff_t>(length)) {
    check_interruption();
    list.push_back(numbers({row, row + static_cast<std::ptrdiff_t>(length)}));
  }
  return list;
}

/// The truth value, or null if it is undecided.
inline nlohmann::json truth(std::optional<bool> value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace platoon
