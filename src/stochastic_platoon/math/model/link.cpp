#include "stochastic_platoon/math/model/link.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/math/model/coloured_noise.hpp"
#include "stochastic_platoon/math/model/delay_line.hpp"
#include "stochastic_platoon/math/model/packet_loss.hpp"
#include "stochastic_platoon/math/model/quantiser.hpp"

namespace platoon {

namespace {

// The only place that defines the order of the stages.
std::vector<std::unique_ptr<LinkStage>> stages_of(const LinkModel& link, double noise_variance, std::uint64_t seed,
                                                  std::uint32_t receiver) {
  std::vector<std::unique_ptr<LinkStage>> stages;
  if (link.quantisation_step > 0.0)
    stages.push_back(std::make_unique<Quantiser>(link.quantisation_step, seed, receiver));
  if (noise_variance > 0.0)
    stages.push_back(std::make_unique<ColouredNoise>(noise_variance, link.noise_filter, seed, receiver));
  if (link.delay > 0) stages.push_back(std::make_unique<DelayLine>(link.delay));
  if (link.loss && link.loss->probability > 0.0)
    stages.push_back(std::make_unique<PacketLoss>(*link.loss, seed, receiver));
  return stages;
}

}  // namespace

Link::Link(const PlatoonModel& model, std::uint64_t seed, std::uint32_t receiver)
    : noise_(vehicle(model, receiver).noise_variance, seed, receiver) {
  const VehicleModel own = vehicle(model, receiver);
  if (!own.link.is_white_noise_only()) take(stages_of(own.link, own.noise_variance, seed, receiver));
}

Link Link::radio(const PlatoonModel& model, std::uint64_t seed, std::uint32_t receiver) {
  constexpr std::uint32_t kRadio = 1u << 23;
  const std::optional<FeedForward>& given = vehicle(model, receiver).feed_forward;
  if (!given) throw std::logic_error("vehicle_" + std::to_string(receiver) + " has no radio");
  LinkModel link = given->link;
  if (link.delay < 1) throw std::invalid_argument("delay of a radio: 0: must be >= 1");
  --link.delay;
  return Link(stages_of(link, given->noise_variance, seed, receiver + kRadio));
}

Link::Link(std::vector<std::unique_ptr<LinkStage>> stages) : noise_(0.0, 0, 1) {
  take(std::move(stages));
}

void Link::take(std::vector<std::unique_ptr<LinkStage>> stages) {
  stages_ = std::move(stages);
  for (const auto& stage : stages_) keeps_state_ = keeps_state_ || stage->keeps_state();
}

void Link::transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                    double* received) {
  if (stages_.empty()) return noise_.transmit(step, first_realization, sent, count, received);
  std::copy_n(sent, count, received);
  for (const auto& stage : stages_) {
    if (step < 0) {
      stage->start(first_realization, count, received);
    } else {
      stage->step(step, first_realization, count, received);
    }
  }
}

}  // namespace platoon
