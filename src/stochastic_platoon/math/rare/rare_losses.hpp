#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
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

  /// Writes the w of realizations first .. first + count - 1, infinity without a rare mode, and the step at which their
  /// first rare mode begins, kNever without one.
  void weights(const WhiteNoise& noise, std::uint64_t first, std::size_t count, double* weights,
               std::int64_t* begins) const;
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  /// Realizations that the paths of draw(), and as many others, are not likely to contain.
  struct Unseen {
    double probability = 0.0;   ///< at most
    double realizations = 0.0;  ///< of a repetition: number from which on all are likely
  };
  /// Of several repetitions with this number of paths each. With beginnings that fewer than one path of a repetition
  /// has: of one that is no chain's, or beside a rare one (union bound). Else two rare beginnings, or a rare mode that
  /// remains where it hardly does: few pairs of steps may make up an event, so that it is at most what n paths of
  /// weight w <= M max e_c, none of which has it, leave to 5 % (rule of three, 3 w / n).
  Unseen unseen(std::size_t paths, std::uint64_t repetitions) const;

private:
  struct Chain {
    Chain(const LossModel& loss, std::int64_t steps);
    Eigen::VectorXd before(Eigen::Index mode) const;
    Eigen::VectorXd before_begin(Eigen::Index mode) const;

    std::shared_ptr<const ModeChances> chances;
    Eigen::VectorXd stationary;  ///< pi and Pi as the links draw them: a mode may be too rare for a uniform draw
    Eigen::MatrixXd transition;
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
