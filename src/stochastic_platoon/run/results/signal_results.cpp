#include "stochastic_platoon/run/results/signal_results.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/results/amplification_results.hpp"

namespace platoon {

namespace {

// The follower with the smallest gap, the first of equal ones; no follower without gaps.
std::size_t nearest_follower(const GapTable& gaps) {
  const std::vector<FollowerGaps>& all = gaps.followers();
  const auto nearest = std::min_element(all.begin(), all.end(), [](const FollowerGaps& a, const FollowerGaps& b) {
    return a.smallest.gap < b.smallest.gap;
  });
  return static_cast<std::size_t>(nearest - all.begin()) + 1;
}

}  // namespace

bool has_signal_theory(const Prediction& prediction, std::size_t follower) {
  return !prediction.signals.empty() && follower <= prediction.followers_with_theory;
}

std::string signals_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  std::string text = "signal,vehicle,step,count,mean,variance,theoretical_mean,theoretical_variance\n";
  for (std::size_t s = 0; s < run.signals.size(); ++s) {
    for (std::size_t i = 1; i <= run.followers; ++i) {
      for (std::int64_t k = 0; k < run.steps; ++k) {
        const std::size_t c = cell(i, k, run.steps);
        const Moments& of = result.signals[s][c];
        text +=
            formatted("%s,%zu,%lld,%llu,%.17g,%.17g,", run.signals[s].c_str(), i, static_cast<long long>(k),
                      static_cast<unsigned long long>(of.count), of.count > 0 ? of.mean : std::nan(""), of.variance());
        text += has_signal_theory(prediction, i)
                    ? formatted("%.17g,%.17g\n", prediction.signals[s].mean[c], prediction.signals[s].variance[c])
                    : ",\n";
      }
    }
  }
  return text;
}

std::string gaps_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const GapCounting& counting = result.gaps.counting();
  const std::vector<FollowerGaps>& all = result.gaps.followers();
  std::set<std::int64_t> bins;
  for (const FollowerGaps& of : all) {
    for (const auto& [bin, count] : of.histogram) bins.insert(bin);
  }
  std::string text =
      "vehicle,count,smallest_gap,realization,step,collisions,below_safe_gap,theoretical_collision_bound";
  for (const std::int64_t bin : bins) text += formatted(",bin_%.10g", static_cast<double>(bin) * counting.bin_width);
  text += "\n";
  for (std::size_t i = 1; i <= configuration.run.followers; ++i) {
    const FollowerGaps& of = all[i - 1];
    text += formatted("%zu,%llu,%.17g,%llu,%lld,%llu,", i, static_cast<unsigned long long>(result.realizations),
                      of.smallest.gap, static_cast<unsigned long long>(of.smallest.realization),
                      static_cast<long long>(of.smallest.step), static_cast<unsigned long long>(of.collisions));
    if (counting.safe_gap) text += std::to_string(of.unsafe);
    text += has_signal_theory(prediction, i) ? formatted(",%.17g", prediction.collision_bound[i - 1]) : ",";
    for (const std::int64_t bin : bins) {
      const auto found = of.histogram.find(bin);
      text += "," + std::to_string(found == of.histogram.end() ? 0 : found->second);
    }
    text += "\n";
  }
  return text;
}

nlohmann::json smallest_gap_json(const RunResult& result) {
  if (result.gaps.empty() || result.realizations == 0) return {};
  const std::size_t vehicle = nearest_follower(result.gaps);
  const FollowerGaps& of = result.gaps.followers()[vehicle - 1];
  return {{"gap", of.smallest.gap},
          {"vehicle", vehicle},
          {"realization", of.smallest.realization},
          {"step", of.smallest.step}};
}

namespace {

std::string gap_lines(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const std::size_t vehicle = nearest_follower(result.gaps);
  const FollowerGaps& of = result.gaps.followers()[vehicle - 1];
  std::string text =
      formatted("Smallest gap: %.6g m, follower %zu, realization %llu, step %lld (%s)\n", of.smallest.gap, vehicle,
                static_cast<unsigned long long>(of.smallest.realization), static_cast<long long>(of.smallest.step),
                duration(of.smallest.step, configuration.model).c_str());
  const std::vector<FollowerGaps>& all = result.gaps.followers();
  const auto worst = std::max_element(
      all.begin(), all.end(), [](const FollowerGaps& a, const FollowerGaps& b) { return a.collisions < b.collisions; });
  const auto follower = static_cast<std::size_t>(worst - all.begin()) + 1;
  text += formatted("Collisions (a gap below 0): in %llu of %llu realizations of follower %zu, the most",
                    static_cast<unsigned long long>(worst->collisions),
                    static_cast<unsigned long long>(result.realizations), follower);
  if (has_signal_theory(prediction, follower))
    text += formatted("; by theory at most %.6g of them", prediction.collision_bound[follower - 1]);
  text += "\n";
  if (configuration.run.external.empty() && result.complete && !configuration.run.output.empty()) {
    text += formatted(
        "To replay it: rosrun stochastic_platoon monte_carlo --repeat %s/summary.json --only %llu --trajectories --output %s/realization_%llu\n",
        configuration.run.output.c_str(), static_cast<unsigned long long>(of.smallest.realization),
        configuration.run.output.c_str(), static_cast<unsigned long long>(of.smallest.realization));
  }
  return text;
}

}  // namespace

std::string signals_report(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  std::string text;
  for (std::size_t s = 0; s < result.signals.size(); ++s) {
    const std::size_t last = cell(run.followers, run.steps - 1, run.steps);
    const Moments& of = result.signals[s][last];
    const char* const unit = unit_of(run.signals[s]);
    text +=
        formatted("%s of follower %zu at step %lld: mean %.6g %s, standard deviation %.6g %s", run.signals[s].c_str(),
                  run.followers, static_cast<long long>(run.steps - 1), of.mean, unit, std::sqrt(of.variance()), unit);
    text += has_signal_theory(prediction, run.followers)
                ? formatted(" (theory %.6g, %.6g)\n", prediction.signals[s].mean[last],
                            std::sqrt(prediction.signals[s].variance[last]))
            : prediction.signals.empty() ? " (measured only)\n"
                                         : "\n";
  }
  if (!result.signals.empty() && run.has_amplification())
    text += amplification_report(configuration, prediction, result);
  if (!result.gaps.empty() && result.realizations > 0) text += gap_lines(configuration, prediction, result);
  return text;
}

}  // namespace platoon
