#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"

namespace platoon {

/// The paper's example as a model file.
inline const std::string kModelText =
    "plant: {numerator: [1.0], denominator: [1.0, -2.0, 1.0]}\n"
    "controller: {numerator: [1.35, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: true}\n"
    "time_headway: 3.2\n"
    "standstill_distance: 0.0\n"
    "sample_period: 0.1\n"
    "noise_variance: 0.6\n"
    "leader: {speed: [{from_step: 0, value: 20.0}]}\n"
    "initial_position: {mean: 0.0, variance: 0.0}\n";

/// The same with one part of the text, which must exist, replaced by another.
inline std::string model_text_with(const std::string& part, const std::string& other) {
  std::string text = kModelText;
  const std::size_t place = text.find(part);
  if (place == std::string::npos) throw std::invalid_argument("not in the model file: " + part);
  return text.replace(place, part.size(), other);
}

/// The problems that `parse` reports, none if it does not throw.
template <typename Parse>
std::vector<std::string> problems_of(const Parse& parse) {
  try {
    parse();
  } catch (const ConfigurationError& error) {
    EXPECT_FALSE(error.problems().empty());
    return error.problems();
  }
  return {};
}

}  // namespace platoon
