#include "stochastic_platoon/math/rare/splitting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/rare/path_draws.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"

namespace platoon {

namespace {

constexpr double kFraction = 0.2;  // of the paths that reach the next level
constexpr std::size_t kPathsAtOnce = 256, kMostLevels = 120;
constexpr double kMostDraws = 6e7;      // normal draws of all paths: 0.5 GB, twice in each thread
constexpr std::uint64_t kPilot = 4095;  // its repetition

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

/// The paths of one row in one repetition, level by level.
class Splitting::Paths {
public:
  Paths(const Splitting& of, std::size_t row, std::uint64_t repetition)
      : of_(of),
        row_(row),
        repetition_(repetition),
        draws_(std::make_shared<PathDraws>(realization_of(0, repetition, 0), of.paths_)),
        string_(of.model_, WhiteNoise(of.event_.seed, draws_), of.last_follower(row)) {
    for (std::size_t i = 1; i <= of.last_follower(row); ++i)
      gaps_.push_back(signals_of(of.model_, {kGap}, i).requested[0]);
  }

  // Simulates all paths: the smallest gap of each, and the first step with a gap below the level. Returns the share of
  // the paths that have one.
  double run(double level, const Check& check) {
    smallest.assign(of_.paths_, std::numeric_limits<double>::infinity());
    crossing_.assign(of_.paths_, kNever);
    for (std::size_t first = 0; first < of_.paths_; first += kPathsAtOnce) {
      const std::size_t count = std::min(kPathsAtOnce, of_.paths_ - first);
      std::vector<double> values(count);
      string_.run(first, count, of_.event_.steps,
                  [&](std::size_t follower, std::int64_t step, const SignalPositions& at) {
                    check();
                    if (step < of_.event_.burn_in || (row_ < of_.event_.followers && follower != row_ + 1)) return;
                    gaps_[follower - 1](at.ahead, at.own, count, values.data());
                    for (std::size_t s = 0; s < count; ++s) {
                      smallest[first + s] = std::min(smallest[first + s], values[s]);
                      if (values[s] < level) crossing_[first + s] = std::min(crossing_[first + s], step);
                    }
                  });
    }
    survivors_.clear();
    for (std::size_t s = 0; s < of_.paths_; ++s) {
      if (crossing_[s] != kNever) survivors_.emplace_back(s, crossing_[s]);
    }
    return static_cast<double>(survivors_.size()) / static_cast<double>(of_.paths_);
  }

  // Replaces the paths by as many continuations of those that fall below the level, all equally often on average, and
  // moves these without a change of their law.
  void branch(double level, const Check& check) {
    const double offset = uniforms(1).front(), count = static_cast<double>(survivors_.size());
    std::sort(survivors_.begin(), survivors_.end(),
              [](const auto& one, const auto& other) { return one.second < other.second; });
    std::vector<std::pair<std::size_t, std::int64_t>> parents;
    std::vector<std::int64_t> crossing;
    for (std::size_t s = 0; s < of_.paths_; ++s) {
      const double place = (static_cast<double>(s) + offset) / static_cast<double>(of_.paths_);
      parents.push_back(survivors_[std::min(static_cast<std::size_t>(place * count), survivors_.size() - 1)]);
      crossing.push_back(parents.back().second);
    }
    *draws_ = draws_->continued(parents, of_.event_.seed, first());
    for (const double kept : kKept) {
      ++round_;
      propose(draws_->moved(kept, of_.event_.seed, first()), level, check, crossing, {}, 0);
    }
    if (!of_.has_uniforms_) return;
    for (const std::int64_t reach : kReaches) {
      const std::vector<double> chosen = uniforms(of_.paths_);
      std::vector<std::int64_t> from;
      for (std::size_t s = 0; s < of_.paths_; ++s)
        from.push_back(crossing[s] - static_cast<std::int64_t>(chosen[s] * static_cast<double>(reach + 1)));
      propose(draws_->redrawn(from, first()), level, check, crossing, from, reach);
    }
  }

