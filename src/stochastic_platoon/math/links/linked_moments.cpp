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

void add_multiple(double factor, const Values& from, Values& to) {
  for (std::size_t k = 0; k < from.size(); ++k) to[k] += factor * from[k];
}

/// Squared responses of a source's own vehicle and of those behind it.
struct Responses {
  std::vector<Values> error;  ///< of zeta
  std::array<std::vector<Values>, 2>
      innovation;  ///< of e, per link; empty where a vehicle has no such link with losses
};

/// Powers of the responses to the losses of one link.
struct LossResponses {
  Kernels error;
  std::array<Kernels, 2> innovation;
  Values own;  ///< of the link's own innovation
};

class LinkedString {
public:
  LinkedString(const PlatoonModel& model, std::size_t followers, std::int64_t steps)
      : model_(model),
        followers_(followers),
        steps_(static_cast<std::size_t>(steps)),
        responses_(model, followers, steps_, StringResponses::Pass::innovations) {}

  ErrorMoments moments() {
    ErrorMoments result{static_cast<std::int64_t>(steps_), followers_, {}, {}};
    innovation_means_.clear();
    responses_.visit_means([&](std::size_t i, const Sequence& predecessor, const StringResponses::Response& response) {
      const Sequence errors = tracking_errors(vehicle(model_, i).headway, predecessor, response.own.position);
      result.mean.insert(result.mean.end(), errors.begin(), errors.end());
      innovation_means_.emplace_back();
      for (std::size_t link = 0; link < response.innovation.size(); ++link) {
        const Sequence& mean = response.innovation[link];
        if (factor(i, link) > 0.0) innovation_means_.back()[link].assign(mean.begin(), mean.end());
      }
    });
    error_.assign(followers_, Values(steps_, 0.0));
    innovation_.clear();
    for (const std::array<Values, 2>& mean : innovation_means_)
      innovation_.push_back({products(mean[0], mean[0]), products(mean[1], mean[1])});
    for (std::size_t i = 1; i <= std::min(period(), followers_); ++i) {
      for (const StringResponses::Source& source : responses_.sources(i)) add_white(source);
    }
    add_losses();
    for (const Values& row : error_) result.variance.insert(result.variance.end(), row.begin(), row.end());
    return result;
  }

  // The fourth cumulants of every cell, from E e^2 as computed by moments().
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
                    [](LossResponses& of) -> Kernels& { return of.error; });
      result.insert(result.end(), of_error.begin(), of_error.end());
    }
    return result;
  }

private:
  std::size_t period() const { return responses_.different().period; }

  // p q of a link; 0 if there is none.
  double factor(std::size_t follower, std::size_t link) const {
    return link < vehicle(model_, follower).inputs.size() ? responses_.loss_factor(follower, link) : 0.0;
  }

  Responses responses_to(const StringResponses::Source& source) const {
    Responses found;
    responses_.visit(source, [&](std::size_t i, const Sequence& predecessor, const StringResponses::Response& of) {
      found.error.push_back(squares(tracking_errors(vehicle(model_, i).headway, predecessor, of.own.position)));
      for (std::size_t link = 0; link < 2; ++link)
        found.innovation[link].push_back(factor(i, link) > 0.0 ? squares(of.innovation[link]) : Values());
    });
    return found;
  }

  // Adds a noise or dither, present from step 0 on, or an initial position, at its follower and its repetitions.
  void add_white(const StringResponses::Source& source) {
    Responses responses = responses_to(source);
    for (auto* rows : {&responses.error, &responses.innovation.front(), &responses.innovation.back()}) {
      for (Values& row : *rows) {
        if (source.input) std::partial_sum(row.begin(), row.end(), row.begin());
      }
    }
    add_repeated_rows(source, std::move(responses.error), [this](std::size_t i) { return &error_[i]; });
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
      for (const Values& row : to_loss.error) of.error.emplace_back(power(row));
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
      add_losses_to(convolution, responses, i, 2 * i + 2, error_[i],
                    [](LossResponses& of) -> Kernels& { return of.error; });
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
  std::size_t followers_, steps_;
  StringResponses responses_;
  std::vector<std::array<Values, 2>> innovation_means_;  ///< E e(k) per follower and link
  std::vector<Values> error_;                            ///< variance of zeta_i(k), accumulated
  std::vector<std::array<Values, 2>> innovation_;        ///< E e(k)^2 per follower and link, accumulated
  Kernels sources_;                                      ///< variance of every w, two links per follower
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
