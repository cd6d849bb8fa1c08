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
  size_ = positions.size();
  tiles_.resize((size_ + kTile - 1) / kTile);
  spare_.resize(rows_.size() * kTile);
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    tiles_[t].resize(rows_.size() * kTile);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (std::size_t r = 0; r < tile_size(t); ++r) {
        tiles_[t][i * kTile + r] = rest_state_[i] * positions[t * kTile + r];
      }
    }
  }
}

// out = row state + gain (input - offset), in the order of the row's terms.
void ClosedLoopBatch::combine(const Row& row, const double* state, double gain, const double* input,
                              double offset, std::size_t size, double* out) {
  const std::size_t terms = row.values.size();
  const std::size_t at_once = std::min(terms, detail::kTermsAtOnce);
  if (gain == 0.0) input = nullptr;
  if (terms == 0) std::fill(out, out + size, 0.0);
  std::array<const double*, detail::kTermsAtOnce> sources{};
  for (std::size_t j = 0; j < at_once; ++j) sources[j] = state + row.columns[j] * kTile;
  const bool all_at_once = terms > 0 && terms == at_once;
  detail::combine(row.values.data(), sources.data(), at_once, gain, all_at_once ? input : nullptr, offset,
                  size, out);
  if (all_at_once) return;
  for (std::size_t j = at_once; j < terms; ++j) {
    detail::add_scaled(row.values[j], state + row.columns[j] * kTile, 0.0, size, out);
  }
  if (input != nullptr) detail::add_scaled(gain, input, offset, size, out);
}

void ClosedLoopBatch::step(const std::vector<double>& input, double offset, std::vector<double>& positions) {
  positions.resize(size_);
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      combine(rows_[i], tiles_[t].data(), input_gain_[i], &input[t * kTile], offset, tile_size(t),
              &spare_[i * kTile]);
    }
    tiles_[t].swap(spare_);
    write_output(t, positions);
  }
}

void ClosedLoopBatch::output(std::vector<double>& positions) const {
  positions.resize(size_);
  for (std::size_t t = 0; t < tiles_.size(); ++t) write_output(t, positions);
}

void ClosedLoopBatch::write_output(std::size_t tile, std::vector<double>& positions) const {
  combine(output_row_, tiles_[tile].data(), 0.0, nullptr, 0.0, tile_size(tile), &positions[tile * kTile]);
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
  loop_.step(received, standstill_distance_, positions);
}

LeaderVehicle::LeaderVehicle(const PlatoonModel& model)
    : loop_(model.loop.realization), profile_(model.leader), buffer_(1), input_(1) {}

double LeaderVehicle::start() {
  step_ = -1;
  buffer_.assign(1, profile_.position(step_));
  loop_.rest_at(buffer_);
  loop_.output(buffer_);
  return buffer_.front();
}

double LeaderVehicle::step() {
  input_.front() = profile_.position(step_);
  loop_.step(input_, 0.0, buffer_);
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
  for (std::size_t r = 0; r < sent.size(); r += kTile) {
    const std::size_t size = std::min(kTile, sent.size() - r);
    noise_.fill({receiver_, step}, first_realization + r, size, &received[r]);
    detail::scale_and_add(deviation_, &sent[r], size, &received[r]);
  }
}

}  // namespace platoon
