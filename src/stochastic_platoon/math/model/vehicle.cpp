#include "stochastic_platoon/math/model/vehicle.hpp"

#include <algorithm>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/limited_vehicle.hpp"
#include "stochastic_platoon/math/numerics/multiples.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace detail {

PLATOON_VECTOR_CLONES
void add_own_motion(double speed, double acceleration, const double* y0, const double* y1, const double* y2,
                    std::size_t count, double* out) {
  for (std::size_t r = 0; r < count; ++r) {
    const double moved = y0[r] - y1[r];
    out[r] = out[r] - speed * moved + acceleration * (moved - (y1[r] - y2[r]));
  }
}

}  // namespace detail

FollowerVehicle::FollowerVehicle(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t index)
    : noise_(noise), index_(index) {
  const VehicleModel& own = vehicle(model, index);
  const double spacing = spacing_in_vehicles(own, index), period = model.sample_period;
  loop_ = vehicle_batch(own, period, spacing);
  initial_place_ = own.initial_position.mean + start_place(model, index);
  slope_ = start_slope(model);
  initial_deviation_ = standard_deviation("variance of the initial positions", own.initial_position.variance);
  offset_ = spacing * own.standstill_distance;
  if (own.radio() != nullptr) feed_forward_gain_ = own.radio()->gain;
  if (own.hears_predecessor_only()) return;
  sums_ = Sums{{}, own_speed_gain(own, period), own.own_acceleration / (period * period)};
  for (const Input& input : own.inputs) sums_->shares.push_back({input.signal == InputSignal::position, input.gain});
  feed_forward_gain_ = 1.0;
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
  if (!sums_) return;
  sums_->own.start(positions.data(), count, slope_);
  sums_->position.resize(count);
  sums_->forward.resize(count);
}

void FollowerVehicle::step(const Received& received, double* positions, double* own_input) {
  if (!sums_) {
    const double* const heard = received.size() > 1 ? received[1] : nullptr;
    return loop_->step(received.front(), offset_, positions, {heard, feed_forward_gain_, own_input});
  }
  sum(received);
  loop_->step(sums_->position.data(), offset_, positions, {sums_->forward.data(), feed_forward_gain_, own_input});
  sums_->own.add(positions);
}

void FollowerVehicle::sum(const Received& received) {
  const std::size_t count = sums_->position.size();
  bool has_position = false, has_other = false;
  for (std::size_t n = 0; n < received.size(); ++n) {
    const Sums::Share& share = sums_->shares[n];
    bool& has = share.is_position ? has_position : has_other;
    AlignedValues& sum = share.is_position ? sums_->position : sums_->forward;
    (has ? add_multiple : set_multiple)(share.gain, received[n], count, sum.data());
    has = true;
  }
  if (!has_other) std::fill(sums_->forward.begin(), sums_->forward.end(), 0.0);
  if (sums_->own_speed == 0.0 && sums_->own_acceleration == 0.0) return;
  const Signal::Recent<const double*> own = sums_->own.all();
  detail::add_own_motion(sums_->own_speed, sums_->own_acceleration, own[0], own[1], own[2], count,
                         sums_->forward.data());
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
  manoeuvre_.next_speed(profile_.speed(0));  // from which an order begins
}

// r_0 of the present step.
double LeaderVehicle::virtual_leader() const {
  const double position = step_ < 0 ? 0.0 - slope_ : profile_.position(step_);
  return departure_ != 0.0 ? position + departure_ : position;
}

double LeaderVehicle::start() {
  if (step_ != kNotStarted) {
    manoeuvre_.end();
    manoeuvre_.next_speed(profile_.speed(0));
  }
  step_ = -1;
  departure_ = 0.0;
  control_ = 0.0;
  moved_ = slope_;
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
