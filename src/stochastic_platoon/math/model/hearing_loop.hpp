#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// A vehicle given by plant and controller that hears any vehicles ahead (see Input), as a filter of what it receives.
/// With W = 1 + s (1 - 1/z), s = h times the spacing_in_vehicles(), F_v the sum of the gains of its speeds, and d = (1
/// - 1/z) / T_s, \f[ y_i = \frac{K \sum w_j r_j + \sum F_j r_j}{H / G + K W + F_v d - F_a d^2}. \f]
class HearingLoop {
public:
  /// Throws std::invalid_argument for a vehicle without plant and controller.
  HearingLoop(const VehicleModel& vehicle, std::size_t follower, double sample_period);

  using Complex = std::complex<long double>;

  /// The filters at one point of the unit circle.
  struct Value {
    Complex of_position;  ///< from the weighted positions to the own one
    Complex of_input;     ///< from the sum of all other signals, times their gains [s^2]
    Complex sent;         ///< 1 / G: from the own position to the own control input

    /// N: from what the vehicle receives as this input to its own position.
    Complex of(const Input& input) const {
      return static_cast<long double>(input.gain) * (input.signal == InputSignal::position ? of_position : of_input);
    }
  };
  Value at(const CirclePoint& point) const;

  /// The closed loop's poles, from its characteristic polynomial in a hundred digits, and their largest modulus.
  std::vector<std::complex<long double>> poles() const;
  double spectral_radius() const;

  /// L = numerator / denominator z^-delay by powers of s = z - 1: the loop opened at the plant's input, (G K W + G F_v
  /// d - G F_a d^2) / H.
  ExactTransfer opened() const;

private:
  std::shared_ptr<const ExactTransfer> plant_, controller_;  ///< G, K
  double headway_, spacing_;                                 ///< h with a headway filter, else 0; s
  double speed_, acceleration_;                              ///< F_v / T_s, F_a / T_s^2
  CirclePolynomial rounded_[4];
};

/// z^-m S: from the position of the source of an input to what arrives of it without losses. `of_source`: 1 / G of the
/// source, of control inputs.
HearingLoop::Complex sent_value(const Input& input, const CirclePoint& point, HearingLoop::Complex of_source,
                                double sample_period);

}  // namespace platoon
