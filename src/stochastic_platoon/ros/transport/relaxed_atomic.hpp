#pragma once

#include <atomic>

namespace platoon {

/// A number that one thread writes and others may read at any time.
template <typename Number>
class RelaxedAtomic {
public:
  RelaxedAtomic() = default;
  explicit RelaxedAtomic(Number value) : value_(value) {}
  RelaxedAtomic(const RelaxedAtomic& other) : value_(other.get()) {}
  RelaxedAtomic& operator=(Number value) {
    value_.store(value, std::memory_order_relaxed);
    return *this;
  }
  RelaxedAtomic& operator=(const RelaxedAtomic& other) { return *this = other.get(); }
  RelaxedAtomic& operator++() { return *this = get() + 1; }
  Number get() const { return value_.load(std::memory_order_relaxed); }

private:
  std::atomic<Number> value_{Number{}};
};

}  // namespace platoon
