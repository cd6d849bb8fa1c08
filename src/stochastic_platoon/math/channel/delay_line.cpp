#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

namespace {

class DelayLine : public LinkStage {
public:
  explicit DelayLine(std::int64_t steps) {
    if (steps < 1) throw std::invalid_argument("delay: " + std::to_string(steps) + ": must be >= 0 here");
    registers_.resize(static_cast<std::size_t>(steps));
  }

  bool keeps_state() const override { return true; }

  void start(std::uint64_t, std::size_t count, double* positions, double slope) override {
    oldest_ = 0;
    for (std::size_t j = registers_.size(); j-- > 0;) {  // from the position of step -1 back
      registers_[j].assign(positions, positions + count);
      if (slope == 0.0) continue;
      for (std::size_t r = 0; r < count; ++r) positions[r] -= slope;
    }
  }

  void step(std::int64_t, std::uint64_t, std::size_t count, double* positions) override {
    std::swap_ranges(positions, positions + count, registers_[oldest_].begin());
    oldest_ = (oldest_ + 1) % registers_.size();
  }

private:
  std::vector<AlignedValues> registers_;  ///< ring of the last m positions, per realization
  std::size_t oldest_ = 0;
};

}  // namespace

std::unique_ptr<LinkStage> delay_line(const Input& input) {
  return input.delay() == 0 ? nullptr : std::make_unique<DelayLine>(input.delay());
}

}  // namespace platoon
