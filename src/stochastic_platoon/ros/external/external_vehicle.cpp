#include "stochastic_platoon/external_vehicle.hpp"

#include <boost/make_shared.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr std::uint32_t kUnbounded = 0;

void require_follower(std::size_t index) {
  if (index < 1) throw std::invalid_argument("index: 0: must be the number of a follower, 1 or more");
}

std::string topic(std::size_t index, const std::string& name) {
  require_follower(index);
  return vehicle_name(index) + "/" + name;
}

// A key of follower i: that of its type, or the default vehicle's.
double number_of(const nlohmann::json& model, std::size_t follower, const char* key) {
  if (!model.contains("string")) return model.at(key);
  const nlohmann::json& string = model.at("string");
  const std::string type = string.at((follower - 1) % string.size());
  return type == "default" ? model.at(key).get<double>()
                           : model.at("vehicle_types").at(type).value(key, model.at(key).get<double>());
}

VehicleSettings settings_of(const nlohmann::json& model, std::size_t index) {
  const auto distance_up_to = [&model](std::size_t last) {
    double distance = 0.0;
    for (std::size_t i = 1; i <= last; ++i) distance += number_of(model, i, "standstill_distance");
    return distance;
  };
  const std::size_t length = model.contains("string") ? model.at("string").size() : 1;
  return {number_of(model, index, "time_headway"), number_of(model, index, "standstill_distance"),
          model.at("sample_period"),
          -(static_cast<double>(index / length) * distance_up_to(length) + distance_up_to(index % length))};
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
    : start_(std::move(start)),
      move_(std::move(move)),
      position_(platoon.advertise<Position>(topic(index, "position"), kUnbounded)),
      predecessor_position_(platoon.subscribe(topic(index, "predecessor_position"), kUnbounded,
                                              &ExternalVehicle::receive, this,
                                              ros::TransportHints().tcpNoDelay(true))) {}

bool ExternalVehicle::is_in_turn(const Position& message) const {
  const bool same_run = latest_ && message.run == latest_->run;
  if (message.step == -1) {
    return !same_run || std::tie(message.attempt, message.first_realization) >
                            std::tie(latest_->attempt, latest_->first_realization);
  }
  return same_run && message.attempt == latest_->attempt && message.first_realization == latest_->first_realization &&
         message.step == latest_->step + 1;
}

void ExternalVehicle::receive(const Position::ConstPtr& message) {
  if (!is_in_turn(*message)) return;
  if (message->step == -1) {
    own_.assign(message->position.size(), 0.0);
    start_(own_);
  }
  latest_ = message;
  const auto answer = boost::make_shared<Position>();
  answer->header = message->header;
  answer->run = message->run;
  answer->attempt = message->attempt;
  answer->first_realization = message->first_realization;
  answer->step = message->step;
  answer->position = own_;
  position_.publish(answer);
  move_(message->position, own_);
}

}  // namespace platoon
