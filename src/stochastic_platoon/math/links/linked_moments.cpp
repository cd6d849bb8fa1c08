#include "stochastic_platoon/math/links/linked_moments.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/string_responses.hpp"
#include "stochastic_platoon/math/numerics/causal_convolution.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Sequence = VehicleResponse::Sequence;
using Values = CausalConvolution::Values;
using Kernels = std::vector<CausalConvolution::Prepared>;  // by the number of vehicles behind the source

Values squares(const Sequence& values, std::size_t from = 0) {
  Values result;
  for (std::size_t a = from; a < values.size(); ++a) result.push_back(static_cast<double>(values[a] * values[a]));
  return result;
}

Values products(const Values& a, const Values& b) {
  Values result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(a[k] * b[k]);
  return result;
}

void add_multiple(double factor, const Values& from, Values& to) {
  for (std::size_t k = 0; k < from.size(); ++k) to[k] += factor * from[k];
}

/// Squared responses of a source's own vehicle and of those behind it.
struct Responses {
  std::vector<std::vector<Values>> signals;  ///< per signal
  std::array<std::vector<Values>, 2>
      innovation;  ///< of e, per link; empty where a vehicle has no such link with losses
};

/// Powers of the responses to the losses of one link.
struct LossResponses {
  std::vector<Kernels> signals;
  std::array<Kernels, 2> innovation;
  Values own;  ///< of the link's own innovation
};

class LinkedString {
public:
  LinkedString(const PlatoonModel& model, const SignalLists& signals, std::int64_t steps)
      : model_(model),
        signals_(signals),
        followers_(signals.size()),
        steps_(static_cast<std::size_t>(steps)),
        responses_(model, followers_, steps_, StringResponses::Pass::innovations) {}

  std::vector<SignalMoments> moments() {
    std::vector<SignalMoments> result(kinds(), {static_cast<std::int64_t>(steps_), followers_});
    innovation_means_.clear();
    responses_.visit_means([&](std::size_t i, const Sequence& predecessor, const StringResponses::Response& response) {
      for (std::size_t s = 0; s < kinds(); ++s)
        add_means(signals_[i - 1][s], vehicle(model_, i).standstill_distance, predecessor, response.own,
                  result[s].mean);
      innovation_means_.emplace_back();
      for (std::size_t link = 0; link < response.innovation.size(); ++link) {
        const Sequence& mean = response.innovation[link];
        if (factor(i, link) > 0.0) innovation_means_.back()[link].assign(mean.begin(), mean.end());
      }
    });
    variances_.assign(kinds(), std::vector<Values>(followers_, Values(steps_, 0.0)));
    innovation_.clear();
    for (const std::array<Values, 2>& mean : innovation_means_)
      innovation_.push_back({products(mean[0], mean[0]), products(mean[1], mean[1])});
    for (std::size_t i = 1; i <= std::min(period(), followers_); ++i) {
      for (const StringResponses::Source& source : responses_.sources(i)) add_white(source);
    }
    add_losses();
    for (std::size_t s = 0; s < kinds(); ++s) {
      for (const Values& row : variances_[s])
        result[s].variance.insert(result[s].variance.end(), row.begin(), row.end());
    }
    return result;
  }

  // The fourth cumulants of every cell of the first signal, from E e^2 as computed by moments().
  Values fourth_cumulants() {
    std::vector<LossResponses> responses =
        loss_responses([](const Values& squared) { return products(squared, squared); });
    CausalConvolution convolution(steps_);
    Values result;
    sources_.clear();
    for (std::size_t i = 0; i < followers_; ++i) {
      for (std::size_t link = 0; link < 2; ++link) {
        Values of_innovation(steps_, 0.0);
        if (factor(i + 1, link) > 0.0) {
          add_losses_to(convolution, responses, i, 2 * i, of_innovation,
                        [link](LossResponses& of) -> Kernels& { return of.innovation[link]; });
        }
        sources_.emplace_back(loss_cumulants(i, link, of_innovation));
      }
      Values of_error(steps_, 0.0);
      add_losses_to(convolution, responses, i, 2 * i + 2, of_error,
                    [](LossResponses& of) -> Kernels& { return of.signals.front(); });
      result.insert(result.end(), of_error.begin(), of_error.end());
    }
    return result;
  }

private:
  std::size_t kinds() const { return signals_.front().size(); }
  std::size_t period() const { return responses_.different().period; }

