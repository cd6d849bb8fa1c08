#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

PLATOON_INLINE double from_bits(std::uint64_t bits) {
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

PLATOON_INLINE std::uint64_t to_bits(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// a b + c, rounded once, by one instruction.
struct Fused {
  PLATOON_INLINE static double multiply_add(double a, double b, double c) { return std::fma(a, b, c); }
};

/// The same for processors without that instruction, from additions and multiplications of vectors: the C library's
/// function takes twelve times as long. Exact unless a product underflows, which no product of the noise does.
struct Emulated {
  struct Sum {
    double value, error;  // their sum is exact
  };

  PLATOON_INLINE static Sum sum(double a, double b) {
    const double value = a + b, added = value - a;
    return {value, (a - (value - added)) + (b - added)};
  }

  PLATOON_INLINE static double upper_half(double a) {
    const double scaled = 134217729.0 * a;  // 2^27 + 1
    return scaled - (scaled - a);
  }

  // T. J. Dekker (1971) for the product; S. Boldo and G. Melquiond (2008) for the sum of three, whose smaller part is
  // rounded to odd.
  PLATOON_INLINE static double multiply_add(double a, double b, double c) {
    const double product = a * b, a1 = upper_half(a), b1 = upper_half(b), a2 = a - a1, b2 = b - b1;
    const double rest = a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2);
    const Sum low = sum(c, rest), high = sum(product, low.value), small = sum(high.error, low.error);
    const std::uint64_t bits = to_bits(small.value);
    const std::uint64_t outwards = 1 - ((bits ^ to_bits(small.error)) >> 63 << 1);  // 1 or -1
    const std::uint64_t to_odd = small.error != 0.0 ? ~bits & 1 : 0;
    return high.value + from_bits(bits + (outwards & (0 - to_odd)));
  }
};

}  // namespace platoon
