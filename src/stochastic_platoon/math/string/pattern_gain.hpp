#pragma once

#include <complex>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/string/attenuation.hpp"

namespace platoon {

enum class Sign { kAbove, kZero, kBelow };

/// -ln |prod T|^2 where it is least, its zero at w = 0 divided out.
struct LeastMargin {
  Sign sign;         ///< zero where the rounding of the coefficients cannot tell it from zero
  double value;      ///< over (1 - cos w)^zeros for w up to pi/2; 0 where the sign is zero
  double frequency;  ///< [rad/sample]
};

/// One factor T = N/D of |prod T|^2, and the polynomials whose coefficients are rounded: what they leave in doubt.
struct RatedFactor {
  GainFactor factor;
  std::vector<Polynomial> rounded;  ///< by powers of z; all multiply or divide T
};

/// The factor of a closed loop. Throws std::invalid_argument when T has a pole or a zero at z = 1.
RatedFactor rated_factor(const DeltaFraction& transfer);

/// |prod T|^2 over one pattern of vehicles, decided from its factors: they are never multiplied out, as the
/// coefficients of the product of a dozen vehicles have no digits left.
class PatternGain {
public:
  explicit PatternGain(std::vector<RatedFactor> factors);

  /// How often 1 - cos w divides 1 - |prod T|^2, to rounding; at least 1.
  int zeros() const { return zeros_; }

  /// Whether |prod T| = 1 at every frequency, as of a pure delay.
  bool is_one() const { return attenuation_.is_zero(); }

  /// The least -ln |prod T|^2 without these zeros.
  LeastMargin least() const;

  /// The largest |prod T|^2, and where: 1 at w = 0 unless it is larger elsewhere.
  struct Peak {
    double excess;     ///< |prod T| - 1, also where |prod T| is 1 in double
    double frequency;  ///< [rad/sample]
  };
  Peak peak() const;

  /// Frequencies in (0, pi] where |prod T| has a local maximum, and pi [rad/sample].
  std::vector<double> maxima() const;

  /// The complex w near which |prod T| = 1: off the local maxima by as much as these stay below 1.
  std::vector<std::complex<double>> margin_frequencies() const;

private:
  /// By how much rounding of the coefficients may change -ln |prod T|^2, over (1 - cos w)^zeros up to pi/2.
  double doubt(double frequency) const;

  std::vector<RatedFactor> factors_;
  Attenuation attenuation_;
  int zeros_ = 1;
};

}  // namespace platoon
