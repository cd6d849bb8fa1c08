#pragma once

#include <complex>
#include <vector>

#include "stochastic_platoon/theory/circle_polynomial.hpp"
#include "stochastic_platoon/theory/least_margin.hpp"
#include "stochastic_platoon/theory/linked_vehicle.hpp"

namespace platoon {

/// |prod T^|^2 over one pattern of vehicles, as a fraction of polynomials in t = 1 - cos w and 1 + cos w.
class PatternGain {
public:
  explicit PatternGain(const std::vector<LinkedVehicle>& vehicles);

  /// How often 1 - cos w divides 1 - |prod T^|^2.
  int zeros() const { return zeros_; }

  /// The least 1 - |prod T^|^2 without these zeros, as of LoopSpectrum, relative to the pattern's |prod D^|^2.
  LeastMargin least() const;

  /// Frequencies w > 0 where |prod T^| may be largest [rad/sample].
  std::vector<double> critical_frequencies() const;

  /// The complex w off the real axis where |prod T^| = 1.
  std::vector<std::complex<double>> margin_frequencies() const;

private:
  struct Half {
    CirclePolynomial numerator, denominator;
    CirclePolynomial margin;  ///< their difference; about z = 1 divided by t^zeros
  };
  const Half& about(Centre centre) const { return centre == Centre::kOne ? near_ : far_; }
  long double doubt(long double t, Centre centre) const;

  Half near_, far_;
  int zeros_ = 1;
};

}  // namespace platoon
