#include "stochastic_platoon/ros/nodes/follower.hpp"

#include <utility>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/delivery/pipeline.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

Follower::Follower(ros::NodeHandle platoon, const std::optional<Configuration>& present, std::uint32_t index,
                   const MessagePool& messages, Joined joined)
    : index_(index),
      joined_(std::move(joined)),
      membership_(platoon, vehicle_name(index), 0,
                  [this](const Configuration& configuration) { begin(configuration); }),
      input_(membership_, platoon.resolveName(predecessor_position_topic(index))),
      messages_(messages),
      position_(platoon.advertise<Position>(position_topic(index), kUnboundedQueue)) {
  if (present) membership_.join(*present);
  // Last: the receiving thread may call back before the constructor returns.
  predecessor_position_ =
      platoon.subscribe(predecessor_position_topic(index), kUnboundedQueue, &Follower::receive, this, no_delay());
}

void Follower::begin(const Configuration& configuration) {
  const std::size_t followers = configuration.run.followers;
  if (index_ < 1 || index_ > followers) {
    throw ConfigurationError({"~index: " + std::to_string(index_) + ": must be a whole number from 1 to " +
                              std::to_string(followers) + ", the number of followers"});
  }
  const BatchSchedule schedule = configuration.run.schedule();
  run_state_.emplace(RunState{schedule, publishes_ahead(index_, followers, configuration.run.pipeline_depth()),
                              platoon_period(configuration.model.sample_period),
                              FollowerVehicle(configuration.model, configuration.run.seed, index_),
                              MessageOrder(schedule)});
  if (joined_) joined_(configuration);
}

void Follower::receive(const PositionEvent& event) {
  const Position::ConstPtr message = event.getMessage();
  if (!input_.admits(event)) return;
  const MessageDescriptor descriptor = descriptor_of(*message);
  // While nodes come up, the predecessor reaches step i - 2 at most.
  if (!input_.takes(descriptor, run_state_->order, index_)) return;
  const MessageId& id = descriptor.id;
  const ros::Time stamp = message->header.stamp;
  if (id.step == kInitialStep) {
    const auto initial = messages_.take();
    run_state_->vehicle.start(first_noise_realization(run_state_->schedule, id), descriptor.size, initial->position);
    publish(initial, id, stamp);
  } else if (!run_state_->is_ahead) {
    publish(std::exchange(run_state_->upcoming, nullptr), id, stamp);
  }
  if (run_state_->schedule.is_last_step(id.step)) return;
  const auto next = messages_.take();
  run_state_->vehicle.step(message->position, next->position);
  if (run_state_->is_ahead) {
    publish(next, {id.attempt, id.first_realization, id.step + 1}, later(stamp, run_state_->period));
  } else {
    run_state_->upcoming = next;
  }
}

void Follower::publish(const Position::Ptr& message, const MessageId& id, const ros::Time& stamp) {
  set_id(membership_.run(), id, *message);
  message->header.stamp = stamp;
  platoon::publish(position_, message);
}

}  // namespace platoon
