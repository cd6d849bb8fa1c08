#include "stochastic_platoon/math/channel/link.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"

namespace platoon {

namespace {

// The only place that defines the order of the stages.
std::vector<std::unique_ptr<LinkStage>> stages_of(const Input& input, const WhiteNoise& noise, std::uint32_t stream,
                                                  std::uint32_t loss_stream) {
  std::vector<std::unique_ptr<LinkStage>> stages;
  const auto add = [&stages](std::unique_ptr<LinkStage> stage) {
    if (stage != nullptr) stages.push_back(std::move(stage));
  };
  add(quantiser(input, noise, stream));
  add(coloured_noise(input, noise, stream));
  add(delay_line(input));
  if (input.link.loses()) add(packet_loss(*input.link.loss, noise, loss_stream));
  return stages;
}

}  // namespace

std::uint32_t loss_stream(const PlatoonModel& model, std::uint32_t receiver, std::uint32_t input) {
  return input_stream(receiver, static_cast<std::uint32_t>(vehicle(model, receiver).losses_of(input)));
}

Link::Link(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t receiver, std::uint32_t input)
    : noise_(vehicle(model, receiver).inputs.at(input).noise_variance, noise, input_stream(receiver, input)),
      length_(vehicle(model, receiver - 1).length) {
  const Input& own = vehicle(model, receiver).inputs[input];
  if (own.delay() < 0) throw std::invalid_argument("delay of a radio: 0: must be >= 1");
  if (own.signal == InputSignal::position) slope_ = start_slope(model);
  if (!own.link.is_white_noise_only())
    take(stages_of(own, noise, input_stream(receiver, input), loss_stream(model, receiver, input)));
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
