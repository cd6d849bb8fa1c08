#include "stochastic_platoon/math/model/vehicle.hpp"

#include "stochastic_platoon/math/model/limited_vehicle.hpp"

namespace platoon {

FollowerVehicle::FollowerVehicle(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t index)
    : noise_(noise), index_(index) {
  const VehicleModel& own = vehicle(model, index);
  loop_ = vehicle_batch(own, model.sample_period);
  initial_place_ = own.initial_position.mean + start_place(model, index);
  slope_ = start_slope(model);
  initial_deviation_ = standard_deviation("variance of the initial positions", own.initial_position.variance);
  standstill_distance_ = own.standstill_distance;
  if (own.radio() != nullptr) feed_forward_gain_ = own.radio()->gain;
}

void FollowerVehicle::start(std::uint64_t first_realization, std::size_t count, std::vector<double>& positions) {
  positions.resize(count);
  if (initial_deviation_ > 0.0) {
    noise_.fill({index_, -1}, first_realization, count, positions.data());
    for (double& position : positions) position = initial_place_ + initial_deviation_ * position;
  } else {
    positions.assign(count, initial_place_);
  }
  loop_->start(positions, slope_);
  loop_->output(positions);
}

LeaderVehicle::LeaderVehicle(const PlatoonModel& model)
    : profile_(model.leader),
      sample_period_(model.sample_period),
      manoeuvre_(model.sample_period, model.default_vehicle().limits),
      slope_(start_slope(model)),
      lag_(slope_ * model.default_vehicle().headway),
      recorded_(model.recorded_leader),
      buffer_(1) {
  if (!moves_leader(model)) loop_ = loop_batch(model.default_vehicle().loop);
}

// r_0 of the present step.
double LeaderVehicle::virtual_leader() const {
  const double position = step_ < 0 ? 0.0 - slope_ : profile_.position(step_);
  return departure_ != 0.0 ? position + departure_ : position;
}

double LeaderVehicle::start() {
  step_ = -1;
  departure_ = 0.0;
  control_ = 0.0;
  moved_ = slope_;
  manoeuvre_.end();
  buffer_.assign(1, recorded_.empty() ? virtual_leader() : recorded_.front());
  if (loop_) {
    loop_->start(buffer_, slope_);
    loop_->output(buffer_);
  }
  return buffer_.front();
}

double LeaderVehicle::step() {
  const double before = buffer_.front();
  double input = virtual_leader();
  if (lag_ != 0.0) input += lag_;
  if (recorded_.empty()) {
    const double speed = step_ < 0 ? slope_ / sample_period_ : profile_.speed(step_);
    departure_ += sample_period_ * (manoeuvre_.next_speed(speed) - speed);
  }
  ++step_;
  if (loop_) {
    loop_->step(&input, 0.0, buffer_.data(), {nullptr, 0.0, &control_});
    return buffer_.front();
  }
  buffer_.front() = recorded_.empty() ? virtual_leader() : recorded_.at(static_cast<std::size_t>(step_ + 1));
  const double moved = buffer_.front() - before;
  control_ = (moved - moved_) / (sample_period_ * sample_period_);
  moved_ = moved;
  return buffer_.front();
}

}  // namespace platoon
