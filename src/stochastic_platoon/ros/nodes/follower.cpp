#include "stochastic_platoon/ros/nodes/follower.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/delivery/pipeline.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

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
      position_(platoon.advertise<Position>(position_topic(index), kUnboundedQueue)),
      input_(membership_, platoon, predecessor_position_topic(index)),
      radio_input_(membership_, platoon, predecessor_input_topic(index)) {
  if (kept_) advertise_input();
  if (present) membership_.join(*present);
  // Last: the receiving thread may call back before the constructor returns.
  if (kept_) subscribe_to_input();
  input_.subscribe([this](const PositionEvent& event) { receive_position(event); });
}

namespace {

bool is_measured(const Configuration& configuration, std::size_t follower) {
  const std::vector<std::size_t> measured = measured_followers(configuration);
  return std::binary_search(measured.begin(), measured.end(), follower);
}

}  // namespace

void Follower::begin(const Configuration& configuration) {
  const std::size_t followers = configuration.run.followers;
  if (index_ < 1 || index_ > followers) {
    throw ConfigurationError({"~index: " + std::to_string(index_) + ": must be a whole number from 1 to " +
                              std::to_string(followers) + ", the number of followers"});
  }
  const BatchSchedule schedule = configuration.run.schedule();
  run_state_.emplace(RunState{schedule, publishes_ahead(index_, followers, configuration.run.pipeline_depth()),
                              vehicle(configuration.model, index_).radio() != nullptr,
                              sends_input(configuration.model, index_, followers) || is_measured(configuration, index_),
                              platoon_period(configuration.model.sample_period),
                              FollowerVehicle(configuration.model, configuration.run.seed, index_),
                              MessageOrder(schedule), MessageOrder(schedule)});
  if (run_state_->sends_input && !own_input_) advertise_input();
  if (run_state_->has_radio && !kept_) subscribe_to_input();
  if (joined_) joined_(configuration);
}

void Follower::advertise_input() {
  own_input_ = platoon_.advertise<Position>(input_topic(index_), kUnboundedQueue);
}

void Follower::subscribe_to_input() {
  radio_input_.subscribe([this](const PositionEvent& event) { receive_input(event); });
}

// While nodes come up, the predecessor reaches step i - 2 at most.
bool Follower::takes(PositionInput& input, MessageOrder& order, const PositionEvent& event) {
  return input.takes(descriptor_of(*event.getConstMessage()), order, index_);
}

void Follower::receive_position(const PositionEvent& event) {
  if (!takes(input_, run_state_->order, event)) return;
  if (!run_state_->has_radio) return move_on(*event.getConstMessage(), nullptr);
  run_state_->pairs.add_position(event.getConstMessage());
  match();
}

void Follower::receive_input(const PositionEvent& event) {
  if (!run_state_->has_radio || !takes(radio_input_, run_state_->radio_order, event)) return;
  run_state_->pairs.add_input(event.getConstMessage());
  match();
}

void Follower::match() {
  run_state_->pairs.visit(membership_.run(),
                          [this](const auto& position, const auto& input) { move_on(*position, input.get()); });
}

void Follower::move_on(const Message& received, const Message* input) {
  const MessageId id = id_of(received);
  const ros::Time stamp = received.header.stamp;
  const std::size_t size = received.position.size();
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
  FollowerVehicle::Received all{received.position.data()};
  if (input != nullptr) all.push_back(input->position.data());
  run_state_->vehicle.step(all, next.position->position.data(), next.input ? next.input->position.data() : nullptr);
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
