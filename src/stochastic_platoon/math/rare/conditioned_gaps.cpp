#include "stochastic_platoon/math/rare/conditioned_gaps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"
#include "stochastic_platoon/math/statistics/normal_tail.hpp"
#include "stochastic_platoon/math/string/collision_risk.hpp"

namespace platoon {

namespace {

constexpr double kMostCovariances = 2.5e8;  // 2 GB
constexpr std::size_t kMostGapsAtOnce = std::size_t{1} << 19;
constexpr std::size_t kUniforms = 3;  // per condition: step, value, follower

// Draws of conditions have no link: the number of a row takes the place of the vehicle.
DrawName choice_of(std::size_t row, std::size_t number) {
  return {static_cast<std::uint32_t>(row), static_cast<std::int64_t>(number), Purpose::choice};
}

const RareEvent& require_fitting(const RareEvent& event) {
  const auto steps = static_cast<double>(event.steps);
  if (static_cast<double>(event.followers) * steps * steps > kMostCovariances)
    throw std::invalid_argument(
        formatted("steps: %lld: must be at most %.0f for %zu followers: covariances are steps^2",
                  static_cast<long long>(event.steps),
                  std::sqrt(kMostCovariances / static_cast<double>(event.followers)), event.followers));
  return event;
}

void require_rare(const GapLaw& law, const RareEvent& event) {
  bool is_random = false;
  for (std::size_t i = 1; i <= law.followers(); ++i) {
    for (auto k = static_cast<std::size_t>(event.burn_in); k < law.steps(); ++k) {
      is_random = is_random || law.variance(i, k) > 0.0;
      if (event.below < law.mean(i, k)) continue;
      throw std::invalid_argument(formatted(
          "below: %g m: must be below the mean gap of vehicle_%zu at step %zu, %g m: a larger standstill_distance, or a burn_in beyond this step",
          event.below, i, k, law.mean(i, k)));
    }
  }
  if (!is_random)
    throw std::invalid_argument("below: " + formatted("%g", event.below) +
                                " m: the event cannot happen: must be of a model with noise");
}

// collision_bounds() of the steps that count, about the bound of the event.
std::vector<double> bounds_of(const GapLaw& law, const RareEvent& event) {
  SignalMoments counted;
  const SignalMoments& all = law.moments();
  for (std::size_t at = 0; at < all.mean.size(); ++at) {
    if (at % law.steps() < static_cast<std::size_t>(event.burn_in)) continue;
    counted.mean.push_back(all.mean[at] - event.below);
    counted.variance.push_back(all.variance[at]);
    counted.covariance_with_previous.push_back(all.covariance_with_previous[at]);
  }
  return collision_bounds(counted, law.steps() - static_cast<std::size_t>(event.burn_in));
}

}  // namespace

ConditionedGaps::ConditionedGaps(const PlatoonModel& model, const RareEvent& event)
    : model_(model), event_(require_fitting(event)), law_(model, event.followers, event.steps) {
  require_rare(law_, event);
  covariances_ = law_.covariances();
  std::vector<double> of_followers;
  for (std::size_t i = 1; i <= event.followers; ++i) {
    std::vector<double> log_p(law_.steps(), -std::numeric_limits<double>::infinity());
    for (auto k = static_cast<std::size_t>(event.burn_in); k < law_.steps(); ++k) {
      if (law_.variance(i, k) > 0.0)
        log_p[k] = log_normal_tail((law_.mean(i, k) - event.below) / std::sqrt(law_.variance(i, k)));
    }
    choices_.emplace_back(std::move(log_p));
    of_followers.push_back(choices_.back().log_sum());
  }
  choices_.emplace_back(std::move(of_followers));
  bounds_ = bounds_of(law_, event);
}

std::pair<double, double> ConditionedGaps::log_limits(std::size_t row) const {
  const bool is_any = row == event_.followers;
  double least = -std::numeric_limits<double>::infinity(), bound = 0.0;
  for (std::size_t i = is_any ? 0 : row; i < (is_any ? row : row + 1); ++i) {
    least = std::max(least, choices_[i].log_weights()[choices_[i].largest()]);
    bound += bounds_[i];
  }
  // A sum below the range of double has lost terms.
  const double log_bound = bound > 1e-280 ? std::log(bound) : std::numeric_limits<double>::infinity();
  return {least, std::min({log_bound, choices_[row].log_sum(), 0.0})};
}

ConditionedGaps::Condition ConditionedGaps::condition(std::size_t row, const double* uniforms) const {
  const std::size_t follower = row < event_.followers ? row + 1 : choices_.back()(uniforms[2]) + 1;
  const WeightedChoice& steps = choices_[follower - 1];
  const std::size_t step = steps(uniforms[0]);
  const double log_p = steps.log_weights()[step] + std::log1p(-uniforms[1]);
  return {follower, step,
          law_.mean(follower, step) - std::sqrt(law_.variance(follower, step)) * normal_tail_quantile(log_p)};
}

double ConditionedGaps::shift(const Condition& at, const DrawName& draw) const {
  const auto tau = static_cast<Eigen::Index>(at.step);
  return law_.response(draw, at.follower, at.step) / covariances_[at.follower - 1](tau, tau);
}

std::uint64_t ConditionedGaps::batch() const {
  std::uint64_t batch = 256;
  while (batch > 1 && batch * event_.followers * law_.steps() > kMostGapsAtOnce) batch /= 2;
  return batch;
}

/// Shifted noise of the realizations of one batch.
class ConditionedGaps::Shifts : public ChangedDraws {
public:
  explicit Shifts(const ConditionedGaps& of) : of_(of) {}

