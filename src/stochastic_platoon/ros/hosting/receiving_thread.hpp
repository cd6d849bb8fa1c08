#pragma once

#include <ros/callback_queue_interface.h>

#include <cstdint>
#include <mutex>

namespace platoon {

/// A callback queue that stores nothing: every callback runs at once, in the thread that received the message. This
/// saves the last of a message's three wake-ups (sender's network thread, receiver's network thread, receiver's
/// spinning thread).
///
/// For a node in its own process with callbacks that only publish. Not for timers, which hold their own lock while they
/// add a callback, and not for components connected by shared pointers, where one publication would call the next.
class ReceivingThread : public ros::CallbackQueueInterface {
public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override {
    const std::lock_guard<std::mutex> one_at_a_time(mutex_);
    callback->call();
  }

  /// The queue is always empty. On unsubscribing, roscpp's own lock waits for a running callback.
  void removeByID(std::uint64_t) override {}

private:
  std::mutex mutex_;
};

}  // namespace platoon