  // Passes the levels one after the other. Returns per level ln of the product of the shares of the paths that fall
  // below it and those before, -infinity from the first level on that none falls below.
  std::vector<double> descend(const std::vector<double>& levels, const Check& check) {
    std::vector<double> products(levels.size(), -std::numeric_limits<double>::infinity());
    double log_product = 0.0;
    for (std::size_t level = 0; level < levels.size(); ++level) {
      log_product += std::log(run(levels[level], check));
      if (survivors_.empty()) break;
      products[level] = log_product;
      if (level + 1 < levels.size()) branch(levels[level], check);
    }
    return products;
  }

  /// The draws of a path that fell below the latest level.
  std::shared_ptr<const ChangedDraws> survivor() const { return draws_->only(survivors_.front().first); }

  std::vector<double> smallest;  ///< [m]

private:
  // Accepts the proposals that fall below the level; with `from`, those that do so at most `reach` steps behind.
  void propose(PathDraws proposal, double level, const Check& check, std::vector<std::int64_t>& crossing,
               const std::vector<std::int64_t>& from, std::int64_t reach) {
    std::swap(*draws_, proposal);
    run(level, check);
    std::swap(*draws_, proposal);
    for (std::size_t s = 0; s < of_.paths_; ++s) {
      const bool is_near = from.empty() || (from[s] >= -1 && crossing_[s] - from[s] <= reach);
      if (crossing_[s] == kNever || !is_near) continue;
      draws_->take(s, proposal);
      crossing[s] = crossing_[s];
    }
  }

  // The first new realization of this round.
  std::uint64_t first() const { return realization_of(round_, repetition_, 0); }