  void origins(std::int64_t, std::uint64_t first, std::size_t count, std::uint64_t* origins) const override {
    for (std::size_t r = 0; r < count; ++r) origins[r] = noiseless ? kNoNoise : first + r;
  }

  void shift(const DrawName& name, std::uint64_t first, std::size_t count, double* normals) const override {
    for (std::size_t r = 0; r < count; ++r)
      normals[r] += lengths[first - first_ + r] * of_.shift(conditions[first - first_ + r], name);
  }

  void begin(std::uint64_t first) {
    first_ = first;
    conditions.clear();
    lengths.clear();
  }

  bool noiseless = false;
  std::vector<Condition> conditions;  ///< per realization
  std::vector<double> lengths;        ///< x - g(tau) [m]

private:
  const ConditionedGaps& of_;
  std::uint64_t first_ = 0;
};

/// Computes the weights of batch after batch, in one thread.
class ConditionedGaps::Sampler {
public:
  explicit Sampler(const ConditionedGaps& of)
      : of_(of),
        steps_(of.law_.steps()),
        draws_(of.event_.seed),
        shifts_(std::make_shared<Shifts>(of)),
        string_(of.model_, of.event_.seed, of.event_.followers),
        shifted_(of.model_, WhiteNoise(of.event_.seed, shifts_), of.event_.followers) {
    for (std::size_t i = 1; i <= of.event_.followers; ++i)
      gap_.push_back(signals_of(of.model_, {kGap}, i).requested[0]);
  }

  void operator()(const RealizationRange& batch, const std::function<void()>& check, EnsembleTotals& totals) {
    const std::size_t count = batch.size(), followers = of_.event_.followers;
    BatchMoments moments(batch.first, count, followers + 1);
    std::vector<double> weights;
    simulate(batch, check);
    for (std::size_t row = 0; row < followers; ++row) {
      draw_conditions(batch, row);
      weights = weights_of(row, count);
      moments.set(row, weights.data());
    }
    if (followers > 1) {
      draw_conditions(batch, followers);
      weights = weights_of_any(batch, check);
    }
    moments.set(followers, weights.data());
    totals.moments.add(std::move(moments));
  }

private:
  // Gaps of the ordinary realizations: of follower i at step k from gaps_[((i-1) steps + k) count] on.
  void simulate(const RealizationRange& batch, const std::function<void()>& check) {
    const std::size_t count = batch.size();
    gaps_.resize(of_.event_.followers * steps_ * count);
    string_.run(batch.first, count, of_.event_.steps,
                [&](std::size_t follower, std::int64_t step, const SignalPositions& at) {
                  check();
                  gap_[follower - 1](at.ahead, at.own, count,
                                     &gaps_[((follower - 1) * steps_ + static_cast<std::size_t>(step)) * count]);
                });
  }

  // The conditions of a row.
  void draw_conditions(const RealizationRange& batch, std::size_t row) {
    const std::size_t count = batch.size();
    uniforms_.resize(kUniforms * count);
    for (std::size_t j = 0; j < kUniforms; ++j)
      draws_.fill_uniform(choice_of(row + 1, j), batch.first, count, &uniforms_[j * count]);
    shifts_->begin(batch.first);
    for (std::size_t r = 0; r < count; ++r) {
      const double uniforms[kUniforms] = {uniforms_[r], uniforms_[count + r], uniforms_[2 * count + r]};
      const Condition at = of_.condition(row, uniforms);
      shifts_->conditions.push_back(at);
      shifts_->lengths.push_back(at.gap - gaps_[((at.follower - 1) * steps_ + at.step) * count + r]);
    }
  }

