#include "stochastic_platoon/math/string/linked_moments.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/numerics/causal_convolution.hpp"
#include "stochastic_platoon/math/string/mean_vehicle.hpp"

namespace platoon {

namespace {

using Sequence = MeanVehicle::Sequence;
using Values = CausalConvolution::Values;

Values squares(const Sequence& values) {
  Values result;
  for (const long double value : values) result.push_back(static_cast<double>(value * value));
  return result;
}

Values products(const Values& a, const Values& b) {
  Values result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(a[k] * b[k]);
  return result;
}

/// Responses of the vehicles downstream to one kind of source at one place of the pattern. Index: number of vehicles
/// behind the source, from 0 for the source's own vehicle.
struct Responses {
  std::vector<Values> error;       ///< squared responses of zeta
  std::vector<Values> innovation;  ///< squared responses of e; empty for the source's own vehicle
};

class LinkedString {
public:
  LinkedString(const PlatoonModel& model, std::size_t followers, std::int64_t steps)
      : model_(model), followers_(followers), steps_(static_cast<std::size_t>(steps)), vehicles_(pattern(model)) {
    for (const VehicleModel& vehicle : vehicles_) mean_vehicles_.emplace_back(vehicle);
  }

  ErrorMoments moments() {
    ErrorMoments result{static_cast<std::int64_t>(steps_), followers_, {}, {}};
    innovation_means_.clear();
    pass_means(result.mean, innovation_means_);
    error_.assign(followers_, Values(steps_, 0.0));
    innovation_.clear();
    for (const Values& mean : innovation_means_) innovation_.push_back(products(mean, mean));
    for (std::size_t j = 0; j < vehicles_.size() && j < followers_; ++j) add_constant_sources(j);
    add_losses();
    for (const Values& row : error_) result.variance.insert(result.variance.end(), row.begin(), row.end());
    return result;
  }

  // The fourth cumulants of every cell, from E e^2 as computed by moments().
  Values fourth_cumulants() {
    LossResponses responses = loss_responses([](const Values& squared) { return products(squared, squared); });
    CausalConvolution convolution(steps_);
    Values result;
    sources_.clear();
    for (std::size_t i = 0; i < followers_; ++i) {
      Values of_error(steps_, 0.0), of_innovation(steps_, 0.0);
      if (responses.any && i > 0) add_losses_to(convolution, responses.innovation, i, i - 1, of_innovation);
      sources_.emplace_back(loss_cumulants(i, of_innovation));
      if (responses.any) add_losses_to(convolution, responses.error, i, i, of_error);
      result.insert(result.end(), of_error.begin(), of_error.end());
    }
    return result;
  }

private:
  const MeanVehicle& mean_vehicle(std::size_t i) const { return mean_vehicles_[i % mean_vehicles_.size()]; }

  Sequence leader_positions() const {
    Sequence positions;
    if (!model_.recorded_leader.empty()) {
      if (model_.recorded_leader.size() < steps_ + 1) {
        throw std::invalid_argument("recorded leader: " + std::to_string(model_.recorded_leader.size()) +
                                    " positions: must be at least steps + 1 = " + std::to_string(steps_ + 1));
      }
      positions.assign(model_.recorded_leader.begin(),
                       model_.recorded_leader.begin() + static_cast<std::ptrdiff_t>(steps_ + 1));
      return positions;
    }
    for (std::size_t a = 0; a <= steps_; ++a)
      positions.push_back(model_.leader.position(static_cast<std::int64_t>(a) - 1));
    return LoopResponse(model_.default_vehicle().loop)(positions);
  }

  void pass_means(Values& error_means, std::vector<Values>& innovation_means) const {
    Sequence predecessor = leader_positions();
    for (std::size_t i = 0; i < followers_; ++i) {
      const MeanVehicle& vehicle = mean_vehicle(i);
      MeanVehicle::Passed passed = vehicle(predecessor);
      const double placed = vehicles_[i % vehicles_.size()].initial_position.mean;
      if (placed != 0.0) {
        const Sequence free = vehicle.free_motion(steps_);
        for (std::size_t a = 0; a < free.size(); ++a) passed.position[a] += placed * free[a];
      }
      const Sequence errors = vehicle.error(predecessor, passed.position);
      error_means.insert(error_means.end(), errors.begin(), errors.end());
      innovation_means.emplace_back(passed.innovation.begin(), passed.innovation.end());
      predecessor.swap(passed.position);
    }
  }

