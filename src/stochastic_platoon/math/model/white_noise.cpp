#include "stochastic_platoon/math/model/white_noise.hpp"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PLATOON_NAMED_WIDTHS
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>

#include "stochastic_platoon/math/model/vector_clones.hpp"

namespace platoon {

namespace {

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

// sqrt(-2 ln u) / 2 for u in (0, 1], by u = 2^e m with m in [sqrt(1/2), sqrt(2)) and -ln m = 2 artanh((m - 1) / (-1 -
// m)). Half of it, as factors of two and signs change no bit and would cost an operation each.
PLATOON_INLINE double half_radius(double u) {
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcdULL;  // bits of sqrt(1/2)
  const std::uint64_t offset = to_bits(u) - kSqrtHalf + (1023ULL << 52);
  const double m = from_bits((offset & 0xfffffffffffffULL) + kSqrtHalf);
  // Converts a small integer to double through the mantissa of 2^52, as AVX2 lacks the conversion instruction.
  const double e = from_bits(0x4330000000000000ULL | (offset >> 52)) - 4503599627371519.0;  // 2^52 + 1023
  const double s = (m - 1.0) / (-1.0 - m);
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
  constexpr double kHalfLn2 = 0.5 * 0.693147180559945309417232121458;
  return std::sqrt((s + s * (t * p)) - e * kHalfLn2);
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

constexpr std::uint64_t kSign = 1ULL << 63;

// 2 cos and 2 sin of 2 pi u2 up to a common sign, which is the leading bit of the word. The next bit is set in every
// other quadrant, and the 52 below it are u2 within the quadrant: exact reduction.
PLATOON_INLINE Pair twice_cos_sin(std::uint64_t word) {
  const double fraction = in_one_to_two(word << 2) - 1.5;  // in [-1/2, 1/2): quarter turns from the quadrant's middle
  const double x = fraction * 1.57079632679489661923132169164;
  const double c = cos_polynomial(x);
  const double s = sin_polynomial(x);
  // The middle of a quadrant is at 45 degrees. In the next quadrant (c - s, c + s) becomes (-c - s, c - s).
  const std::uint64_t turned = (word << 1) & kSign;
  constexpr double kSqrtTwo = 2.0 * 0.707106781186547524400844362105;
  return {kSqrtTwo * (from_bits(to_bits(c) ^ turned) - s), kSqrtTwo * (c + from_bits(to_bits(s) ^ turned))};
}

}  // namespace

namespace detail {

// Philox4x32: the multipliers of a round and the key increments (Salmon et al., 2011).
constexpr std::uint64_t kMultiplier0 = 0xd2511f53;
constexpr std::uint64_t kMultiplier1 = 0xcd9e8d57;
constexpr std::uint32_t kWeyl0 = 0x9e3779b9;
constexpr std::uint32_t kWeyl1 = 0xbb67ae85;

#ifdef PLATOON_NAMED_WIDTHS

#pragma GCC push_options
#pragma GCC target("avx512f")
namespace avx512 {
typedef std::uint64_t Lanes __attribute__((vector_size(64)));
inline Lanes multiply_low(Lanes a, Lanes b) {
  return reinterpret_cast<Lanes>(
      _mm512_maskz_mul_epu32(0xff, reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
}
#include "stochastic_platoon/math/model/philox_lanes.inc"
}  // namespace avx512
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
typedef std::uint64_t Lanes __attribute__((vector_size(32)));
inline Lanes multiply_low(Lanes a, Lanes b) {
  return reinterpret_cast<Lanes>(_mm256_mul_epu32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
}
#include "stochastic_platoon/math/model/philox_lanes.inc"
}  // namespace avx2
#pragma GCC pop_options

#endif

namespace baseline {
typedef std::uint64_t Lanes __attribute__((vector_size(16)));
inline Lanes multiply_low(Lanes a, Lanes b) {
#ifdef PLATOON_NAMED_WIDTHS
  return reinterpret_cast<Lanes>(_mm_mul_epu32(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return (a & 0xffffffffULL) * (b & 0xffffffffULL);
#endif
}
#include "stochastic_platoon/math/model/philox_lanes.inc"
}  // namespace baseline

std::vector<DrawWords> draw_words_versions() {
  std::vector<DrawWords> versions;
#ifdef PLATOON_NAMED_WIDTHS
  if (__builtin_cpu_supports("avx512f")) versions.push_back(avx512::draw_words);
  if (__builtin_cpu_supports("avx2")) versions.push_back(avx2::draw_words);
#endif
  versions.push_back(baseline::draw_words);
  return versions;
}

PLATOON_VECTOR_CLONES
void box_muller(const std::uint64_t* radius, const std::uint64_t* angle, std::size_t pairs, double* normals) {
  for (std::size_t j = 0; j < pairs; ++j) {
    const double half = half_radius(2.0 - in_one_to_two(radius[j]));
    const double r = from_bits(to_bits(half) ^ (angle[j] & kSign));
    const Pair direction = twice_cos_sin(angle[j]);
    normals[2 * j] = r * direction.cosine;
    normals[2 * j + 1] = r * direction.sine;
  }
}

PLATOON_VECTOR_CLONES
void uniform_pairs(const std::uint64_t* first, const std::uint64_t* second, std::size_t pairs, double* uniforms) {
  for (std::size_t j = 0; j < pairs; ++j) {
    uniforms[2 * j] = in_one_to_two(first[j]) - 1.0;
    uniforms[2 * j + 1] = in_one_to_two(second[j]) - 1.0;
  }
}

}  // namespace detail

namespace {

// Two values per block by `transform`, for realizations that may begin and end inside a block.
template <class Transform>
void fill_by(const Transform& transform, std::uint64_t seed, DrawName name, std::uint64_t first_realization,
             std::size_t count, double* values) {
  static const detail::DrawWords draw_words = detail::draw_words_versions().front();
  detail::Words first, second;
  double pair[2];
  std::size_t written = 0;
  while (written < count) {
    const std::uint64_t realization = first_realization + written;
    const std::size_t skipped = realization % 2;  // only the first pass can start inside a block
    const std::size_t blocks = std::min(detail::kBlocks, (skipped + count - written + 1) / 2);
    draw_words(seed, name, realization / 2, blocks, &first, &second);
    if (skipped == 1) {
      transform(first.data(), second.data(), 1, pair);
      values[written++] = pair[1];
    }
    const std::size_t pairs = std::min(blocks - skipped, (count - written) / 2);
    transform(first.data() + skipped, second.data() + skipped, pairs, values + written);
    written += 2 * pairs;
    if (skipped + pairs < blocks) {
      transform(first.data() + skipped + pairs, second.data() + skipped + pairs, 1, pair);
      values[written++] = pair[0];
    }
  }
}

}  // namespace

void WhiteNoise::fill(DrawName name, std::uint64_t first_realization, std::size_t count, double* normals) const {
  fill_by(detail::box_muller, seed_, name, first_realization, count, normals);
}

void WhiteNoise::fill_uniform(DrawName name, std::uint64_t first_realization, std::size_t count,
                              double* uniforms) const {
  fill_by(detail::uniform_pairs, seed_, name, first_realization, count, uniforms);
}

}  // namespace platoon
