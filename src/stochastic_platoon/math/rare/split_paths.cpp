#include "stochastic_platoon/math/rare/split_paths.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

constexpr std::size_t kPathsAtOnce = 256;
constexpr std::uint64_t kWithRareLosses = 2048;  // this bit of a repetition
constexpr std::int64_t kRounds = 1024;           // more than all levels have

// The moves of the paths below a level: the share of the normal draws that is kept, or the number of steps before the
// crossing from which on the uniform draws are replaced.
constexpr double kKept[] = {0.9, 0.6, 0.8};
constexpr std::int64_t kReaches[] = {8, 32};

// A realization for every path in a round (a branching or a move) of a repetition, below 2^48; round 0 of repetition 0
// begins with 0, 1, ....
std::uint64_t realization_of(std::uint64_t round, std::uint64_t repetition, std::size_t path) {
  return round << 38 | repetition << 26 | path;
}

}  // namespace

SplitPaths::SplitPaths(const SplitEvent& of, std::uint64_t repetition, bool has_rare_losses)
    : of_(of),
      repetition_(has_rare_losses ? repetition ^ kWithRareLosses : repetition),
      has_rare_losses_(has_rare_losses),
      draws_(std::make_shared<PathDraws>(has_rare_losses ? with_rare_losses() : PathDraws(first(), of.paths))),
      string_(of.model, WhiteNoise(of.event.seed, draws_), of.last_follower()),
      weights_(of.paths, 1.0),
      begins_(of.paths, kNever) {
  for (std::size_t i = 1; i <= of.last_follower(); ++i) gaps_.push_back(signals_of(of.model, {kGap}, i).requested[0]);
}

double SplitPaths::run(double level, const Check& check) {
  smallest_.assign(of_.paths, kInfinity);
  crossing_.assign(of_.paths, kNever);
  for (std::size_t first = 0; first < of_.paths; first += kPathsAtOnce) {
    const std::size_t count = std::min(kPathsAtOnce, of_.paths - first);
    std::vector<double> values(count);
    if (!has_rare_losses_ && !of_.losses.empty()) weigh(first, count);
    string_.run(first, count, of_.event.steps, [&](std::size_t follower, std::int64_t step, const SignalPositions& at) {
      check();
      if (step < of_.event.burn_in || (of_.is_of_one_follower() && follower != of_.row + 1)) return;
      gaps_[follower - 1](at.ahead, at.own, count, values.data());
      for (std::size_t s = 0; s < count; ++s) {
        if (!has_rare_losses_ && step > begins_[first + s]) continue;
        smallest_[first + s] = std::min(smallest_[first + s], values[s]);
        if (values[s] < level) crossing_[first + s] = std::min(crossing_[first + s], step);
      }
    });
  }
  survivors_.clear();
  for (std::size_t s = 0; s < of_.paths; ++s) {
    if (crossing_[s] != kNever) survivors_.emplace_back(s, crossing_[s]);
  }
  return static_cast<double>(survivors_.size()) / static_cast<double>(of_.paths);
}

void SplitPaths::branch(double level, const Check& check) {
  const double offset = uniforms(1).front(), count = static_cast<double>(survivors_.size());
  std::sort(survivors_.begin(), survivors_.end(),
            [](const auto& one, const auto& other) { return one.second < other.second; });
  std::vector<std::pair<std::size_t, std::int64_t>> parents;
  std::vector<std::int64_t> crossing;
  for (std::size_t s = 0; s < of_.paths; ++s) {
    const double place = (static_cast<double>(s) + offset) / static_cast<double>(of_.paths);
    parents.push_back(survivors_[std::min(static_cast<std::size_t>(place * count), survivors_.size() - 1)]);
    crossing.push_back(parents.back().second);
  }
  *draws_ = draws_->continued(parents, of_.event.seed, first());
  for (const double kept : kKept) {
    ++round_;
    propose(draws_->moved(kept, of_.event.seed, first()), level, check, crossing, {}, 0);
  }
  if (!of_.has_uniforms) return;
  for (const std::int64_t reach : kReaches) {
    const std::vector<double> chosen = uniforms(of_.paths);
    std::vector<std::int64_t> from;
    for (std::size_t s = 0; s < of_.paths; ++s)
      from.push_back(crossing[s] - static_cast<std::int64_t>(chosen[s] * static_cast<double>(reach + 1)));
    propose(draws_->redrawn(from, first()), level, check, crossing, from, reach);
  }
}

std::vector<double> SplitPaths::descend(const std::vector<double>& levels, const std::vector<double>& reported,
                                        const Check& check) {
  std::vector<double> result(reported.size(), -kInfinity);
  double log_product = 0.0;
  for (std::size_t level = 0, next = 0; level < levels.size(); ++level) {
    const double share = run(levels[level], check);
    if (has_rare_losses_) weigh(0, of_.paths);
    for (; next < reported.size() && reported[next] >= levels[level]; ++next) {
      double sum = 0.0;
      for (std::size_t s = 0; s < of_.paths; ++s) sum += smallest_[s] < reported[next] ? weights_[s] : 0.0;
      result[next] = log_product + std::log(sum / static_cast<double>(of_.paths));
    }
    if (survivors_.empty()) break;
    log_product += std::log(share);
    if (level + 1 < levels.size()) branch(levels[level], check);
  }
  return result;
}

// Accepts the proposals that fall below the level; with `from`, those that do so at most `reach` steps behind.
void SplitPaths::propose(PathDraws proposal, double level, const Check& check, std::vector<std::int64_t>& crossing,
                         const std::vector<std::int64_t>& from, std::int64_t reach) {
  std::swap(*draws_, proposal);
  run(level, check);
  std::swap(*draws_, proposal);
  for (std::size_t s = 0; s < of_.paths; ++s) {
    const bool is_near = from.empty() || (from[s] >= -1 && crossing_[s] - from[s] <= reach);
    if (crossing_[s] == kNever || !is_near) continue;
    draws_->take(s, proposal);
    crossing[s] = crossing_[s];
  }
}

// Paths that start with rare losses.
PathDraws SplitPaths::with_rare_losses() const {
  std::vector<std::shared_ptr<const GivenModes>> modes;
  for (std::size_t s = 0; s < of_.paths; ++s) {
    std::int64_t number = kRounds;
    modes.push_back(of_.losses.draw([&] {
      double value = 0.0;
      WhiteNoise(of_.event.seed)
          .fill_uniform({static_cast<std::uint32_t>(of_.row + 1), number++, Purpose::choice}, first() + s, 1, &value);
      return value;
    }));
  }
  return PathDraws(first(), std::move(modes));
}

// Those of RareLosses; without rare losses 1, and 0 for a path that has some.
void SplitPaths::weigh(std::size_t first, std::size_t count) {
  of_.losses.weights(WhiteNoise(of_.event.seed, draws_), first, count, &weights_[first], &begins_[first]);
  for (std::size_t s = first; s < first + count && !has_rare_losses_; ++s)
    weights_[s] = begins_[s] == kNever ? 1.0 : 0.0;
}

// The first new realization of this round.
std::uint64_t SplitPaths::first() const {
  return realization_of(round_, repetition_, 0);
}

// Begins a round: the uniform values of its choices.
std::vector<double> SplitPaths::uniforms(std::size_t count) {
  std::vector<double> values(count);
  WhiteNoise(of_.event.seed)
      .fill_uniform({static_cast<std::uint32_t>(of_.row + 1), static_cast<std::int64_t>(++round_), Purpose::choice},
                    realization_of(0, repetition_, 0), count, values.data());
  return values;
}

}  // namespace platoon
