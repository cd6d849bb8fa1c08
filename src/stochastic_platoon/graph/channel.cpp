#include "stochastic_platoon/graph/channel.hpp"

#include <boost/function.hpp>

#include "stochastic_platoon/graph/wire.hpp"

namespace platoon {

using stochastic_platoon::Position;

Channel::Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first,
                 std::uint32_t last, const MessagePool& messages)
    : messages_(messages) {
  for (std::uint32_t i = first; i <= last; ++i) {
    links_.push_back({NoisyChannel(configuration.model.noise_variance, configuration.run.seed, i),
                      platoon.advertise<Position>(predecessor_position_topic(i), kUnboundedQueue),
                      ros::Subscriber()});
  }
  for (std::uint32_t i = first; i <= last; ++i) {
    Link& link = links_[i - first];
    const boost::function<void(const Position::ConstPtr&)> receive =
        [this, &link](const Position::ConstPtr& message) { transmit(link, message); };
    link.sent = platoon.subscribe<Position>(position_topic(i - 1), kUnboundedQueue, receive,
                                            ros::VoidConstPtr(), no_delay());
  }
}

void Channel::transmit(const Link& link, const Position::ConstPtr& message) {
  const auto received = messages_.take();
  received->header = message->header;
  set_turn(turn_of(*message), *received);
  link.noise.transmit(message->step, message->first_realization, message->position, received->position);
  publish(link.received, received);
}

}  // namespace platoon
