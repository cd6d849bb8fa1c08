#include "stochastic_platoon/ros/nodes/follower.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/delivery/pipeline.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

bool is_measured(const Configuration& configuration, std::size_t follower) {
  const std::vector<std::size_t> measured = measured_followers(configuration);
  return std::binary_search(measured.begin(), measured.end(), follower);
}

}  // namespace

Follower::Follower(ros::NodeHandle platoon, const std::optional<Configuration>& present, std::uint32_t index, bool kept,
                   const MessagePool& messages, Joined joined)
    : platoon_(platoon),
      index_(index),
      kept_(kept),
      joined_(std::move(joined)),
      membership_(platoon, vehicle_name(index), 0,
                  [this](const Configuration& configuration) {
                    begin(configuration);
                    return true;
                  }),
      messages_(messages),
      position_(platoon.advertise<Position>(position_topic(index), kUnboundedQueue)) {
  if (kept_) {
    advertise_input();
    stream_of(predecessor_input_topic(index));
  }
  if (kept_ || !present) stream_of(predecessor_position_topic(index));
  if (present) membership_.join(*present);
  for (const auto& [topic, stream] : streams_) sources_.push_back(&stream.input.counter());
  // Last: the receiving thread may call back before the constructor returns.
  subscribe();
}

void Follower::begin(const Configuration& configuration) {
  const std::size_t followers = configuration.run.followers;
  if (index_ < 1 || index_ > followers) {
    throw ConfigurationError({"~index: " + std::to_string(index_) + ": must be a whole number from 1 to " +
                              std::to_string(followers) + ", the number of followers"});
  }
  const BatchSchedule schedule = configuration.run.schedule();
  const VehicleModel& own = vehicle(configuration.model, index_);
  run_state_.emplace(RunState{schedule,
                              publishes_ahead(index_, followers, configuration.run.pipeline_depth()),
                              sends_input(configuration.model, index_, followers) || is_measured(configuration, index_),
                              platoon_period(configuration.model.sample_period),
                              FollowerVehicle(configuration.model, configuration.run.seed, index_),
                              {},
                              MessageSets<Message::ConstPtr>(own.inputs.size())});
  if (run_state_->sends_input && !own_input_) advertise_input();
  for (auto& [topic, stream] : streams_) stream.number.reset();
  for (std::size_t n = 0; n < own.inputs.size(); ++n) {
    run_state_->heard.push_back({MessageOrder(schedule), source_of(own.inputs[n], index_)});
    stream_of(received_topic(own, index_, n)).number = n;
  }
  if (subscribes_) subscribe();
  if (joined_) joined_(configuration);
}

void Follower::advertise_input() {
  own_input_ = platoon_.advertise<Position>(input_topic(index_), kUnboundedQueue);
}

Follower::Stream& Follower::stream_of(const std::string& topic) {
  return streams_.try_emplace(topic, Stream{PositionInput(membership_, platoon_, topic)}).first->second;
}

void Follower::subscribe() {
  std::vector<Stream*> added;
  for (auto& [topic, stream] : streams_) {
    if (!std::exchange(stream.is_subscribed, true)) added.push_back(&stream);
  }
  subscribes_ = true;
  for (Stream* const stream : added)
    stream->input.subscribe([this, stream](const PositionEvent& event) { receive(*stream, event); });
}

// While nodes come up, a vehicle reaches the step before its own number at most.
void Follower::receive(Stream& stream, const PositionEvent& event) {
  if (!stream.number) return;
  Heard& heard = run_state_->heard[*stream.number];
  const auto first_loss = static_cast<std::int64_t>(heard.source) + 1;
  if (!stream.input.takes(descriptor_of(*event.getConstMessage()), heard.order, first_loss)) return;
  run_state_->sets.add(*stream.number, event.getConstMessage());
  run_state_->sets.visit(membership_.run(), [this](const auto& received) { move_on(received); });
}

void Follower::move_on(const std::vector<Message::ConstPtr>& received) {
  const MessageId id = id_of(*received.front());
  const ros::Time stamp = received.front()->header.stamp;
  const std::size_t size = received.front()->position.size();
  if (id.step == kInitialStep) {
    const Own initial = new_messages(size);
    run_state_->vehicle.start(first_noise_realization(run_state_->schedule, id), size, initial.position->position);
    if (initial.input) initial.input->position.assign(size, 0.0);
    publish(initial, id, stamp);
  } else if (!run_state_->is_ahead) {
    publish(std::exchange(run_state_->upcoming, {}), id, stamp);
  }
  if (run_state_->schedule.is_last_step(id.step)) return;
  const Own next = new_messages(size);
  FollowerVehicle::Received values;
  for (const Message::ConstPtr& input : received) values.push_back(input->position.data());
  run_state_->vehicle.step(values, next.position->position.data(), next.input ? next.input->position.data() : nullptr);
  if (run_state_->is_ahead) {
    publish(next, {id.attempt, id.first_realization, id.step + 1}, later(stamp, run_state_->period));
  } else {
    run_state_->upcoming = next;
  }
}

Follower::Own Follower::new_messages(std::size_t size) {
  Own own{messages_.take(), run_state_->sends_input ? messages_.take() : nullptr};
  for (const Message::Ptr& message : {own.position, own.input}) {
    if (message) message->position.resize(size);
  }
  return own;
}

void Follower::publish(const Own& own, const MessageId& id, const ros::Time& stamp) {
  for (const Message::Ptr& message : {own.position, own.input}) {
    if (!message) continue;
    set_id(membership_.run(), id, *message);
    message->header.stamp = stamp;
  }
  platoon::publish(position_, own.position);
  if (own.input) platoon::publish(*own_input_, own.input);
}

}  // namespace platoon
