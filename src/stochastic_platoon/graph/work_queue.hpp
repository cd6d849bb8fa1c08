#pragma once

#include <ros/callback_queue_interface.h>
#include <ros/init.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace platoon {

/// The callback queue of one thread of a busy process, in the order of arrival.
///
/// Where ros::CallbackQueue wakes its thread for every callback, this one takes all that wait at once, looks
/// for more for a moment before it goes to sleep, and is woken only when it sleeps. For components that live
/// longer than run().
class WorkQueue : public ros::CallbackQueueInterface {
public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.push_back({owner, callback});
    if (asleep_) arrival_.notify_one();
  }

  void removeByID(std::uint64_t owner) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(),
                                  [owner](const Entry& entry) { return entry.owner == owner; }),
                   waiting_.end());
  }

  /// Serves the queue from the calling thread until ROS shuts down, and `at_once` after each of its
  /// callbacks.
  void run(WorkQueue& at_once) {
    std::vector<Entry> taken, urgent;
    while (ros::ok()) {
      if (!wait_for_more(taken)) sleep();
      for (const Entry& entry : taken) {
        call(entry);
        at_once.serve(urgent);
      }
      taken.clear();
    }
  }

private:
  struct Entry {
    std::uint64_t owner;
    ros::CallbackInterfacePtr callback;
  };

  void call(const Entry& entry) {
    if (entry.callback->call() == ros::CallbackInterface::TryAgain) addCallback(entry.callback, entry.owner);
  }

  // All that wait, to an empty list.
  bool take(std::vector<Entry>& taken) {
    const std::lock_guard<std::mutex> lock(mutex_);
    taken.swap(waiting_);
    return !taken.empty();
  }

  void serve(std::vector<Entry>& taken) {
    take(taken);
    for (const Entry& entry : taken) call(entry);
    taken.clear();
  }

  bool wait_for_more(std::vector<Entry>& taken) {
    constexpr std::chrono::microseconds patience(50);  // about what a sleep and a wake-up cost
    const auto until = std::chrono::steady_clock::now() + patience;
    do {
      if (take(taken)) return true;
      std::this_thread::yield();
    } while (std::chrono::steady_clock::now() < until);
    return false;
  }

  void sleep() {
    std::unique_lock<std::mutex> lock(mutex_);
    asleep_ = true;
    arrival_.wait_for(lock, std::chrono::milliseconds(100), [this] { return !waiting_.empty(); });
    asleep_ = false;
  }

  std::mutex mutex_;
  std::condition_variable arrival_;
  std::vector<Entry> waiting_;
  bool asleep_ = false;
};

}  // namespace platoon
