#include "stochastic_platoon/ros/nodes/channel.hpp"

#include <string>
#include <utility>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon {

using stochastic_platoon::Position;

Channel::Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first, std::uint32_t last,
                 const MessagePool& messages, std::shared_ptr<Snapshots> told, RunMembership::Join superseded)
    : superseded_(std::move(superseded)),
      run_(configuration.run),
      first_(first),
      last_(last),
      kinds_(kinds_of(configuration, first, last)),
      membership_(platoon, "channel", 0, [this](const Configuration& joined) { return begin(joined); }),
      platoon_(platoon),
      messages_(messages),
      told_(std::move(told)) {
  if (const std::string reason = slow_noise(); !reason.empty()) ROS_WARN_STREAM_ONCE(reason);
  for (const Kind& kind : kinds_) wires_.push_back(wire(kind));
  membership_.join(configuration);
  for (Wire& wire : wires_) {
    if (!wire.own) {
      hear(wire.sent, [this, &wire](const PositionEvent& event) { transmit(wire, *event.getMessage(), {}); });
      continue;
    }
    const auto move_on = [this, &wire] {
      using Ends = const Position*;
      wire.waiting.visit(membership_.run(), [this, &wire](const Position& sent, Ends predecessor, Ends own) {
        transmit(wire, sent,
                 own == nullptr ? LinkEnds{} : LinkEnds{predecessor->position.data(), own->position.data()});
      });
    };
    hear(wire.sent, [&wire, move_on](const PositionEvent& event) {
      wire.waiting.add_sent(event.getMessage());
      if (!wire.predecessor) wire.waiting.add_predecessor(event.getMessage());
      move_on();
    });
    hear(*wire.own, [&wire, move_on](const PositionEvent& event) {
      wire.waiting.add_own(event.getMessage());
      move_on();
    });
    if (!wire.predecessor) continue;
    hear(*wire.predecessor, [&wire, move_on](const PositionEvent& event) {
      wire.waiting.add_predecessor(event.getMessage());
      move_on();
    });
  }
}

std::vector<Channel::Kind> Channel::kinds_of(const Configuration& configuration, std::uint32_t first,
                                             std::uint32_t last) {
  const auto by_gap = [](const LinkModel& link) { return link.loses() && link.loss->by_distance; };
  std::vector<Kind> kinds;
  for (std::uint32_t i = first; i <= last; ++i) {
    const VehicleModel& of = vehicle(configuration.model, i);
    kinds.push_back({i, false, by_gap(of.link)});
    if (of.feed_forward) kinds.push_back({i, true, by_gap(of.feed_forward->link)});
  }
  return kinds;
}

Channel::Stream Channel::stream(const std::string& topic, std::uint32_t first_loss) {
  return {PositionInput(membership_, platoon_, topic, " (channel)"), first_loss, std::nullopt};
}

Channel::Wire Channel::wire(const Kind& kind) {
  const std::uint32_t i = kind.follower;
  Wire wire{kind,
            std::nullopt,
            stream(kind.radio ? input_topic(i - 1) : position_topic(i - 1), i),
            platoon_.advertise<Position>(kind.radio ? predecessor_input_topic(i) : predecessor_position_topic(i),
                                         kUnboundedQueue),
            std::nullopt,
            std::nullopt};
  if (kind.depends_on_gap) wire.own.emplace(stream(position_topic(i), i + 1));
  if (kind.depends_on_gap && kind.radio) wire.predecessor.emplace(stream(position_topic(i - 1), i));
  return wire;
}

template <class Take>
void Channel::hear(Stream& stream, const Take& take) {
  stream.input.subscribe([this, &stream, take](const PositionEvent& event) {
    if (takes(stream, event)) take(event);
  });
}

template <class AnyWire, class Visit>
void Channel::for_each_stream(AnyWire& wire, const Visit& visit) {
  visit(wire.sent);
  if (wire.own) visit(*wire.own);
  if (wire.predecessor) visit(*wire.predecessor);
}

bool Channel::begin(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  if (run.followers != run_.followers || run.batch != run_.batch || run.record != run_.record ||
      !(kinds_of(configuration, first_, last_) == kinds_)) {
    return superseded_(configuration);
  }
  run_ = run;
  told_->set_rate(run.rate);
  for (Wire& wire : wires_) {
    wire.link.emplace(wire.kind.radio ? Link::radio(configuration.model, run.seed, wire.kind.follower)
                                      : Link(configuration.model, run.seed, wire.kind.follower));
    wire.waiting = {};
    for_each_stream(wire, [&wire, &run](Stream& stream) {
      stream.order.reset();
      if (wire.link->keeps_state()) stream.order.emplace(run.schedule());
    });
  }
  return true;
}

VitalSigns::Sources Channel::sources() const {
  VitalSigns::Sources all;
  for (const Wire& wire : wires_) {
    for_each_stream(wire, [&all](const Stream& stream) { all.push_back(&stream.input.counter()); });
  }
  return all;
}

bool Channel::takes(Stream& stream, const PositionEvent& event) {
  const Position& message = *event.getConstMessage();
  if (membership_.is_over()) return false;
  if (stream.order) return stream.input.takes(descriptor_of(message), *stream.order, stream.first_loss);
  return stream.input.takes(DropReason::none, id_of(message), message.position.size());
}

void Channel::transmit(Wire& wire, const Position& message, const LinkEnds& before) {
  const MessageId id = id_of(message);
  const auto received = messages_.take();
  received->header = message.header;
  set_id(message.run, id, *received);
  wire.link->transmit(id.step, first_noise_realization(run_.schedule(), id), message.position, received->position,
                      before);
  if (!wire.kind.radio && told_->wanted()) told_->take(wire.kind.follower - 1, *received);
  publish(wire.received, received);
}

}  // namespace platoon
