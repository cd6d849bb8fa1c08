#include "stochastic_platoon/math/channel/information_age.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/channel/packet_loss.hpp"

namespace platoon {

namespace {

void require_chain(const LossModel& loss) {
  if (loss.trace || loss.by_distance)
    throw std::invalid_argument("ages of a link: its losses must be independent or in bursts or by a chain");
}

/// Runs of losses of a chain by its states: the lost modes one step later are x Pi_ll.
class LossRuns {
public:
  explicit LossRuns(const LossModel& loss) {
    const LossChain chain(loss);
    const Eigen::Index arrived = chain.arrived(), lost = chain.lost();
    stays_ = chain.transition().bottomRightCorner(lost, lost);
    lost_ = chain.stationary().tail(lost).transpose();
    begins_ = chain.stationary().head(arrived).transpose() * chain.transition().topRightCorner(arrived, lost);
  }

  double all_lost(std::int64_t n) const { return (lost_ * power(n - 1)).sum(); }  ///< n >= 1 steps in a row
  double age(std::int64_t n) const { return (begins_ * power(n - 1)).sum(); }     ///< P(n), n >= 1

  /// Sum of all_lost(1), all_lost(2), ...
  double mean_age() const {
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

  Eigen::MatrixXd stays_;             ///< Pi_ll
  Eigen::RowVectorXd lost_, begins_;  ///< lost modes at any step, and at the first loss behind an arrival
};

/// P(n).
double stationary(const LossModel& loss, std::int64_t n) {
  const double arrival = 1.0 - loss.probability;
  if (n == 0) return arrival;
  if (loss.markov) return LossRuns(loss).age(n);
  return arrival * loss.after_arrival() * std::pow(loss.after_loss(), static_cast<double>(n - 1));
}

/// Probability that n >= 1 steps in a row lose.
double all_lost(const LossModel& loss, std::int64_t n) {
  if (loss.markov) return LossRuns(loss).all_lost(n);
  return loss.probability * std::pow(loss.after_loss(), static_cast<double>(n - 1));
}

}  // namespace

std::vector<double> age_probabilities(const LossModel& loss) {
  require_chain(loss);
  constexpr double kRest = 1e-12;
  constexpr std::int64_t kMost = 100000;
  std::vector<double> probabilities{stationary(loss, 0)};
  double rest = loss.probability;  // everything from age n on
  for (std::int64_t n = 1; rest >= kRest && n < kMost; ++n) {
    probabilities.push_back(stationary(loss, n));
    rest = loss.markov ? all_lost(loss, n + 1) : rest * loss.after_loss();
  }
  return probabilities;
}

double mean_age(const LossModel& loss) {
  require_chain(loss);
  if (loss.markov) return LossRuns(loss).mean_age();
  return loss.probability * loss.mean_burst.value_or(loss.independent_burst());
}

double age_exceeded_with(const LossModel& loss, double rest) {
  require_chain(loss);
  if (loss.probability <= rest) return 0.0;
  if (loss.markov) {
    std::int64_t most = 1;
    while (all_lost(loss, most + 1) > rest) most *= 2;
    for (std::int64_t least = most / 2; most - least > 1;) {
      const std::int64_t middle = least + (most - least) / 2;
      (all_lost(loss, middle + 1) > rest ? least : most) = middle;
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
  require_chain(loss);
  if (n > steps) return 0.0;
  const double since_start = n == 0 ? 0.0 : all_lost(loss, n);
  return (static_cast<double>(steps - n) * stationary(loss, n) + since_start) / static_cast<double>(steps);
}

// Sends the number of each step over a link that holds: the received value is the step of the latest arrival.
std::vector<std::uint64_t> count_ages(const LossModel& loss, std::uint64_t seed, std::uint32_t receiver,
                                      std::uint64_t realizations, std::int64_t steps) {
  if (loss.by_distance) throw std::invalid_argument("ages of a link: losses by the distance depend on the run");
  LossModel holding = loss;
  holding.predictor = {1.0};
  PacketLoss link(holding, seed, receiver);
  std::vector<std::uint64_t> counts(1);
  for (std::uint64_t first = 0; first < realizations; first += kTile) {
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(kTile, realizations - first));
    std::vector<double> latest(size, -1.0);
    link.start(first, size, latest.data());
    for (std::int64_t k = 0; k < steps; ++k) {
      const auto now = static_cast<double>(k);
      std::fill(latest.begin(), latest.end(), now);
      link.step(k, first, size, latest.data());
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
