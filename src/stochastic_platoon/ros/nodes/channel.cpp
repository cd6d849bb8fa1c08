#include "stochastic_platoon/ros/nodes/channel.hpp"

#include <string>
#include <tuple>
#include <utility>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"

namespace platoon {

using stochastic_platoon::Position;

Channel::Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first, std::uint32_t last,
                 const MessagePool& messages, std::shared_ptr<Snapshots> snapshots, RunMembership::Join superseded)
    : superseded_(std::move(superseded)),
      run_(configuration.run),
      first_(first),
      last_(last),
      kinds_(kinds_of(configuration, first, last)),
      membership_(platoon, "channel", 0, [this](const Configuration& joined) { return begin(joined); }),
      platoon_(platoon),
      messages_(messages),
      snapshots_(std::move(snapshots)) {
  if (const std::string reason = slow_noise(); !reason.empty()) ROS_WARN_STREAM_ONCE(reason);
  for (const Kind& kind : kinds_) wires_.push_back(wire(kind));
  membership_.join(configuration);
  for (Wire& wire : wires_) {
    for (Stream& stream : wire.streams) {
      stream.input.subscribe([this, &wire, &stream](const PositionEvent& event) {
        if (takes(stream, event)) receive(wire, stream.role, event.getMessage());
      });
    }
  }
}

bool operator==(const Channel::Kind& one, const Channel::Kind& other) {
  const auto all = [](const Channel::Kind& kind) {
    return std::tie(kind.follower, kind.input, kind.source, kind.signal, kind.sent, kind.received, kind.depends_on_gap);
  };
  return all(one) == all(other);
}

std::vector<Channel::Kind> Channel::kinds_of(const Configuration& configuration, std::uint32_t first,
                                             std::uint32_t last) {
  std::vector<Kind> kinds;
  for (std::uint32_t i = first; i <= last; ++i) {
    const std::vector<Input>& inputs = vehicle(configuration.model, i).inputs;
    for (std::uint32_t n = 0; n < inputs.size(); ++n) {
      const LinkModel& link = inputs[n].link;
      kinds.push_back({i, n, static_cast<std::uint32_t>(source_of(inputs[n], i)), inputs[n].signal,
                       sent_topic(inputs[n], i), received_topic(vehicle(configuration.model, i), i, n),
                       link.loses() && link.loss->by_distance});
    }
  }
  return kinds;
}

Channel::Wire Channel::wire(const Kind& kind) {
  const std::uint32_t i = kind.follower;
  Wire wire{kind, platoon_.advertise<Position>(kind.received, kUnboundedQueue)};
  const auto add = [this, &wire](Role role, const std::string& topic, std::uint32_t vehicle) {
    wire.streams.push_back({role, PositionInput(membership_, platoon_, topic, " (channel)"), vehicle + 1});
  };
  add(Role::sent, kind.sent, kind.source);
  if (kind.depends_on_gap) add(Role::own, position_topic(i), i);
  if (kind.depends_on_gap && kind.signal != InputSignal::position) add(Role::predecessor, position_topic(i - 1), i - 1);
  return wire;
}

bool Channel::begin(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  if (run.followers != run_.followers || run.batch != run_.batch || run.record != run_.record ||
      !(kinds_of(configuration, first_, last_) == kinds_)) {
    return superseded_(configuration);
  }
  run_ = run;
  slope_ = start_slope(configuration.model);
  snapshots_->set_rate(run.rate);
  for (Wire& wire : wires_) {
    wire.link.emplace(configuration.model, run.seed, wire.kind.follower, wire.kind.input);
    wire.difference.reset();
    if (is_difference(wire.kind.signal))
      wire.difference = difference(wire.kind.signal, configuration.model.sample_period);
    wire.waiting = {};
    for (Stream& stream : wire.streams) {
      stream.order.reset();
      if (wire.link->keeps_state() || wire.difference) stream.order.emplace(run.schedule());
    }
  }
  return true;
}

VitalSigns::Sources Channel::sources() const {
  VitalSigns::Sources all;
  for (const Wire& wire : wires_) {
    for (const Stream& stream : wire.streams) all.push_back(&stream.input.counter());
  }
  return all;
}

bool Channel::takes(Stream& stream, const PositionEvent& event) {
  const Position& message = *event.getConstMessage();
  if (membership_.is_over()) return false;
  if (stream.order) return stream.input.takes(descriptor_of(message), *stream.order, stream.first_loss);
  return stream.input.takes(DropReason::none, id_of(message), message.position.size());
}

void Channel::receive(Wire& wire, Role role, const Position::ConstPtr& message) {
  if (!wire.kind.depends_on_gap) return transmit(wire, *message, {});
  if (role == Role::sent) wire.waiting.add_sent(message);
  if (role == Role::own) wire.waiting.add_own(message);
  if (role == Role::predecessor || (role == Role::sent && wire.kind.signal == InputSignal::position))
    wire.waiting.add_predecessor(message);
  wire.waiting.visit(membership_.run(), [&](const Position& sent, const Position* predecessor, const Position* own) {
    transmit(wire, sent, own == nullptr ? LinkEnds{} : LinkEnds{predecessor->position.data(), own->position.data()});
  });
}

void Channel::transmit(Wire& wire, const Position& message, const LinkEnds& before) {
  const MessageId id = id_of(message);
  const auto received = messages_.take();
  received->header = message.header;
  if (!wire.kind.of_predecessors_position()) received->header.frame_id = name_of(wire.kind.signal);
  set_id(message.run, id, *received);
  wire.link->transmit(id.step, first_noise_realization(run_.schedule(), id), sent_by(wire, message), received->position,
                      before);
  if (wire.kind.of_predecessors_position() && snapshots_->wanted()) snapshots_->take(wire.kind.follower - 1, *received);
  publish(wire.received, received);
}

const std::vector<double>& Channel::sent_by(Wire& wire, const Position& message) {
  if (!wire.difference) return message.position;
  if (message.step == kInitialStep) {
    wire.positions.start(message.position.data(), message.position.size(), slope_);
  } else {
    wire.positions.add(message.position.data());
  }
  sent_.resize(wire.positions.count());
  (*wire.difference)({}, wire.positions.all(), sent_.size(), sent_.data());
  return sent_;
}

}  // namespace platoon
