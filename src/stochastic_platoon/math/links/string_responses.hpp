#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
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

/// The vehicles of a string as operators on finite sequences, and the random sources that drive them. Losses are
/// replaced by their mean effect; a loss has a source of its own:
/// \f[ r(k) = (L r)(k) + p e(k) + w(k), \qquad e(k) = s(k) - (L r)(k), \qquad E w(k)^2 = p q E e(k)^2. \f]
/// Sequences of values start at step -1, those of e at step 0. A source farther back than the vehicles that hear
/// vehicle 0 in place of one farther ahead has the responses of the same place one pattern before.
class StringResponses {
public:
  using Sequence = VehicleResponse::Sequence;

  /// How values pass a link that does not lose: as they are, or as (L r)(k) + e(k), which differs in rounding alone.
  enum class Pass { values, innovations };

  /// `model` must outlive the object. Throws std::invalid_argument for losses in bursts and for vehicles with limits.
  StringResponses(const PlatoonModel& model, std::size_t followers, std::size_t steps, Pass pass = Pass::values);

  const DifferentFollowers& different() const { return different_; }

  /// p q of an input of a follower; 0 if it loses nothing.
  double loss_factor(std::size_t follower, std::size_t input) const;

  /// A noise or dither on an input, present from step 0 on; the w of its losses; or, without input, the initial
  /// position.
  struct Source {
    std::size_t follower;
    std::optional<std::size_t> input;
    double variance;   ///< [square of the input's unit], above 0; 1 of a loss
    Sequence impulse;  ///< what a white value of 1 at step 0 adds to the values sent, from step -1 on; none of a loss
  };
  /// All but losses.
  std::vector<Source> sources(std::size_t follower) const;

  /// The own motion, and e of each input where it is computed and not 0.
  struct Response {
    Motion own;
    std::vector<Sequence> innovation;
  };

  /// Called for one follower after the other with the positions of its predecessor and its response.
  using Visitor = std::function<void(std::size_t follower, const Sequence& predecessor, const Response& response)>;

  /// Visits the source's own follower and all behind it with their deviations from the mean motion.
  void visit(const Source& source, const Visitor& visitor) const;

  /// Visits all followers, which must hear their predecessors only, with their mean motions without place in formation.
  void visit_means(const Visitor& visitor) const;

private:
  struct MeanLink {
    std::size_t delay;
    LossModel loss;
    bool passes_values;

    long double prediction(const Sequence& received) const;
    Sequence pass(const Sequence& sent, Sequence& innovation) const;
    Sequence after_loss(std::size_t count, Sequence& innovation) const;
  };
  struct Follower {
    VehicleResponse vehicle;
    std::vector<MeanLink> links;
  };

  void visit(const Source* source, const Motion* leader, const Visitor& visitor) const;
  Response response(std::size_t follower, const std::vector<Motion>& ahead, const Motion* leader,
                    const Source* source) const;

  const PlatoonModel& model_;
  std::size_t followers_, count_, reach_;
  DifferentFollowers different_;
  std::vector<Follower> vehicles_;  ///< the different followers
};

/// The response of a noise filter to a unit impulse at step 0, from step -1 to step steps - 1.
VehicleResponse::Sequence filtered_impulse(const TransferFunction& filter, std::size_t steps);

/// The response of a signal to a source, given those of its vehicle and its predecessor, from step -1 on: y_{i-1} - y_i
/// (of relative signals only) plus factor D^order y_i, or the input; without offsets.
VehicleResponse::Sequence signal_values(const Signal& signal, const VehicleResponse::Sequence& predecessor,
                                        const Motion& motion);

/// Appends the means of a signal from step 0 on, from the mean motions without place in formation.
void add_means(const Signal& signal, double standstill_distance, const VehicleResponse::Sequence& predecessor,
               const Motion& motion, std::vector<double>& means);

}  // namespace platoon
