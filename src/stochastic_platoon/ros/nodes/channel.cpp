#include "stochastic_platoon/ros/nodes/channel.hpp"

#include <boost/function.hpp>
#include <string>
#include <utility>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

// For each follower from first to last whether it has a radio.
std::vector<bool> radios_of(const Configuration& configuration, std::uint32_t first, std::uint32_t last) {
  std::vector<bool> radios;
  for (std::uint32_t i = first; i <= last; ++i)
    radios.push_back(vehicle(configuration.model, i).feed_forward.has_value());
  return radios;
}

}  // namespace

Channel::Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first, std::uint32_t last,
                 const MessagePool& messages, std::shared_ptr<Snapshots> told, RunMembership::Join superseded)
    : superseded_(std::move(superseded)),
      run_(configuration.run),
      first_(first),
      radios_(radios_of(configuration, first, last)),
      membership_(platoon, "channel", 0, [this](const Configuration& joined) { begin(joined); }),
      messages_(messages),
      told_(std::move(told)) {
  if (const std::string reason = slow_noise(); !reason.empty()) ROS_WARN_STREAM_ONCE(reason);
  const auto add = [&](std::uint32_t follower, bool radio, const std::string& from, const std::string& to) {
    wires_.push_back({follower, radio, std::nullopt, std::nullopt,
                      PositionInput(membership_, platoon.resolveName(from), " (channel)"),
                      platoon.advertise<Position>(to, kUnboundedQueue), ros::Subscriber()});
  };
  for (std::uint32_t i = first; i <= last; ++i) {
    add(i, false, position_topic(i - 1), predecessor_position_topic(i));
    if (radios_[i - first]) add(i, true, input_topic(i - 1), predecessor_input_topic(i));
  }
  membership_.join(configuration);
  for (Wire& wire : wires_) {
    const boost::function<void(const PositionEvent&)> receive = [this, &wire](const PositionEvent& event) {
      transmit(wire, event);
    };
    const std::string from = wire.radio ? input_topic(wire.follower - 1) : position_topic(wire.follower - 1);
    wire.sent = platoon.subscribe<Position, const PositionEvent&>(from, kUnboundedQueue, receive, ros::VoidConstPtr(),
                                                                  no_delay());
  }
}

void Channel::begin(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  const auto last = first_ + static_cast<std::uint32_t>(radios_.size()) - 1;
  if (run.followers != run_.followers || run.batch != run_.batch || run.record != run_.record ||
      radios_of(configuration, first_, last) != radios_) {
    over_ = true;
    return superseded_(configuration);
  }
  run_ = run;
  told_->set_rate(run.rate);
  for (Wire& wire : wires_) {
    wire.link.emplace(wire.radio ? Link::radio(configuration.model, run.seed, wire.follower)
                                 : Link(configuration.model, run.seed, wire.follower));
    wire.order.reset();
    if (wire.link->keeps_state()) wire.order.emplace(run.schedule());
  }
}

VitalSigns::Sources Channel::sources() const {
  VitalSigns::Sources all;
  for (const Wire& wire : wires_) all.emplace_back(&wire.input.activity(), &wire.input.drops());
  return all;
}

void Channel::transmit(Wire& wire, const PositionEvent& event) {
  const Position::ConstPtr message = event.getMessage();
  const MessageId id = id_of(*message);
  if (!wire.input.admits(event) || over_) return;
  if (wire.order) {
    if (!wire.input.takes(descriptor_of(*message), *wire.order, wire.follower)) return;
  } else {
    wire.input.takes(DropReason::none, id, message->position.size());
  }
  const auto received = messages_.take();
  received->header = message->header;
  set_id(message->run, id, *received);
  wire.link->transmit(id.step, first_noise_realization(run_.schedule(), id), message->position, received->position);
  if (!wire.radio && told_->wanted()) told_->take(wire.follower - 1, *received);
  publish(wire.received, received);
}

}  // namespace platoon
