#pragma once

#include <atomic>
#include <thread>

namespace platoon {

/// For very short critical sections: waiters yield instead of sleeping, as a wake-up would take longer.
class SpinLock {
public:
  void lock() {
    while (taken_.test_and_set(std::memory_order_acquire)) std::this_thread::yield();
  }
  void unlock() { taken_.clear(std::memory_order_release); }

private:
  std::atomic_flag taken_ = ATOMIC_FLAG_INIT;
};

}  // namespace platoon