  // p q of a link; 0 if there is none.
  double factor(std::size_t follower, std::size_t link) const {
    return link < vehicle(model_, follower).inputs.size() ? responses_.loss_factor(follower, link) : 0.0;
  }

  Responses responses_to(const StringResponses::Source& source) const {
    Responses found{std::vector<std::vector<Values>>(kinds()), {}};
    responses_.visit(source, [&](std::size_t i, const Sequence& predecessor, const StringResponses::Response& of) {
      for (std::size_t s = 0; s < kinds(); ++s)
        found.signals[s].push_back(squares(signal_values(signals_[i - 1][s], predecessor, of.own), 1));
      for (std::size_t link = 0; link < 2; ++link)
        found.innovation[link].push_back(factor(i, link) > 0.0 ? squares(of.innovation[link]) : Values());
    });
    return found;
  }

  // Adds a noise or dither, present from step 0 on, or an initial position, at its follower and its repetitions.
  void add_white(const StringResponses::Source& source) {
    Responses responses = responses_to(source);
    const auto add_up = [&source](std::vector<Values>& rows) {
      for (Values& row : rows) {
        if (source.input) std::partial_sum(row.begin(), row.end(), row.begin());
      }
    };
    for (std::vector<Values>& rows : responses.signals) add_up(rows);
    for (std::vector<Values>& rows : responses.innovation) add_up(rows);
    for (std::size_t s = 0; s < kinds(); ++s)
      add_repeated_rows(source, std::move(responses.signals[s]),
                        [this, s](std::size_t i) { return &variances_[s][i]; });
    for (std::size_t to = 0; to < 2; ++to) {
      add_repeated_rows(source, std::move(responses.innovation[to]),
                        [this, to](std::size_t i) { return &innovation_[i][to]; });
    }
  }

  // Repetitions of the source add the rows at distances i, i - M, ... to follower i; they are summed once.
  template <class Target>
  void add_repeated_rows(const StringResponses::Source& source, std::vector<Values> rows, const Target& target) {
    for (std::size_t m = 0; m < rows.size(); ++m) {
      if (m >= period()) {
        const Values& before = rows[m - period()];
        rows[m].resize(std::max(rows[m].size(), before.size()), 0.0);
        add_multiple(1.0, before, rows[m]);
      }
      Values* const to = target(source.follower - 1 + m);
      if (!to->empty()) add_multiple(source.variance, rows[m], *to);
    }
  }

  // Adds the contribution of the losses of the first `links` links of the string to follower i's row; `kernels` names
  // the responses to one link's losses.
  template <class Kernel>
  void add_losses_to(CausalConvolution& convolution, std::vector<LossResponses>& responses, std::size_t i,
                     std::size_t links, Values& row, const Kernel& kernels) {
    std::vector<CausalConvolution::Product> products;
    for (std::size_t source = 0; source < links; ++source) {
      if (sources_[source].is_zero()) continue;
      LossResponses& of = responses[source % (2 * period())];
      products.push_back({kernels(of)[i - source / 2], sources_[source]});
    }
    if (!products.empty()) convolution.add(products, row);
  }

  // The links come from one pattern, two per vehicle. `power` converts squared responses to the required power.
  template <class Power>
  std::vector<LossResponses> loss_responses(const Power& power) const {
    std::vector<LossResponses> result(2 * period());
    for (std::size_t source = 0; source < std::min(result.size(), 2 * followers_); ++source) {
      const std::size_t follower = source / 2 + 1, link = source % 2;
      if (factor(follower, link) == 0.0) continue;
      const Responses to_loss = responses_to({follower, link, 1.0, {}});
      LossResponses& of = result[source];
      of.own = power(to_loss.innovation[link].front());
      of.signals.resize(kinds());
      for (std::size_t s = 0; s < kinds(); ++s) {
        for (const Values& row : to_loss.signals[s]) of.signals[s].emplace_back(power(row));
      }
      for (std::size_t to = 0; to < 2; ++to) {
        for (const Values& row : to_loss.innovation[to]) of.innovation[to].emplace_back(power(row));
      }
    }
    return result;
  }

