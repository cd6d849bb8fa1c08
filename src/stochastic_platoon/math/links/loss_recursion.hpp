#pragma once

#include <Eigen/Core>
#include <vector>

#include "stochastic_platoon/math/model/loss_chain.hpp"

namespace platoon {

using ExtendedMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using ExtendedVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// Moments of a sequence from step -1 on: its means, and the covariance of every two steps.
struct SequenceMoments {
  ExtendedVector mean;
  ExtendedMatrix covariance;
};

/// The recursion over the steps of one link with losses: see chain_error_moments(). A state has n entries, the
/// registers, for each mode of the chain.
class LossRecursion {
public:
  explicit LossRecursion(const LossModel& loss);

  /// The moments of the values that the vehicle uses, from those of the arriving values.
  SequenceMoments operator()(const SequenceMoments& arriving) const;

  /// Each column passed by the link on average.
  ExtendedMatrix on_average(const ExtendedMatrix& columns) const;

private:
  using Matrix = ExtendedMatrix;
  using Vector = ExtendedVector;

  Vector innovations(const Vector& mean) const;
  std::vector<Matrix> powers(Eigen::Index count) const;
  Matrix started(const Matrix& covariance) const;
  long double received_of(const Eigen::Ref<const Vector>& state) const;
  void advance(Matrix& states, Eigen::Index from) const;
  void advance_squares(std::vector<Matrix>& squares) const;
  void add_later(Eigen::Index k, Matrix state, const Matrix& mean, const Matrix& cross, const Vector& innovation,
                 const std::vector<Matrix>& later_modes, Matrix& second) const;

  Eigen::Index n_, modes_, arrived_;
  Matrix transition_;
  Vector stationary_, predictor_;
  mutable std::vector<long double> before_;  ///< a state, while advance() changes it
};

}  // namespace platoon
