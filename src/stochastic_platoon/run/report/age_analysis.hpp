#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// A line of the report: the largest mean age of information among the links, and the age that one step in a million
/// exceeds. Empty if no link has random losses.
std::string age_report(const PlatoonModel& model);

/// age_probabilities() as lists over followers: of every input ("inputs", a list over n), of the first "position" and,
/// in strings with radios, of the predecessor's "input". [1] without losses, null where the theory has no distribution.
/// Null if no link of the string loses messages.
nlohmann::json ages_to_json(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
