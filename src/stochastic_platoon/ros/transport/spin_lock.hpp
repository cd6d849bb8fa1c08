#pragma once

#include <atomic>
#include <thread>

// The thread safety analysis of Clang, which test/tidy runs, checks these attributes. Other compilers have none.
#if defined(__clang__)
#define PLATOON_THREAD_SAFETY(attribute) __attribute__((attribute))
#else
#define PLATOON_THREAD_SAFETY(attribute)
#endif
#define PLATOON_GUARDED_BY(lock) PLATOON_THREAD_SAFETY(guarded_by(lock))

namespace platoon {

/// For very short critical sections: waiters yield instead of sleeping, as a wake-up would take longer.
class PLATOON_THREAD_SAFETY(capability("mutex")) SpinLock {
public:
  void lock() PLATOON_THREAD_SAFETY(acquire_capability()) {
    while (taken_.test_and_set(std::memory_order_acquire)) std::this_thread::yield();
  }
  void unlock() PLATOON_THREAD_SAFETY(release_capability()) { taken_.clear(std::memory_order_release); }

private:
  std::atomic_flag taken_ = ATOMIC_FLAG_INIT;
};

/// Holds a lock during its lifetime: std::lock_guard has no attributes for the analysis.
class PLATOON_THREAD_SAFETY(scoped_lockable) Locked {
public:
  explicit Locked(SpinLock& lock) PLATOON_THREAD_SAFETY(acquire_capability(lock)) : lock_(lock) { lock_.lock(); }
  ~Locked() PLATOON_THREAD_SAFETY(release_capability()) { lock_.unlock(); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

private:
  SpinLock& lock_;
};

}  // namespace platoon