  void add_losses() {
    std::vector<LossResponses> responses = loss_responses([](const Values& squared) { return squared; });
    CausalConvolution convolution(steps_);
    sources_.clear();
    for (std::size_t i = 0; i < followers_; ++i) {
      for (std::size_t link = 0; link < 2; ++link) {
        if (factor(i + 1, link) > 0.0) {
          add_losses_to(convolution, responses, i, 2 * i, innovation_[i][link],
                        [link](LossResponses& of) -> Kernels& { return of.innovation[link]; });
        }
        add_source(i, link, responses[2 * (i % period()) + link].own);
      }
      for (std::size_t s = 0; s < kinds(); ++s) {
        add_losses_to(convolution, responses, i, 2 * i + 2, variances_[s][i],
                      [s](LossResponses& of) -> Kernels& { return of.signals[s]; });
      }
    }
  }

  // Appends the variance of the w of a link, p q E e^2; w also acts on the innovation of its own link.
  void add_source(std::size_t i, std::size_t link, const Values& own) {
    Values variance;  // of w(k), from step 0 on
    if (factor(i + 1, link) > 0.0) {
      std::size_t reach = own.size();
      const double negligible = 1e-40 * *std::max_element(own.begin(), own.end());
      while (reach > 1 && own[reach - 1] <= negligible) --reach;
      Values& squared = innovation_[i][link];
      for (std::size_t k = 0; k < steps_; ++k) {
        check_interruption();
        double returned = 0.0;
        for (std::size_t t = 1; t < reach && t <= k; ++t) returned += own[t] * variance[k - t];
        squared[k] += returned;
        variance.push_back(factor(i + 1, link) * squared[k]);
      }
    }
    sources_.emplace_back(std::move(variance));
  }

  // The fourth cumulants of w, pq (1 - 3pq) E e^4 - 3 (pq E e^2)^2, at least 0, with E e^4 of a normal e plus the
  // contribution of the links before.
  Values loss_cumulants(std::size_t i, std::size_t link, const Values& of_innovation) const {
    Values result;
    const double of_link = factor(i + 1, link);
    if (of_link == 0.0) return result;
    for (std::size_t k = 0; k < steps_; ++k) {
      const double square = innovation_[i][link][k], mean = innovation_means_[i][link][k];
      const double fourth = 3.0 * square * square - 2.0 * mean * mean * mean * mean + of_innovation[k];
      result.push_back(
          std::max(of_link * (1.0 - 3.0 * of_link) * fourth - 3.0 * of_link * of_link * square * square, 0.0));
    }
    return result;
  }

  const PlatoonModel& model_;
  const SignalLists& signals_;
  std::size_t followers_, steps_;
  StringResponses responses_;
  std::vector<std::array<Values, 2>> innovation_means_;  ///< E e(k) per follower and link
  std::vector<std::vector<Values>> variances_;           ///< per signal and follower, accumulated
  std::vector<std::array<Values, 2>> innovation_;        ///< E e(k)^2 per follower and link, accumulated
  Kernels sources_;                                      ///< variance of every w, two links per follower
};

}  // namespace

std::vector<SignalMoments> linked_moments(const PlatoonModel& model, const SignalLists& signals, std::int64_t steps,
                                          std::vector<double>* fourth_cumulants) {
  if (signals.empty()) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  for (const VehicleModel& vehicle : pattern(model)) unit_equilibrium(vehicle.loop.realization);
  LinkedString string(model, signals, steps);
  std::vector<SignalMoments> moments = string.moments();
  if (fourth_cumulants != nullptr) *fourth_cumulants = string.fourth_cumulants();
  return moments;
}

SignalMoments linked_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                                   std::vector<double>* fourth_cumulants) {
  return linked_moments(model, signal_lists(model, {}, followers), steps, fourth_cumulants).front();
}

}  // namespace platoon
