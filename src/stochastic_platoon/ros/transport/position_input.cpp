#include "stochastic_platoon/ros/transport/position_input.hpp"

#include <boost/function.hpp>
#include <utility>

#include "stochastic_platoon/ros/messages/position.hpp"

namespace platoon {

using stochastic_platoon::Position;

PositionInput::PositionInput(RunMembership& membership, const ros::NodeHandle& node, const std::string& topic,
                             const std::string& receiver, const std::string& external)
    : membership_(&membership),
      node_(node),
      topic_(topic),
      publisher_(node.resolveName(topic),
                 external.empty() ? "" : "; the vehicle is external: " + named(Clause::one_publisher)),
      counter_(node.resolveName(topic) + receiver, external) {}

void PositionInput::subscribe(std::function<void(const PositionEvent&)> receive) {
  if (subscriber_) return;
  const boost::function<void(const PositionEvent&)> callback =
      [this, receive = std::move(receive)](const PositionEvent& event) {
        if (admits(event)) receive(event);
      };
  subscriber_ = node_.subscribe<Position, const PositionEvent&>(topic_, kUnboundedQueue, callback, ros::VoidConstPtr(),
                                                                no_delay());
}

bool PositionInput::admits(const PositionEvent& event) {
  const Position& message = *event.getConstMessage();
  if (membership_->admits(message.run)) return publisher_.admits(event.getConnectionHeaderPtr(), message.run);
  if (!membership_->is_over()) counter_.drop(DropReason::foreign_run, id_of(message), message.position.size());
  return false;
}

bool PositionInput::takes(const MessageDescriptor& descriptor, MessageOrder& order, std::int64_t first_loss) {
  const DropReason drop = order.receive(descriptor);
  if (order.has_missed(drop, descriptor.id, first_loss)) membership_->notify_missed(descriptor.id.attempt);
  return takes(drop, descriptor.id, descriptor.size);
}

bool PositionInput::takes(DropReason drop, const MessageId& id, std::size_t size) {
  if (drop != DropReason::none) {
    counter_.drop(drop, id, size);
    return false;
  }
  counter_.take(id);
  return true;
}

}  // namespace platoon
