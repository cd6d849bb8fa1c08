#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/links/link_filter.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/response/designed_gain.hpp"
#include "stochastic_platoon/math/response/pattern_gain.hpp"

namespace platoon {

/// Gains of one input of a follower at one frequency, with T_L of its link and N from the received value to the own
/// position (see LossFilter, DesignedGain; N = T for positions).
struct InputValue {
  double own;     ///< |N|^2: from what the losses of the link scatter
  double passed;  ///< |N T_L|^2: from the noise of the link
  double noise;   ///< |W|^2 P_d + D^2 / 12 [m^2] or [(m/s^2)^2]
};

/// Gains of one follower and the links into it at one frequency, with H = (1 + h) - h / z. T^ leads from the
/// predecessor's position to the mean of the own: T_L z^-m T for one input; with feed-forward Gamma = (G K + F z^-m G /
/// G_before) / (H (1 + G K)), each input with the mean effect of its link, G_before the plant of the predecessor.
struct LinkedVehicleValue {
  double gain;                      ///< |T^|^2
  double margin;                    ///< 1 - |T^|^2, given that T^(1) = 1 exactly
  double complement;                ///< |1 - H T^|^2
  double spacing_gain;              ///< |H|^2
  double of_gap;                    ///< |1 - T^|^2
  std::complex<double> undelayed;   ///< H T^ without the delay z^-m of the position
  std::complex<double> response;    ///< T^ without it
  double sent;                      ///< |1 / G|^2: from the spectrum of y to that of the own input; 0 without radios
  std::array<InputValue, 2> input;  ///< the position, and the predecessor's input (zero without feed-forward)
};

/// One follower behind its links, on the unit circle, w in rad/sample.
class LinkedVehicle {
public:
  /// `known`: the same vehicle with another headway or other links; it saves the search for zeros that do not depend on
  /// the headway. `before`: its predecessor, if another plant sends the input; null: the same plant. Throws as
  /// LossFilter does, and std::invalid_argument for a radio of a vehicle that is not computed part by part.
  explicit LinkedVehicle(const VehicleModel& vehicle, const LinkedVehicle* known = nullptr,
                         const VehicleModel* before = nullptr);

  /// The mean effects of the losses of the links.
  using MeanEffects = std::array<LossFilter::Value, 2>;
  LinkedVehicleValue at(const CirclePoint& point, const MeanEffects& effects) const;
  LinkedVehicleValue at(const CirclePoint& point) const;
  LinkedVehicleValue at(double frequency) const { return at(CirclePoint(frequency)); }

  /// |T^|^2 as a factor of the pattern's, without |G / G_before|^2, which cancels in it.
  const RatedFactor& factor() const { return factor_; }

  /// The complex frequencies at which any of the above is singular, plus as many as resolve the delays of a radio.
  std::vector<std::complex<double>> pole_frequencies() const;

  ZerosAtZero zeros_at_zero() const;

  double spectral_radius() const { return spectral_radius_; }  ///< rho(A)
  double loss_feedback() const;                                ///< the largest of its links

  /// The links of the position and, with feed-forward, of the predecessor's input.
  const std::vector<LinkFilter>& links() const { return links_; }
  bool has_losses() const;
  bool has_memory() const;  ///< of the losses of a link

  /// Mean lag of the received position at constant speed [steps]. Inputs are 0 there.
  double lag() const { return links_.front().lag(); }

  /// Whether this object describes `vehicle`, which differs at most in headway and links.
  bool is_of(const VehicleModel& vehicle) const;

  const VehicleModel& vehicle() const { return vehicle_; }

private:
  /// T about one centre.
  struct Half {
    CirclePolynomial numerator, denominator;
  };
  RatedFactor designed_factor(const LinkedVehicle* known, bool behind_other) const;
  std::complex<long double> designed_response(const CirclePoint& point, const MeanEffects& effects,
                                              LinkedVehicleValue& value) const;
  std::complex<long double> given_response(const CirclePoint& point, const LossFilter::Value& effect,
                                           LinkedVehicleValue& value) const;
  int complement_zeros() const;
  int feed_forward_zeros() const;

  VehicleModel vehicle_;
  std::vector<LinkFilter> links_;
  double spectral_radius_;
  Half near_, far_;
  std::optional<DesignedGain> designed_;  ///< of a vehicle by parts
  CirclePolynomial margin_;               ///< of any other one: |D|^2 - |N|^2 over t, about z = 1
  RatedFactor factor_;
  std::ptrdiff_t loop_zeros_ = 0;  ///< number of its first zeros, which do not come from losses alone
};

}  // namespace platoon
