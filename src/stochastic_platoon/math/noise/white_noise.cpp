#include "stochastic_platoon/math/noise/white_noise.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#define PLATOON_NAMED_WIDTHS
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "stochastic_platoon/math/noise/multiply_add.hpp"

namespace platoon {

namespace {

constexpr std::uint64_t kMantissa = 0xfffffffffffffULL;

// 1 + (the 52 low bits) 2^-52, in [1, 2).
PLATOON_INLINE double in_one_to_two(std::uint64_t word) {
  return from_bits(0x3ff0000000000000ULL | (word & kMantissa));
}

// The value with its sign flipped if the leading bit is set.
PLATOON_INLINE double flipped_by(std::uint64_t word, double value) {
  return from_bits(to_bits(value) ^ (word & (1ULL << 63)));
}

// c + t (c_1 + t (...)).
template <class Arithmetic>
PLATOON_INLINE double polynomial(double, double c) {
  return c;
}
template <class Arithmetic, class... Coefficients>
PLATOON_INLINE double polynomial(double t, double c, Coefficients... further) {
  return Arithmetic::multiply_add(polynomial<Arithmetic>(t, further...), t, c);
}

// The coefficients are those of the minimax polynomials from test/noise_polynomials, which also measures the errors.

// -ln u for u in (0, 1], by u = 2^e m with m in [sqrt(1/2), sqrt(2)) and -ln m = 2 artanh(s / 2), s = 2 (1 - m) / (1 +
// m).
template <class Arithmetic>
PLATOON_INLINE double minus_log(double u) {
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcdULL;  // bits of sqrt(1/2)
  const std::uint64_t offset = to_bits(u) - kSqrtHalf + (1023ULL << 52);
  const double m = from_bits((offset & kMantissa) + kSqrtHalf);
  // Converts a small integer to double through the mantissa of 2^52, as AVX2 lacks the conversion instruction.
  const double minus_e = 4503599627371519.0 - from_bits(0x4330000000000000ULL | (offset >> 52));  // 2^52 + 1023
  const double s = (m - 1.0) / (-0.5 - 0.5 * m);
  const double t = s * s;
  const double p =
      polynomial<Arithmetic>(t, 0x1.5555555555592p-4, 0x1.999999997ff6ap-7, 0x1.24924941da6f1p-9, 0x1.c71c521b146bfp-12,
                             0x1.74663b6b40a36p-14, 0x1.39a210af88b1ap-16, 0x1.2f022da15c6d8p-18);
  constexpr double kLn2 = 0.693147180559945309417232121458;
  return Arithmetic::multiply_add(minus_e, kLn2, Arithmetic::multiply_add(s * t, p, s));
}

// sin(x pi / 2) for |x| <= 1/2.
template <class Arithmetic>
PLATOON_INLINE double sin_quarters(double x) {
  return x * polynomial<Arithmetic>(x * x, 0x1.921fb54442d18p+0, -0x1.4abbce625bdaep-1, 0x1.466bc6774afc8p-4,
                                    -0x1.32d2ccd469861p-8, 0x1.507821d3e5d80p-13, -0x1.e2f3efde2505dp-19,
                                    0x1.dfc54cdf7db22p-25);
}

// cos(x pi / 2) for |x| <= 1/2.
template <class Arithmetic>
PLATOON_INLINE double cos_quarters(double x) {
  return polynomial<Arithmetic>(x * x, 1.0, -0x1.3bd3cc9be459dp+0, 0x1.03c1f081b0defp-2, -0x1.55d3c7dc39f01p-6,
                                0x1.e1f4fb80ff535p-11, -0x1.a6c9c93fb65f9p-16, 0x1.f3dcbc17ed8e0p-22);
}

}  // namespace

namespace detail {

// Philox4x32: the multipliers of a round and the key increments (Salmon et al., 2011).
constexpr std::uint64_t kMultiplier0 = 0xd2511f53;
constexpr std::uint64_t kMultiplier1 = 0xcd9e8d57;
constexpr std::uint32_t kWeyl0 = 0x9e3779b9;
constexpr std::uint32_t kWeyl1 = 0xbb67ae85;

// GCC compiles multiply_low to one instruction only through its intrinsic, and inlines an intrinsic only into a
// function of the same target. to_low copies each odd half to the even one by a shuffle, as the port for shifts is the
// busier one on Intel processors.
#ifdef __clang__
#define PLATOON_TO_LOW(...) \
  reinterpret_cast<Lanes>(  \
      __builtin_shufflevector(reinterpret_cast<Halves>(lanes), reinterpret_cast<Halves>(lanes), __VA_ARGS__))
#else
#define PLATOON_TO_LOW(...) \
  reinterpret_cast<Lanes>(__builtin_shuffle(reinterpret_cast<Halves>(lanes), Halves{__VA_ARGS__}))
#endif

#ifdef PLATOON_NAMED_WIDTHS

#define PLATOON_TARGET __attribute__((target("avx512f")))
namespace avx512 {
typedef std::uint64_t Lanes __attribute__((vector_size(64)));
typedef std::uint32_t Halves __attribute__((vector_size(64)));
PLATOON_TARGET inline Lanes multiply_low(Lanes a, Lanes b) {
  return reinterpret_cast<Lanes>(
      _mm512_maskz_mul_epu32(0xff, reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
}
PLATOON_TARGET inline Lanes to_low(Lanes lanes) {
  return PLATOON_TO_LOW(1, 1, 3, 3, 5, 5, 7, 7, 9, 9, 11, 11, 13, 13, 15, 15);
}
using Arithmetic = Fused;
#include "stochastic_platoon/math/noise/noise_lanes.inc"
}  // namespace avx512
#undef PLATOON_TARGET

#define PLATOON_TARGET __attribute__((target("avx2,fma")))
namespace avx2 {
typedef std::uint64_t Lanes __attribute__((vector_size(32)));
typedef std::uint32_t Halves __attribute__((vector_size(32)));
PLATOON_TARGET inline Lanes multiply_low(Lanes a, Lanes b) {
  return reinterpret_cast<Lanes>(_mm256_mul_epu32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
}
PLATOON_TARGET inline Lanes to_low(Lanes lanes) {
  return PLATOON_TO_LOW(1, 1, 3, 3, 5, 5, 7, 7);
}
using Arithmetic = Fused;
#include "stochastic_platoon/math/noise/noise_lanes.inc"
}  // namespace avx2
#undef PLATOON_TARGET

#endif

#define PLATOON_TARGET
namespace baseline {
typedef std::uint64_t Lanes __attribute__((vector_size(16)));
typedef std::uint32_t Halves __attribute__((vector_size(16)));
inline Lanes multiply_low(Lanes a, Lanes b) {
#ifdef PLATOON_NAMED_WIDTHS
  return reinterpret_cast<Lanes>(_mm_mul_epu32(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return (a & 0xffffffffULL) * (b & 0xffffffffULL);
#endif
}
inline Lanes to_low(Lanes lanes) {
  return PLATOON_TO_LOW(1, 1, 3, 3);
}
#if defined(__FMA__) || !defined(__x86_64__)
using Arithmetic = Fused;
#else
using Arithmetic = Emulated;
#endif
#include "stochastic_platoon/math/noise/noise_lanes.inc"
}  // namespace baseline
#undef PLATOON_TARGET

std::vector<NoiseVersion> noise_versions() {
  std::vector<NoiseVersion> versions;
#ifdef PLATOON_NAMED_WIDTHS
  if (__builtin_cpu_supports("avx512f"))
    versions.push_back({"AVX-512", true, avx512::draw_words, avx512::box_muller, avx512::uniform_pairs});
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    versions.push_back({"AVX2", true, avx2::draw_words, avx2::box_muller, avx2::uniform_pairs});
#endif
  constexpr bool kFused = std::is_same_v<baseline::Arithmetic, Fused>;
  versions.push_back({"baseline", kFused, baseline::draw_words, baseline::box_muller, baseline::uniform_pairs});
  return versions;
}

}  // namespace detail

namespace {

const detail::NoiseVersion& fastest() {
  static const detail::NoiseVersion version = detail::noise_versions().front();
  return version;
}

// Writes two values per block by `transform`. The realizations may begin and end inside a block.
void fill_by(detail::TransformWords transform, std::uint64_t seed, DrawName name, std::uint64_t first_realization,
             std::size_t count, double* values) {
  detail::Words w1, w2;
  double pair[2];
  std::size_t written = 0;
  while (written < count) {
    const std::uint64_t realization = first_realization + written;
    const std::size_t skipped = realization % 2;  // only the first pass can start inside a block
    const std::uint64_t first_block = realization / 2, same_upper_bits = (1ULL << 32) - (first_block & 0xffffffffULL);
    const std::size_t blocks =
        std::min({detail::kBlocks, (skipped + count - written + 1) / 2, static_cast<std::size_t>(same_upper_bits)});
    fastest().draw_words(seed, name, first_block, blocks, &w1, &w2);
    if (skipped == 1) {
      transform(w1.data(), w2.data(), 1, pair);
      values[written++] = pair[1];
    }
    const std::size_t pairs = std::min(blocks - skipped, (count - written) / 2);
    transform(w1.data() + skipped, w2.data() + skipped, pairs, values + written);
    written += 2 * pairs;
    if (skipped + pairs < blocks) {
      transform(w1.data() + skipped + pairs, w2.data() + skipped + pairs, 1, pair);
      values[written++] = pair[0];
    }
  }
}

// The same for changed draws, run by run of equal or successive origins.
void fill_changed(detail::TransformWords transform, std::uint64_t seed, const ChangedDraws& changes, DrawName name,
                  std::uint64_t first_realization, std::size_t count, double* values) {
  std::array<std::uint64_t, 256> origins;
  for (std::size_t from = 0; from < count; from += origins.size()) {
    const std::size_t size = std::min(origins.size(), count - from);
    double* const here = values + from;
    changes.origins(name.step, first_realization + from, size, origins.data());
    for (std::size_t r = 0, end; r < size; r = end) {
      end = r + 1;
      if (r > 0 && origins[r] == origins[r - 1]) {
        here[r] = here[r - 1];
      } else if (origins[r] == ChangedDraws::kNoNoise) {
        here[r] = 0.0;
      } else {
        while (end < size && origins[end] == origins[end - 1] + 1) ++end;
        fill_by(transform, seed, name, origins[r], end - r, here + r);
      }
    }
  }
}

}  // namespace

double standard_deviation(const char* name, double variance) {
  if (!(variance >= 0.0) || !std::isfinite(variance)) {
    throw std::invalid_argument(std::string(name) + ": " + std::to_string(variance) +
                                ": must be finite and >= 0 [m^2]");
  }
  return std::sqrt(variance);
}

std::string slow_noise() {
  if (fastest().is_fused) return "";
  return "the noise is slow: this processor has no AVX2 and FMA, and fused multiply-adds are computed by other operations; "
         "the results have the same bits";
}

void WhiteNoise::fill(DrawName name, std::uint64_t first_realization, std::size_t count, double* normals) const {
  if (changes_ == nullptr) return fill_by(fastest().box_muller, seed_, name, first_realization, count, normals);
  fill_changed(fastest().box_muller, seed_, *changes_, name, first_realization, count, normals);
  changes_->shift(name, first_realization, count, normals);
}

void WhiteNoise::fill_uniform(DrawName name, std::uint64_t first_realization, std::size_t count,
                              double* uniforms) const {
  if (changes_ == nullptr) return fill_by(fastest().uniform_pairs, seed_, name, first_realization, count, uniforms);
  fill_changed(fastest().uniform_pairs, seed_, *changes_, name, first_realization, count, uniforms);
  changes_->replace(name, first_realization, count, uniforms);
}

}  // namespace platoon
