#pragma once

#include <chrono>

namespace platoon {

/// Monotonic time [s].
inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace platoon
