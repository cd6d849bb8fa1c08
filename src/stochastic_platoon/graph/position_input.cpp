#include "stochastic_platoon/graph/position_input.hpp"

#include "stochastic_platoon/messages/position.hpp"

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
  const DropReason verdict = order.receive(descriptor);
  if (order.has_missed(verdict, descriptor.id, first_loss)) membership_->tell_missed(descriptor.id.attempt);
  return takes(verdict, descriptor.id, descriptor.size);
}

bool PositionInput::takes(DropReason verdict, const MessageId& id, std::size_t size) {
  if (verdict != DropReason::none) {
    drops_.count(verdict, id, size);
    return false;
  }
  drops_.forget_breach();
  activity_.count(id);
  return true;
}

}  // namespace platoon
