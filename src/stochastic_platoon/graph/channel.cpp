#include "stochastic_platoon/graph/channel.hpp"

#include <boost/function.hpp>

#include "stochastic_platoon/graph/wire.hpp"

namespace platoon {

using stochastic_platoon::Position;

Channel::Channel(ros::NodeHandle platoon, const Configuration& configuration) {
  const std::size_t followers = configuration.run.followers;
  for (std::size_t i = 1; i <= followers; ++i) {
    links_.push_back({NoisyChannel(configuration.model.noise_variance, configuration.run.seed,
                                   static_cast<std::uint32_t>(i)),
                      platoon.advertise<Position>(predecessor_position_topic(i), kUnboundedQueue),
                      ros::Subscriber()});
  }
  for (std::size_t i = 1; i <= followers; ++i) {
    Link& link = links_[i - 1];
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
  link.received.publish(received);
}

}  // namespace platoon
