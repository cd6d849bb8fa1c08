#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace platoon {

/// Purpose of a draw. Different purposes share no counter and therefore no bits.
enum class Purpose : std::uint32_t {
  noise = 0,   ///< channel noise; the vehicle's initial position at step -1
  dither = 1,  ///< dither of a quantiser
  loss = 2,    ///< whether a position arrives
};

/// Name of one draw: the receiving vehicle, the step and the purpose. Step -1 names the initial position.
struct DrawName {
  std::uint32_t vehicle;  ///< i >= 1, below 2^24
  std::int64_t step;      ///< k >= -1, below 2^47
  Purpose purpose = Purpose::noise;
};

/// Standard normal white noise g(seed, i, k, r) as a pure function of its arguments (paper, assumption d).
///
/// Philox4x32-10 with key = seed and counter = (block number, step, vehicle + 2^24 purpose). Block b serves
/// realizations 2b and 2b + 1: two 52 bit uniforms u1 in (0, 1], u2 in [0, 1) give
///     g(2b) = sqrt(-2 ln u1) cos(2 pi u2),   g(2b + 1) = sqrt(-2 ln u1) sin(2 pi u2)     (Box and Muller, 1958).
/// ln, cos and sin are polynomials in plain IEEE arithmetic, without libm and without contraction, and give the same
/// bits on every x86-64 machine. |g| <= sqrt(104 ln 2) = 8.49. Reference: J. Salmon et al., Parallel random numbers: as
/// easy as 1, 2, 3, SC 2011.
class WhiteNoise {
public:
  explicit WhiteNoise(std::uint64_t seed) : seed_(seed) {}

  /// Writes g for realizations first .. first + count - 1 (below 2^48).
  void fill(DrawName name, std::uint64_t first_realization, std::size_t count, double* normals) const;

  /// Writes uniform values in [0, 1), multiples of 2^-52: u(2b) = 1 - u1 and u(2b + 1), the leading bits of the two
  /// words of block b.
  void fill_uniform(DrawName name, std::uint64_t first_realization, std::size_t count, double* uniforms) const;

private:
  std::uint64_t seed_;
};

namespace detail {

constexpr std::size_t kBlocks = 256;  // drawn at once; their words fit in the first level cache

using Words = std::array<std::uint64_t, kBlocks>;

/// Writes the words behind u1 and u2 of `blocks` <= kBlocks blocks, and possibly of further blocks that fit.
using DrawWords = void (*)(std::uint64_t seed, DrawName name, std::uint64_t first_block, std::size_t blocks,
                           Words* radius, Words* angle);

/// One version per vector width of this machine, the widest first. All write the same bits.
std::vector<DrawWords> draw_words_versions();

/// normals[2j] and normals[2j + 1] from the j-th words.
void box_muller(const std::uint64_t* radius, const std::uint64_t* angle, std::size_t pairs, double* normals);

}  // namespace detail

}  // namespace platoon
