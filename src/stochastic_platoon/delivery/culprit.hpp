#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/delivery/batch_schedule.hpp"

namespace platoon {

/// Who holds the platoon up, in words: "vehicle_7 has sent nothing since step 12".
///
/// `latest` is the last turn received from each vehicle 0 .. N. A follower that is behind what its
/// predecessor's latest step lets it send is stuck. One stuck follower is the culprit itself; when all of
/// several are stuck it is the channel; when none is, it is the leader.
std::string culprit(const std::vector<std::optional<Turn>>& latest, const BatchSchedule& schedule);

}  // namespace platoon
