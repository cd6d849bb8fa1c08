#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "stochastic_platoon/math/model/transfer_function.hpp"

namespace platoon {

struct ExactTransfer;

/// G(s) = N(s) / D(s) e^(-input_delay s), by descending powers of s.
struct ContinuousPlant {
  Polynomial numerator;
  Polynomial denominator;
  double input_delay = 0.0;  ///< [s], >= 0
};

/// A car whose acceleration follows its control input,
/// \f[ G(s) = \frac{e^{-\tau s}}{s^2 (\lambda s + 1)}, \f]
/// with the lag lambda >= 0 [s] of its actuator and the input delay tau [s].
ContinuousPlant car_with_actuator_lag(double lag, double input_delay);

/// K(z) = kp + kd (1 - 1/z) / T_s + ki T_s / (1 - 1/z).
struct ControllerGains {
  double kp = 0.0;  ///< [1/s^2], of the spacing error
  double kd = 0.0;  ///< [1/s]
  double ki = 0.0;  ///< [1/s^3]
};

/// The lag of such a car [s]; none for any other plant.
std::optional<double> actuator_lag(const ContinuousPlant& plant);

/// Number of whole sample periods in an input delay, and what is left [s]. A delay within 8 units in the last place of
/// whole sample periods is taken as whole.
struct SplitDelay {
  double steps, fraction;
};
SplitDelay split_delay(double input_delay, double sample_period);

/// G(z) by descending powers of z; poles and zeros at z = 0 are not reduced.
struct SampledPlant {
  Polynomial numerator, denominator;
};

/// The plant of a vehicle: G(z) as given, or the exact zero-order hold equivalent of G(s).
///
/// An input delay of d + f sample periods, 0 <= f < 1, makes the held input change within the sample: G(z) = z^-d C (zI
/// - Phi(T_s))^-1 (Gamma_0 + Gamma_1 / z) with Phi(t) = e^(A t), Gamma(t) = (integral of Phi from 0 to t) B, Gamma_0 =
/// Gamma((1 - f) T_s), Gamma_1 = Phi((1 - f) T_s) Gamma(f T_s). Computed to a hundred digits; poles at s = 0 become
/// poles at z = 1 exactly. A delay within 8 units in the last place of whole sample periods is taken as whole.
class Plant {
public:
  Plant(const TransferFunction& sampled);  // NOLINT(google-explicit-constructor): any G(z) is a plant
  /// Throws std::invalid_argument unless G(s) is strictly proper, T_s > 0 is finite, and the delay is between 0 and
  /// kLongestInputDelay sample periods.
  Plant(const ContinuousPlant& continuous, double sample_period);

  /// As given.
  const std::variant<TransferFunction, ContinuousPlant>& given() const { return given_; }
  const ExactTransfer& exact() const { return *exact_; }

  /// G(z), rounded.
  SampledPlant sampled() const;

  /// Number of poles at z = 1 minus number of zeros there.
  int integrators() const;

  /// Whether G(z) is the same to the last digit.
  bool operator==(const Plant& other) const;

private:
  std::variant<TransferFunction, ContinuousPlant> given_;
  std::shared_ptr<const ExactTransfer> exact_;
};

constexpr long kLongestInputDelay = 100;  ///< in sample periods

/// The controller of a vehicle: K(z) as given, or by its gains.
class Controller {
public:
  Controller(const TransferFunction& sampled);  // NOLINT(google-explicit-constructor): any K(z) is a controller
  /// Throws std::invalid_argument unless the gains are finite, not all zero, and T_s > 0 is finite.
  Controller(const ControllerGains& gains, double sample_period);

  const std::variant<TransferFunction, ControllerGains>& given() const { return given_; }
  const ExactTransfer& exact() const { return *exact_; }

  /// Leading coefficient of the numerator, or kp.
  double gain() const;
  /// The same controller, scaled to this gain(). Throws std::invalid_argument if the present gain is 0.
  Controller with_gain(double gain) const;

private:
  std::variant<TransferFunction, ControllerGains> given_;
  double sample_period_ = 0.0;  ///< of gains
  std::shared_ptr<const ExactTransfer> exact_;
};

/// Plant and controller of a vehicle; they define a closed loop for every headway.
struct LoopDesign {
  Plant plant;            ///< G(z)
  Controller controller;  ///< K(z), K(z) (1 + h) or K(z) H(z), see below
  bool divide_by_one_plus_headway = false;
  bool headway_filter = false;  ///< the controller is divided by H(z) = (1 + h) - h / z
  bool sends_input = false;     ///< a radio of its string needs its control input, or its limits do
};

/// Whether the vehicle is computed part by part (LoopPartsBatch) instead of by the canonical form of T: the design has
/// a continuous plant, gains or a headway filter, or something needs its control input, which the canonical form lacks.
bool is_by_parts(const LoopDesign& design);

}  // namespace platoon