  // Begins a round: the uniform values of its choices.
  std::vector<double> uniforms(std::size_t count) {
    std::vector<double> values(count);
    WhiteNoise(of_.event_.seed)
        .fill_uniform({static_cast<std::uint32_t>(row_ + 1), static_cast<std::int64_t>(++round_), Purpose::choice},
                      realization_of(0, repetition_, 0), count, values.data());
    return values;
  }

  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  const Splitting& of_;
  std::size_t row_;
  std::uint64_t repetition_;
  std::uint64_t round_ = 0;
  std::shared_ptr<PathDraws> draws_;
  PlatoonString string_;
  std::vector<Signal> gaps_;
  std::vector<std::int64_t> crossing_;
  std::vector<std::pair<std::size_t, std::int64_t>> survivors_;  ///< paths, and their first steps below the level
};

Splitting::Splitting(const PlatoonModel& model, const RareEvent& event, std::uint64_t realizations)
    : model_(model),
      event_(event),
      paths_(static_cast<std::size_t>(realizations / kRepetitions)),
      has_uniforms_(any_link(model, [](const LinkModel& link) { return !link.is_normal(); })) {
  if (realizations < kLeastRealizations || realizations > kMostRealizations)
    throw std::invalid_argument(formatted(
        "realizations: %llu: must be from %llu to %llu for a splitting", static_cast<unsigned long long>(realizations),
        static_cast<unsigned long long>(kLeastRealizations), static_cast<unsigned long long>(kMostRealizations)));
  std::size_t inputs = 1;
  for (const VehicleModel& of : pattern(model)) inputs = std::max(inputs, of.inputs.size());
  const double draws = static_cast<double>(event.followers * inputs) * static_cast<double>(event.steps);  // of one path
  if (static_cast<double>(paths_) * draws > kMostDraws)
    throw std::invalid_argument(
        formatted("realizations: %llu: must be at most %.0f for %zu followers over %lld steps by splitting",
                  static_cast<unsigned long long>(realizations), kMostDraws * static_cast<double>(kRepetitions) / draws,
                  event.followers, static_cast<long long>(event.steps)));
  for (std::size_t row = 0; row <= event.followers; ++row)
    rows_.push_back(row == event.followers && row == 1 ? rows_.front() : pilot(row));
}

Splitting::Row Splitting::pilot(std::size_t row) const {
  Paths paths(*this, row, kPilot);
  const Check check = [] { check_interruption(); };
  Row result;
  double before = std::numeric_limits<double>::infinity();
  while (result.levels.size() < kMostLevels) {
    paths.run(-std::numeric_limits<double>::infinity(), check);
    std::vector<double> sorted = paths.smallest;
    std::sort(sorted.begin(), sorted.end());
    if (row < event_.followers && sorted.back() < event_.below && result.levels.empty())
      throw std::invalid_argument(
          formatted("below: %g m: the gap of vehicle_%zu is smaller in each of %zu realizations: must be smaller",
                    event_.below, row + 1, paths_));
    const double level =
        std::max(sorted[static_cast<std::size_t>(kFraction * static_cast<double>(sorted.size()))], event_.below);
    const double share = level < before ? paths.run(level, check) : 0.0;
    if (share == 0.0) {
      result.problem = formatted(
          "below: %g m: levels die out: no path of %s falls below %g m: must be larger, or realizations more than %zu; the event may be impossible",
          event_.below, row < event_.followers ? ("vehicle_" + std::to_string(row + 1)).c_str() : "any vehicle",
          sorted.front(), paths_ * kRepetitions);
      return result;
    }
    result.log_reached.push_back((result.levels.empty() ? 0.0 : result.log_reached.back()) + std::log(share));
    result.levels.push_back(level);
    if (level == event_.below) return result;
    before = level;
    paths.branch(level, check);
  }
  result.problem = formatted("below: %g m: more than %zu levels, of which the last is at %g m: must be larger",
                             event_.below, kMostLevels, result.levels.back());
  return result;
}

RareEstimator::Unseen Splitting::unseen(std::size_t row) const {
  Unseen found;
  for (std::size_t i = 1; i <= last_follower(row); ++i) {
    const std::vector<Input>& inputs = vehicle(model_, i).inputs;
    for (std::size_t n = 0; n < inputs.size(); ++n) {
      if (!inputs[n].link.loses() || first_of_packet(inputs, n) != n) continue;
      const LossChain chain(*inputs[n].link.loss);
      const Eigen::VectorXd& share = chain.stationary();
      for (Eigen::Index mode = 0; mode < chain.modes(); ++mode) {
        const double stays = share(mode) * chain.transition()(mode, mode);
        const double entries = share.dot(chain.transition().col(mode)) - stays;
        const double visits = share(mode) + static_cast<double>(event_.steps) * entries;
        if (!(visits * static_cast<double>(paths_) < 1.0)) continue;
        found.probability = std::min(1.0, found.probability + visits);
        found.realizations = std::max(found.realizations, static_cast<double>(kRepetitions) / visits);
      }
    }
  }
  return found;
}

BatchWork Splitting::work() const {
  std::size_t cells = 0;
  for (const Row& row : rows_) cells += row.levels.size();
  const auto computation = [this, cells](const RealizationRange& batch, const Check& check, EnsembleTotals& totals) {
    BatchMoments moments(batch.first, batch.size(), cells);
    std::size_t first = 0;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      const Row& of = rows_[row];
      const std::size_t same = event_.followers == 1 ? 0 : row;  // the only follower is any follower
      std::vector<std::vector<double>> weights(of.levels.size());
      for (std::uint64_t repetition = batch.first; repetition < batch.end; ++repetition) {
        const std::vector<double> products = Paths(*this, same, repetition).descend(of.levels, check);
        for (std::size_t level = 0; level < products.size(); ++level)
          weights[level].push_back(std::exp(products[level] - of.log_reached[level]));
      }
      for (const std::vector<double>& of_level : weights) moments.set(first++, of_level.data());
    }
    totals.moments.add(std::move(moments));
  };
  return {EnsembleTotals(MomentTable(cells)), 1, [computation] { return computation; }};
}

std::shared_ptr<const ChangedDraws> Splitting::replay(std::size_t row, std::optional<std::uint64_t> sample) const {
  if (event_.followers == 1) row = 0;
  if (!rows_[row].problem.empty()) return nullptr;
  const Check check = [] { check_interruption(); };
  for (std::uint64_t repetition = sample.value_or(0); repetition < kRepetitions; ++repetition) {
    Paths paths(*this, row, repetition);
    if (std::isfinite(paths.descend(rows_[row].levels, check).back())) return paths.survivor();
    if (sample) break;
  }
  return nullptr;
}

}  // namespace platoon