  // The responses down the string, given the response of the position of the source's own vehicle.
  Responses downstream(std::size_t place, Sequence position) const {
    Responses responses;
    responses.error.push_back(squares(mean_vehicle(place).error(Sequence(steps_ + 1, 0.0L), position)));
    responses.innovation.emplace_back();
    for (std::size_t i = place + 1; i < followers_; ++i) {
      MeanVehicle::Passed passed = mean_vehicle(i)(position);
      responses.error.push_back(squares(mean_vehicle(i).error(position, passed.position)));
      responses.innovation.push_back(squares(passed.innovation));
      position.swap(passed.position);
    }
    return responses;
  }

  // Adds the noise and the dither of link `place` and its repetitions, and the initial positions there.
  void add_constant_sources(std::size_t place) {
    const VehicleModel& vehicle = vehicles_[place];
    const double quantisation = vehicle.link.quantisation_step * vehicle.link.quantisation_step / 12.0;
    const bool white = vehicle.link.has_white_noise();
    if (vehicle.noise_variance > 0.0) {
      const Sequence of_noise = white ? impulse() : filtered_impulse(vehicle.link.noise_filter);
      add_white(place, of_noise, vehicle.noise_variance + (white ? quantisation : 0.0));
    }
    if (quantisation > 0.0 && !(white && vehicle.noise_variance > 0.0)) add_white(place, impulse(), quantisation);
    if (vehicle.initial_position.variance > 0.0) {
      add_repeated(place, downstream(place, mean_vehicle(place).free_motion(steps_)), {},
                   vehicle.initial_position.variance);
    }
  }

  // Adds a white source of this variance on the sent position from step 0 on, summed over all steps so far.
  void add_white(std::size_t place, const Sequence& sent, double variance) {
    const MeanVehicle::Passed own = mean_vehicle(place)(sent);
    Responses responses = downstream(place, own.position);
    Values own_innovation = squares(own.innovation);
    for (auto* rows : {&responses.error, &responses.innovation}) {
      for (Values& row : *rows) std::partial_sum(row.begin(), row.end(), row.begin());
    }
    std::partial_sum(own_innovation.begin(), own_innovation.end(), own_innovation.begin());
    add_repeated(place, responses, own_innovation, variance);
  }

  void add_repeated(std::size_t place, const Responses& responses, const Values& own_innovation, double variance) {
    const auto add = [&](const Values& from, Values& to) {
      for (std::size_t k = 0; k < from.size(); ++k) to[k] += variance * from[k];
    };
    // Repetitions of the source add the responses at distances i, i - M, ... to follower i; sum them once.
    const std::size_t period = vehicles_.size(), count = responses.error.size();
    std::vector<Values> error = responses.error, innovation = responses.innovation;
    if (!own_innovation.empty()) innovation[0] = own_innovation;
    if (innovation[0].empty()) innovation[0].assign(steps_, 0.0);
    for (std::size_t m = period; m < count; ++m) {
      for (std::size_t k = 0; k < steps_; ++k) {
        error[m][k] += error[m - period][k];
        innovation[m][k] += innovation[m - period][k];
      }
    }
    for (std::size_t m = 0; m < count; ++m) {
      add(error[m], error_[place + m]);
      add(innovation[m], innovation_[place + m]);
    }
  }

  Sequence impulse() const {
    Sequence sequence(steps_ + 1, 0.0L);
    sequence[1] = 1.0L;
    return sequence;
  }

  Sequence filtered_impulse(const TransferFunction& filter) const {
    const Polynomial &b = filter.numerator(), &a = filter.denominator();
    const Eigen::Index lead = a.size() - b.size();
    Sequence w(steps_ + 1, 0.0L);
    for (std::size_t k = 0; k < steps_; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      long double value = at >= lead && at - lead < b.size() ? b(at - lead) : 0.0;
      for (Eigen::Index j = 1; j < a.size() && j <= at; ++j) value -= a(j) * w[k + 1 - static_cast<std::size_t>(j)];
      w[k + 1] = value;
    }
    return w;
  }

  using Kernels = std::vector<CausalConvolution::Prepared>;

  // Adds the contribution of the losses of the links up to `last` to follower i's row, given these responses.
  void add_losses_to(CausalConvolution& convolution, std::vector<Kernels>& kernels, std::size_t i, std::size_t last,
                     Values& row) {
    std::vector<CausalConvolution::Product> products;
    for (std::size_t j = 0; j <= last; ++j) {
      if (!sources_[j].is_zero()) products.push_back({kernels[j % vehicles_.size()][i - j], sources_[j]});
    }
    convolution.add(products, row);
  }

