#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "stochastic_platoon/ros/transport/activity.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"
#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"

namespace platoon {

/// Counts the messages that a component drops and logs them, at most once a second per topic. Drops that are expected
/// after a restart or while links come up are counted without a log message.
class DropCounter {
public:
  /// `external`: name of the external vehicle that publishes the topic, whose contract a dropped message violates;
  /// empty: none.
  explicit DropCounter(std::string topic, std::string external = {})
      : topic_(std::move(topic)), external_(std::move(external)) {}

  void count(DropReason drop, const MessageId& id, std::size_t size);

  std::uint64_t of(DropReason drop) const { return counts_[static_cast<std::size_t>(drop)].get(); }

  /// Number of unexpected drops.
  std::uint64_t faults() const;

  /// Call it when a message has been accepted: an earlier violation no longer blocks the run.
  void forget_breach() { breach_ = DropReason::none; }

  /// How the latest message of an external vehicle violated the contract; none if it did not.
  std::optional<DropReason> latest_breach() const {
    return breach_.get() == DropReason::none ? std::nullopt : std::make_optional(breach_.get());
  }

private:
  std::string topic_;
  std::string external_;
  RelaxedAtomic<DropReason> breach_{DropReason::none};
  std::array<RelaxedAtomic<std::uint64_t>, kDropReasons> counts_{};
  std::optional<double> last_said_;  ///< [s]
};

}  // namespace platoon
