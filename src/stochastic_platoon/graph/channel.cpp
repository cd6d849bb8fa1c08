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
    links_.push_back({NoisyChannel(configuration.model.noise_variance, configuration.run.seed, i),
                      SolePublisher(platoon.resolveName(position_topic(i - 1))),
                      DropCounter(platoon.resolveName(position_topic(i - 1)) + " (channel)"),
                      platoon.advertise<Position>(predecessor_position_topic(i), kUnboundedQueue),
                      ros::Subscriber()});
  }
  for (std::uint32_t i = first; i <= last; ++i) {
    Link& link = links_[i - first];
    const boost::function<void(const PositionEvent&)> receive = [this, &link](const PositionEvent& event) {
      transmit(link, event);
    };
    link.sent = platoon.subscribe<Position, const PositionEvent&>(position_topic(i - 1), kUnboundedQueue,
                                                                  receive, ros::VoidConstPtr(), no_delay());
  }
}

void Channel::transmit(Link& link, const PositionEvent& event) {
  const Position::ConstPtr message = event.getMessage();
  const MessageId id = id_of(*message);
  if (!membership_.admits(message->run))
    return link.drops.count(Verdict::foreign_run, id, message->position.size());
  if (!link.sender.admits(event.getConnectionHeaderPtr(), message->run)) return;
  const auto received = messages_.take();
  received->header = message->header;
  set_id(message->run, id, *received);
  link.noise.transmit(id.step, first_noise_realization(schedule_, id), message->position, received->position);
  publish(link.received, received);
}

}  // namespace platoon
