#pragma once

#include <ros/callback_queue_interface.h>

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

namespace platoon {

/// The callback queue of one thread of a busy process, in the order of arrival.
///
/// ros::CallbackQueue wakes its thread for every callback. This queue takes all waiting callbacks at once, polls for
/// more for some microseconds before its thread sleeps, and wakes the thread only if it sleeps. For components that
/// outlive run().
class WorkQueue : public ros::CallbackQueueInterface {
public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override;
  void removeByID(std::uint64_t owner) override;

  /// Runs callbacks in the calling thread while `going_on` returns true; drains `at_once` after each.
  void run(WorkQueue& at_once, const std::function<bool()>& going_on);

private:
  struct Entry {
    std::uint64_t owner;
    ros::CallbackInterfacePtr callback;
  };
  void call(const Entry& entry);
  bool take(std::vector<Entry>& taken);
  void drain(std::vector<Entry>& taken);
  bool wait_for_more(std::vector<Entry>& taken);
  void sleep();

  std::mutex mutex_;
  std::condition_variable arrival_;
  std::vector<Entry> waiting_;
  bool asleep_ = false;
};

}  // namespace platoon
