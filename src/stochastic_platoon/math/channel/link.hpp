#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/channel/awgn_channel.hpp"
#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The link of input n, 0 .. 31, into vehicle i below 2^23 draws as receiver i + 2^23 (n mod 2) + 2^28 [n / 2]: no bit
/// of it is one of the purpose's in the counter of a draw (see WhiteNoise).
constexpr std::uint32_t input_stream(std::uint32_t vehicle, std::uint32_t input) {
  return vehicle | (input & 1u) << 23 | (input >> 1) << 28;
}
constexpr std::uint32_t vehicle_of_stream(std::uint32_t stream) {
  return stream & ((1u << 23) - 1u);
}
constexpr std::uint32_t input_of_stream(std::uint32_t stream) {
  return (stream >> 23 & 1u) | (stream >> 28) << 1;
}

/// The stream by which the link of input n into a vehicle loses: that of the first input of its packet.
std::uint32_t loss_stream(const PlatoonModel& model, std::uint32_t receiver, std::uint32_t input);

/// The positions of both ends of a link one step earlier, per realization [m].
struct LinkEnds {
  const double* predecessor = nullptr;  ///< y_{i-1}(k-1)
  const double* own = nullptr;          ///< y_i(k-1)
};

/// The link of an input of vehicle i, which transmits a signal of its source, positions y(k) or v(k) = u(k-1) (see
/// Input). The inputs of a packet share the draws of the losses.
///
///     quantise -> + noise -> delay -> loss
///
/// (see LinkModel). At step -1 every stage is as the start of the platoon leaves it: see Start.
///
/// Every draw is a pure function of (seed, purpose, i, k, r). A link with stages that keep state requires the steps of
/// a batch in order, from step -1 on; any other link, such as the paper's, accepts steps in any order.
class Link {
public:
  /// receiver is i >= 1, input the index n of its VehicleModel::inputs. Throws std::invalid_argument if the constructor
  /// of a stage does and for a radio without delay, and std::out_of_range if the vehicle has no input of this index.
  Link(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t receiver, std::uint32_t input = 0);

  /// A link of these stages, in this order.
  explicit Link(std::vector<std::unique_ptr<LinkStage>> stages);

  Link(const Link&) = delete;  // so that vectors of classes that contain a Link move it
  Link(Link&&) = default;
  Link& operator=(Link&&) = default;

  bool keeps_state() const { return keeps_state_; }

  /// Whether steps k >= 0 need the ends of the link at step k - 1, because its losses depend on the gap.
  bool depends_on_gap() const { return depends_on_gap_; }

  /// sent and received: one position [m] or input [m/s^2] per realization first_realization .. first_realization +
  /// count - 1. Throws std::logic_error if the ends are needed and not given.
  void transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                double* received, const LinkEnds& before = {});
  void transmit(std::int64_t step, std::uint64_t first_realization, const std::vector<double>& sent,
                std::vector<double>& received, const LinkEnds& before = {}) {
    received.resize(sent.size());
    transmit(step, first_realization, sent.data(), sent.size(), received.data(), before);
  }

private:
  void take(std::vector<std::unique_ptr<LinkStage>> stages);

  AwgnChannel noise_;                               ///< the paper's channel
  std::vector<std::unique_ptr<LinkStage>> stages_;  ///< replace noise_; empty if the link is the paper's
  bool keeps_state_ = false, depends_on_gap_ = false;
  double length_ = 0.0;  ///< of the predecessor [m]
  double slope_ = 0.0;   ///< start_slope() of what is sent
  std::vector<double> gaps_;
};

}  // namespace platoon
