#include "stochastic_platoon/graph/vehicle_replay.hpp"

#include <cmath>
#include <cstring>

#include "stochastic_platoon/graph/transport.hpp"
#include "stochastic_platoon/io/text.hpp"
#include "stochastic_platoon/messages/topics.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

std::function<bool(const PlatoonTopic&)> only(PlatoonTopic::Kind kind, std::size_t vehicle) {
  return
      [kind, vehicle](const PlatoonTopic& topic) { return topic.kind == kind && topic.vehicle == vehicle; };
}

}  // namespace

VehicleReplay::VehicleReplay(ros::NodeHandle platoon, const Configuration& configuration,
                             const std::vector<std::string>& bags, std::size_t vehicle, bool own)
    : name_("vehicle_" + std::to_string(vehicle)),
      run_(run_identity(configuration)),
      window_(configuration.run.window),
      own_(own),
      inputs_(bags, only(PlatoonTopic::Kind::predecessor_position, vehicle)),
      outputs_(bags, only(PlatoonTopic::Kind::position, vehicle)),
      expected_(outputs_.next()),
      done_(!expected_),
      predecessor_position_(
          platoon.advertise<Position>(predecessor_position_topic(vehicle), kUnboundedQueue)),
      position_(platoon.subscribe(position_topic(vehicle), kUnboundedQueue, &VehicleReplay::receive, this,
                                  no_delay())) {
  timer_ = platoon.createSteadyTimer(ros::WallDuration(0.02), [this](const auto&) { play(); });
}

// Nothing is sent before both links are up: there is no second attempt here.
void VehicleReplay::play() {
  if (predecessor_position_.getNumSubscribers() == 0 || position_.getNumPublishers() == 0) return;
  while (!done_ && sent_ - received_ < window_) {
    const std::optional<RecordedPosition> input = inputs_.next();
    if (!input) return;
    input->message->run = run_;
    predecessor_position_.publish(input->message);
    ++sent_;
  }
}

void VehicleReplay::receive(const Message& message) {
  if (done_) return;
  ++received_;
  compare(*message, *expected_->message);
  expected_ = outputs_.next();
  done_ = !expected_;
  play();
}

void VehicleReplay::compare(const Position& live, const Position& recorded) {
  if (!difference_.empty()) return;
  const bool same_message = live.run == run_ && live.attempt == recorded.attempt &&
                            live.first_realization == recorded.first_realization &&
                            live.step == recorded.step && live.position.size() == recorded.position.size();
  const std::size_t bytes = recorded.position.size() * sizeof(double);
  if (same_message && std::memcmp(live.position.data(), recorded.position.data(), bytes) == 0) return;
  if (same_message && own_) {
    for (std::size_t r = 0; r < recorded.position.size(); ++r) {
      const double apart = std::abs(live.position[r] - recorded.position[r]);
      if (apart > largest_ || std::isnan(apart)) largest_ = apart;  // a NaN stays
    }
    return;
  }
  difference_ = formatted("step %lld of the realizations from %llu", static_cast<long long>(recorded.step),
                          static_cast<unsigned long long>(recorded.first_realization));
  for (std::size_t r = 0; same_message && r < recorded.position.size(); ++r) {
    if (live.position[r] == recorded.position[r]) continue;
    difference_ += formatted(": realization %zu is at %.17g m, was at %.17g m", r, live.position[r],
                             recorded.position[r]);
    break;
  }
}

std::string VehicleReplay::verdict() const {
  if (!difference_.empty()) return name_ + " differs from the recording at " + difference_;
  if (largest_ != 0.0) {
    return name_ + formatted(": %lld messages as in the recording, positions at most %.3g m apart",
                             static_cast<long long>(received_), largest_);
  }
  return name_ +
         formatted(": %lld messages equal the recorded ones to the bit", static_cast<long long>(received_));
}

}  // namespace platoon
