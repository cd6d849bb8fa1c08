#include "stochastic_platoon/math/links/chain_moments.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/linked_responses.hpp"
#include "stochastic_platoon/math/links/loss_recursion.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Matrix = ExtendedMatrix;
using Vector = ExtendedVector;

Vector filled(const MeanVehicle::Sequence& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// One link: delay, noise and losses.
class Wire {
public:
  Wire(const Input& input, Eigen::Index count) : delay_(input.delay()), noise_(Matrix::Zero(count, count)) {
    const LinkModel& link = input.link;
    if (link.loses()) losses_.emplace(*link.loss);
    const Vector colour = filled(filtered_impulse(link.noise_filter, static_cast<std::size_t>(count) - 1));
    const long double variance = input.noise_variance, step = link.quantisation_step;
    for (Eigen::Index a = 1; a < count; ++a) {
      check_interruption();
      for (Eigen::Index b = 1; b <= a; ++b) {
        noise_(a, b) = noise_(a - 1, b - 1) + variance * colour(a) * colour(b);
        noise_(b, a) = noise_(a, b);
      }
    }
    for (Eigen::Index a = 1; a < count; ++a) noise_(a, a) += step * step / 12.0L;
  }

  /// The values that the vehicle uses, given those sent.
  SequenceMoments operator()(const Vector& mean, const Matrix& covariance) const {
    SequenceMoments arriving{delayed(mean), delayed((covariance + noise_).transpose())};
    arriving.covariance = delayed(arriving.covariance.transpose());
    return losses_ ? (*losses_)(arriving) : arriving;
  }

  /// Covariances of the used values with others, given those of the sent ones in the same order.
  Matrix with_others(const Matrix& sent) const { return losses_ ? losses_->on_average(delayed(sent)) : delayed(sent); }

private:
  Matrix delayed(const Matrix& rows) const {
    Matrix result(rows.rows(), rows.cols());
    for (Eigen::Index a = 0; a < rows.rows(); ++a) result.row(a) = rows.row(std::max<Eigen::Index>(a - delay_, 0));
    return result;
  }

  Eigen::Index delay_;
  Matrix noise_;  ///< covariance
  std::optional<LossRecursion> losses_;
};

/// One follower and its links. Moments are those of its positions and, in a string with radios, its inputs, one block
/// of rows and columns for each.
class ChainFollower {
public:
  ChainFollower(const VehicleModel& vehicle, std::size_t steps, Eigen::Index blocks)
      : model_(vehicle), count_(static_cast<Eigen::Index>(steps) + 1), blocks_(blocks), vehicle_(vehicle) {
    for (const Input& input : vehicle.inputs) wires_.emplace_back(input, count_);
    free_ = joined(vehicle_.free_motion(steps + 1));
  }

  /// The moments of the own motion behind this predecessor. Appends mean and variance of every tracking error.
  SequenceMoments behind(const SequenceMoments& predecessor, ErrorMoments& moments) const {
    const Eigen::Index links = static_cast<Eigen::Index>(wires_.size());
    SequenceMoments used{Vector(links * count_), Matrix(links * count_, links * count_)};
    Matrix with_position(links * count_, count_);  // covariance of what is used with the predecessor's position
    for (Eigen::Index l = 0; l < links; ++l) {
      const Wire& wire = wires_[static_cast<std::size_t>(l)];
      const SequenceMoments of_wire =
          wire(predecessor.mean.segment(l * count_, count_), block(predecessor.covariance, l, l));
      used.mean.segment(l * count_, count_) = of_wire.mean;
      used.covariance.block(l * count_, l * count_, count_, count_) = of_wire.covariance;
      with_position.middleRows(l * count_, count_) = wire.with_others(block(predecessor.covariance, l, 0));
    }
    if (links > 1) {
      const Matrix of_both =
          wires_[0].with_others(wires_[1].with_others(block(predecessor.covariance, 1, 0)).transpose());
      used.covariance.topRightCorner(count_, count_) = of_both;
      used.covariance.bottomLeftCorner(count_, count_) = of_both.transpose();
    }
    const InitialPosition& initial = model_.initial_position;
    SequenceMoments own{passed(used.mean) + static_cast<long double>(initial.mean) * free_,
                        passed(passed(used.covariance).transpose())};
    add_errors(predecessor, own, passed(with_position), moments);
    own.covariance += static_cast<long double>(initial.variance) * (free_ * free_.transpose());
    return own;
  }

private:
  Matrix block(const Matrix& whole, Eigen::Index row, Eigen::Index column) const {
    return whole.block(row * count_, column * count_, count_, count_);
  }

  // `own`: without the initial position's part of the covariance, which is a square in the error: until noise arrives
  // it may be all of the variance, and near 0. `shared`: the own motion (row) with the predecessor's position.
  void add_errors(const SequenceMoments& predecessor, const SequenceMoments& own, const Matrix& shared,
                  ErrorMoments& moments) const {
    const long double h = model_.headway, g = 1.0L + h, initial = model_.initial_position.variance;
    for (Eigen::Index a = 1; a < count_; ++a) {
      moments.mean.push_back(
          static_cast<double>(predecessor.mean(a) - own.mean(a) - h * (own.mean(a) - own.mean(a - 1))));
      const long double variance = predecessor.covariance(a, a) + g * g * own.covariance(a, a) +
                                   h * h * own.covariance(a - 1, a - 1) - 2.0L * g * h * own.covariance(a, a - 1) -
                                   2.0L * g * shared(a, a) + 2.0L * h * shared(a - 1, a);
      const long double free = free_(a) + h * (free_(a) - free_(a - 1));
      moments.variance.push_back(static_cast<double>(std::max(variance, 0.0L) + initial * free * free));
    }
  }

  Vector joined(const Motion& motion) const {
    Vector all(blocks_ * count_);
    all.head(count_) = filled(motion.position);
    if (blocks_ > 1) all.tail(count_) = filled(motion.input);
    return all;
  }

  // The closed loop's response to every column of used values.
  Matrix passed(const Matrix& columns) const {
    Matrix result(blocks_ * count_, columns.cols());
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      check_interruption();
      const Vector column = columns.col(c);
      const long double* const data = column.data();
      Motion received{{data, data + count_}, {}};
      if (wires_.size() > 1) received.input.assign(data + count_, data + 2 * count_);
      result.col(c) = joined(vehicle_(received));
    }
    return result;
  }

  VehicleModel model_;
  Eigen::Index count_, blocks_;
  VehicleResponse vehicle_;
  std::vector<Wire> wires_;
  Vector free_;
};

}  // namespace

