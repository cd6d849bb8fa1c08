#pragma once

#include <Eigen/Core>
#include <vector>

#include "stochastic_platoon/math/model/loss_chain.hpp"

namespace platoon {

using ExtendedMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using ExtendedVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// Moments of one or more sequences from step -1 on, a block for each: their means, and the covariance of every two
/// steps.
struct SequenceMoments {
  ExtendedVector mean;
  ExtendedMatrix covariance;
};

/// The recursion over the steps of one link with losses: see chain_moments(). A state has n entries, the
/// registers, for each mode of the chain.
class LossRecursion {
public:
  explicit LossRecursion(const LossModel& loss);

  /// The moments of the values that the vehicle uses, from those of the arriving values: of all sequences that are lost
  /// together, as those of a packet are. `slopes`: each mean is given relative to a motion by this much per step, which
  /// began before step -1.
  SequenceMoments operator()(const SequenceMoments& arriving, const std::vector<long double>& slopes = {0.0L}) const;

  /// Each column passed by the link on average.
  ExtendedMatrix on_average(const ExtendedMatrix& columns) const;

private:
  using Matrix = ExtendedMatrix;
  using Vector = ExtendedVector;
  using Block = Eigen::Ref<Matrix, 0, Eigen::OuterStride<>>;

  Vector innovations(const Eigen::Ref<const Vector>& mean, long double slope) const;
  Vector mean_of(const Vector& innovation) const;
  std::vector<Matrix> powers(Eigen::Index count) const;
  Matrix started(const Matrix& covariance) const;
  long double received_of(const Eigen::Ref<const Vector>& state) const;
  void advance(Matrix& states, Eigen::Index from) const;
  void advance_products(std::vector<Matrix>& products) const;
  void add_products(const Vector& one, const Vector& other, const Matrix& covariance,
                    const std::vector<Matrix>& later_modes, Block second, Block mirrored) const;
  void add_later(Eigen::Index k, Matrix state, const Matrix& mean, const Matrix& cross, const Vector& innovation,
                 const std::vector<Matrix>& later_modes, Block second, Block mirrored) const;

  Eigen::Index n_, modes_, arrived_;
  Matrix transition_;
  Vector stationary_, predictor_;
  mutable std::vector<long double> before_;  ///< a state, while advance() changes it
};

}  // namespace platoon
