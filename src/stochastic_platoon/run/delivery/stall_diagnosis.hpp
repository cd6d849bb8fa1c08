#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// Why a run stalls.
enum class StallCause {
  not_running,       ///< the vehicle's topic has no publisher
  no_input,          ///< the vehicle publishes no control input, and its follower has a radio
  blocked_receiver,  ///< a receiver reports that it cannot go on
  silent_receiver,   ///< the leader waits for the first report of a receiver
  silent_vehicle,
  silent_channel
};

/// The node that blocks the run.
struct StallDiagnosis {
  StallCause cause;
  std::optional<std::size_t> vehicle;  ///< the blocking vehicle, 0 is the leader; none for another component
  std::string text;                    ///< "vehicle_7 has sent nothing since step 12"

  /// Whether this is the same stall, although its text may differ.
  bool is_that_of(const StallDiagnosis& other) const { return cause == other.cause && vehicle == other.vehicle; }
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
