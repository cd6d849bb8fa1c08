#pragma once

#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"

namespace platoon {

/// Loses positions, independently, in bursts, as recorded or by the gap, and replaces each by a prediction from its
/// earlier outputs: r(k) = s(k) if s(k) arrives and c_1 r(k-1) + c_2 r(k-2) + ... if it is lost, with r(-1), r(-2), ...
/// the position of step -1. See LossModel. Without coefficients a lost value is replaced by 0.
class PacketLoss : public LinkStage {
public:
  /// receiver is i >= 1. Throws std::invalid_argument unless 0 <= q < 1.
  PacketLoss(const LossModel& loss, std::uint64_t seed, std::uint32_t receiver);

  bool keeps_state() const override { return true; }
  void start(std::uint64_t first_realization, std::size_t count, const double* positions) override;
  bool depends_on_gap() const override { return loss_.by_distance.has_value(); }
  void see_gaps(std::size_t count, const double* gaps) override;
  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override;

private:
  LossModel loss_;
  WhiteNoise draws_;
  std::uint32_t receiver_;
  std::vector<AlignedValues> used_;  ///< ring of r(k-1), r(k-2), ... from newest_ on, per realization
  std::size_t newest_ = 0;
  AlignedValues chance_;              ///< probability of a loss at the next step, per realization
  std::vector<std::uint32_t> entry_;  ///< of the trace at the next step, per realization
};

}  // namespace platoon
