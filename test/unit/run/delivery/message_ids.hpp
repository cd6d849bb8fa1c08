#pragma once

#include <ostream>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// For EXPECT_EQ of ids and acknowledgements.
inline bool operator==(const MessageId& left, const MessageId& right) {
  return left.attempt == right.attempt && left.first_realization == right.first_realization && left.step == right.step;
}

/// Shows an id in a failed expectation.
inline void PrintTo(const MessageId& id, std::ostream* out) {
  *out << "attempt " << id.attempt << ", realization " << id.first_realization << ", step " << id.step;
}

}  // namespace platoon
