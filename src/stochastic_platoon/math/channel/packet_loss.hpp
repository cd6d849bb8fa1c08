#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

/// Draws the modes of a LossChain.
class ModeChances {
public:
  explicit ModeChances(const LossChain& chain);

  /// The mode that follows one, or begins the chain, for a uniform draw: the lost modes share the draws below the
  /// probability of a loss.
  std::uint8_t after(std::size_t mode, double uniform) const;
  std::uint8_t first(double uniform) const { return after(modes_.size() - 1, uniform); }
  bool is_lost(std::uint8_t mode) const { return mode >= arrived_; }

private:
  struct Share {
    double upto;  ///< of a uniform draw
    std::uint8_t mode;
  };
  std::vector<std::vector<Share>> modes_;  ///< behind each mode, and at last the stationary ones
  std::size_t arrived_;
};

/// Loses positions, independently, in bursts, by the states of a chain, as recorded or by the gap, and replaces each by
/// a prediction from its earlier outputs: r(k) = s(k) if s(k) arrives and c_1 r(k-1) + c_2 r(k-2) + ... if it is lost,
/// with r(-1), r(-2), ... as without losses before step 0. See LossModel. Without coefficients a lost value is replaced
/// by 0.
class PacketLoss : public LinkStage {
public:
  /// receiver is i >= 1. Throws std::invalid_argument unless 0 <= q < 1.
  PacketLoss(const LossModel& loss, const WhiteNoise& noise, std::uint32_t receiver);

  bool keeps_state() const override { return true; }
  void start(std::uint64_t first_realization, std::size_t count, double* positions, double slope) override;
  bool depends_on_gap() const override { return loss_.by_distance.has_value(); }
  void see_gaps(std::size_t count, const double* gaps) override;
  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override;

private:
  void lose_by_modes(std::int64_t step, const double* uniforms, const double* predicted, std::size_t size,
                     std::uint8_t* mode, double* positions) const;

  LossModel loss_;
  WhiteNoise draws_;
  std::uint32_t receiver_;
  std::vector<AlignedValues> used_;  ///< ring of r(k-1), r(k-2), ... from newest_ on, per realization
  std::size_t newest_ = 0;
  AlignedValues chance_;              ///< probability of a loss at the next step, per realization
  std::optional<ModeChances> modes_;  ///< of losses by the states of a chain
  std::vector<std::uint8_t> mode_;    ///< of the chain at the latest step, per realization
  std::vector<std::uint32_t> entry_;  ///< of the trace at the next step, per realization
};

}  // namespace platoon
