#pragma once

#include <vector>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

/// A delay of m whole steps: outputs the position of step k - m; at rest that of step -1 for k < m.
class DelayLine : public LinkStage {
public:
  /// Throws std::invalid_argument unless m >= 1.
  explicit DelayLine(std::int64_t steps);

  bool keeps_state() const override { return true; }
  void start(std::uint64_t first_realization, std::size_t count, double* positions, double slope) override;
  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override;

private:
  std::vector<AlignedValues> registers_;  ///< ring of the last m positions, per realization
  std::size_t oldest_ = 0;
};

}  // namespace platoon
