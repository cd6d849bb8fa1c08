#include "stochastic_platoon/ros/hosting/work_queue.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

namespace platoon {

void WorkQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.push_back({owner, callback});
  if (asleep_) arrival_.notify_one();
}

void WorkQueue::removeByID(std::uint64_t owner) {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.erase(
      std::remove_if(waiting_.begin(), waiting_.end(), [owner](const Entry& entry) { return entry.owner == owner; }),
      waiting_.end());
}

void WorkQueue::run(WorkQueue& at_once, const std::function<bool()>& going_on) {
  std::vector<Entry> taken, urgent;
  while (going_on()) {
    if (!wait_for_more(taken)) sleep();
    for (const Entry& entry : taken) {
      call(entry);
      at_once.drain(urgent);
    }
    taken.clear();
  }
}

void WorkQueue::call(const Entry& entry) {
  if (entry.callback->call() == ros::CallbackInterface::TryAgain) addCallback(entry.callback, entry.owner);
}

// Moves all waiting entries to the empty list `taken`.
bool WorkQueue::take(std::vector<Entry>& taken) {
  const std::lock_guard<std::mutex> lock(mutex_);
  taken.swap(waiting_);
  return !taken.empty();
}

void WorkQueue::drain(std::vector<Entry>& taken) {
  take(taken);
  for (const Entry& entry : taken) call(entry);
  taken.clear();
}

bool WorkQueue::wait_for_more(std::vector<Entry>& taken) {
  constexpr std::chrono::microseconds patience(50);  // about the cost of a sleep and a wake-up
  const auto until = std::chrono::steady_clock::now() + patience;
  do {
    if (take(taken)) return true;
    std::this_thread::yield();
  } while (std::chrono::steady_clock::now() < until);
  return false;
}

void WorkQueue::sleep() {
  std::unique_lock<std::mutex> lock(mutex_);
  asleep_ = true;
  arrival_.wait_for(lock, std::chrono::milliseconds(100), [this] { return !waiting_.empty(); });
  asleep_ = false;
}

}  // namespace platoon
