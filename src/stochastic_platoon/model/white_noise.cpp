#include "stochastic_platoon/model/white_noise.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "stochastic_platoon/model/vector_clones.hpp"

namespace platoon {

namespace {

constexpr std::size_t kLanes =
    64;  // blocks drawn at once: their words and normals stay in the first level cache

using Words = std::array<std::uint64_t, kLanes>;
using Reals = std::array<double, kLanes>;

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

constexpr std::uint64_t kOne = 0x3ff0000000000000ULL;  // bits of 1.0

// 1 + (the 52 leading bits) 2^-52, in [1, 2).
PLATOON_INLINE double in_one_to_two(std::uint64_t word) {
  return from_bits(kOne | (word >> 12));
}

// -ln u for u in (0, 1], by u = 2^e m with m in [sqrt(1/2), sqrt(2)) and ln m = 2 artanh((m - 1) / (m + 1)).
PLATOON_INLINE double minus_log(double u) {
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcdULL;  // bits of sqrt(1/2)
  const std::uint64_t offset = to_bits(u) - kSqrtHalf + (1023ULL << 52);
  const std::uint64_t biased_exponent = offset >> 52;  // e + 1023
  const double m = from_bits(to_bits(u) - ((biased_exponent - 1023ULL) << 52));
  // A small integer becomes a double by way of the mantissa of 2^52: no integer conversion, which AVX2 lacks.
  const double e = from_bits(0x4330000000000000ULL | biased_exponent) - 4503599627371519.0;  // 2^52 + 1023
  const double s = (m - 1.0) / (m + 1.0);
  const double t = s * s;
  double p = 1.0 / 21.0;
  p = p * t + 1.0 / 19.0;
  p = p * t + 1.0 / 17.0;
  p = p * t + 1.0 / 15.0;
  p = p * t + 1.0 / 13.0;
  p = p * t + 1.0 / 11.0;
  p = p * t + 1.0 / 9.0;
  p = p * t + 1.0 / 7.0;
  p = p * t + 1.0 / 5.0;
  p = p * t + 1.0 / 3.0;
  const double log_m = 2.0 * (s + s * (t * p));
  return -(e * 0.693147180559945309417232121458 + log_m);
}

// sin x for |x| <= pi/4, Taylor to x^15.
PLATOON_INLINE double sin_polynomial(double x) {
  const double t = x * x;
  double p = -1.0 / 1307674368000.0;
  p = p * t + 1.0 / 6227020800.0;
  p = p * t - 1.0 / 39916800.0;
  p = p * t + 1.0 / 362880.0;
  p = p * t - 1.0 / 5040.0;
  p = p * t + 1.0 / 120.0;
  p = p * t - 1.0 / 6.0;
  return x + x * (t * p);
}

// cos x for |x| <= pi/4, Taylor to x^16.
PLATOON_INLINE double cos_polynomial(double x) {
  const double t = x * x;
  double p = 1.0 / 20922789888000.0;
  p = p * t - 1.0 / 87178291200.0;
  p = p * t + 1.0 / 479001600.0;
  p = p * t - 1.0 / 3628800.0;
  p = p * t + 1.0 / 40320.0;
  p = p * t - 1.0 / 720.0;
  p = p * t + 1.0 / 24.0;
  p = p * t - 1.0 / 2.0;
  return 1.0 + t * p;
}

struct Pair {
  double cosine;
  double sine;
};

// cos and sin of 2 pi u2, with u2 the 52 bits below the two that name the quadrant: exact reduction.
PLATOON_INLINE Pair cos_sin(std::uint64_t word) {
  const double fraction =
      in_one_to_two(word << 2) - 1.5;  // in [-1/2, 1/2): quarter turns from the quadrant's middle
  const double x = fraction * 1.57079632679489661923132169164;
  const double c = cos_polynomial(x);
  const double s = sin_polynomial(x);
  // The middle of a quadrant lies at 45 degrees.
  constexpr double kSqrtHalf = 0.707106781186547524400844362105;
  const double plus = kSqrtHalf * (c + s);
  const double minus = kSqrtHalf * (c - s);
  const std::uint64_t quadrant = word >> 62;
  const std::uint64_t swap = std::uint64_t{0} - (quadrant & 1);
  const std::uint64_t bits_cos = (to_bits(minus) & ~swap) | (to_bits(plus) & swap);
  const std::uint64_t bits_sin = (to_bits(plus) & ~swap) | (to_bits(minus) & swap);
  const std::uint64_t sign_cos = ((quadrant ^ (quadrant >> 1)) & 1) << 63;
  const std::uint64_t sign_sin = (quadrant >> 1) << 63;
  return {from_bits(bits_cos ^ sign_cos), from_bits(bits_sin ^ sign_sin)};
}

}  // namespace

namespace detail {

PLATOON_VECTOR_CLONES
void draw_words(std::uint64_t seed, DrawName name, std::uint64_t first_block, std::size_t blocks,
                Words* radius, Words* angle) {
  const auto step = static_cast<std::uint64_t>(name.step) & 0xffffffffffffULL;
  for (std::size_t lane = 0; lane < blocks; ++lane) {
    const std::uint64_t block = first_block + lane;
    std::uint32_t c0 = static_cast<std::uint32_t>(block);
    std::uint32_t c1 =
        static_cast<std::uint32_t>(block >> 32) | static_cast<std::uint32_t>((step >> 32) << 16);
    std::uint32_t c2 = static_cast<std::uint32_t>(step);
    std::uint32_t c3 = name.vehicle;
    std::uint32_t k0 = static_cast<std::uint32_t>(seed);
    std::uint32_t k1 = static_cast<std::uint32_t>(seed >> 32);
    for (int round = 0; round < 10; ++round) {
      const std::uint64_t product0 = std::uint64_t{PHILOX_M4x32_0} * c0;
      const std::uint64_t product1 = std::uint64_t{PHILOX_M4x32_1} * c2;
      c0 = static_cast<std::uint32_t>(product1 >> 32) ^ c1 ^ k0;
      c1 = static_cast<std::uint32_t>(product1);
      c2 = static_cast<std::uint32_t>(product0 >> 32) ^ c3 ^ k1;
      c3 = static_cast<std::uint32_t>(product0);
      k0 += PHILOX_W32_0;
      k1 += PHILOX_W32_1;
    }
    (*radius)[lane] = (std::uint64_t{c1} << 32) | c0;
    (*angle)[lane] = (std::uint64_t{c3} << 32) | c2;
  }
}

PLATOON_VECTOR_CLONES
void box_muller(const Words& radius, const Words& angle, std::size_t blocks, Reals* even, Reals* odd) {
  for (std::size_t lane = 0; lane < blocks; ++lane) {
    const double u1 = 2.0 - in_one_to_two(radius[lane]);
    const double r = std::sqrt(2.0 * minus_log(u1));
    const Pair direction = cos_sin(angle[lane]);
    (*even)[lane] = r * direction.cosine;
    (*odd)[lane] = r * direction.sine;
  }
}

}  // namespace detail

void WhiteNoise::fill(DrawName name, std::uint64_t first_realization, std::size_t count,
                      double* normals) const {
  Words radius, angle;
  Reals even, odd;
  std::size_t written = 0;
  while (written < count) {
    const std::uint64_t realization = first_realization + written;
    const std::size_t skipped = realization % 2;  // only the first pass can start inside a block
    const std::size_t blocks = std::min(kLanes, (skipped + count - written + 1) / 2);
    detail::draw_words(seed_, name, realization / 2, blocks, &radius, &angle);
    detail::box_muller(radius, angle, blocks, &even, &odd);
    if (skipped == 1) normals[written++] = odd[0];
    const std::size_t pairs = std::min(blocks - skipped, (count - written) / 2);
    double* out = normals + written;
    for (std::size_t j = 0; j < pairs; ++j) {
      out[2 * j] = even[skipped + j];
      out[2 * j + 1] = odd[skipped + j];
    }
    written += 2 * pairs;
    if (skipped + pairs < blocks) normals[written++] = even[skipped + pairs];
  }
}

}  // namespace platoon
