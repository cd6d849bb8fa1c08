#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/response/vehicle_response.hpp"

namespace platoon {

/// A follower and the links into it as operators on means, with losses replaced by their mean effect:
/// \f[ r(k) = (L r)(k) + p e(k), \qquad e(k) = s(k) - (L r)(k). \f]
///
/// Sequences of sent values start at step -1; innovation and error sequences start at step 0.
class MeanVehicle {
public:
  using Sequence = VehicleResponse::Sequence;

  /// Throws std::invalid_argument for losses in bursts.
  explicit MeanVehicle(const VehicleModel& vehicle);

  struct Passed {
    std::array<Sequence, 2> innovation;  ///< e(k) of each link; empty if there is none
    Motion own;                          ///< y_i and, with radios, its inputs
  };

  /// Number of links: the position's and, with feed-forward, that of the predecessor's input.
  std::size_t links() const { return links_.size(); }

  /// Response to the predecessor's motion, without the own initial position.
  Passed operator()(const Motion& predecessor) const;

  /// Response to a sequence that is sent over one link alone.
  Passed over_link(std::size_t link, const Sequence& sent) const;

  /// Response to the w of a link: a unit impulse at step 0 on the received value.
  Passed of_loss(std::size_t link, std::size_t steps) const;

  /// Free motion from the own equilibrium at position 1.
  Motion free_motion(std::size_t steps) const { return vehicle_.free_motion(steps + 1); }

  /// zeta_i from the positions of both vehicles.
  Sequence error(const Sequence& predecessor, const Sequence& own) const;

  /// p q of a link: E w(k)^2 = p q E e(k)^2.
  double variance_factor(std::size_t link) const;

private:
  struct MeanLink {
    std::size_t delay;
    LossModel loss;

    long double prediction(const Sequence& received) const;
    Sequence pass(const Sequence& sent, Sequence& innovation) const;
  };
  Motion nothing(std::size_t count) const;

  VehicleResponse vehicle_;
  long double headway_;
  std::vector<MeanLink> links_;
};

}  // namespace platoon
