#include "stochastic_platoon/ros/transport/position_input.hpp"

#include "stochastic_platoon/ros/messages/position.hpp"

namespace platoon {

PositionInput::PositionInput(RunMembership& membership, const std::string& topic, const std::string& receiver,
                             const std::string& external)
    : membership_(&membership),
      publisher_(topic, external.empty() ? "" : "; the vehicle is external: " + named(Clause::one_publisher)),
      drops_(topic + receiver, external) {}

bool PositionInput::admits(const PositionEvent& event) {
  const stochastic_platoon::Position& message = *event.getConstMessage();
  if (membership_->admits(message.run)) return publisher_.admits(event.getConnectionHeaderPtr(), message.run);
  if (!membership_->is_over()) drops_.count(DropReason::foreign_run, id_of(message), message.position.size());
  return false;
}

bool PositionInput::takes(const MessageDescriptor& descriptor, MessageOrder& order, std::int64_t first_loss) {
  const DropReason drop = order.receive(descriptor);
  if (order.has_missed(drop, descriptor.id, first_loss)) membership_->tell_missed(descriptor.id.attempt);
  return takes(drop, descriptor.id, descriptor.size);
}

bool PositionInput::takes(DropReason drop, const MessageId& id, std::size_t size) {
  if (drop != DropReason::none) {
    drops_.count(drop, id, size);
    return false;
  }
  drops_.forget_breach();
  activity_.count(id);
  return true;
}

}  // namespace platoon
