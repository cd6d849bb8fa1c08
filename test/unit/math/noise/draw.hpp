#pragma once

#include <vector>

#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

/// Standard normals of realizations first .. first + count - 1.
inline std::vector<double> draw(std::uint64_t seed, DrawName name, std::uint64_t first, std::size_t count) {
  std::vector<double> normals(count);
  WhiteNoise(seed).fill(name, first, count, normals.data());
  return normals;
}

}  // namespace platoon
