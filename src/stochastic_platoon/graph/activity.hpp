#pragma once

#include <atomic>
#include <cstdint>

#include "stochastic_platoon/delivery/batch_schedule.hpp"

namespace platoon {

/// A number that one thread writes and others may read, each at its own time.
template <typename Number>
class Shown {
public:
  Shown() = default;
  explicit Shown(Number value) : value_(value) {}
  Shown(const Shown& other) : value_(other.get()) {}
  Shown& operator=(Number value) {
    value_.store(value, std::memory_order_relaxed);
    return *this;
  }
  Shown& operator=(const Shown& other) { return *this = other.get(); }
  Shown& operator++() { return *this = get() + 1; }
  Number get() const { return value_.load(std::memory_order_relaxed); }

private:
  std::atomic<Number> value_{Number{}};
};

/// What a component has done last: for diagnostics.
struct Activity {
  Shown<std::int64_t> step{kNothingYet};
  Shown<std::uint32_t> attempt;
  Shown<std::uint64_t> messages;

  void count(const MessageId& id) {
    step = id.step;
    attempt = id.attempt;
    ++messages;
  }
};

}  // namespace platoon
