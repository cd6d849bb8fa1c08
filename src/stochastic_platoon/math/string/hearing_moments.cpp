#include "stochastic_platoon/math/string/hearing_moments.hpp"

#include <algorithm>
#include <stdexcept>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "stochastic_platoon/math/string/source_responses.hpp"

namespace platoon {

namespace {

using Sequence = MeanVehicle::Sequence;

class HearingTables {
public:
  HearingTables(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
                std::size_t steps)
      : model_(model),
        names_(names),
        followers_(followers),
        steps_(steps),
        responses_(model, followers, steps),
        moments_(names.size() + 1) {
    for (std::size_t s = 0; s < moments_.size(); ++s) {
      moments_[s].variance.assign(followers * steps, 0.0);
      if (s > 0 && names[s - 1] == kGap) moments_[s].covariance_with_previous.assign(followers * steps, 0.0);
    }
  }

  std::vector<SignalMoments> operator()() {
    add_means();
    for (std::size_t i = 1; i <= std::min(followers_, responses_.different().count()); ++i) {
      for (const SourceResponses::Source& source : responses_.sources(i)) add(source);
    }
    return std::move(moments_);
  }

private:
  void add_means() {
    PlatoonModel quiet = model_;
    for (VehicleType& type : quiet.types) {
      for (Input& input : type.vehicle.inputs) {
        input.noise_variance = 0.0;
        input.link.quantisation_step = 0.0;
      }
      type.vehicle.initial_position.variance = 0.0;
    }
    for_each_trajectory(quiet, 1, followers_, static_cast<std::int64_t>(steps_), 0, names_,
                        [this](const Trajectory& of) {
                          for (std::size_t s = 0; s < of.signals.size(); ++s)
                            moments_[s].mean.insert(moments_[s].mean.end(), of.signals[s].begin(), of.signals[s].end());
                        });
  }

  void add(const SourceResponses::Source& source) {
    const DifferentFollowers& different = responses_.different();
    const std::size_t period = source.follower > different.alone ? different.period : followers_;
    responses_.visit(source, [&](std::size_t i, const Sequence& predecessor, const Motion& own) {
      const FollowerSignals of = signals_of(model_, names_, i);
      for (std::size_t s = 0; s < moments_.size(); ++s) {
        const Signal& signal = s == 0 ? of.error : of.requested[s - 1];
        const ResponseProducts products(signal_values(signal, predecessor, own), source.input.has_value());
        add_products(products.variance, i, period, source.variance, moments_[s].variance);
        if (!moments_[s].covariance_with_previous.empty())
          add_products(products.covariance, i, period, source.variance, moments_[s].covariance_with_previous);
      }
    });
  }

  // A follower hears a source, and those whole patterns farther back from the same distance.
  void add_products(const Sequence& products, std::size_t follower, std::size_t period, double variance,
                    std::vector<double>& cells) const {
    for (std::size_t i = follower; i <= followers_; i += period) {
      for (std::size_t k = 0; k < steps_; ++k)
        cells[(i - 1) * steps_ + k] += static_cast<double>(static_cast<long double>(variance) * products[k]);
    }
  }

  const PlatoonModel& model_;
  const std::vector<std::string>& names_;
  std::size_t followers_, steps_;
  SourceResponses responses_;
  std::vector<SignalMoments> moments_;
};

}  // namespace

std::vector<SignalMoments> hearing_moments(const PlatoonModel& model, const std::vector<std::string>& names,
                                           std::size_t followers, std::int64_t steps) {
  if (any_link(model, [](const LinkModel& link) { return link.loses(); }))
    throw std::invalid_argument("links: lose: must not lose for the moments of every step");
  return HearingTables(model, names, followers, static_cast<std::size_t>(steps))();
}

}  // namespace platoon
