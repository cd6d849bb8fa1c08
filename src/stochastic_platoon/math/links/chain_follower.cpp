#include "stochastic_platoon/math/links/chain_follower.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/links/string_responses.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

using Matrix = ExtendedMatrix;
using Vector = ExtendedVector;

ExtendedVector column_of(const VehicleResponse::Sequence& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Wire::Wire(const Input& input, double period, Eigen::Index count)
    : delay_(input.delay()), noise_(Matrix::Zero(count, count)) {
  if (is_difference(input.signal)) difference_ = difference(input.signal, period);
  const LinkModel& link = input.link;
  const Vector colour = column_of(filtered_impulse(link.noise_filter, static_cast<std::size_t>(count) - 1));
  const long double variance = input.noise_variance, step = link.quantisation_step;
  for (Eigen::Index a = 1; a < count; ++a) {
    check_interruption();
    for (Eigen::Index b = 1; b <= a; ++b) {
      noise_(a, b) = noise_(a - 1, b - 1) + variance * colour(a) * colour(b);
      noise_(b, a) = noise_(a, b);
    }
  }
  for (Eigen::Index a = 1; a < count; ++a) noise_(a, a) += step * step / 12.0L;
  noise_ = delayed(delayed(noise_).transpose());
}

Matrix Wire::arriving(const Matrix& source) const {
  if (!difference_) return delayed(source);
  Matrix change = source;
  for (int order = 0; order < difference_->own.order; ++order) {
    for (Eigen::Index a = change.rows() - 1; a > 0; --a) change.row(a) -= change.row(a - 1);
    change.row(0).setZero();
  }
  return static_cast<long double>(difference_->own.factor) * delayed(change);
}

Matrix Wire::delayed(const Matrix& rows) const {
  Matrix result(rows.rows(), rows.cols());
  for (Eigen::Index a = 0; a < rows.rows(); ++a) result.row(a) = rows.row(std::max<Eigen::Index>(a - delay_, 0));
  return result;
}

Ahead Ahead::behind(std::size_t follower, const Moved& own, std::size_t most) const {
  const Eigen::Index block = own.own.mean.size(), all = moments.mean.size(),
                     kept = vehicles.size() < most ? all : all - block;
  Ahead next{vehicles, {Vector(kept + block), Matrix(kept + block, kept + block)}};
  if (kept < all) next.vehicles.erase(next.vehicles.begin());
  next.vehicles.push_back(follower);
  next.moments.mean << moments.mean.tail(kept), own.own.mean;
  next.moments.covariance.topLeftCorner(kept, kept) = moments.covariance.bottomRightCorner(kept, kept);
  next.moments.covariance.bottomLeftCorner(block, kept) = own.with_ahead.rightCols(kept);
  next.moments.covariance.topRightCorner(kept, block) = own.with_ahead.rightCols(kept).transpose();
  next.moments.covariance.bottomRightCorner(block, block) = own.own.covariance;
  return next;
}

ChainFollower::ChainFollower(const PlatoonModel& model, std::size_t follower, Eigen::Index count, Eigen::Index blocks)
    : platoon_(model),
      model_(vehicle(model, follower)),
      follower_(follower),
      count_(count),
      blocks_(blocks),
      slope_(start_slope(model)),
      response_(model_, follower, model.sample_period),
      free_(joined(response_.free_motion(static_cast<std::size_t>(count)))),
      packets_(model_.inputs.size()) {
  const bool plain = model_.hears_predecessor_only();
  for (std::size_t n = 0; n < model_.inputs.size(); ++n) {
    const Input& input = model_.inputs[n];
    const bool is_position = input.signal == InputSignal::position;
    heard_.push_back({Wire(input, model.sample_period, count),
                      source_of(input, follower),
                      input.signal == InputSignal::input ? 1 : 0,
                      is_position ? 0 : 1,
                      plain ? 1.0L : static_cast<long double>(input.gain),
                      is_position ? slope_ : 0.0L,
                      0.0L,
                      {}});
    if (input.link.loses()) heard_.back().losses.emplace(*input.link.loss);
    if (input.link.loses() && input.link.loss->predictor.empty() && input.signal == InputSignal::speed)
      heard_.back().level = slope_ / static_cast<long double>(model.sample_period);
    packets_[model_.losses_of(n)].push_back(n);
    kinds_ = std::max(kinds_, heard_.back().kind + 1);
  }
  if (!plain) offset_ = steady_offset(model);
}

Moved ChainFollower::behind(const Ahead& ahead, const Motion& leader) const {
  std::vector<Arriving> all;
  for (const Heard& heard : heard_) all.push_back(arriving(heard, ahead, leader));
  Moved used{{Vector::Zero(kinds_ * count_), Matrix::Zero(kinds_ * count_, kinds_ * count_)},
             Matrix::Zero(kinds_ * count_, ahead.moments.mean.size())};
  used.own.mean.head(count_).array() += offset_;
  for (const std::vector<std::size_t>& packet : packets_) {
    if (!packet.empty()) add_packet(packet, all, ahead, used);
  }
  for (std::size_t j = 0; j < all.size(); ++j) {
    for (std::size_t l = 0; l < j; ++l) {
      if (model_.losses_of(j) != model_.losses_of(l)) add_pair(j, l, all, ahead, used);
    }
  }
  return {{passed(used.own.mean) + static_cast<long double>(model_.initial_position.mean) * free_,
           passed(passed(used.own.covariance).transpose())},
          passed(used.with_ahead)};
}

Moved ChainFollower::placed(Moved own) const {
  own.own.covariance += static_cast<long double>(model_.initial_position.variance) * (free_ * free_.transpose());
  return own;
}

// Where the steady motion before step -1 is not an equilibrium, a constant error drives the vehicle.
long double ChainFollower::steady_offset(const PlatoonModel& model) const {
  const long double own = start_place(model, follower_), distance = model_.standstill_distance,
                    spacing = slope_ * model_.headway + distance;
  long double offset = -own - spacing_in_vehicles(model_, follower_) * spacing;
  for (const Input& input : model_.inputs) {
    if (input.signal != InputSignal::position) continue;
    offset += input.gain *
              (start_place(model, source_of(input, follower_)) - slope_ * static_cast<long double>(input.link.delay));
  }
  return offset;
}

Eigen::Index ChainFollower::place_of(std::size_t vehicle, Eigen::Index block, const Ahead& ahead) const {
  const auto found = std::find(ahead.vehicles.begin(), ahead.vehicles.end(), vehicle) - ahead.vehicles.begin();
  return (static_cast<Eigen::Index>(found) * blocks_ + block) * count_;
}

ChainFollower::Arriving ChainFollower::arriving(const Heard& heard, const Ahead& ahead, const Motion& leader) const {
  if (heard.source == 0)
    return {heard.wire.arriving(column_of(heard.block == 0 ? leader.position : leader.input)),
            Matrix::Zero(count_, ahead.moments.mean.size())};
  const Eigen::Index at = place_of(heard.source, heard.block, ahead);
  return {heard.wire.arriving(ahead.moments.mean.segment(at, count_)),
          heard.wire.arriving(ahead.moments.covariance.middleRows(at, count_))};
}

// Covariance of what arrives of inputs j and l, without noise.
Matrix ChainFollower::covariance(std::size_t j, std::size_t l, const std::vector<Arriving>& all,
                                 const Ahead& ahead) const {
  if (heard_[j].source == 0 || heard_[l].source == 0) return Matrix::Zero(count_, count_);
  const Eigen::Index at = place_of(heard_[l].source, heard_[l].block, ahead);
  return heard_[l].wire.arriving(all[j].with_ahead.middleCols(at, count_).transpose()).transpose();
}

Eigen::Ref<Matrix, 0, Eigen::OuterStride<>> ChainFollower::of_kinds(Matrix& whole, std::size_t j, std::size_t l) const {
  return whole.block(heard_[j].kind * count_, heard_[l].kind * count_, count_, count_);
}

void ChainFollower::add_packet(const std::vector<std::size_t>& packet, const std::vector<Arriving>& all,
                               const Ahead& ahead, Moved& used) const {
  const auto size = static_cast<Eigen::Index>(packet.size()) * count_;
  SequenceMoments moments{Vector(size), Matrix(size, size)};
  std::vector<long double> slopes;
  for (Eigen::Index a = 0; a * count_ < size; ++a) {
    const std::size_t j = packet[static_cast<std::size_t>(a)];
    slopes.push_back(heard_[j].slope);
    moments.mean.segment(a * count_, count_) = all[j].mean.array() + heard_[j].level;
    for (Eigen::Index b = 0; b * count_ < size; ++b) {
      const std::size_t l = packet[static_cast<std::size_t>(b)];
      moments.covariance.block(a * count_, b * count_, count_, count_) = covariance(j, l, all, ahead);
    }
    moments.covariance.block(a * count_, a * count_, count_, count_) += heard_[j].wire.noise();
  }
  if (const auto& losses = heard_[packet.front()].losses) moments = (*losses)(moments, slopes);
  for (Eigen::Index a = 0; a * count_ < size; ++a) {
    const std::size_t j = packet[static_cast<std::size_t>(a)];
    const Heard& heard = heard_[j];
    const Eigen::Index at = heard.kind * count_;
    used.own.mean.segment(at, count_).array() +=
        heard.weight * (moments.mean.segment(a * count_, count_).array() - heard.level);
    used.with_ahead.middleRows(at, count_) += heard.weight * heard.on_average(all[j].with_ahead);
    for (Eigen::Index b = 0; b * count_ < size; ++b) {
      const std::size_t l = packet[static_cast<std::size_t>(b)];
      of_kinds(used.own.covariance, j, l) +=
          heard.weight * heard_[l].weight * moments.covariance.block(a * count_, b * count_, count_, count_);
    }
  }
}

// Two inputs whose losses are independent of each other.
void ChainFollower::add_pair(std::size_t j, std::size_t l, const std::vector<Arriving>& all, const Ahead& ahead,
                             Moved& used) const {
  const Heard &one = heard_[j], &other = heard_[l];
  const Matrix both = one.on_average(other.on_average(covariance(j, l, all, ahead).transpose()).transpose()) *
                      (one.weight * other.weight);
  of_kinds(used.own.covariance, j, l) += both;
  of_kinds(used.own.covariance, l, j) += both.transpose();
}

namespace {

/// What a term takes of y(k), y(k-1), ...: factor (1 - z^-1)^order.
Signal::Recent<long double> weights(const Signal::Term& term) {
  Signal::Recent<long double> of{static_cast<long double>(term.factor)};
  for (int n = 0; n < term.order; ++n) {
    for (std::size_t j = of.size(); --j > 0;) of[j] -= of[j - 1];
  }
  return of;
}

/// A quadratic form of a covariance, and the size of its terms.
struct Form {
  long double value = 0.0L, size = 0.0L;

  void add(long double term) {
    value += term;
    size += std::abs(term);
  }
};

}  // namespace

// Until noise arrives, the initial position's part may be all of the variance, and near 0: it is a square, added apart.
void ChainFollower::add_moments(const Signal& signal, const Moved& own, const Ahead& ahead, const Motion& leader,
                                SignalMoments& moments) const {
  const bool first = follower_ == 1;
  const Eigen::Index at = first ? 0 : place_of(follower_ - 1, 0, ahead), block = signal.is_input ? count_ : 0;
  const Vector of_leader = first ? column_of(leader.position) : Vector();
  const Signal::Recent<long double> apart = weights(signal.apart);
  Signal::Recent<long double> of_own = weights(signal.own);
  if (signal.own.order == 0) of_own = {signal.is_input ? 1.0L : 0.0L};
  for (std::size_t j = 0; j < of_own.size(); ++j) of_own[j] -= apart[j];
  const long double steady = steady_value(platoon_, signal, follower_) + signal.at_rest(model_.standstill_distance);
  const auto size = static_cast<Eigen::Index>(signal.order()) + 1;
  for (Eigen::Index a = 1; a < count_; ++a) {
    long double mean = steady, free = 0.0L;
    Form variance;
    for (Eigen::Index j = 0; j < size; ++j) {
      const Eigen::Index here = std::max<Eigen::Index>(a - j, 0), of_here = block + here, in_ahead = at + here;
      const long double own_j = of_own[static_cast<std::size_t>(j)], apart_j = apart[static_cast<std::size_t>(j)];
      mean += own_j * own.own.mean(of_here);
      if (apart_j != 0.0L) mean += apart_j * (first ? of_leader(here) : ahead.moments.mean(in_ahead));
      free += own_j * free_(of_here);
      for (Eigen::Index l = 0; l < size; ++l) {
        const Eigen::Index there = std::max<Eigen::Index>(a - l, 0);
        const long double own_l = of_own[static_cast<std::size_t>(l)], apart_l = apart[static_cast<std::size_t>(l)];
        variance.add(own_j * own_l * own.own.covariance(of_here, block + there));
        if (first || apart_l == 0.0L) continue;
        variance.add(2.0L * own_j * apart_l * own.with_ahead(of_here, at + there));
        variance.add(apart_j * apart_l * ahead.moments.covariance(in_ahead, at + there));
      }
    }
    const bool is_error = signal.of_distance() != 0.0 && signal.own.order > 0;
    const bool is_hidden = !is_error && variance.value != 0.0L && variance.value < 1e-13L * variance.size;
    moments.mean.push_back(static_cast<double>(mean));
    moments.variance.push_back(is_hidden ? kNaN
                                         : static_cast<double>(std::max(variance.value, 0.0L) +
                                                               model_.initial_position.variance * free * free));
  }
}

Vector ChainFollower::joined(const Motion& motion) const {
  Vector all(blocks_ * count_);
  all.head(count_) = column_of(motion.position);
  if (blocks_ > 1) all.tail(count_) = column_of(motion.input);
  return all;
}

// The closed loop's response to every column of used values.
Matrix ChainFollower::passed(const Matrix& columns) const {
  Matrix result(blocks_ * count_, columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    check_interruption();
    const Vector column = columns.col(c);
    const long double* const data = column.data();
    Motion used{{data, data + count_}, {}};
    if (kinds_ > 1) used.input.assign(data + count_, data + 2 * count_);
    result.col(c) = joined(response_(used));
  }
  return result;
}

}  // namespace platoon
