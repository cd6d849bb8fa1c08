#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/string/designed_gain.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"

namespace platoon {

/// Gains of one follower and the link into it at one frequency. With p = 1 - q, the predictor L = c_1 z^-1 + c_2 z^-2 +
/// ..., F = 1 / (1 - q L) and H = (1 + h) - h / z:
struct LinkedVehicleValue {
  double gain;                     ///< |T^|^2, T^ = p z^-m F T: from the predecessor's position to the mean of the own
  double margin;                   ///< 1 - |T^|^2, given that T^(1) = 1 exactly
  double loss_gain;                ///< |T F|^2: from the loss noise w to the own position
  double innovation;               ///< |(1 - L) F|^2: from the position at the loss stage to its prediction error e
  double noise;                    ///< |W|^2 P_d + D^2 / 12 [m^2]
  double complement;               ///< |1 - H T^|^2
  double headway;                  ///< |H|^2
  std::complex<double> undelayed;  ///< H p F T: H T^ without the delay z^-m
};

/// Multiplicity of the factor w^2 in spectral gains at low frequencies.
struct ZerosAtZero {
  int complement;  ///< |1 - H T^|^2: 1 if delay or losses leave a mean error at constant speed, 2 or more otherwise
  int innovation;  ///< |(1 - L) F|^2: 1 for holding, 2 for extrapolating, ...
  int noise;       ///< |W|^2 P_d + D^2 / 12; kNone without noise
  static constexpr int kNone = 1000;
};

/// One follower behind its link with independent losses, on the unit circle, w in rad/sample. The losses act on the
/// moments as a white noise w = (theta - p) e, with theta 1 if a position arrives and 0 if not. It is uncorrelated with
/// all sent positions and has variance E w^2 = p q E e^2.
class LinkedVehicle {
public:
  /// Throws std::invalid_argument for losses in bursts.
  explicit LinkedVehicle(const VehicleModel& vehicle);

  LinkedVehicleValue at(const CirclePoint& point) const;
  LinkedVehicleValue at(double frequency) const { return at(CirclePoint(frequency)); }

  /// |T^|^2 as a factor of the pattern's.
  const RatedFactor& factor() const { return factor_; }

  /// The complex frequencies at which any of the above is singular.
  std::vector<std::complex<double>> pole_frequencies() const;

  ZerosAtZero zeros_at_zero() const;

  double spectral_radius() const { return spectral_radius_; }  ///< rho(A)
  double loss_feedback() const { return loss_feedback_; }      ///< p q ||L F||^2; infinite: F is unstable

  /// kappa = p q / (1 - p q ||L F||^2): E w^2 over the E e^2 without the feedback of w through the link.
  double loss_factor() const;

  /// Mean lag of the received position at constant speed [steps]: m + q (c_1 + 2 c_2 + ...) / p.
  double lag() const;

  /// Mean of e at constant speed, divided by the metres per step: (c_1 + 2 c_2 + ...) / p; 0 without losses.
  double mean_innovation() const;

  /// Whether this object describes `vehicle`, which differs at most in headway and link.
  bool is_of(const VehicleModel& vehicle) const;

  bool has_losses() const { return loss_.probability > 0.0; }
  const VehicleModel& vehicle() const { return vehicle_; }

private:
  /// Taylor coefficients about one centre.
  struct Half {
    CirclePolynomial numerator, denominator;  ///< of T
    CirclePolynomial registers;               ///< z^n / F = z^n - q (c_1 z^(n-1) + ...)
    CirclePolynomial surprise;                ///< z^n (1 - L) = z^n - (c_1 z^(n-1) + ...)
  };

  VehicleModel vehicle_;
  LossModel loss_;  ///< probability 0 without a loss stage
  double spectral_radius_, loss_feedback_;
  Half near_, far_;
  std::optional<DesignedGain> designed_;  ///< of a vehicle by parts
  CirclePolynomial margin_;               ///< of any other one: |D^|^2 - |N^|^2 over t, about z = 1
  RatedFactor factor_;
};

/// One pattern of the string: its vehicle types, each once, and their order.
struct LinkedPattern {
  std::vector<LinkedVehicle> types;
  std::vector<std::size_t> order;  ///< index of the type at each place of the pattern

  std::size_t size() const { return order.size(); }
  std::size_t type(std::size_t follower) const { return order[follower % order.size()]; }
  const LinkedVehicle& operator[](std::size_t follower) const { return types[type(follower)]; }
  PatternGain gain() const;
};

/// The pattern of a platoon. `known`: pattern of the same platoon with other headways and links; its unchanged vehicles
/// are reused. Throws std::invalid_argument for losses in bursts.
LinkedPattern linked_pattern(const PlatoonModel& model, const LinkedPattern& known = {});

}  // namespace platoon
