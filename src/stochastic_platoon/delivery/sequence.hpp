#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stochastic_platoon/delivery/batch_schedule.hpp"

namespace platoon {

/// What a receiver makes of a message. All but in_turn are dropped.
enum class Verdict {
  in_turn,
  stale,         ///< belongs to an older attempt: expected after a restart, no fault
  missed_start,  ///< belongs to an attempt whose step -1 never came: expected while links come up, no fault
  out_of_turn,   ///< a gap, a duplicate, or a batch that is not due
  wrong_size,    ///< not one position per realization of the batch
  not_finite,    ///< a NaN or an infinity
};
constexpr std::size_t kVerdicts = 6;

/// "in turn", "out of turn", ...
const char* to_string(Verdict verdict);

/// The order in which one vehicle's positions must arrive: all steps of a batch from -1 on, then the next
/// batch. A newer attempt is taken up only at step -1; what belongs to an older one is stale.
class Sequence {
public:
  explicit Sequence(const BatchSchedule& schedule) : schedule_(schedule) {}

  /// Judges a message and, if it is in turn, moves on.
  Verdict receive(const Turn& turn, const std::vector<double>& positions);

  /// The latest turn taken, if any.
  const std::optional<Turn>& latest() const { return latest_; }

private:
  bool continues(const Turn& turn) const;

  BatchSchedule schedule_;
  std::optional<Turn> latest_;
};

/// Whether every value is finite.
bool all_finite(const std::vector<double>& values);

}  // namespace platoon
