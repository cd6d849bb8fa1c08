#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "stochastic_platoon/math/response/loop_margins.hpp"
#include "stochastic_platoon/math/string/critical_delay.hpp"

namespace platoon {

/// How far the loop is from instability, and the radio's delay from string instability.
struct Robustness {
  std::optional<LoopMargins> margins;  ///< see loop_margins()
  CriticalDelay critical_delay = {};
};

Robustness robustness(const PlatoonModel& model);

/// `phase_margin` [deg], `delay_margin` [s], `sensitivity_peak` and `critical_delay` [s]; null where there is none.
nlohmann::json to_json(const Robustness& found, double sample_period);

/// One line for the margins, and one for the radio if there is one.
std::string report(const PlatoonModel& model, const Robustness& found);

}  // namespace platoon
