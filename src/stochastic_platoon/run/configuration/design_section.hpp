#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads plant and controller of a vehicle, each in one of its forms:
///
///     plant: {numerator, denominator}, {continuous: {numerator, denominator, input_delay}}
///            or {actuator_lag, input_delay}
///     controller: {numerator, denominator} or {kp, kd, ki}, with divide_by_one_plus_headway or headway_filter
///
/// An absent key keeps its value in `base`; without `base` both are required. Reports all problems; after a problem the
/// result is a placeholder.
LoopDesign read_design(Section& vehicle, const std::optional<LoopDesign>& base, double sample_period);

/// A design in place of an unreadable one.
LoopDesign placeholder_design();

nlohmann::json to_json(const Plant& plant);

/// The key controller of a design.
nlohmann::json controller_json(const LoopDesign& design);

}  // namespace platoon
