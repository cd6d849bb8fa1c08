#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/rare/path_draws.hpp"
#include "stochastic_platoon/math/rare/rare_event.hpp"
#include "stochastic_platoon/math/rare/rare_losses.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"

namespace platoon {

/// The event of one row of a splitting.
struct SplitEvent {
  const PlatoonModel& model;
  const RareEvent& event;
  std::size_t row;
  std::size_t paths;
  const RareLosses& losses;  ///< of the vehicles whose losses matter
  bool has_uniforms;         ///< whether links lose or quantise

  bool is_of_one_follower() const { return row < event.followers; }
  std::size_t last_follower() const { return is_of_one_follower() ? row + 1 : row; }
};

/// The paths of a Splitting in one repetition, level by level, of an event with rare losses or without.
class SplitPaths {
public:
  using Check = std::function<void()>;

  SplitPaths(const SplitEvent& of, std::uint64_t repetition, bool has_rare_losses);

  /// Simulates all paths: the smallest gap of each, and the first step with a gap below the level. Returns the share of
  /// the paths that have one. Without rare losses, a path has no gap behind the step at which its first one begins.
  double run(double level, const Check& check);

  /// Replaces the paths by as many continuations of those that fall below the level, all equally often on average, and
  /// moves these without a change of their law.
  void branch(double level, const Check& check);

  /// Passes the levels one after the other. Returns for each of `reported`, descending to the last level, ln of the
  /// probability to fall below it: of the product of the shares of the paths at the levels before, times the mean
  /// weight of those that do. -infinity from the first level on that no path falls below.
  std::vector<double> descend(const std::vector<double>& levels, const std::vector<double>& reported,
                              const Check& check);

  /// The draws of a path that fell below the latest level.
  std::shared_ptr<const ChangedDraws> survivor() const { return draws_->only(survivors_.front().first); }

  /// The smallest gap of each path [m].
  const std::vector<double>& smallest() const { return smallest_; }

private:
  static constexpr std::int64_t kNever = RareLosses::kNever;

  void propose(PathDraws proposal, double level, const Check& check, std::vector<std::int64_t>& crossing,
               const std::vector<std::int64_t>& from, std::int64_t reach);
  PathDraws with_rare_losses() const;
  void weigh(std::size_t first, std::size_t count);
  std::uint64_t first() const;
  std::vector<double> uniforms(std::size_t count);

  SplitEvent of_;
  std::uint64_t repetition_;
  bool has_rare_losses_;
  std::uint64_t round_ = 0;
  std::shared_ptr<PathDraws> draws_;
  PlatoonString string_;
  std::vector<Signal> gaps_;
  std::vector<double> smallest_;
  std::vector<std::int64_t> crossing_;
  std::vector<double> weights_;                                  ///< of the paths at a reported level
  std::vector<std::int64_t> begins_;                             ///< steps of their first rare losses
  std::vector<std::pair<std::size_t, std::int64_t>> survivors_;  ///< paths, and their first steps below the level
};

}  // namespace platoon
