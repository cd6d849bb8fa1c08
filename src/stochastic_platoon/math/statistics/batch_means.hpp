#pragma once

#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/statistics/agreement.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// Effective sample size of one stationary, correlated sequence, estimated from its values by the method of batch means
/// (S. Asmussen, P. W. Glynn, Stochastic Simulation, 2007, chapter IV.5).
///
/// The sequence is cut into kMostBatches / 2 to kMostBatches batches of equal length L, a power of 2; whenever all are
/// full, neighbours are joined. With the batch means' variance c_0 and covariance c_1 of neighbours,
/// \f[ n Var(\bar x_n) = L \max(c_0, c_0 + 2 c_1), \qquad \bar x_n \mbox{ the mean of } n \mbox{ values,} \f]
/// and the same with the squared deviations for the variance. This estimate has a relative standard error of about 20
/// %.
class BatchMeans {
public:
  void add(double value);

  /// See IndependentShare; `expected` is NaN, as the bias of the variance is not measured. NaN for fewer than
  /// kMostBatches / 2 batches, and as long as neighbours' correlation c_1 / c_0 exceeds 0.6: the batches are too short.
  IndependentShare share() const;

private:
  static constexpr std::size_t kMostBatches = 64;

  std::uint64_t length_ = 1;
  std::vector<Moments> full_;
  Moments filling_;
};

}  // namespace platoon
