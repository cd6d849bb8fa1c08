#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/links/linked_moments.hpp"
#include "stochastic_platoon/math/links/loss_recursion.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/response/vehicle_response.hpp"

namespace platoon {

/// A sequence as a column.
ExtendedVector column_of(const VehicleResponse::Sequence& values);

/// An input of a follower up to its losses: what it carries, delay and noise.
class Wire {
public:
  Wire(const Input& input, double period, Eigen::Index count);

  /// What arrives of the positions, or of the inputs, of the source: one row per step.
  ExtendedMatrix arriving(const ExtendedMatrix& source) const;

  const ExtendedMatrix& noise() const { return noise_; }

private:
  ExtendedMatrix delayed(const ExtendedMatrix& rows) const;

  std::optional<Signal> difference_ = {};
  Eigen::Index delay_;
  ExtendedMatrix noise_;  ///< covariance
};

/// The motion of a follower behind others.
struct Moved {
  SequenceMoments own;
  ExtendedMatrix with_ahead;  ///< covariance of the own motion (rows) with the vehicles ahead
};

/// Moments of the vehicles that are heard, the leader's mean apart. All means are relative to the steady motion before
/// step -1.
struct Ahead {
  std::vector<std::size_t> vehicles = {};  ///< the last of them is the predecessor
  SequenceMoments moments = {};            ///< blocks: the positions of each and, where inputs are heard, its inputs

  /// The vehicles ahead of the next follower: at most `most` of them.
  Ahead behind(std::size_t follower, const Moved& own, std::size_t most) const;
};

/// One follower and its links: a step of chain_moments(). What it uses has one block for the weighted sum of the
/// positions and, if it hears any, one for that of all other signals.
class ChainFollower {
public:
  /// `model` must outlive the object. `blocks` of a vehicle: 1 for its positions, 2 with its inputs.
  ChainFollower(const PlatoonModel& model, std::size_t follower, Eigen::Index count, Eigen::Index blocks);

  /// The own motion behind these vehicles, without what the variance of the initial position adds.
  Moved behind(const Ahead& ahead, const Motion& leader) const;

  /// The same with it.
  Moved placed(Moved own) const;

  /// Appends mean and variance of a signal at every step, of behind().
  void add_moments(const Signal& signal, const Moved& own, const Ahead& ahead, const Motion& leader,
                   SignalMoments& moments) const;

private:
  using Matrix = ExtendedMatrix;
  using Vector = ExtendedVector;

  struct Heard {
    Wire wire;
    std::size_t source;
    Eigen::Index block;  ///< of the source: 0 its positions, 1 its inputs
    Eigen::Index kind;   ///< of what the vehicle uses: 0 positions, 1 all others
    long double weight;
    long double slope;  ///< of what is sent
    /// What is sent in the steady motion before step -1, where a loss replaces it by 0; else 0.
    long double level;
    std::optional<LossRecursion> losses;

    Matrix on_average(const Matrix& columns) const { return losses ? losses->on_average(columns) : columns; }
  };

  /// What arrives of one input, before its losses.
  struct Arriving {
    Vector mean;
    Matrix with_ahead;  ///< covariance with the vehicles ahead
  };

  long double steady_offset(const PlatoonModel& model) const;
  Eigen::Index place_of(std::size_t vehicle, Eigen::Index block, const Ahead& ahead) const;
  Arriving arriving(const Heard& heard, const Ahead& ahead, const Motion& leader) const;
  Matrix covariance(std::size_t j, std::size_t l, const std::vector<Arriving>& all, const Ahead& ahead) const;
  Eigen::Ref<Matrix, 0, Eigen::OuterStride<>> of_kinds(Matrix& whole, std::size_t j, std::size_t l) const;
  void add_packet(const std::vector<std::size_t>& packet, const std::vector<Arriving>& all, const Ahead& ahead,
                  Moved& used) const;
  void add_pair(std::size_t j, std::size_t l, const std::vector<Arriving>& all, const Ahead& ahead, Moved& used) const;
  Vector joined(const Motion& motion) const;
  Matrix passed(const Matrix& columns) const;

  const PlatoonModel& platoon_;
  VehicleModel model_;
  std::size_t follower_;
  Eigen::Index count_, blocks_, kinds_ = 1;
  long double slope_;  ///< start_slope()
  VehicleResponse response_;
  Vector free_;
  std::vector<Heard> heard_;
  std::vector<std::vector<std::size_t>> packets_;  ///< inputs that are lost together, at the first of them
  long double offset_ = 0.0L;                      ///< of what it uses, before step -1
};

}  // namespace platoon
