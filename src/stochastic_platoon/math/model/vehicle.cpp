#include "stochastic_platoon/math/model/vehicle.hpp"

namespace platoon {

FollowerVehicle::FollowerVehicle(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t index)
    : noise_(noise), index_(index) {
  const VehicleModel& own = vehicle(model, index);
  loop_ = loop_batch(own.loop);
  initial_place_ = own.initial_position.mean + place_in_formation(model, index);
  initial_deviation_ = standard_deviation("variance of the initial positions", own.initial_position.variance);
  standstill_distance_ = own.standstill_distance;
  if (own.feed_forward) feed_forward_gain_ = own.feed_forward->gain;
}

void FollowerVehicle::start(std::uint64_t first_realization, std::size_t count, std::vector<double>& positions) {
  positions.resize(count);
  if (initial_deviation_ > 0.0) {
    noise_.fill({index_, -1}, first_realization, count, positions.data());
    for (double& position : positions) position = initial_place_ + initial_deviation_ * position;
  } else {
    positions.assign(count, initial_place_);
  }
  loop_->start_at_equilibrium(positions);
  loop_->output(positions);
}

LeaderVehicle::LeaderVehicle(const PlatoonModel& model)
    : loop_(loop_batch(model.default_vehicle().loop)),
      profile_(model.leader),
      sample_period_(model.sample_period),
      manoeuvre_(model.sample_period),
      recorded_(model.recorded_leader),
      buffer_(1) {}

double LeaderVehicle::start() {
  step_ = -1;
  departure_ = 0.0;
  control_ = 0.0;
  manoeuvre_.end();
  if (!recorded_.empty()) return recorded_.front();
  buffer_.assign(1, profile_.position(step_));
  loop_->start_at_equilibrium(buffer_);
  loop_->output(buffer_);
  return buffer_.front();
}

double LeaderVehicle::step() {
  if (!recorded_.empty()) return recorded_.at(static_cast<std::size_t>(++step_ + 1));
  double input = profile_.position(step_);
  if (departure_ != 0.0) input += departure_;
  loop_->step(&input, 0.0, buffer_.data(), {nullptr, 0.0, &control_});
  const double speed = profile_.speed(step_);
  departure_ += sample_period_ * (manoeuvre_.next_speed(speed) - speed);
  ++step_;
  return buffer_.front();
}

}  // namespace platoon
