#pragma once

#include <vector>

#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/model/link_stage.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"

namespace platoon {

/// Loses positions, independently or in bursts, and gives the prediction from what it gave before in the place
/// of each: r(k) = s(k) where it arrives, c_1 r(k-1) + c_2 r(k-2) + ... where it is lost, r(-1), r(-2), ...
/// being the position of step -1. See LossModel.
class PacketLoss : public LinkStage {
public:
  /// receiver is i >= 1. Throws std::invalid_argument unless 0 <= q < 1 and there is a predictor.
  PacketLoss(const LossModel& loss, std::uint64_t seed, std::uint32_t receiver);

  bool keeps_state() const override { return true; }
  void start(std::uint64_t first_realization, std::size_t count, const double* positions) override;
  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override;

private:
  LossModel loss_;
  WhiteNoise draws_;
  std::uint32_t receiver_;
  std::vector<AlignedValues> used_;  ///< r(k-1), r(k-2), ... of every realization, as a ring from newest_ on
  std::size_t newest_ = 0;
  AlignedValues chance_;  ///< of a loss at the next step, of every realization
};

}  // namespace platoon
