#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace platoon {

class LossChain;

/// The modes of a LossChain as functions of uniform draws: the lost modes share the draws below the probability of a
/// loss, as links with two modes decide.
class ModeChances {
public:
  explicit ModeChances(const LossChain& chain);

  /// The mode that follows one, or begins the chain, for a uniform draw.
  std::uint8_t after(std::size_t mode, double uniform) const;
  std::uint8_t first(double uniform) const { return after(start(), uniform); }

  bool is_lost(std::uint8_t mode) const { return mode >= arrived_; }

  /// Stands for the mode before the first one.
  std::size_t start() const { return modes_.size() - 1; }

  /// The share of the uniform draws that lead from one mode to another.
  double probability(std::size_t from, std::uint8_t to) const;

  /// A uniform draw from those that lead from one mode to another of positive probability.
  double leading(std::size_t from, std::uint8_t to, double uniform) const;

private:
  struct Share {
    double upto;  ///< of a uniform draw
    std::uint8_t mode;
  };
  std::vector<std::vector<Share>> modes_;  ///< behind each mode, and at last the stationary ones
  std::size_t arrived_;
};

}  // namespace platoon
