#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace platoon {

/// Purpose of a draw. Different purposes share no counter and therefore no bits.
enum class Purpose : std::uint32_t {
  noise = 0,   ///< channel noise; the vehicle's initial position at step -1
  dither = 1,  ///< dither of a quantiser
  loss = 2,    ///< whether a position arrives
  choice = 3,  ///< choices of an estimator of rare events
};

/// Name of one draw: the receiving vehicle, the step and the purpose. Step -1 names the initial position.
struct DrawName {
  std::uint32_t vehicle;  ///< i >= 1; bits 24 to 27 are those of the purpose
  std::int64_t step;      ///< k >= -1, below 2^47
  Purpose purpose = Purpose::noise;
};

/// Changes of draws, by which conditioned and branched realizations are simulated like any others.
class ChangedDraws {
public:
  /// The origin of draws that are 0 before the shift.
  static constexpr std::uint64_t kNoNoise = ~std::uint64_t{0};

  virtual ~ChangedDraws() = default;

  /// Writes, for realizations first .. first + count - 1, the realizations whose draws they have at this step.
  virtual void origins(std::int64_t step, std::uint64_t first, std::size_t count, std::uint64_t* origins) const = 0;

  /// Adds the shifts of these realizations to their normal draws.
  virtual void shift(const DrawName& /*name*/, std::uint64_t /*first*/, std::size_t /*count*/,
                     double* /*normals*/) const {}

  /// Replaces uniform draws of these realizations.
  virtual void replace(const DrawName& /*name*/, std::uint64_t /*first*/, std::size_t /*count*/,
                       double* /*uniforms*/) const {}
};

/// Standard normal white noise g(seed, i, k, r) as a pure function of its arguments (paper, assumption d).
///
/// Philox4x32-10 with key = seed and counter = (block number, step, vehicle + 2^24 purpose). Block b gives two words w1
/// = (c0, c1) and w2 = (c2, c3), the first half above the second, and serves realizations 2b and 2b + 1. The 52 low
/// bits of the words give uniform u1 in (0, 1] and u2 in [0, 1), the leading bits give the signs:
/// \f[ g(2b) = \pm \sqrt{-2 \ln u_1} \cos(\pi u_2 / 2), \qquad g(2b + 1) = \pm \sqrt{-2 \ln u_1} \sin(\pi u_2 / 2) \f]
/// (Box and Muller, 1958). ln, cos and sin are polynomials of fused multiply-adds in IEEE arithmetic and give the same
/// bits on every machine. Their largest errors over 10^8 arguments are 1.45, 1.28 and 1.50 units in the last place,
/// that of g is 4.2 2^-53 sqrt(-2 ln u1) (test/benchmark/noise_accuracy). |g| <= sqrt(104 ln 2) = 8.49. Reference: J.
/// Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC 2011.
class WhiteNoise {
public:
  /// `changes`: none for the draws as above. A seed alone is white noise, too.
  WhiteNoise(std::uint64_t seed, std::shared_ptr<const ChangedDraws> changes = nullptr)  // NOLINT
      : seed_(seed), changes_(std::move(changes)) {}

  /// Writes g for realizations first .. first + count - 1 (below 2^48).
  void fill(DrawName name, std::uint64_t first_realization, std::size_t count, double* normals) const;

  /// Writes uniform values in [0, 1), multiples of 2^-52: u(2b) = 1 - u1 and u(2b + 1) = u2.
  void fill_uniform(DrawName name, std::uint64_t first_realization, std::size_t count, double* uniforms) const;

private:
  std::uint64_t seed_;
  std::shared_ptr<const ChangedDraws> changes_;
};

/// The standard deviation [m] of a variance [m^2]. Throws std::invalid_argument, with the variance's name, unless it is
/// finite and >= 0.
double standard_deviation(const char* name, double variance);

/// The reason for slow noise on this machine; empty if the noise is not slow.
std::string slow_noise();

namespace detail {

constexpr std::size_t kBlocks = 256;  // drawn at once; their words fit in the first level cache

using Words = std::array<std::uint64_t, kBlocks>;

/// Writes the words of `blocks` <= kBlocks blocks, and possibly of further blocks that fit. The numbers of the blocks
/// have the same upper 32 bits.
using DrawWords = void (*)(std::uint64_t seed, DrawName name, std::uint64_t first_block, std::size_t blocks, Words* w1,
                           Words* w2);

/// values[2j] and values[2j + 1] from the j-th words.
using TransformWords = void (*)(const std::uint64_t* w1, const std::uint64_t* w2, std::size_t pairs, double* values);

/// The noise compiled for one vector width.
struct NoiseVersion {
  const char* name;
  bool is_fused;  ///< a fused multiply-add is an instruction
  DrawWords draw_words;
  TransformWords box_muller, uniform_pairs;
};

/// One version per vector width of this machine, the widest first. All write the same bits.
std::vector<NoiseVersion> noise_versions();

}  // namespace detail

}  // namespace platoon
