#pragma once

#include <nlohmann/json.hpp>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads the key `limits` of a vehicle: {input: [lower, upper], speed: [lower, upper]}. An absent key keeps its value
/// in `limits`. Reports all problems.
void read_limits(Section section, VehicleLimits& limits);

nlohmann::json to_json(const VehicleLimits& limits);

/// Reports limits of vehicles that cannot have them or that exclude the first speed of a steady start, and rebuilds the
/// loops of limited vehicles with a known control input.
void check_limits(PlatoonModel& model, Section& document);

/// Whether the platoon of a model file starts in steady motion, before its limits are read.
bool starts_steady(Section& document);

}  // namespace platoon
