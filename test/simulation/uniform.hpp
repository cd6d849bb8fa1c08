#pragma once

#include <random>

namespace platoon::simulation {

/// From 0 to below 1, with the same bits on every machine.
inline double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace platoon::simulation
