#include "stochastic_platoon/external_vehicle.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "stochastic_platoon/run/delivery/message_pairs.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr std::uint32_t kUnbounded = 0;

void require_follower(std::size_t index) {
  if (index < 1) throw std::invalid_argument("index: 0: must be the number of a follower, 1 or more");
}

// A key of follower i: that of its type, or the default vehicle's; null if neither has it.
nlohmann::json value_of(const nlohmann::json& model, std::size_t follower, const char* key) {
  nlohmann::json common = model.value(key, nlohmann::json());
  if (!model.contains("string")) return common;
  const nlohmann::json& string = model.at("string");
  const std::string type = string.at((follower - 1) % string.size());
  return type == "default" ? common : model.at("vehicle_types").at(type).value(key, common);
}

bool hears_input(const nlohmann::json& model, std::size_t follower) {
  const nlohmann::json inputs = value_of(model, follower, "inputs");
  return std::any_of(inputs.begin(), inputs.end(), [](const auto& input) { return input.at("signal") == "input"; });
}

/// How the platoon starts: vehicle 0 moves from `first` by `slope` per step [m].
struct SteadyStart {
  bool steady;
  double first, slope;
};

SteadyStart start_of(const nlohmann::json& model) {
  bool steady = model.contains("limits");
  for (const auto& type : model.value("vehicle_types", nlohmann::json::object()))
    steady = steady || type.contains("limits");
  if (!(model.contains("start") ? model.at("start") == "steady" : steady)) return {false, 0.0, 0.0};
  const nlohmann::json& leader = model.at("leader");
  if (leader.contains("positions")) {
    const auto positions = leader.at("positions").get<std::vector<double>>();
    return {true, positions.at(0), positions.size() > 1 ? positions[1] - positions[0] : 0.0};
  }
  double slope = 0.0;
  for (const nlohmann::json& change : leader.at("speed")) {
    if (change.at("from_step") == 0) slope = model.at("sample_period").get<double>() * change.at("value").get<double>();
  }
  return {true, -slope, slope};
}

VehicleSettings settings_of(const nlohmann::json& model, std::size_t index) {
  const SteadyStart start = start_of(model);
  const auto distance_up_to = [&](std::size_t last) {
    double distance = 0.0;
    for (std::size_t i = 1; i <= last; ++i) {
      distance += value_of(model, i, "standstill_distance").get<double>();
      if (!start.steady) continue;
      const nlohmann::json channel = value_of(model, i, "channel");
      const double delay = channel.is_object() ? channel.value("delay", 0.0) : 0.0;
      distance += start.slope * (value_of(model, i, "time_headway").get<double>() + delay);
    }
    return distance;
  };
  const std::size_t length = model.contains("string") ? model.at("string").size() : 1, repetitions = index / length;
  return {value_of(model, index, "time_headway").get<double>(),
          value_of(model, index, "standstill_distance").get<double>(),
          model.at("sample_period"),
          start.first - (static_cast<double>(repetitions) * distance_up_to(length) + distance_up_to(index % length)),
          start.slope / model.at("sample_period").get<double>(),
          hears_input(model, index)};
}

}  // namespace

VehicleSettings vehicle_settings(const ros::NodeHandle& platoon, std::size_t index) {
  require_follower(index);
  std::string text;
  const std::string parameter = platoon.resolveName("configuration");
  if (!platoon.getParam(parameter, text)) throw std::runtime_error(parameter + ": absent: no launch has set it");
  try {
    return settings_of(nlohmann::json::parse(text).at("model"), index);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(parameter + ": is no configuration of a platoon: " + error.what());
  }
}

ExternalVehicle::ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, Move move)
    : ExternalVehicle(
          platoon, index, std::move(start),
          [move = std::move(move)](const auto& received, const auto&, auto& position, auto&) {
            move(received, position);
          },
          false) {}

ExternalVehicle::ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, MoveByRadio move)
    : ExternalVehicle(platoon, index, std::move(start), std::move(move), true) {}

ExternalVehicle::ExternalVehicle(const ros::NodeHandle& platoon, std::size_t index, Start start, MoveByRadio move,
                                 bool radio)
    : platoon_(platoon),
      index_(index),
      pairs_(std::make_shared<MessagePairs<Message::ConstPtr>>()),
      start_(std::move(start)),
      move_(std::move(move)) {
  require_follower(index);
  const std::string name = vehicle_name(index);
  const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay(true);
  position_ = platoon_.advertise<Position>(name + "/position", kUnbounded);
  if (radio) input_ = platoon_.advertise<Position>(name + "/input", kUnbounded);
  predecessor_position_ = platoon_.subscribe(name + "/predecessor_position", kUnbounded,
                                             &ExternalVehicle::receive_position, this, no_delay);
  if (radio) {
    predecessor_input_ =
        platoon_.subscribe(name + "/predecessor_input", kUnbounded, &ExternalVehicle::receive_input, this, no_delay);
  }
}

// Accepts the step after the latest, and a step -1 of another run, of a newer attempt or of the next batch.
bool ExternalVehicle::Stream::takes(const Message::ConstPtr& message) {
  const bool same_run = latest && message->run == latest->run;
  const bool in_turn = message->step == -1 ? !same_run || std::tie(message->attempt, message->first_realization) >
                                                              std::tie(latest->attempt, latest->first_realization)
                                           : same_run && message->attempt == latest->attempt &&
                                                 message->first_realization == latest->first_realization &&
                                                 message->step == latest->step + 1;
  if (in_turn) latest = message;
  return in_turn;
}

void ExternalVehicle::receive_position(const Message::ConstPtr& message) {
  const bool other_run = !positions_.latest || positions_.latest->run != message->run;
  if (!positions_.takes(message)) return;
  if (other_run) hears_ = input_ && vehicle_settings(platoon_, index_).hears_input;
  if (!hears_) return answer(*message, {});
  pairs_->add_position(message);
  match();
}

void ExternalVehicle::receive_input(const Message::ConstPtr& message) {
  if (!inputs_.takes(message)) return;
  pairs_->add_input(message);
  match();
}

void ExternalVehicle::match() {
  if (!positions_.latest) return;
  pairs_->visit(positions_.latest->run,
                [this](const auto& position, const auto& input) { answer(*position, input->position); });
}

void ExternalVehicle::answer(const Message& received, const std::vector<double>& heard) {
  if (received.step == -1) {
    own_.assign(received.position.size(), 0.0);
    own_input_.assign(received.position.size(), 0.0);
    start_(own_);
  }
  publish(position_, received, own_);
  if (input_) publish(input_, received, own_input_);
  move_(received.position, heard, own_, own_input_);
}

void ExternalVehicle::publish(const ros::Publisher& publisher, const Message& received,
                              const std::vector<double>& values) const {
  const auto message = boost::make_shared<Position>();
  message->header = received.header;
  message->run = received.run;
  message->attempt = received.attempt;
  message->first_realization = received.first_realization;
  message->step = received.step;
  message->position = values;
  publisher.publish(message);
}

}  // namespace platoon
