#include "stochastic_platoon/math/channel/link.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/math/channel/coloured_noise.hpp"
#include "stochastic_platoon/math/channel/delay_line.hpp"
#include "stochastic_platoon/math/channel/packet_loss.hpp"
#include "stochastic_platoon/math/channel/quantiser.hpp"

namespace platoon {

namespace {

// The only place that defines the order of the stages.
std::vector<std::unique_ptr<LinkStage>> stages_of(const LinkModel& link, double noise_variance, const WhiteNoise& noise,
                                                  std::uint32_t receiver) {
  std::vector<std::unique_ptr<LinkStage>> stages;
  if (link.quantisation_step > 0.0)
    stages.push_back(std::make_unique<Quantiser>(link.quantisation_step, noise, receiver));
  if (noise_variance > 0.0)
    stages.push_back(std::make_unique<ColouredNoise>(noise_variance, link.noise_filter, noise, receiver));
  if (link.delay > 0) stages.push_back(std::make_unique<DelayLine>(link.delay));
  if (link.loses()) stages.push_back(std::make_unique<PacketLoss>(*link.loss, noise, receiver));
  return stages;
}

}  // namespace

Link::Link(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t receiver)
    : noise_(vehicle(model, receiver).noise_variance, noise, receiver),
      length_(vehicle(model, receiver - 1).length),
      slope_(start_slope(model)) {
  const VehicleModel& own = vehicle(model, receiver);
  if (!own.link.is_white_noise_only()) take(stages_of(own.link, own.noise_variance, noise, receiver));
}

Link Link::radio(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t receiver) {
  const std::optional<FeedForward>& given = vehicle(model, receiver).feed_forward;
  if (!given) throw std::logic_error("vehicle_" + std::to_string(receiver) + " has no radio");
  LinkModel link = given->link;
  if (link.delay < 1) throw std::invalid_argument("delay of a radio: 0: must be >= 1");
  --link.delay;
  Link radio(stages_of(link, given->noise_variance, noise, receiver + kRadioReceiver));
  radio.length_ = vehicle(model, receiver - 1).length;
  return radio;
}

Link::Link(std::vector<std::unique_ptr<LinkStage>> stages) : noise_(0.0, 0, 1) {
  take(std::move(stages));
}

void Link::take(std::vector<std::unique_ptr<LinkStage>> stages) {
  stages_ = std::move(stages);
  for (const auto& stage : stages_) {
    keeps_state_ = keeps_state_ || stage->keeps_state();
    depends_on_gap_ = depends_on_gap_ || stage->depends_on_gap();
  }
}

void Link::transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                    double* received, const LinkEnds& before) {
  if (stages_.empty()) return noise_.transmit(step, first_realization, sent, count, received);
  std::copy_n(sent, count, received);
  if (depends_on_gap_ && step >= 0) {
    if (before.predecessor == nullptr || before.own == nullptr)
      throw std::logic_error("losses by the gap need the positions of the step before");
    gaps_.resize(count);
    for (std::size_t r = 0; r < count; ++r) gaps_[r] = before.predecessor[r] - before.own[r] - length_;
    for (const auto& stage : stages_) {
      if (stage->depends_on_gap()) stage->see_gaps(count, gaps_.data());
    }
  }
  for (const auto& stage : stages_) {
    if (step < 0) {
      stage->start(first_realization, count, received, slope_);
    } else {
      stage->step(step, first_realization, count, received);
    }
  }
}

}  // namespace platoon
