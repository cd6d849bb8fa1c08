#pragma once

#include <functional>
#include <utility>

namespace platoon {

/// Ends a long computation. Not a std::exception, so that no handler takes it for an error of the computation.
struct Interrupted {};

/// While an object of this class lives, the long loops of the theory in this thread call `check`, at intervals from
/// microseconds to half a second. It throws Interrupted to end the computation, as on Ctrl-C in Python. The check of an
/// outer object stays in force.
class Interruptible {
public:
  explicit Interruptible(std::function<void()> check) : check_(std::move(check)), before_(present()) {
    if (before_ != nullptr) {
      check_ = [inner = std::move(check_), outer = before_] {
        (*outer)();
        inner();
      };
    }
    present() = &check_;
  }
  ~Interruptible() { present() = before_; }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  /// The check of this thread; null outside of an Interruptible.
  static const std::function<void()>*& present() {
    thread_local const std::function<void()>* check = nullptr;
    return check;
  }

private:
  std::function<void()> check_;
  const std::function<void()>* before_;  ///< of an outer Interruptible
};

/// To be called in loops that may take longer than half a second.
inline void check_interruption() {
  if (const std::function<void()>* check = Interruptible::present()) (*check)();
}

}  // namespace platoon
