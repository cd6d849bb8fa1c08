#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// Who holds the platoon up.
struct StallDiagnosis {
  std::optional<std::size_t> vehicle;  ///< the one that is stuck, if it is one; 0 is the leader
  std::string text;                    ///< "vehicle_7 has sent nothing since step 12"
};

/// `latest` is the last message received from each vehicle 0 .. N in the present attempt, `ever` in any; empty: not
/// known. `pipeline_depth` is that of publishes_ahead(). `external` are vehicles that may be aligned all the same,
/// ascending. A follower that is behind what its predecessor's latest step lets it send is stuck. One stuck follower is
/// the culprit itself; when all of several are stuck it is the channel; when none is, it is the leader.
StallDiagnosis diagnose_stall(const std::vector<std::optional<MessageId>>& latest, const BatchSchedule& schedule,
                              std::size_t pipeline_depth, const std::vector<std::size_t>& external = {},
                              const std::vector<std::optional<MessageId>>& ever = {});

}  // namespace platoon
