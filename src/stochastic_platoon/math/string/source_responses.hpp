#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/links/linked_responses.hpp"
#include "stochastic_platoon/math/response/vehicle_response.hpp"

namespace platoon {

/// Followers whose sources or responses differ: the first ones, which hear vehicle 0 in place of one farther ahead, and
/// one pattern behind them, which all others repeat.
struct DifferentFollowers {
  std::size_t alone, period;

  /// The different follower that a follower is or repeats.
  std::size_t of(std::size_t follower) const {
    return follower <= alone ? follower : alone + (follower - alone - 1) % period + 1;
  }
  std::size_t count() const { return alone + period; }
};

/// The random sources of a string whose links do not lose, and the deviations from the mean motion that each of them
/// causes in the vehicles behind it. A source farther back than the vehicles that hear vehicle 0 in place of one
/// farther ahead has the responses of the same place one pattern before.
class SourceResponses {
public:
  using Sequence = VehicleResponse::Sequence;

  /// `model` must outlive the object.
  SourceResponses(const PlatoonModel& model, std::size_t followers, std::size_t steps);

  const DifferentFollowers& different() const { return different_; }

  /// A noise or dither on an input, present from step 0 on, or without input the initial position.
  struct Source {
    std::size_t follower;
    std::optional<std::size_t> input;
    double variance;   ///< [square of the input's unit], above 0
    Sequence impulse;  ///< what a white value of 1 at step 0 adds to the values sent, from step -1 on
  };
  std::vector<Source> sources(std::size_t follower) const;

  /// Called for the source's own follower and all behind it, with the deviations of predecessor and follower from step
  /// -1 on.
  using Visitor = std::function<void(std::size_t follower, const Sequence& predecessor, const Motion& own)>;
  void visit(const Source& source, const Visitor& visitor) const;

private:
  Motion response(std::size_t follower, const std::vector<Motion>& all, const Source* source) const;

  const PlatoonModel& model_;
  std::size_t followers_, count_;
  DifferentFollowers different_;
  std::vector<VehicleResponse> vehicles_;  ///< of the different followers
};

}  // namespace platoon
