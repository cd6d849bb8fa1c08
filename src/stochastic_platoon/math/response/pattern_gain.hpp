#pragma once

#include <complex>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/response/attenuation.hpp"
#include "stochastic_platoon/math/response/realization_rounding.hpp"

namespace platoon {

enum class Sign { kAbove, kZero, kBelow };

/// Minimum of -ln |prod T|^2 with its zero at w = 0 divided out: divided by (1 - cos w)^zeros for w up to pi/2.
struct LeastMargin {
  Sign sign;         ///< zero if rounding of the given numbers hides it
  double value;      ///< the minimum less the effect of this rounding: positive exactly if the sign is kAbove
  double frequency;  ///< [rad/sample]
};

/// One factor T = N/D of |prod T|^2, and the rounded numbers that limit the accuracy of T: none for a vehicle by parts.
struct RatedFactor {
  GainFactor factor;
  std::vector<Polynomial> rounded;                        ///< by powers of z; all multiply or divide T
  std::shared_ptr<const RealizationRounding> given = {};  ///< A, B and C, if the loop was given by them
  long double gain_at_one = 1.0L;  ///< |T(1)|: given A, B and C have T(1) = 1 to their number of digits only
  GainFactor exact = {};  ///< further poles and zeros of T, rounded to long double only; count stays that of `factor`
};

/// The factor of a closed loop. Throws std::invalid_argument if T has a pole or a zero at z = 1.
RatedFactor rated_factor(const ClosedLoop& loop);

/// |prod T|^2 over one pattern of vehicles, evaluated from its factors. They are never multiplied out, as the
/// coefficients of a product of a dozen vehicles have no accurate digits left.
class PatternGain {
public:
  explicit PatternGain(std::vector<RatedFactor> factors);

  /// Multiplicity of the factor 1 - cos w in 1 - |prod T|^2, to rounding; at least 1.
  int zeros() const { return zeros_; }

  /// Whether |prod T| = 1 at every frequency, as for a pure delay.
  bool is_one() const { return attenuation_.is_zero(); }

  /// Accuracy of a margin whose sign alone decides.
  static constexpr double kSignAccuracy = 1e-4;

  /// Minimum of -ln |prod T|^2 with these zeros divided out, to this relative accuracy; its sign is exact.
  LeastMargin least(double accuracy = 1e-12) const;

  /// The largest |prod T| and its frequency: 1 at w = 0 unless it is larger elsewhere. Relative to |prod T(1)| if only
  /// that is exceeded, which then is below 1.
  struct Peak {
    double excess;     ///< |prod T| - 1, accurate even if |prod T| is 1 in double
    double frequency;  ///< [rad/sample]
  };
  Peak peak() const;

  /// Frequencies in (0, pi] of the local maxima of |prod T|, and pi [rad/sample].
  std::vector<double> maxima() const;

  /// The complex w near which |prod T| = 1; their distance from a local maximum follows from the distance of that
  /// maximum from 1.
  std::vector<std::complex<double>> margin_frequencies() const;

private:
  /// Bounds of the change of -ln |prod T|^2 over (1 - cos w)^zeros up to pi/2.
  double doubt(double frequency) const { return rounding(frequency) + rounding_of_entries(frequency); }
  double spread_of_places(double frequency) const;     ///< if each pole and zero s changes by 1, relative
  double rounding(double frequency) const;             ///< by rounding of poles, zeros and coefficients
  double rounding_of_entries(double frequency) const;  ///< by that of given A, B and C

  std::vector<RatedFactor> factors_;
  Attenuation attenuation_;
  int zeros_ = 1;
};

}  // namespace platoon
