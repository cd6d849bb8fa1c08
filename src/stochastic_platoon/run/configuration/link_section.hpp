#pragma once

#include <nlohmann/json.hpp>

#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads the key `channel` of a vehicle; what it does not give is as in `base`. Reports what is wrong: among it
/// a noise filter that is improper or unstable, a burst that no chain has, a predictor whose sum is not 1, and,
/// unless `allow_unstable`, one whose predictions grow without bound.
LinkModel read_link(Section section, const LinkModel& base, bool allow_unstable);

/// For read_link: what differs from the paper's channel.
nlohmann::json to_json(const LinkModel& link);

}  // namespace platoon
