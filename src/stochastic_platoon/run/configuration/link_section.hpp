#pragma once

#include <nlohmann/json.hpp>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads the key `channel` of a vehicle; omitted keys are as in `base`. Reports all problems, including a noise filter
/// that is improper or unstable, a mean burst for which no Markov chain exists, a predictor whose sum is not 1 and,
/// unless `allow_unstable`, a predictor whose predictions grow without bound. Any lost signal but a position may be
/// replaced by 0 (`on_loss: zero`).
LinkModel read_link(Section section, const LinkModel& base, bool allow_unstable,
                    InputSignal signal = InputSignal::position);

/// JSON for read_link(): the differences from the paper's channel. `with_defaults`: all keys but a loss, as a vehicle
/// type inherits omitted ones. Only `inputs` can take away a loss.
nlohmann::json to_json(const LinkModel& link, bool with_defaults = false);

}  // namespace platoon
