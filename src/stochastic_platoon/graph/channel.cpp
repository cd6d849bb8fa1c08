#include "stochastic_platoon/graph/channel.hpp"

#include <boost/function.hpp>
#include <utility>

#include "stochastic_platoon/messages/position.hpp"
#include "stochastic_platoon/messages/topics.hpp"

namespace platoon {

using stochastic_platoon::Position;

Channel::Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first,
                 std::uint32_t last, const MessagePool& messages, RunMembership::Join superseded)
    : membership_(platoon, "channel", run_identity(configuration), std::move(superseded)),
      schedule_(configuration.run.schedule()),
      messages_(messages) {
  for (std::uint32_t i = first; i <= last; ++i) {
    Link link(configuration.model, configuration.run.seed, i);
    const std::optional<MessageOrder> order =
        link.keeps_state() ? std::make_optional(MessageOrder(schedule_)) : std::nullopt;
    wires_.push_back({std::move(link), order, SolePublisher(platoon.resolveName(position_topic(i - 1))),
                      DropCounter(platoon.resolveName(position_topic(i - 1)) + " (channel)"),
                      platoon.advertise<Position>(predecessor_position_topic(i), kUnboundedQueue),
                      ros::Subscriber()});
  }
  for (std::uint32_t i = first; i <= last; ++i) {
    Wire& wire = wires_[i - first];
    const boost::function<void(const PositionEvent&)> receive = [this, &wire](const PositionEvent& event) {
      transmit(wire, event);
    };
    wire.sent = platoon.subscribe<Position, const PositionEvent&>(position_topic(i - 1), kUnboundedQueue,
                                                                  receive, ros::VoidConstPtr(), no_delay());
  }
}

void Channel::transmit(Wire& wire, const PositionEvent& event) {
  const Position::ConstPtr message = event.getMessage();
  const MessageId id = id_of(*message);
  if (!membership_.admits(message->run))
    return wire.drops.count(Verdict::foreign_run, id, message->position.size());
  if (!wire.sender.admits(event.getConnectionHeaderPtr(), message->run)) return;
  if (wire.order) {
    const Verdict verdict = wire.order->receive(heading_of(*message));
    if (verdict != Verdict::in_turn) return wire.drops.count(verdict, id, message->position.size());
  }
  const auto received = messages_.take();
  received->header = message->header;
  set_id(message->run, id, *received);
  wire.link.transmit(id.step, first_noise_realization(schedule_, id), message->position, received->position);
  publish(wire.received, received);
}

}  // namespace platoon
