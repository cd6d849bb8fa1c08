#include "stochastic_platoon/external_vehicle.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "stochastic_platoon/run/delivery/message_sets.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr std::uint32_t kUnbounded = 0;

void require_follower(std::size_t index) {
  if (index < 1) throw std::invalid_argument("index: 0: must be the number of a follower, 1 or more");
}

// The keys of follower i's type; none for the default vehicle.
nlohmann::json type_of(const nlohmann::json& model, std::size_t follower) {
  if (!model.contains("string")) return nlohmann::json::object();
  const nlohmann::json& string = model.at("string");
  const std::string type = string.at((follower - 1) % string.size());
  return type == "default" ? nlohmann::json::object() : model.at("vehicle_types").at(type);
}

// A key of follower i: that of its type, or the default vehicle's; null if neither has it.
nlohmann::json value_of(const nlohmann::json& model, std::size_t follower, const char* key) {
  return type_of(model, follower).value(key, model.value(key, nlohmann::json()));
}

// The channel beside the inputs of follower i. A type with inputs of its own does not inherit the default vehicle's.
nlohmann::json channel_of(const nlohmann::json& model, std::size_t follower) {
  const nlohmann::json type = type_of(model, follower);
  return type.contains("inputs") ? type.value("channel", nlohmann::json()) : value_of(model, follower, "channel");
}

std::vector<VehicleInput> inputs_of(const nlohmann::json& model, std::size_t follower) {
  nlohmann::json inputs = value_of(model, follower, "inputs");
  if (inputs.is_null()) inputs = nlohmann::json::parse(R"([{"signal": "position"}])");
  const auto from = [&inputs](std::size_t n) { return inputs[n].value("from", nlohmann::json("predecessor")); };
  const auto carries = [&](std::size_t n, const char* signal) {
    return from(n) == "predecessor" && inputs[n].at("signal") == signal;
  };
  std::vector<VehicleInput> found;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const nlohmann::json& input = inputs[n];
    const std::size_t ahead = from(n) == "predecessor" ? 1
                              : from(n) == "leader"    ? follower
                                                       : from(n).get<std::size_t>();
    found.push_back({input.at("signal"), follower - std::min(ahead, follower),
                     input.value("weight", input.value("gain", 1.0)), received_topic(follower, n, carries)});
  }
  return found;
}

// A type with constant spacing does not inherit the default vehicle's headway.
double headway_of(const nlohmann::json& model, std::size_t follower) {
  if (value_of(model, follower, "spacing") == "constant") return 0.0;
  const nlohmann::json headway = value_of(model, follower, "time_headway");
  return headway.is_null() ? 0.0 : headway.get<double>();
}

std::string received_position(std::size_t follower) {
  return vehicle_name(follower) + "/predecessor_position";
}

std::string received_input(std::size_t follower) {
  return vehicle_name(follower) + "/predecessor_input";
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

// Places of vehicles 0 .. index at step -1 [m]: in formation or, for a steady start, where no vehicle has a spacing
// error.
std::vector<double> places_of(const nlohmann::json& model, std::size_t index, const SteadyStart& start) {
  std::vector<double> places{start.first};
  for (std::size_t i = 1; i <= index; ++i) {
    const double distance = value_of(model, i, "standstill_distance").get<double>();
    if (!start.steady) {
      places.push_back(places.back() - distance);
      continue;
    }
    const double spacing = distance + start.slope * headway_of(model, i);
    const nlohmann::json inputs = value_of(model, i, "inputs"), channel = channel_of(model, i);
    const auto delay = [&](std::size_t n) {
      const nlohmann::json& own =
          inputs.is_array() && inputs[n].contains("channel") ? inputs[n].at("channel") : channel;
      return own.is_object() ? own.value("delay", 0.0) : 0.0;
    };
    double place = 0.0;
    const std::vector<VehicleInput> heard = inputs_of(model, i);
    for (std::size_t n = 0; n < heard.size(); ++n) {
      if (heard[n].signal != "position") continue;
      const auto ahead = static_cast<double>(i - heard[n].source);
      place += heard[n].gain * (places[heard[n].source] - start.slope * delay(n) - ahead * spacing);
    }
    places.push_back(place);
  }
  return places;
}

VehicleSettings settings_of(const nlohmann::json& model, std::size_t index) {
  const SteadyStart start = start_of(model);
  const std::vector<VehicleInput> inputs = inputs_of(model, index);
  const double period = model.at("sample_period");
  return {headway_of(model, index),
          value_of(model, index, "standstill_distance").get<double>(),
          period,
          places_of(model, index, start).back(),
          start.slope / period,
          std::any_of(inputs.begin(), inputs.end(),
                      [index](const VehicleInput& of) { return of.topic == received_input(index); }),
          inputs};
}

}  // namespace

