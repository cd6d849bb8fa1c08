#pragma once

#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <optional>
#include <string>

#include "stochastic_platoon/ros/transport/activity.hpp"
#include "stochastic_platoon/ros/transport/drop_counter.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/sole_publisher.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// One topic of positions as a component receives it, with the checks that every message passes, in this order: it
/// belongs to the component's run, it comes from the only publisher of that run, and it is the next one of its vehicle.
/// Dropped messages are counted, and logged at most once a second.
///
/// One thread calls its functions; diagnostics may read from another.
class PositionInput {
public:
  /// `topic`: resolved. `receiver`: added to the topic's name in the log, " (channel)". `external`: name of the
  /// external vehicle that publishes the topic, whose contract a dropped message violates; empty: none.
  PositionInput(RunMembership& membership, const std::string& topic, const std::string& receiver = {},
                const std::string& external = {});

  /// The first two checks.
  bool admits(const PositionEvent& event);

  /// The third one. Notifies the leader and the monitor if earlier messages are lost: see MessageOrder::has_missed().
  bool takes(const MessageDescriptor& descriptor, MessageOrder& order, std::int64_t first_loss);

  /// The third one, done by the component: counts the message as taken or dropped. Returns whether it is taken.
  bool takes(DropReason drop, const MessageId& id, std::size_t size);

  /// How the latest message of an external vehicle violated the contract; none if it did not.
  std::optional<DropReason> latest_breach() const { return drops_.latest_breach(); }

  const Activity& activity() const { return activity_; }
  const DropCounter& drops() const { return drops_; }

private:
  RunMembership* membership_;
  SolePublisher publisher_;
  DropCounter drops_;
  Activity activity_;
};

}  // namespace platoon
