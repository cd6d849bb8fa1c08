#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// A vehicle on the unit circle from plant G and controller K, with one or two inputs. With W = 1 / (G K) and H =
/// (1 + h) - h / z, from the received position and, by feed-forward F, from the received input to the own position:
///
///     N_position = 1 / (H (1 + W)),   N_input = F G W / (H (1 + W))    behind a headway filter,
///     N_position = 1 / (H + W),       N_input = F G W / (H + W)        without one (paper, section 3).
///
/// The received input is that of the predecessor, u = y / G_before, whose plant G_before may be another one.
///
/// Coefficients of T by powers of z - 1 lose a digit for every two or three steps of input delay; here the delay stays
/// a power of z, and the double integrators of G K make W small where |T| is near 1.
class DesignedGain {
public:
  /// feed_forward: F, 0 without a radio. before: the plant G_before.
  DesignedGain(const LoopDesign& design, double headway, double feed_forward, const Plant& before);

  /// The mean effect of the links: 1 / T_L - 1 of each and their delays (see LinkFilter).
  struct Links {
    std::complex<long double> position_excess, input_excess;
    std::int64_t position_delay = 0, input_delay = 0;
  };

  struct Value {
    std::complex<long double> position;  ///< N_position
    std::complex<long double> input;     ///< N_input
    /// N_input / G_before z^(m_position - m_input): from the predecessor's position, by its input, without the links'
    /// losses
    std::complex<long double> through_input;
    long double sent;  ///< 1 / |G|^2: from the spectrum of y to that of u, infinite where G = 0; 0 without radios
    /// 1 / |T^|^2 - 1, without cancellation near w = 0, with T^ from the predecessor's position to the mean of the own;
    /// infinite where T^ = 0.
    long double excess;
  };
  Value at(const CirclePoint& point, const Links& links) const;

  /// The zeros s = z - 1 of T^ G_before / G, apart from those at z = 0, with these losses and, without effect of their
  /// excess, these links; without feed-forward those of a T_L = 1. Along a string the factors G / G_before cancel.
  std::vector<std::complex<long double>> zeros(const ExactTransfer& position, const ExactTransfer& input,
                                               const Links& links) const;

  /// Difference of the delays of G and G_before [steps].
  std::int64_t plant_turns() const;

  /// Multiplicity of z = 1 as a zero of 1 - F G / G_before, negative for a pole.
  int zeros_of_difference() const;

private:
  std::shared_ptr<const ExactTransfer> ahead_;  ///< G_before K
  CirclePolynomial numerator_, denominator_;    ///< G K = numerator / denominator z^-delay
  CirclePolynomial plant_numerator_, plant_denominator_, controller_denominator_;
  /// G / G_before = numerator / denominator z^-(delay - ahead_delay), difference = denominator - numerator; empty: 1.
  CirclePolynomial quotient_numerator_, quotient_denominator_, quotient_difference_;
  std::ptrdiff_t delay_, controller_delay_;
  bool filtered_, sends_;
  long double headway_, feed_forward_;
};

}  // namespace platoon
