#include "stochastic_platoon/math/channel/information_age.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

namespace {

void require_chain(const LossModel& loss) {
  if (loss.trace || loss.by_distance)
    throw std::invalid_argument("ages of a link: its losses must be independent, in bursts or by a chain");
}

/// Runs of losses of a chain: with its states, the lost modes one step later are x Pi_ll; without, Pi_ll is the number
/// b.
class LossRuns {
public:
  explicit LossRuns(const LossModel& loss) : loss_(loss) {
    require_chain(loss);
    if (!loss.markov) return;
    const LossChain chain(loss);
    const Eigen::Index arrived = chain.arrived(), lost = chain.lost();
    stays_ = chain.transition().bottomRightCorner(lost, lost);
    lost_ = chain.stationary().tail(lost).transpose();
    begins_ = chain.stationary().head(arrived).transpose() * chain.transition().topRightCorner(arrived, lost);
  }

  /// Probability that n >= 1 steps in a row lose.
  double all_lost(std::int64_t n) const {
    if (loss_.markov) return (lost_ * power(n - 1)).sum();
    return loss_.probability * std::pow(loss_.after_loss(), static_cast<double>(n - 1));
  }

  /// P(n).
  double age(std::int64_t n) const {
    const double arrival = 1.0 - loss_.probability;
    if (n == 0) return arrival;
    if (loss_.markov) return (begins_ * power(n - 1)).sum();
    return arrival * loss_.after_arrival() * std::pow(loss_.after_loss(), static_cast<double>(n - 1));
  }

  /// Sum of all_lost(1), all_lost(2), ...
  double mean_age() const {
    if (!loss_.markov) return loss_.probability * loss_.mean_burst.value_or(loss_.independent_burst());
    const Eigen::Index n = stays_.rows();
    return (Eigen::MatrixXd::Identity(n, n) - stays_).transpose().partialPivLu().solve(lost_.transpose()).sum();
  }

private:
  Eigen::MatrixXd power(std::int64_t exponent) const {
    Eigen::MatrixXd result = Eigen::MatrixXd::Identity(stays_.rows(), stays_.cols()), square = stays_;
    for (; exponent > 0; exponent /= 2, square = (square * square).eval()) {
      if (exponent % 2 == 1) result = (result * square).eval();
    }
    return result;
  }

  const LossModel& loss_;
  Eigen::MatrixXd stays_;             ///< Pi_ll
  Eigen::RowVectorXd lost_, begins_;  ///< lost modes at any step, and at the first loss behind an arrival
};

}  // namespace

std::vector<double> age_probabilities(const LossModel& loss) {
  const LossRuns runs(loss);
  constexpr double kRest = 1e-12;
  constexpr std::int64_t kMost = 100000;
  std::vector<double> probabilities{runs.age(0)};
  double rest = loss.probability;  // everything from age n on
  for (std::int64_t n = 1; rest >= kRest && n < kMost; ++n) {
    probabilities.push_back(runs.age(n));
    rest = loss.markov ? runs.all_lost(n + 1) : rest * loss.after_loss();
  }
  return probabilities;
}

double mean_age(const LossModel& loss) {
  return LossRuns(loss).mean_age();
}

double age_exceeded_with(const LossModel& loss, double rest) {
  const LossRuns runs(loss);
  if (loss.probability <= rest) return 0.0;
  if (loss.markov) {
    std::int64_t most = 1;
    while (runs.all_lost(most + 1) > rest) most *= 2;
    for (std::int64_t least = most / 2; most - least > 1;) {
      const std::int64_t middle = least + (most - least) / 2;
      (runs.all_lost(middle + 1) > rest ? least : most) = middle;
    }
    return static_cast<double>(most);
  }
  if (loss.after_loss() == 0.0) return 1.0;
  const double log_b = loss.mean_burst ? std::log1p(-1.0 / *loss.mean_burst) : std::log(loss.probability);
  const double n = std::log(rest / loss.probability) / log_b;
  // An integer that the quotient misses by rounding: q b^n = rest.
  const double nearest = std::round(n);
  return std::abs(n - nearest) <= 1e-12 * nearest ? nearest : std::ceil(n);
}

double expected_age_share(const LossModel& loss, std::int64_t n, std::int64_t steps) {
  const LossRuns runs(loss);
  if (n > steps) return 0.0;
  const double since_start = n == 0 ? 0.0 : runs.all_lost(n);
  return (static_cast<double>(steps - n) * runs.age(n) + since_start) / static_cast<double>(steps);
}

// Sends the number of each step over a link that holds: the received value is the step of the latest arrival.
std::vector<std::uint64_t> count_ages(const LossModel& loss, std::uint64_t seed, std::uint32_t stream,
                                      std::uint64_t realizations, std::int64_t steps, std::uint64_t first) {
  if (loss.by_distance) throw std::invalid_argument("ages of a link: losses by the distance depend on the run");
  LossModel holding = loss;
  holding.predictor = {1.0};
  const std::unique_ptr<LinkStage> link = packet_loss(holding, seed, stream);
  std::vector<std::uint64_t> counts(1);
  for (const std::uint64_t end = first + realizations; first < end; first += kTile) {
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(kTile, end - first));
    std::vector<double> latest(size, -1.0);
    link->start(first, size, latest.data(), 0.0);
    for (std::int64_t k = 0; k < steps; ++k) {
      const auto now = static_cast<double>(k);
      std::fill(latest.begin(), latest.end(), now);
      link->step(k, first, size, latest.data());
      for (const double arrival : latest) {
        const auto age = static_cast<std::size_t>(now - arrival);
        if (age >= counts.size()) counts.resize(age + 1);
        ++counts[age];
      }
    }
  }
  return counts;
}

}  // namespace platoon
