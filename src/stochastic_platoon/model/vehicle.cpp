#include "stochastic_platoon/model/vehicle.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/model/vector_clones.hpp"

namespace platoon {

namespace detail {

PLATOON_VECTOR_CLONES
void scale(double value, const double* in, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] = value * in[r];
}

PLATOON_VECTOR_CLONES
void add_scaled(double value, const double* in, double offset, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] += value * (in[r] - offset);
}

// out = in + value out
PLATOON_VECTOR_CLONES
void scale_and_add(double value, const double* in, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] = in[r] + value * out[r];
}

}  // namespace detail

namespace {

// target = sum over terms of value * source[column], in the order of the terms.
template <typename Terms>
void combine(const Terms& terms, const std::vector<std::vector<double>>& source,
             std::vector<double>& target) {
  bool first = true;
  for (const auto& term : terms) {
    const double* const in = source[term.column].data();
    if (!first) {
      detail::add_scaled(term.value, in, 0.0, target.size(), target.data());
    } else if (term.value == 1.0) {
      std::copy(in, in + target.size(), target.data());
    } else {
      detail::scale(term.value, in, target.size(), target.data());
    }
    first = false;
  }
  if (first) std::fill(target.begin(), target.end(), 0.0);
}

}  // namespace

ClosedLoopBatch::ClosedLoopBatch(const StateSpace& system) {
  const Eigen::VectorXd rest = unit_rest_state(system);
  for (Eigen::Index i = 0; i < system.order(); ++i) {
    std::vector<Term> row;
    for (Eigen::Index j = 0; j < system.order(); ++j) {
      if (system.a()(i, j) != 0.0) row.push_back({static_cast<std::size_t>(j), system.a()(i, j)});
    }
    rows_.push_back(row);
    input_gain_.push_back(system.b()(i));
    rest_state_.push_back(rest(i));
    if (system.c()(i) != 0.0) output_row_.push_back({static_cast<std::size_t>(i), system.c()(i)});
  }
  state_.resize(rows_.size());
  next_state_.resize(rows_.size());
}

void ClosedLoopBatch::rest_at(const std::vector<double>& positions) {
  for (std::size_t i = 0; i < state_.size(); ++i) {
    state_[i].resize(positions.size());
    next_state_[i].resize(positions.size());
    for (std::size_t r = 0; r < positions.size(); ++r) state_[i][r] = rest_state_[i] * positions[r];
  }
}

void ClosedLoopBatch::step(const std::vector<double>& input, double offset) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    combine(rows_[i], state_, next_state_[i]);
    if (input_gain_[i] == 0.0) continue;
    detail::add_scaled(input_gain_[i], input.data(), offset, input.size(), next_state_[i].data());
  }
  state_.swap(next_state_);
}

void ClosedLoopBatch::output(std::vector<double>& positions) const {
  positions.resize(state_.front().size());
  combine(output_row_, state_, positions);
}

FollowerVehicle::FollowerVehicle(const PlatoonModel& model, std::uint64_t seed, std::uint32_t index)
    : loop_(model.loop.realization),
      noise_(seed),
      initial_(model.initial_position),
      standstill_distance_(model.standstill_distance),
      index_(index) {}

void FollowerVehicle::start(std::uint64_t first_realization, std::size_t count,
                            std::vector<double>& positions) {
  positions.resize(count);
  const double place = initial_.mean - static_cast<double>(index_) * standstill_distance_;
  if (initial_.variance > 0.0) {
    const double deviation = std::sqrt(initial_.variance);
    noise_.fill({index_, -1}, first_realization, count, positions.data());
    for (double& position : positions) position = place + deviation * position;
  } else {
    positions.assign(count, place);
  }
  loop_.rest_at(positions);
  loop_.output(positions);
}

void FollowerVehicle::step(const std::vector<double>& received, std::vector<double>& positions) {
  loop_.step(received, standstill_distance_);
  loop_.output(positions);
}

LeaderVehicle::LeaderVehicle(const PlatoonModel& model)
    : loop_(model.loop.realization), profile_(model.leader), buffer_(1) {}

double LeaderVehicle::start() {
  step_ = -1;
  buffer_.assign(1, profile_.position(step_));
  loop_.rest_at(buffer_);
  loop_.output(buffer_);
  return buffer_.front();
}

double LeaderVehicle::step() {
  buffer_.front() = profile_.position(step_);
  loop_.step(buffer_, 0.0);
  loop_.output(buffer_);
  ++step_;
  return buffer_.front();
}

NoisyChannel::NoisyChannel(double noise_variance, std::uint64_t seed, std::uint32_t receiver)
    : noise_(seed), deviation_(std::sqrt(noise_variance)), receiver_(receiver) {}

void NoisyChannel::transmit(std::int64_t step, std::uint64_t first_realization,
                            const std::vector<double>& sent, std::vector<double>& received) const {
  if (step < 0 || deviation_ == 0.0) {
    received = sent;
    return;
  }
  received.resize(sent.size());
  noise_.fill({receiver_, step}, first_realization, sent.size(), received.data());
  detail::scale_and_add(deviation_, sent.data(), sent.size(), received.data());
}

}  // namespace platoon
