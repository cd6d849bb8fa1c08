#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

struct Input;
struct LossModel;

/// One stage of the link into a follower. It changes the positions of a batch of realizations in place. A realization
/// undergoes the same operations in the same order in every batch.
class LinkStage {
public:
  virtual ~LinkStage() = default;

  /// Whether step() depends on earlier steps. If so, steps must follow in order after start().
  virtual bool keeps_state() const = 0;

  /// Step -1 of realizations first_realization .. first_realization + count - 1: fills the registers as positions [m]
  /// that have always grown by `slope` per step leave them, and passes what it would have passed of these.
  virtual void start(std::uint64_t first_realization, std::size_t count, double* positions, double slope) = 0;

  /// Whether step() depends on the gap to the predecessor. If so, see_gaps() precedes every step k >= 0.
  virtual bool depends_on_gap() const { return false; }

  /// Receives the gaps of the same realizations at step k - 1 [m], before step k.
  virtual void see_gaps(std::size_t /*count*/, const double* /*gaps*/) {}

  /// Step k >= 0 of the same realizations.
  virtual void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) = 0;
};

// The stages of a link, each in its own file. `stream` >= 1 is the receiver of a stage's draws. All throw
// std::invalid_argument for parameters outside the given ranges.

/// Quantisation with subtractive dither: s = D floor((y + nu) / D + 1/2) - nu, D >= 0 [m], with nu uniform in [-D/2,
/// D/2) and known at both ends of the link. The error s - y is white, uniform, independent of y and of variance D^2 /
/// 12 (L. Schuchman, IEEE Trans. Communication Technology 12, 1964). Null for D = 0.
std::unique_ptr<LinkStage> quantiser(const Input& input, const WhiteNoise& noise, std::uint32_t stream);

/// Coloured noise: position + sqrt(P_d) W(z) g, P_d >= 0 [m^2], with g the standard normal white noise of AwgnChannel
/// from k = 0 on and W proper and initially at rest. Null for P_d = 0.
std::unique_ptr<LinkStage> coloured_noise(const Input& input, const WhiteNoise& noise, std::uint32_t stream);

/// A delay of m >= 0 whole steps: outputs the position of step k - m; at rest that of step -1 for k < m. Null for m =
/// 0.
std::unique_ptr<LinkStage> delay_line(const Input& input);

/// Loses positions with 0 <= q < 1, independently, in bursts, by the states of a chain, as recorded or by the gap, and
/// replaces each by a prediction from its earlier outputs: r(k) = s(k) if s(k) arrives and c_1 r(k-1) + c_2 r(k-2) +
/// ... if it is lost, with r(-1), r(-2), ... as without losses before step 0. See LossModel. Without coefficients a
/// lost value is replaced by 0.
std::unique_ptr<LinkStage> packet_loss(const LossModel& loss, const WhiteNoise& noise, std::uint32_t stream);

}  // namespace platoon
