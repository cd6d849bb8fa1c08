#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "stochastic_platoon/math/links/mean_vehicle.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/causal_convolution.hpp"

namespace platoon {

/// Squared responses of the vehicles downstream to one kind of source at one place of the pattern. Index: number of
/// vehicles behind the source, from 0 for the source's own vehicle.
struct Responses {
  using Values = CausalConvolution::Values;

  std::vector<Values> error;  ///< of zeta
  /// Those of e, per link; empty for the source's own vehicle, and where a vehicle has no such link with losses.
  std::array<std::vector<Values>, 2> innovation;
};

/// r_0 [m] from step -1 to step steps - 1, without the rounding of large positions to double.
MeanVehicle::Sequence virtual_leader(const PlatoonModel& model, std::size_t steps);

/// The leader's motion from step -1 to step steps - 1. Throws std::invalid_argument if the recorded leader ends before.
Motion leader_motion(const PlatoonModel& model, std::size_t steps);

/// The response of a noise filter to a unit impulse at step 0, from step -1 to step steps - 1.
MeanVehicle::Sequence filtered_impulse(const TransferFunction& filter, std::size_t steps);

/// The vehicles of a linked platoon as operators, and the responses to its sources over a number of steps.
class LinkedResponses {
public:
  using Sequence = MeanVehicle::Sequence;
  using Values = CausalConvolution::Values;

  LinkedResponses(const PlatoonModel& model, std::size_t followers, std::size_t steps);

  std::size_t period() const { return vehicles_.size(); }
  const VehicleModel& model(std::size_t i) const { return vehicles_[i % period()]; }
  const MeanVehicle& vehicle(std::size_t i) const { return mean_vehicles_[i % period()]; }

  /// Means of all errors, and per follower of the e of each link with losses.
  struct Means {
    Values error;
    std::vector<std::array<Values, 2>> innovation;
  };
  Means means() const;

  /// Called for one follower after the other, i from 0, with the positions of its predecessor and its own response.
  /// Both sequences start at step -1 and leave out the place in formation.
  using Visitor = std::function<void(std::size_t i, const Sequence& predecessor, const MeanVehicle::Passed& passed)>;

  /// Visits all followers with their mean motions.
  void visit_means(const Visitor& visit) const;

  /// Squared responses down the string, given the `motion` that the source's own vehicle at `place` sends in response.
  Responses downstream(std::size_t place, Motion motion) const;

  /// A unit impulse at step 0, and the response of a noise filter to it.
  Sequence impulse() const;
  Sequence filtered_impulse(const TransferFunction& filter) const { return platoon::filtered_impulse(filter, steps_); }

private:
  PlatoonModel model_;
  std::size_t followers_, steps_;
  std::vector<VehicleModel> vehicles_;
  std::vector<MeanVehicle> mean_vehicles_;
};

/// The response of a signal to a source, given those of its vehicle and its predecessor, from step -1 on: y_{i-1} - y_i
/// (of relative signals only) plus factor D^order y_i, or the input; without offsets.
MeanVehicle::Sequence signal_values(const Signal& signal, const MeanVehicle::Sequence& predecessor,
                                    const Motion& motion);

/// What a source of variance 1 with this response adds to the variance of a signal, and to its covariance with the step
/// before, at every step from 0 on: sums over the steps for a noise, and the last term of each for one value at step
/// -1.
struct ResponseProducts {
  MeanVehicle::Sequence variance, covariance;

  ResponseProducts(const MeanVehicle::Sequence& response, bool is_noise);
  void add(const ResponseProducts& other);
};

/// The squares of a sequence.
CausalConvolution::Values squares(const MeanVehicle::Sequence& values);

}  // namespace platoon
