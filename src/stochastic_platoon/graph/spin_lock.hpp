#pragma once

#include <atomic>
#include <thread>

namespace platoon {

/// A lock for a moment: who waits gives way but does not sleep, as to be woken would take longer.
class SpinLock {
public:
  void lock() {
    while (taken_.test_and_set(std::memory_order_acquire)) std::this_thread::yield();
  }
  void unlock() { taken_.clear(std::memory_order_release); }

private:
  std::atomic_flag taken_ = ATOMIC_FLAG_INIT;
};

/// Lets go of a lock for as long as it lives.
template <typename Lock>
class Unlocked {
public:
  explicit Unlocked(Lock& lock) : lock_(lock) { lock_.unlock(); }
  ~Unlocked() { lock_.lock(); }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

private:
  Lock& lock_;
};

}  // namespace platoon
