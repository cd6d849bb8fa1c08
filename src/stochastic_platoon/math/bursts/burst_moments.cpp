#include "stochastic_platoon/math/bursts/burst_moments.hpp"

#include <Eigen/Dense>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/bursts/loss_recursion.hpp"
#include "stochastic_platoon/math/links/linked_responses.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Matrix = ExtendedMatrix;
using Vector = ExtendedVector;

/// One follower and its link.
class BurstFollower {
public:
  BurstFollower(const VehicleModel& vehicle, std::size_t steps)
      : model_(vehicle),
        count_(static_cast<Eigen::Index>(steps) + 1),
        vehicle_(vehicle),
        free_(filled(vehicle_.free_motion(steps + 1).position)),
        noise_(Matrix::Zero(count_, count_)) {
    const Vector colour = filled(filtered_impulse(vehicle.link.noise_filter, steps));
    const long double variance = vehicle.noise_variance, step = vehicle.link.quantisation_step;
    for (Eigen::Index a = 1; a < count_; ++a) {
      check_interruption();
      for (Eigen::Index b = 1; b <= a; ++b) {
        noise_(a, b) = noise_(a - 1, b - 1) + variance * colour(a) * colour(b);
        noise_(b, a) = noise_(a, b);
      }
    }
    for (Eigen::Index a = 1; a < count_; ++a) noise_(a, a) += step * step / 12.0L;
  }

  /// The positions that the vehicle uses, given those sent.
  Received receives(const SequenceMoments& sent) const {
    SequenceMoments arriving{Vector(count_), Matrix(count_, count_)};
    Matrix with_sent(count_, count_);
    for (Eigen::Index a = 0; a < count_; ++a) {
      check_interruption();
      arriving.mean(a) = sent.mean(before(a));
      with_sent.row(a) = sent.covariance.row(before(a));
      for (Eigen::Index b = 0; b < count_; ++b)
        arriving.covariance(a, b) = sent.covariance(before(a), before(b)) + noise_(before(a), before(b));
    }
    if (!model_.link.loses()) return {std::move(arriving), std::move(with_sent)};
    return LossRecursion(*model_.link.loss)(arriving, with_sent);
  }

  SequenceMoments drives(const SequenceMoments& used) const {
    const InitialPosition& initial = model_.initial_position;
    SequenceMoments own{passed(used.mean) + static_cast<long double>(initial.mean) * free_,
                        passed(passed(used.covariance).transpose())};
    own.covariance += static_cast<long double>(initial.variance) * (free_ * free_.transpose());
    return own;
  }

  /// Appends mean and variance of every tracking error.
  void add_errors(const SequenceMoments& predecessor, const SequenceMoments& own, const Matrix& used_with_sent,
                  ErrorMoments& moments) const {
    const Matrix shared = passed(used_with_sent);  // own step (row) with the predecessor's
    const long double h = model_.headway, g = 1.0L + h;
    for (Eigen::Index a = 1; a < count_; ++a) {
      moments.mean.push_back(
          static_cast<double>(predecessor.mean(a) - own.mean(a) - h * (own.mean(a) - own.mean(a - 1))));
      const long double variance = predecessor.covariance(a, a) + g * g * own.covariance(a, a) +
                                   h * h * own.covariance(a - 1, a - 1) - 2.0L * g * h * own.covariance(a, a - 1) -
                                   2.0L * g * shared(a, a) + 2.0L * h * shared(a - 1, a);
      moments.variance.push_back(static_cast<double>(std::max(variance, 0.0L)));
    }
  }

private:
  Eigen::Index before(Eigen::Index a) const { return std::max<Eigen::Index>(a - model_.link.delay, 0); }

  static Vector filled(const MeanVehicle::Sequence& values) {
    return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  // The closed loop's response to every column.
  Matrix passed(const Matrix& columns) const {
    Matrix result(columns.rows(), columns.cols());
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      const Vector column = columns.col(c);
      result.col(c) =
          filled(vehicle_({MeanVehicle::Sequence(column.data(), column.data() + column.size()), {}}).position);
    }
    return result;
  }

  VehicleModel model_;
  Eigen::Index count_;
  VehicleResponse vehicle_;
  Vector free_;
  Matrix noise_;  ///< covariance of the noise of the link
};

}  // namespace

ErrorMoments burst_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  if (has_feed_forward(model))
    throw std::invalid_argument("inputs: a radio: must be absent for the theory of losses in bursts");
  const auto count = static_cast<std::size_t>(steps);
  std::vector<BurstFollower> vehicles;
  for (const VehicleModel& vehicle : pattern(model)) {
    unit_equilibrium(vehicle.loop.realization);
    if (vehicles.size() == followers) break;
    vehicles.emplace_back(vehicle, count);
  }
  const MeanVehicle::Sequence leader = leader_motion(model, count).position;
  const auto size = static_cast<Eigen::Index>(leader.size());
  SequenceMoments predecessor{Eigen::Map<const Vector>(leader.data(), size), Matrix::Zero(size, size)};
  ErrorMoments moments{steps, followers, {}, {}};
  for (std::size_t i = 0; i < followers; ++i) {
    const BurstFollower& vehicle = vehicles[i % vehicles.size()];
    Received received = vehicle.receives(predecessor);
    SequenceMoments own = vehicle.drives(received.own);
    vehicle.add_errors(predecessor, own, received.with_sent, moments);
    predecessor = std::move(own);
  }
  return moments;
}

bool has_feasible_burst_moments(std::size_t followers, std::int64_t steps) {
  const auto count = static_cast<double>(steps);
  return count <= kMostBurstSteps && static_cast<double>(followers) * count * count <= kMostBurstCells;
}

}  // namespace platoon