  std::vector<double> weights_of(std::size_t row, std::size_t count) const {
    if (of_.choices_[row].log_sum() == -std::numeric_limits<double>::infinity()) return std::vector<double>(count, 0.0);
    std::vector<double> weights;
    for (std::size_t r = 0; r < count; ++r) {
      const Condition& at = shifts_->conditions[r];
      const auto tau = static_cast<Eigen::Index>(at.step);
      const Eigen::MatrixXd& covariance = of_.covariances_[row];
      const double shift = shifts_->lengths[r] / covariance(tau, tau), below = of_.event_.below;
      const double *const gap = &gaps_[row * steps_ * count + r], *const column = covariance.data() + at.step * steps_;
      std::size_t steps = 0;
      for (auto k = static_cast<std::size_t>(of_.event_.burn_in); k < steps_; ++k)
        steps += k == at.step || gap[k * count] + shift * column[k] < below ? 1 : 0;
      weights.push_back(1.0 / static_cast<double>(steps));
    }
    return weights;
  }

  std::vector<double> weights_of_any(const RealizationRange& batch, const std::function<void()>& check) {
    const std::size_t count = batch.size();
    std::vector<double> pairs(count, 0.0), values(count);
    shifted_.run(batch.first, count, of_.event_.steps,
                 [&](std::size_t follower, std::int64_t step, const SignalPositions& at) {
                   check();
                   if (step < of_.event_.burn_in) return;
                   gap_[follower - 1](at.ahead, at.own, count, values.data());
                   for (std::size_t r = 0; r < count; ++r) {
                     const Condition& of = shifts_->conditions[r];
                     const bool is_given = of.follower == follower && of.step == static_cast<std::size_t>(step);
                     pairs[r] += is_given || values[r] < of_.event_.below ? 1.0 : 0.0;
                   }
                 });
    for (double& value : pairs) value = 1.0 / value;
    return pairs;
  }

  const ConditionedGaps& of_;
  std::size_t steps_;
  WhiteNoise draws_;
  std::shared_ptr<Shifts> shifts_;
  PlatoonString string_, shifted_;
  std::vector<Signal> gap_;  ///< per follower
  std::vector<double> gaps_, uniforms_;
};

BatchWork ConditionedGaps::work() const {
  return {EnsembleTotals(MomentTable(event_.followers + 1)), batch(), [this] {
            const auto sampler = std::make_shared<Sampler>(*this);
            return [sampler](const RealizationRange& range, const std::function<void()>& check,
                             EnsembleTotals& totals) { (*sampler)(range, check, totals); };
          }};
}

std::shared_ptr<const ChangedDraws> ConditionedGaps::replay(std::size_t row,
                                                            std::optional<std::uint64_t> sample) const {
  const auto shifts = std::make_shared<Shifts>(*this);
  if (event_.followers == 1) row = 0;  // the only follower is any follower
  if (std::isinf(choices_[row].log_sum())) return nullptr;
  const auto gap_of = [&](const Condition& at) {
    const Signal gap = signals_of(model_, {kGap}, at.follower).requested[0];
    double value = 0.0;
    PlatoonString(model_, WhiteNoise(event_.seed), at.follower)
        .run(*sample, 1, static_cast<std::int64_t>(at.step) + 1,
             [&](std::size_t follower, std::int64_t, const SignalPositions& positions) {
               if (follower == at.follower) value = positions.of(gap).front();
             });
    return value;
  };
  if (sample) {
    std::array<double, kUniforms> uniforms;
    for (std::size_t j = 0; j < kUniforms; ++j)
      WhiteNoise(event_.seed).fill_uniform(choice_of(row + 1, j), *sample, 1, &uniforms[j]);
    const Condition at = condition(row, uniforms.data());
    shifts->begin(*sample);
    shifts->conditions = {at};
    shifts->lengths = {at.gap - gap_of(at)};
    return shifts;
  }
  const std::size_t follower = row < event_.followers ? row + 1 : choices_.back().largest() + 1,
                    step = choices_[follower - 1].largest();
  shifts->noiseless = true;
  shifts->conditions = {{follower, step, event_.below}};
  shifts->lengths = {event_.below - law_.mean(follower, step)};
  return shifts;
}

}  // namespace platoon