VehicleSettings vehicle_settings(const ros::NodeHandle& platoon, std::size_t index) {
  require_follower(index);
  std::string text;
  const std::string parameter = platoon.resolveName("configuration");
  if (!platoon.getParam(parameter, text)) throw std::runtime_error(parameter + ": absent: no launch has set it");
  try {
    return vehicle_settings_in(text, index);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(parameter + ": " + error.what());
  }
}

VehicleSettings vehicle_settings_in(const std::string& configuration, std::size_t index) {
  require_follower(index);
  try {
    return settings_of(nlohmann::json::parse(configuration).at("model"), index);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("is no configuration of a platoon: ") + error.what());
  }
}

ExternalVehicle::ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, Move move)
    : ExternalVehicle(
          platoon, index, std::move(start),
          [move = std::move(move)](const auto& received, auto& position, auto&) { move(received.front(), position); },
          Hears::position) {}

ExternalVehicle::ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, MoveByRadio move)
    : ExternalVehicle(
          platoon, index, std::move(start),
          [move = std::move(move)](const auto& received, auto& position, auto& input) {
            static const std::vector<double> nothing;
            move(received.front(), received.size() > 1 ? received[1] : nothing, position, input);
          },
          Hears::radio) {}

ExternalVehicle::ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, MoveByInputs move)
    : ExternalVehicle(platoon, index, std::move(start), std::move(move), Hears::all) {}

ExternalVehicle::ExternalVehicle(const ros::NodeHandle& platoon, std::size_t index, Start start, MoveByInputs move,
                                 Hears hears)
    : platoon_(platoon),
      index_(index),
      start_(std::move(start)),
      move_(std::move(move)),
      hears_(hears),
      sets_(std::make_shared<MessageSets<Message::ConstPtr>>(1)) {
  require_follower(index);
  position_ = platoon_.advertise<Position>(vehicle_name(index) + "/position", kUnbounded);
  if (hears != Hears::position) input_ = platoon_.advertise<Position>(vehicle_name(index) + "/input", kUnbounded);
  subscribe(received_position(index));
  if (hears != Hears::position) subscribe(received_input(index));
  if (hears != Hears::all) return;
  subscribe(vehicle_name(index) + "/inputs/0");  // the first input of any run is one of these three
  if (!platoon_.hasParam("configuration")) return;
  for (const std::string& topic : heard_topics()) subscribe(topic);
}

// In the present run.
std::vector<std::string> ExternalVehicle::heard_topics() const {
  if (hears_ == Hears::position) return {received_position(index_)};
  const VehicleSettings settings = vehicle_settings(platoon_, index_);
  std::vector<std::string> topics;
  if (hears_ == Hears::all) {
    for (const VehicleInput& input : settings.inputs) topics.push_back(input.topic);
    return topics;
  }
  topics = {received_position(index_)};
  if (settings.hears_input) topics.push_back(received_input(index_));
  return topics;
}

void ExternalVehicle::subscribe(const std::string& topic) {
  Stream& stream = streams_[topic];
  if (stream.subscriber) return;
  const boost::function<void(const Message::ConstPtr&)> callback = [this, topic](const Message::ConstPtr& message) {
    receive(topic, message);
  };
  stream.subscriber = platoon_.subscribe<Position>(topic, kUnbounded, callback, ros::VoidConstPtr(),
                                                   ros::TransportHints().tcpNoDelay(true));
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

void ExternalVehicle::begin(std::uint64_t run) {
  run_ = run;
  const std::vector<std::string> topics = heard_topics();
  for (auto& [topic, stream] : streams_) stream.number.reset();
  *sets_ = MessageSets<Message::ConstPtr>(topics.size());
  for (std::size_t n = 0; n < topics.size(); ++n) {
    subscribe(topics[n]);
    streams_[topics[n]].number = n;
  }
}

void ExternalVehicle::receive(const std::string& topic, const Message::ConstPtr& message) {
  Stream& stream = streams_[topic];
  if (!stream.takes(message)) return;
  if (message->run != run_) begin(message->run);
  if (!stream.number) return;
  sets_->add(*stream.number, message);
  sets_->visit(run_, [this](const auto& received) { answer(received); });
}

void ExternalVehicle::answer(const std::vector<Message::ConstPtr>& received) {
  const Message& first = *received.front();
  if (first.step == -1) {
    own_.assign(first.position.size(), 0.0);
    own_input_.assign(first.position.size(), 0.0);
    start_(own_);
  }
  publish(position_, first, own_);
  if (input_) publish(input_, first, own_input_);
  std::vector<std::vector<double>> values;
  for (const Message::ConstPtr& message : received) values.push_back(message->position);
  move_(values, own_, own_input_);
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
