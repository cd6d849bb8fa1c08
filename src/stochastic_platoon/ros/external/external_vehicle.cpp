#include "stochastic_platoon/external_vehicle.hpp"

#include <boost/make_shared.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr std::uint32_t kUnbounded = 0;

std::string topic(std::size_t index, const std::string& name) {
  if (index < 1) throw std::invalid_argument("index: 0: must be the number of a follower, 1 or more");
  return vehicle_name(index) + "/" + name;
}

}  // namespace

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
