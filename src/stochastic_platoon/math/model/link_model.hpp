#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/loss_by_distance.hpp"
#include "stochastic_platoon/math/model/loss_trace.hpp"
#include "stochastic_platoon/math/model/markov_losses.hpp"
#include "stochastic_platoon/math/model/transfer_function.hpp"

namespace platoon {

/// Loss of positions, and the prediction that replaces a lost one: r(k) = c_1 r(k-1) + c_2 r(k-2) + ... of the
/// positions used before.
struct LossModel {
  double probability = 0.0;               ///< q, in [0, 1)
  std::optional<double> mean_burst = {};  ///< b >= max(1, q / (1 - q)) [steps]; none: independent losses
  std::vector<double> predictor = {1.0};  ///< c_1, c_2, ..., of sum 1: holding is [1]; empty: 0 (radios only)
  /// Recorded losses; probability and mean burst then only describe them. Entry (o + k) modulo the size applies at step
  /// k, with a separate offset o for every link and realization. None: a random chain.
  std::shared_ptr<const LossTrace> trace = {};
  /// Loss probability as a function of the gap one step earlier; `probability` is then its largest value. None: the gap
  /// has no effect.
  std::optional<LossByDistance> by_distance = {};
  /// Losses by the states of a chain; probability and mean burst then only describe them.
  std::shared_ptr<const MarkovLosses> markov = {};

  /// The b of independent losses: 1 / (1 - q).
  double independent_burst() const { return 1.0 / (1.0 - probability); }

  /// The smallest mean burst of any chain with this probability: max(1, q / (1 - q)).
  double least_burst() const { return std::max(1.0, probability / (1.0 - probability)); }

  /// Whether the losses are independent of each other and of the positions: random without a mean burst, or with that
  /// of independent losses.
  bool is_independent() const;

  /// Probability of a loss after a loss, 1 - 1 / b, and after an arrival, q / (b (1 - q)); both are q for independent
  /// losses. The chain is stationary: a position is lost with probability q at every step. Losses by the states of a
  /// chain have more memory than these two (see LossChain).
  double after_loss() const { return mean_burst ? 1.0 - 1.0 / *mean_burst : probability; }
  double after_arrival() const { return mean_burst ? probability / (*mean_burst * (1.0 - probability)) : probability; }

  /// Whether losses and arrivals alternate, to 1e-9 of the transition probabilities (q = 1/2 and mean burst 1): the
  /// moments then do not settle.
  bool alternates() const { return !markov && !(after_loss() - after_arrival() > -1.0 + 1e-9); }
};

/// Spectral radius of the second moments of the position r(k) that a follower uses, under losses alone. The variance of
/// r(k) settles if it is below 1. For independent losses this holds exactly if
/// \f[ F = 1 / (1 - q L) \mbox{ is stable and } p q \|L F\|_2^2 < 1, \f]
/// with L = c_1 z^-1 + c_2 z^-2 + ..., p = 1 - q.
///
/// For any chain it is the spectral radius of its LossChain::second_moments() (O. Costa, M. Fragoso, R. Marques,
/// Discrete-Time Markov Jump Linear Systems, 2005, theorem 3.9).
double second_moment_radius(const LossModel& loss);

/// p q ||L F||_2^2 of independent losses (see above); infinite if F is unstable.
double loss_feedback(const LossModel& loss);

/// Factor by which predictions r(k) = c_1 r(k-1) + c_2 r(k-2) + ... grow over one period of a trace: the spectral
/// radius of the product of the registers' matrices, one per entry. r(k) is bounded if it is below 1.
double growth(const LossTrace& trace, const std::vector<double>& predictor);

/// The link into one follower, without its noise variance:
///
///     quantise -> + noise d = W g -> delay of m steps -> loss.
struct LinkModel {
  TransferFunction noise_filter{Polynomial::Ones(1), Polynomial::Ones(1)};  ///< W(z), stable and proper
  double quantisation_step = 0.0;                                           ///< D >= 0 [m]
  std::int64_t delay = 0;                                                   ///< m >= 0, in steps
  std::optional<LossModel> loss = {};

  bool loses() const { return loss && loss->probability > 0.0; }

  /// Why the link has no theory: its losses depend on the gap, are recorded, or strictly alternate with arrivals (q =
  /// 1/2 and mean burst 1). None if it has one.
  std::optional<std::string> no_theory() const;

  /// Whether what a vehicle receives is linear in the positions and in normal noise.
  bool is_normal() const { return !loses() && quantisation_step == 0.0; }

  /// Whether W = 1.
  bool has_white_noise() const;

  /// Whether the link is the paper's: white noise and nothing else. A loss of probability 0 changes nothing.
  bool is_white_noise_only() const;
};

bool operator==(const LossModel& one, const LossModel& other);

/// Whether two links behave identically.
bool operator==(const LinkModel& one, const LinkModel& other);

}  // namespace platoon
