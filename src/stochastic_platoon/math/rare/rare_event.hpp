#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/simulation/ensemble_run.hpp"

namespace platoon {

/// The event that a gap is below a bound at one of the steps burn_in .. steps - 1 of a realization.
struct RareEvent {
  std::uint64_t seed;
  std::size_t followers;
  std::int64_t steps;
  double below = 0.0;        ///< [m]
  std::int64_t burn_in = 0;  ///< steps that do not count
};

/// An unbiased estimator of the probabilities of an event, one row per follower and a last one for any of them. A row
/// has the probabilities of nested events, each a part of the one before, the last one the row's own unless it has a
/// problem(): P = exp(log_scale) times the mean of a weight over independent samples.
class RareEstimator {
public:
  virtual ~RareEstimator() = default;

  /// Natural logarithms of the scales of a row's nested events, -infinity if P is 0 exactly; none without an estimate.
  virtual std::vector<double> log_scales(std::size_t row) const = 0;

  /// The logarithms between which the probability of a row certainly is; infinite without theory.
  virtual std::pair<double, double> log_limits(std::size_t /*row*/) const {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }

  /// The number of samples for this number of realizations.
  virtual std::uint64_t samples(std::uint64_t realizations) const { return realizations; }

  /// The computation of the weights: one cell per nested event of every row.
  virtual BatchWork work() const = 0;

  /// The levels of a row's gap [m]; none without a splitting.
  virtual std::vector<double> levels(std::size_t /*row*/) const { return {}; }

  /// Realizations that are too rare for the samples to contain them. They may be events.
  struct Unseen {
    double probability = 0.0;  ///< at most
    std::string what = {};     ///< "losses that ..."
  };
  virtual Unseen unseen(std::size_t /*row*/) const { return {}; }

  /// The reason why a row's event has no estimate; empty if it has one.
  virtual std::string problem(std::size_t /*row*/) const { return ""; }

  /// The draws of the vehicles in a sample in which the event of a row happens; null if it does not in this sample.
  /// Without a sample: in the most likely one, as far as it is known.
  virtual std::shared_ptr<const ChangedDraws> replay(std::size_t row, std::optional<std::uint64_t> sample) const = 0;
};

}  // namespace platoon
