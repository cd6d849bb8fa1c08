#pragma once

#include <complex>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// One half of the unit circle: Taylor coefficients about the centre, and polynomials in its t. T = N/D, and z D -
/// ((1+h) z - h) N = (z-1)^2 Q is the double integral action of assumption assum:tf_noise b.
struct LoopSpectrumHalf {
  CirclePolynomial numerator;           ///< Taylor coefficients of N
  CirclePolynomial denominator;         ///< of D
  CirclePolynomial sensitivity;         ///< of (z-1)^2 Q
  CirclePolynomial sensitivity_factor;  ///< of Q
  CirclePolynomial margin;              ///< |D|^2 - |N|^2 in t
  CirclePolynomial stripped_margin;     ///< the same; about z = 1 divided by (1 - cos w)^margin_zeros
};

/// Factors of the string's spectra at one frequency.
struct LoopSpectrumValue {
  double gain;          ///< |T|^2
  double margin;        ///< 1 - |T|^2
  double known_margin;  ///< the same, given that T(1) = 1 exactly
  double sensitivity;   ///< |S|^2
  double complement;    ///< |HT|^2
  double ratio;         ///< |S|^2 / (1 - |T|^2), the singularity at w = 0 removed; infinite if |T| = 1
};

/// |T|, |S|, |H| on the unit circle, w in rad/sample.
///
/// The sign of 1 - |T|^2 and the ratio rely on T(1) = 1 and S(1) = S'(1) = 0 exactly: the zeros at w = 0 are divided
/// out algebraically. Everything else uses T as given by its coefficients.
class LoopSpectrum {
public:
  /// Throws std::invalid_argument if S does not have two zeros at z = 1, to the accuracy of violated_assumptions(), or
  /// if h is not positive.
  LoopSpectrum(const ClosedLoop& loop, double headway);

  LoopSpectrumValue at(double frequency) const;

  const LoopSpectrumHalf& about(Centre centre) const { return centre == Centre::kOne ? near_ : far_; }

  /// Multiplicity of the factor 1 - cos w in |D|^2 - |N|^2, to rounding; 1 unless T is maximally flat at w = 0.
  int margin_zeros() const { return margin_zeros_; }
  /// Multiplicity of the factor 1 - cos w in |S|^2; 2 unless G K has more than two poles at z = 1.
  int sensitivity_zeros() const { return sensitivity_zeros_; }

  /// The complex w at which the spectra of every zeta_i are singular: the poles of T, mapped by w = -j ln z.
  std::vector<std::complex<double>> pole_frequencies() const;

  /// The complex zeros, in 1 - cos w, of |D|^2 - |N|^2 except those at 0.
  std::vector<std::complex<double>> margin_roots() const;

private:
  void strip_flat_zeros();
  /// Bound of the change of |D|^2 - |N|^2 by rounding of T's coefficients, over (1 - cos w)^margin_zeros up to w =
  /// pi/2.
  double margin_uncertainty(double frequency) const;

  Polynomial numerator_;  ///< of T by powers of z, to bound the effect of its rounding
  Polynomial denominator_;
  double headway_;
  LoopSpectrumHalf near_;  ///< about z = 1
  LoopSpectrumHalf far_;   ///< about z = -1
  int margin_zeros_ = 1;
  int sensitivity_zeros_ = 2;
};

/// The complex w = -j ln(1 + s) of poles or zeros s = z - 1; none for one at z = 0.
std::vector<std::complex<double>> frequencies_of(const std::vector<std::complex<long double>>& places);

/// The complex w at which a function with this denominator is singular.
std::vector<std::complex<double>> singular_frequencies(const DeltaPolynomial& denominator);

}  // namespace platoon
