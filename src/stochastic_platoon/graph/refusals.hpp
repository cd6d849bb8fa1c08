#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "stochastic_platoon/delivery/sequence.hpp"

namespace platoon {

/// Counts the messages a component has dropped and says so on the console, at most once a second per topic.
/// What is expected after a restart or while links come up is counted in silence.
class Refusals {
public:
  explicit Refusals(std::string topic) : topic_(std::move(topic)) {}

  void count(Verdict verdict, const Turn& turn, std::size_t size);

  std::uint64_t of(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }

private:
  std::string topic_;
  std::array<std::uint64_t, kVerdicts> counts_{};
  double last_said_ = -1.0;  ///< [s]
};

}  // namespace platoon
