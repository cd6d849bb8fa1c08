#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "unit/messages.hpp"

namespace platoon {

using Problems = std::vector<std::string>;

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

/// The closed loop of the same example, instead of its plant and controller.
inline const std::string kClosedLoopText =
    "closed_loop: {A: [[1.11, 1, 0], [-0.57, 0, 1], [0.13857142857142857, 0, 0]], "
    "B: [0, 0.3214285714285714, 0], C: [1, 0, 0]}";

/// A car with an actuator lag, an input delay and gains; without the noise of its received position.
inline const std::string kCarText =
    "plant: {actuator_lag: 0.1, input_delay: 0.2}\n"
    "controller: {kp: 0.2, kd: 0.7, headway_filter: true}\n"
    "time_headway_seconds: 3.5\n"
    "standstill_distance: 5.0\n"
    "sample_period: 0.01\n"
    "leader: {speed: [{from_step: 0, value: 20.0}]}\n"
    "initial_position: {mean: 0.0, variance: 0.0}\n";

/// A text with one part, which must exist, replaced by another.
inline std::string replaced(std::string text, const std::string& part, const std::string& other) {
  const std::size_t place = text.find(part);
  if (place == std::string::npos) throw std::invalid_argument("not in the text: " + part);
  return text.replace(place, part.size(), other);
}

inline std::string model_text_with(const std::string& part, const std::string& other) {
  return replaced(kModelText, part, other);
}

inline PlatoonModel model_of(const std::string& text) {
  return parse_model(YAML::Load(text));
}

/// The problems that `parse` reports, none if it does not throw.
template <typename Parse>
Problems problems_of(const Parse& parse) {
  try {
    parse();
  } catch (const ConfigurationError& error) {
    EXPECT_FALSE(error.problems().empty());
    return error.problems();
  }
  return {};
}

/// The problems of a model file.
inline Problems problems_in(const std::string& text) {
  return problems_of([&text] { model_of(text); });
}

/// Whether there is one problem, which begins with this text.
inline testing::AssertionResult is_problem(const Problems& problems, const std::string& start) {
  if (problems.size() == 1) return begins_with(problems[0], start);
  return testing::AssertionFailure() << testing::PrintToString(problems) << " is not one problem: " << start;
}

/// Whether one of the problems begins with this text.
inline testing::AssertionResult is_among(const Problems& problems, const std::string& start) {
  return testing::AssertionResult(std::any_of(problems.begin(), problems.end(),
                                              [&start](const std::string& one) { return one.find(start) == 0; }))
         << testing::PrintToString(problems) << ": " << start;
}

}  // namespace platoon