  /// Powers of the responses to the losses of each vehicle of the pattern.
  struct LossResponses {
    std::vector<Kernels> error, innovation;
    std::vector<Values> own;  ///< responses of the own link's innovation
    bool any = false;         ///< whether there are losses
  };

  // `power` converts squared responses to the required power.
  template <class Power>
  LossResponses loss_responses(const Power& power) const {
    LossResponses result{std::vector<Kernels>(vehicles_.size()), std::vector<Kernels>(vehicles_.size()),
                         std::vector<Values>(vehicles_.size())};
    for (std::size_t j = 0; j < std::min(vehicles_.size(), followers_); ++j) {
      if (mean_vehicles_[j].variance_factor() == 0.0) continue;
      result.any = true;
      const MeanVehicle::Passed passed = mean_vehicles_[j].of_loss(steps_);
      result.own[j] = power(squares(passed.innovation));
      const Responses responses = downstream(j, passed.position);
      for (std::size_t m = 0; m < responses.error.size(); ++m) {
        result.error[j].emplace_back(power(responses.error[m]));
        result.innovation[j].emplace_back(power(responses.innovation[m]));
      }
    }
    return result;
  }

  void add_losses() {
    LossResponses responses = loss_responses([](const Values& squared) { return squared; });
    if (!responses.any) return;
    CausalConvolution convolution(steps_);
    for (std::size_t i = 0; i < followers_; ++i) {
      if (i > 0) add_losses_to(convolution, responses.innovation, i, i - 1, innovation_[i]);
      add_source(i, responses.own[i % vehicles_.size()]);
      add_losses_to(convolution, responses.error, i, i, error_[i]);
    }
  }

  // Appends the variance of w_i, p q E e^2; w_i also acts on the innovation of its own link.
  void add_source(std::size_t i, const Values& own) {
    Values variance;  // of w(k), from step 0 on
    const double factor = mean_vehicle(i).variance_factor();
    if (factor > 0.0) {
      std::size_t reach = own.size();
      const double negligible = 1e-40 * *std::max_element(own.begin(), own.end());
      while (reach > 1 && own[reach - 1] <= negligible) --reach;
      Values& squared = innovation_[i];
      for (std::size_t k = 0; k < steps_; ++k) {
        double returned = 0.0;
        for (std::size_t t = 1; t < reach && t <= k; ++t) returned += own[t] * variance[k - t];
        squared[k] += returned;
        variance.push_back(factor * squared[k]);
      }
    }
    sources_.emplace_back(std::move(variance));
  }

  // The fourth cumulants of w_i, pq (1 - 3pq) E e^4 - 3 (pq E e^2)^2, at least 0, with E e^4 of a normal e plus the
  // contribution of the links before.
  Values loss_cumulants(std::size_t i, const Values& of_innovation) const {
    Values result;
    const double factor = mean_vehicle(i).variance_factor();
    if (factor == 0.0) return result;
    for (std::size_t k = 0; k < steps_; ++k) {
      const double square = innovation_[i][k], mean = innovation_means_[i][k];
      const double fourth = 3.0 * square * square - 2.0 * mean * mean * mean * mean + of_innovation[k];
      result.push_back(std::max(factor * (1.0 - 3.0 * factor) * fourth - 3.0 * factor * factor * square * square, 0.0));
    }
    return result;
  }

  PlatoonModel model_;
  std::size_t followers_, steps_;
  std::vector<VehicleModel> vehicles_;
  std::vector<MeanVehicle> mean_vehicles_;
  std::vector<Values> innovation_means_;              ///< E e_i(k)
  std::vector<Values> error_;                         ///< variance of zeta_i(k), accumulated
  std::vector<Values> innovation_;                    ///< E e_i(k)^2, accumulated
  std::vector<CausalConvolution::Prepared> sources_;  ///< variance of every w_i
};

}  // namespace

ErrorMoments linked_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                                  std::vector<double>* fourth_cumulants) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  for (const VehicleModel& vehicle : pattern(model)) unit_equilibrium(vehicle.loop.realization);
  LinkedString string(model, followers, steps);
  ErrorMoments moments = string.moments();
  if (fourth_cumulants != nullptr) *fourth_cumulants = string.fourth_cumulants();
  return moments;
}

}  // namespace platoon
