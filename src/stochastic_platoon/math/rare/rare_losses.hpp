#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/channel/mode_chances.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

/// The modes that a link's losses have at the steps 0, 1, ... of a realization, up to the last of these.
struct GivenModes {
  std::uint32_t stream;  ///< see loss_stream()
  std::shared_ptr<const ModeChances> chances;
  std::vector<std::uint8_t> modes;

  /// Maps a uniform draw of a step to one that leads to the step's mode.
  double draw(std::int64_t step, double uniform) const;
};

/// The losses of the first vehicles that few realizations have: modes c of the links' LossChain that begin in K steps
/// less than kMost / n times on average, for n lossy links,
/// \f[ e_c = \pi_c + (K - 1) \sum_{b \ne c} \pi_b \Pi_{bc}. \f]
///
/// draw() gives realizations that have one of them: it chooses one of the M modes, all equally often, and the step at
/// which it begins, in proportion to the probability, and the modes before that step by the reversed chain. With
/// w = M / sum 1 / e_c over all beginnings in such a realization, P(A, and a rare mode begins) = E[w 1_A].
class RareLosses {
public:
  static constexpr double kMost = 0.2;

  RareLosses(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

  bool empty() const { return rare_.empty(); }

  /// The mean number of rare modes that begin in a realization: the sum of e_c.
  double expected() const { return expected_; }

  /// Modes of one link, from uniform values.
  std::shared_ptr<const GivenModes> draw(const std::function<double()>& uniform) const;

  /// Writes the w of realizations first .. first + count - 1; infinity without a rare mode.
  void weights(const WhiteNoise& noise, std::uint64_t first, std::size_t count, double* weights) const;

  /// Realizations that a number of paths of draw(), and as many others, is not likely to contain.
  struct Unseen {
    double probability = 0.0;   ///< union bound: of a mode beside a rare one, and of losses that are no chain
    double realizations = 0.0;  ///< number from which on all are likely
  };
  Unseen unseen(std::size_t paths) const;

private:
  struct Chain {
    LossChain chain;
    std::shared_ptr<const ModeChances> chances;
    Eigen::VectorXd begins;  ///< e_c
    bool is_drawn;           ///< by the chain alone: neither recorded nor by the distance
  };
  struct Place {
    std::uint32_t stream;
    std::shared_ptr<const Chain> of;
  };

  std::int64_t steps_;
  std::vector<Place> places_;                               ///< of all links that lose
  std::vector<std::pair<std::size_t, Eigen::Index>> rare_;  ///< places and modes
  double expected_ = 0.0;
};

}  // namespace platoon
