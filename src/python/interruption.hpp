#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon::python {

/// The result of a computation without Python objects, during which other threads may use the interpreter. Ctrl-C, or
/// any signal whose handler raises an exception, ends it with that exception.
template <typename Computation>
auto unlocked(const Computation& compute) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kPeriod(50);
  std::exception_ptr raised;
  Clock::time_point due = Clock::now() + kPeriod;
  try {
    const pybind11::gil_scoped_release release;
    const Interruptible by_signals([&] {
      if (Clock::now() < due) return;
      const pybind11::gil_scoped_acquire lock;
      due = Clock::now() + kPeriod;
      if (PyErr_CheckSignals() == 0) return;
      raised = std::make_exception_ptr(pybind11::error_already_set());
      throw Interrupted();
    });
    return compute();
  } catch (const Interrupted&) {
  }
  std::rethrow_exception(raised);
}

}  // namespace platoon::python
