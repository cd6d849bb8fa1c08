#include "stochastic_platoon/math/string/source_responses.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Sequence = MeanVehicle::Sequence;

// What an input carries of the motion of its source.
Sequence carried(const Input& input, const Motion& source, double period) {
  if (is_difference(input.signal)) return signal_values(difference(input.signal, period), {}, source);
  return input.signal == InputSignal::position ? source.position : source.input;
}

}  // namespace

SourceResponses::SourceResponses(const PlatoonModel& model, std::size_t followers, std::size_t steps)
    : model_(model),
      followers_(followers),
      count_(steps + 1),
      different_{farthest_ahead(model) - 1, type_order(model).size()} {
  for (std::size_t i = 1; i <= std::min(followers, different_.count()); ++i)
    vehicles_.emplace_back(vehicle(model, i), i, model.sample_period);
}

std::vector<SourceResponses::Source> SourceResponses::sources(std::size_t follower) const {
  const VehicleModel& own = vehicle(model_, follower);
  std::vector<Source> found;
  Sequence impulse(count_, 0.0L);
  impulse[1] = 1.0L;
  for (std::size_t n = 0; n < own.inputs.size(); ++n) {
    const LinkModel& link = own.inputs[n].link;
    const double noise = own.inputs[n].noise_variance, dither = link.quantisation_step * link.quantisation_step / 12.0;
    const bool is_white = link.has_white_noise();
    if (noise > 0.0)
      found.push_back({follower, n, noise, is_white ? impulse : filtered_impulse(link.noise_filter, count_ - 1)});
    if (dither > 0.0) found.push_back({follower, n, dither, impulse});
  }
  if (own.initial_position.variance > 0.0) found.push_back({follower, std::nullopt, own.initial_position.variance, {}});
  return found;
}

void SourceResponses::visit(const Source& source, const Visitor& visitor) const {
  const Motion still{Sequence(count_, 0.0L), Sequence(count_, 0.0L)};
  std::vector<Motion> all(source.follower, still);
  for (std::size_t i = source.follower; i <= followers_; ++i) {
    check_interruption();
    all.push_back(response(i, all, i == source.follower ? &source : nullptr));
    visitor(i, all[i - 1].position, all[i]);
    if (i > different_.alone + 1) all[i - different_.alone - 1] = {};  // no vehicle behind i hears it
  }
}

Motion SourceResponses::response(std::size_t follower, const std::vector<Motion>& all, const Source* source) const {
  const VehicleResponse& responding = vehicles_[different_.of(follower) - 1];
  if (source != nullptr && !source->input) return responding.free_motion(count_);
  const VehicleModel& own = vehicle(model_, follower);
  const std::vector<Input>& inputs = own.inputs;
  const bool plain = own.hears_predecessor_only();  // its response has the gain of its radio
  Motion used{Sequence(count_, 0.0L), Sequence(count_, 0.0L)};
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const Input& input = inputs[n];
    const bool is_noisy = source != nullptr && *source->input == n;
    if (source != nullptr && !is_noisy) continue;  // all vehicles ahead stand still
    const std::size_t from = source_of(input, follower);
    if (source == nullptr && from == 0) continue;
    Sequence& sum = input.signal == InputSignal::position ? used.position : used.input;
    const long double gain = plain ? 1.0 : input.gain;
    const auto delay = static_cast<std::size_t>(input.delay());
    const Sequence sent = is_noisy ? source->impulse : carried(input, all[from], model_.sample_period);
    for (std::size_t k = 0; k < count_; ++k) sum[k] += gain * sent[k > delay ? k - delay : 0];
  }
  return responding(used);
}

}  // namespace platoon
