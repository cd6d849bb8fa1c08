#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "stochastic_platoon/ros/transport/relaxed_atomic.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"
#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"

namespace platoon {

/// Counts the messages of a topic that a component takes, or publishes, and those that it drops. Dropped messages are
/// logged, at most once a second, except for drops that are expected after a restart or while links come up.
///
/// One thread counts; others may read at any time.
class MessageCounter {
public:
  /// `external`: name of the external vehicle that publishes the topic, whose contract a dropped message violates;
  /// empty: none.
  explicit MessageCounter(std::string topic, std::string external = {})
      : topic_(std::move(topic)), external_(std::move(external)) {}

  /// A taken message also ends an earlier violation of the contract.
  void take(const MessageId& id);
  void drop(DropReason reason, const MessageId& id, std::size_t size);

  std::uint64_t taken() const { return taken_.get(); }
  /// Step and attempt of the latest message taken; kNothingYet and 0 before the first.
  std::int64_t step() const { return step_.get(); }
  std::uint32_t attempt() const { return attempt_.get(); }

  std::uint64_t dropped(DropReason reason) const { return dropped_[static_cast<std::size_t>(reason)].get(); }
  /// Number of unexpected drops.
  std::uint64_t faults() const;

  /// How the latest message of an external vehicle violated the contract; none if it did not.
  std::optional<DropReason> latest_breach() const {
    return breach_.get() == DropReason::none ? std::nullopt : std::make_optional(breach_.get());
  }

private:
  std::string topic_;
  std::string external_;
  RelaxedAtomic<std::int64_t> step_{kNothingYet};
  RelaxedAtomic<std::uint32_t> attempt_;
  RelaxedAtomic<std::uint64_t> taken_;
  std::array<RelaxedAtomic<std::uint64_t>, kDropReasons> dropped_{};
  RelaxedAtomic<DropReason> breach_{DropReason::none};
  std::optional<double> last_logged_;  ///< [s]
};

}  // namespace platoon
