#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// The node that blocks the run.
struct StallDiagnosis {
  std::optional<std::size_t> vehicle;  ///< the blocking vehicle, 0 is the leader; none for the channel
  std::string text;                    ///< "vehicle_7 has sent nothing since step 12"
};

/// Finds the vehicle that blocks the run. A follower is stuck if it has sent less than its predecessor's latest step
/// permits. If none is stuck, the leader is the cause; if all of several followers are, the channel; otherwise the
/// first stuck follower.
///
/// `latest`: last message received from each vehicle 0 .. N in the present attempt; `ever`: in any attempt, empty if
/// unknown. `pipeline_depth`: as in publishes_ahead(). `external`: external vehicles, ascending; they need not publish
/// ahead.
StallDiagnosis diagnose_stall(const std::vector<std::optional<MessageId>>& latest, const BatchSchedule& schedule,
                              std::size_t pipeline_depth, const std::vector<std::size_t>& external = {},
                              const std::vector<std::optional<MessageId>>& ever = {});

}  // namespace platoon
