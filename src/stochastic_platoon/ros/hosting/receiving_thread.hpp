#pragma once

#include <ros/callback_queue_interface.h>

#include <cstdint>
#include <mutex>

namespace platoon {

/// A callback queue that keeps nothing: every callback runs at once, in the thread that received the message.
/// This saves a message one of its three wake-ups on the way (sender's network thread, receiver's network
/// thread, receiver's spinning thread).
///
/// For a node of its own process whose callbacks only publish. Not for timers, which hold a lock of their own
/// while they add a callback, nor for components joined by shared pointers, where one publication would call
/// the next.
class ReceivingThread : public ros::CallbackQueueInterface {
public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override;

  /// Nothing waits here. Who unsubscribes waits for a running callback by roscpp's own lock.
  void removeByID(std::uint64_t) override {}

private:
  std::mutex mutex_;
};

}  // namespace platoon
