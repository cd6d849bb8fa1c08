#include "stochastic_platoon/math/rare/splitting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/rare/split_paths.hpp"

namespace platoon {

namespace {

constexpr double kFraction = 0.2;  // of the paths that reach the next level
constexpr std::size_t kMostLevels = 120;
constexpr double kMostDraws = 6e7;      // normal draws of all paths: 0.5 GB, twice in each thread
constexpr std::uint64_t kPilot = 4095;  // its repetition

}  // namespace

Splitting::Splitting(const PlatoonModel& model, const RareEvent& event, std::uint64_t realizations, unsigned threads)
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
    losses_.emplace_back(model_, row < event.followers ? row + 1 : row, event.steps);
  pilot(threads);
  if (std::all_of(rows_.begin(), rows_.end(), [](const Row& of) { return of.parts.front().is_certain; }))
    throw std::invalid_argument(
        formatted("below: %g m: the gap of vehicle_1 is smaller in each of %zu realizations: must be smaller",
                  event.below, paths_));
}

void Splitting::pilot(unsigned threads) {
  rows_.resize(event_.followers + 1);
  const auto computation = [this](const RealizationRange& rows, const Check& check, EnsembleTotals&) {
    rows_[rows.first] = pilot(rows.first, check);
  };
  const BatchWork work{EnsembleTotals(MomentTable(0)), 1, [computation] { return computation; }};
  const bool is_one = event_.followers == 1;  // the only follower is any follower
  EnsembleRun run(work, {0, is_one ? 1 : rows_.size()}, work.none);
  complete(run, threads, [] { check_interruption(); });
  if (is_one) rows_.back() = rows_.front();
}

Splitting::Row Splitting::pilot(std::size_t row, const Check& check) const {
  Part part = pilot(row, false, check);
  if (losses_[row].empty()) return {{part}, part.levels, part.log_reached, part.problem};
  Row result{{std::move(part), pilot(row, true, check)}, {}, {}, {}};
  const bool has_estimate =
      std::any_of(result.parts.begin(), result.parts.end(), [](const Part& of) { return of.problem.empty(); });
  if (!has_estimate) result.problem = result.parts.front().problem;
  for (Part& of : result.parts) {
    if (has_estimate && !of.problem.empty()) of.levels.push_back(event_.below);
    result.levels.insert(result.levels.end(), of.levels.begin(), of.levels.end());
  }
  std::sort(result.levels.begin(), result.levels.end(), std::greater<>());
  result.levels.erase(std::unique(result.levels.begin(), result.levels.end()), result.levels.end());
  // A scale of the weights, which nothing but their range depends on.
  for (const double level : result.levels) {
    double scale = -kInfinity;
    for (const Part& of : result.parts) {
      const double mean = of.has_rare_losses ? std::min(0.0, std::log(losses_[row].expected())) : 0.0;
      std::size_t passed = 0;
      while (passed < of.log_reached.size() && of.levels[passed] >= level) ++passed;
      scale = std::max(scale, mean + (passed > 0 ? of.log_reached[passed - 1] : 0.0));
    }
    result.log_reached.push_back(scale);
  }
  return result;
}

Splitting::Part Splitting::pilot(std::size_t row, bool has_rare_losses, const Check& check) const {
  SplitPaths paths(event(row), kPilot, has_rare_losses);
  Part result{has_rare_losses, false, {}, {}, {}};
  double before = kInfinity;
  while (result.levels.size() < kMostLevels) {
    paths.run(-kInfinity, check);
    std::vector<double> sorted = paths.smallest();
    std::sort(sorted.begin(), sorted.end());
    const double largest = *(std::lower_bound(sorted.begin() + 1, sorted.end(), kInfinity) - 1);
    if (largest < event_.below && result.levels.empty()) result.is_certain = true;
    const double level =
        std::max(std::min(sorted[static_cast<std::size_t>(kFraction * static_cast<double>(sorted.size()))], largest),
                 event_.below);
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

std::vector<double> Splitting::probabilities(std::size_t row, const Row& of, std::uint64_t repetition,
                                             const Check& check) const {
  std::vector<double> result(of.levels.size(), -kInfinity);
  for (const Part& part : of.parts) {
    const std::vector<double> own =
        SplitPaths(event(row), repetition, part.has_rare_losses).descend(part.levels, of.levels, check);
    for (std::size_t level = 0; level < own.size(); ++level) {
      const double larger = std::max(result[level], own[level]), smaller = std::min(result[level], own[level]);
      result[level] = smaller > -kInfinity ? larger + std::log1p(std::exp(smaller - larger)) : larger;
    }
  }
  return result;
}

RareEstimator::Unseen Splitting::unseen(std::size_t row) const {
  Unseen found;
  double largest = 0.0;
  const auto add = [&](double probability, const std::string& what) {
    found.probability = std::min(1.0, found.probability + probability);
    if (probability > largest) found.what = what;
    largest = std::max(largest, probability);
  };
  const RareLosses::Unseen losses = losses_[row].unseen(paths_, kRepetitions);
  add(losses.probability,
      formatted("rare losses, or two of them in one realization: realizations must be more than %.2g",
                static_cast<double>(kRepetitions) * losses.realizations));
  for (const Part& part : rows_[row].parts) {
    if (part.problem.empty() || !rows_[row].problem.empty()) continue;
    const bool is_first = part.log_reached.empty();  // whose paths are independent
    const double samples = kRepetitions * (is_first ? static_cast<double>(paths_) : 1.0);
    const double reached = is_first ? 0.0 : part.log_reached.back();
    const double most = part.has_rare_losses ? std::min(1.0, losses_[row].expected()) : 1.0;
    add(most * std::exp(reached) * 3.0 / samples,
        formatted("%s rare losses: levels die out", part.has_rare_losses ? "with" : "without"));
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
        const std::vector<double> found = probabilities(same, of, repetition, check);
        for (std::size_t level = 0; level < found.size(); ++level)
          weights[level].push_back(std::exp(found[level] - of.log_reached[level]));
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
    double most = -kInfinity;
    std::shared_ptr<const ChangedDraws> found;
    for (const Part& part : rows_[row].parts) {
      SplitPaths paths(event(row), repetition, part.has_rare_losses);
      const double reached = paths.descend(part.levels, {event_.below}, check).front();
      if (reached > most) found = paths.survivor();
      most = std::max(most, reached);
    }
    if (found != nullptr || sample) return found;
  }
  return nullptr;
}

}  // namespace platoon