ErrorMoments chain_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  const auto count = static_cast<std::size_t>(steps);
  const Eigen::Index blocks = has_radios(model) ? 2 : 1, size = blocks * (static_cast<Eigen::Index>(count) + 1);
  std::vector<ChainFollower> vehicles;
  for (const VehicleModel& vehicle : pattern(model)) {
    unit_equilibrium(vehicle.loop.realization);
    if (vehicles.size() == followers) break;
    vehicles.emplace_back(vehicle, count, blocks);
  }
  const Motion leader = leader_motion(model, count);
  SequenceMoments predecessor{Vector::Zero(size), Matrix::Zero(size, size)};
  predecessor.mean.head(size / blocks) = filled(leader.position);
  if (!leader.input.empty()) predecessor.mean.tail(size / blocks) = filled(leader.input);
  ErrorMoments moments{steps, followers, {}, {}};
  for (std::size_t i = 0; i < followers; ++i) predecessor = vehicles[i % vehicles.size()].behind(predecessor, moments);
  return moments;
}

std::int64_t most_chain_steps(const PlatoonModel& model, std::size_t followers, double share_of_time) {
  constexpr double kMostCells = 1e8, kMostSteps = 2000.0;  // followers x steps^2, and steps
  const double most = std::min(kMostSteps, std::sqrt(share_of_time * kMostCells / static_cast<double>(followers)));
  return static_cast<std::int64_t>(has_radios(model) ? most / 2.0 : most);
}

}  // namespace platoon
