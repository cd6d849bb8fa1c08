#pragma once

#include <functional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/rare/rare_event.hpp"
#include "stochastic_platoon/math/rare/rare_losses.hpp"
#include "stochastic_platoon/math/rare/split_paths.hpp"

namespace platoon {

/// Probabilities of small gaps of any platoon that can be simulated, by multilevel splitting with fixed levels.
///
/// A path that falls below a level for the first time at step k is continued from there by several paths, with the
/// draws of new realizations from step k on; its state at step k needs no copy, as draws are pure functions of their
/// names. With n paths per level, of which s_j fall below level j, \f[ P = E \prod_j s_j / n, \f] without bias, as a
/// pilot run places the levels before the repetitions that count, each about a fifth as probable as the one before.
/// Paths of one origin have the same gap at step k. Metropolis moves therefore change all their normal draws, g <- rho
/// g + sqrt(1 - rho^2) g', and their uniform draws (losses, dither) from up to J steps before the crossing on; they are
/// accepted if the path falls below the level again, in the latter case within J steps. One sample is one repetition;
/// the scatter of the repetitions gives the standard error.
///
/// Losses that few realizations have (see RareLosses) may make up the event, and no path would start with them. Its
/// probability is then the sum of two parts with levels of their own: with such losses, where all paths start with them
/// and have weights, and without. There a path falls below a level at a step if no such loss began before, which its
/// draws before that step decide as they do the gap, and counts at the end if it has none at all: continuations draw
/// later losses without a condition. References: P. Del Moral, J. Garnier, Ann. Appl. Probab. 15, 2005; S.-K. Au, J.
/// Beck, Probab. Eng. Mech. 16, 2001.
class Splitting : public RareEstimator {
public:
  static constexpr std::uint64_t kRepetitions = 20;
  static constexpr std::uint64_t kLeastRealizations = 10 * kRepetitions;
  static constexpr std::uint64_t kMostRealizations = kRepetitions << 26;

  /// `realizations`: n per level, of all repetitions. Throws std::invalid_argument unless it is from kLeastRealizations
  /// to kMostRealizations, and if the event always happens to all followers. `threads`: of the pilot run.
  Splitting(const PlatoonModel& model, const RareEvent& event, std::uint64_t realizations, unsigned threads);

  /// The logarithms of the pilot's estimates of the probabilities to fall below each level. With rare losses, the
  /// larger one of the two parts' estimates; a part has that of the nearest of its own levels above.
  std::vector<double> log_scales(std::size_t row) const override { return rows_[row].log_reached; }
  std::uint64_t samples(std::uint64_t) const override { return kRepetitions; }
  BatchWork work() const override;
  std::vector<double> levels(std::size_t row) const override { return rows_[row].levels; }
  std::string problem(std::size_t row) const override { return rows_[row].problem; }

  /// Losses as of RareLosses::unseen(), and what a part of the event may have whose levels die out: by the rule of
  /// three, 3 / n of the last level's probability after n independent samples.
  Unseen unseen(std::size_t row) const override;

  /// A path that reaches the last level in the repetition `sample`, by default in the first one that has any.
  std::shared_ptr<const ChangedDraws> replay(std::size_t row, std::optional<std::uint64_t> sample) const override;

private:
  /// The event without rare losses or with them.
  struct Part {
    bool has_rare_losses;
    bool is_certain;                  ///< all paths of the pilot have the event
    std::vector<double> levels;       ///< [m], descending; the last is the bound of the event
    std::vector<double> log_reached;  ///< per level that the pilot reaches: ln of the share of its paths
    std::string problem;
  };
  struct Row {
    std::vector<Part> parts;
    std::vector<double> levels;       ///< those of the parts
    std::vector<double> log_reached;  ///< per level: ln of the pilot's probability
    std::string problem;
  };
  using Check = std::function<void()>;

  void pilot(unsigned threads);
  Row pilot(std::size_t row, const Check& check) const;
  Part pilot(std::size_t row, bool has_rare_losses, const Check& check) const;
  /// Per level of a row, ln of the probability to fall below it, in one repetition.
  std::vector<double> probabilities(std::size_t row, const Row& of, std::uint64_t repetition, const Check& check) const;
  SplitEvent event(std::size_t row) const { return {model_, event_, row, paths_, losses_[row], has_uniforms_}; }

  PlatoonModel model_;
  RareEvent event_;
  std::size_t paths_;  ///< per level of a repetition
  bool has_uniforms_;  ///< whether links lose or quantise
  std::vector<RareLosses> losses_;
  std::vector<Row> rows_;
};

}  // namespace platoon
