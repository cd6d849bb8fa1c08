#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/model/link_stage.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"

namespace platoon {

/// The link into vehicle i: what becomes of its predecessor's positions on their way to it,
///     quantise -> + noise -> delay -> loss
/// (see LinkModel). At step -1 every stage passes the position on and fills its registers with it.
///
/// Every draw is a pure function of (seed, purpose, i, k, r). A link whose stages keep state takes the steps of
/// a batch in turn, from step -1 on; any other, the paper's among them, takes each by its name alone.
class Link {
public:
  /// receiver is i >= 1. Throws std::invalid_argument for what a stage cannot be.
  Link(const PlatoonModel& model, std::uint64_t seed, std::uint32_t receiver);

  /// Of stages of one's own, in this order.
  explicit Link(std::vector<std::unique_ptr<LinkStage>> stages);

  Link(const Link&) = delete;  // so that a vector of what holds one does not try to copy it
  Link(Link&&) = default;
  Link& operator=(Link&&) = default;

  bool keeps_state() const { return keeps_state_; }

  /// sent and received: one position per realization first_realization .. first_realization + count - 1 [m].
  void transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                double* received);
  void transmit(std::int64_t step, std::uint64_t first_realization, const std::vector<double>& sent,
                std::vector<double>& received) {
    received.resize(sent.size());
    transmit(step, first_realization, sent.data(), sent.size(), received.data());
  }

private:
  void take(std::vector<std::unique_ptr<LinkStage>> stages);

  AwgnChannel noise_;                               ///< the paper's channel
  std::vector<std::unique_ptr<LinkStage>> stages_;  ///< in its place; none where it is all there is
  bool keeps_state_ = false;
};

}  // namespace platoon
