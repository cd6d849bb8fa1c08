#include "stochastic_platoon/model/vehicle.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stochastic_platoon/model/vector_clones.hpp"

namespace platoon {

namespace detail {

// out = value_0 source_0 + value_1 source_1 + ... + gain (input - offset), in this order; without an input
// where it is null.
template <std::size_t terms>
PLATOON_INLINE void combine_terms(const double* values, const double* const* sources, double gain,
                                  const double* input, double offset, std::size_t size, double* out) {
  std::array<double, terms> value;
  std::array<const double*, terms> source;
  std::copy(values, values + terms, value.begin());
  std::copy(sources, sources + terms, source.begin());
  for (std::size_t r = 0; r < size; ++r) {
    double sum = value[0] * source[0][r];
    for (std::size_t j = 1; j < terms; ++j) sum += value[j] * source[j][r];
    out[r] = input == nullptr ? sum : sum + gain * (input[r] - offset);
  }
}

// One pass over the memory for several terms: an observable canonical row has one or two.
constexpr std::size_t kTermsAtOnce = 3;

PLATOON_VECTOR_CLONES
void combine(const double* values, const double* const* sources, std::size_t terms, double gain,
             const double* input, double offset, std::size_t size, double* out) {
  if (terms == 1) combine_terms<1>(values, sources, gain, input, offset, size, out);
  if (terms == 2) combine_terms<2>(values, sources, gain, input, offset, size, out);
  if (terms == 3) combine_terms<3>(values, sources, gain, input, offset, size, out);
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

ClosedLoopBatch::ClosedLoopBatch(const StateSpace& system) {
  const Eigen::VectorXd rest = unit_rest_state(system);
  for (Eigen::Index i = 0; i < system.order(); ++i) {
    rows_.push_back(nonzero_terms(system.a().row(i)));
    input_gain_.push_back(system.b()(i));
    rest_state_.push_back(rest(i));
  }
  output_row_ = nonzero_terms(system.c());
  state_.resize(rows_.size());
  next_state_.resize(rows_.size());
}

ClosedLoopBatch::Row ClosedLoopBatch::nonzero_terms(const Eigen::RowVectorXd& row) {
  Row terms;
  for (Eigen::Index j = 0; j < row.size(); ++j) {
    if (row(j) == 0.0) continue;
    terms.values.push_back(row(j));
    terms.columns.push_back(static_cast<std::size_t>(j));
  }
  return terms;
}

void ClosedLoopBatch::rest_at(const std::vector<double>& positions) {
  for (std::size_t i = 0; i < state_.size(); ++i) {
    state_[i].resize(positions.size());
    next_state_[i].resize(positions.size());
    for (std::size_t r = 0; r < positions.size(); ++r) state_[i][r] = rest_state_[i] * positions[r];
  }
}

// out = row state + gain (input - offset), in the order of the row's terms.
void ClosedLoopBatch::combine(const Row& row, double gain, const double* input, double offset,
                              std::vector<double>& out) const {
  const std::size_t terms = row.values.size();
  const std::size_t at_once = std::min(terms, detail::kTermsAtOnce);
  if (gain == 0.0) input = nullptr;
  if (terms == 0) std::fill(out.begin(), out.end(), 0.0);
  std::array<const double*, detail::kTermsAtOnce> sources{};
  for (std::size_t j = 0; j < at_once; ++j) sources[j] = state_[row.columns[j]].data();
  const bool all_at_once = terms > 0 && terms == at_once;
  detail::combine(row.values.data(), sources.data(), at_once, gain, all_at_once ? input : nullptr, offset,
                  out.size(), out.data());
  if (all_at_once) return;
  for (std::size_t j = at_once; j < terms; ++j) {
    detail::add_scaled(row.values[j], state_[row.columns[j]].data(), 0.0, out.size(), out.data());
  }
  if (input != nullptr) detail::add_scaled(gain, input, offset, out.size(), out.data());
}

void ClosedLoopBatch::step(const std::vector<double>& input, double offset) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    combine(rows_[i], input_gain_[i], input.data(), offset, next_state_[i]);
  }
  state_.swap(next_state_);
}

void ClosedLoopBatch::output(std::vector<double>& positions) const {
  positions.resize(state_.front().size());
  combine(output_row_, 0.0, nullptr, 0.0, positions);
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
