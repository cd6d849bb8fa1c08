#include "stochastic_platoon/graph/follower.hpp"

#include "stochastic_platoon/graph/wire.hpp"

namespace platoon {

using stochastic_platoon::Position;

Follower::Follower(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t index,
                   const MessagePool& messages)
    : schedule_(configuration.run.schedule()),
      period_(platoon_period(configuration.model.sample_period)),
      vehicle_(configuration.model, configuration.run.seed, index),
      sequence_(schedule_),
      refusals_(platoon.resolveName(predecessor_position_topic(index))),
      messages_(messages),
      position_(platoon.advertise<Position>(position_topic(index), kUnboundedQueue)),
      predecessor_position_(platoon.subscribe(predecessor_position_topic(index), kUnboundedQueue,
                                              &Follower::receive, this, no_delay())) {}

void Follower::receive(const Position::ConstPtr& message) {
  const Turn turn = turn_of(*message);
  const Verdict verdict = sequence_.receive(turn, message->position);
  if (verdict != Verdict::in_turn) return refusals_.count(verdict, turn, message->position.size());
  if (turn.step == kInitialStep) {
    const auto initial = messages_.take();
    vehicle_.start(turn.first_realization, message->position.size(), initial->position);
    publish(initial, turn, message->header.stamp);
  }
  if (schedule_.is_last_step(turn.step)) return;
  const auto next = messages_.take();
  vehicle_.step(message->position, next->position);
  publish(next, {turn.attempt, turn.first_realization, turn.step + 1}, message->header.stamp + period_);
}

void Follower::publish(const Position::Ptr& message, const Turn& turn, const ros::Time& stamp) {
  set_turn(turn, *message);
  message->header.stamp = stamp;
  platoon::publish(position_, message);
}

}  // namespace platoon
