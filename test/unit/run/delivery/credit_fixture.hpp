#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "stochastic_platoon/run/delivery/credit.hpp"
#include "unit/run/delivery/message_ids.hpp"

namespace platoon {

inline const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and 16, four steps each
inline const CreditLimits kLimits{5, 2.0, 0.5};
inline const std::string kMonitor = "monitor", kRecorder = "recorder";

/// The messages that may be published at this time, at most 1000.
inline std::vector<MessageId> published(Credit& credit, double now = 0.0) {
  std::vector<MessageId> ids;
  while (const std::optional<MessageId> id = credit.next(now)) {
    ids.push_back(*id);
    if (ids.size() > 1000) break;
  }
  return ids;
}

inline void expect_published(const std::vector<MessageId>& found, const std::vector<MessageId>& expected) {
  EXPECT_EQ(found, expected);
}

/// The monitor has reported that nothing has arrived.
inline Credit with_monitor(const BatchSchedule& schedule = kSchedule, const CreditLimits& limits = kLimits) {
  Credit credit(schedule, limits, {kMonitor});
  EXPECT_TRUE(credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.0));
  return credit;
}

/// The first attempt has begun, and its initial step is acknowledged.
inline Credit under_way(double now = 0.0) {
  Credit credit = with_monitor();
  expect_published(published(credit, now), {{1, 0, -1}});
  credit.acknowledge(kMonitor, {1, 0, -1}, now);
  return credit;
}

/// Expects a stall at `now`, not before, and a new attempt that begins at `turn`.
inline void expect_retry_at(Credit& credit, double now, const MessageId& turn) {
  EXPECT_FALSE(credit.retry_if_stalled(now - 1e-9));
  EXPECT_TRUE(credit.retry_if_stalled(now + 1e-9));
  EXPECT_EQ(credit.attempt(), turn.attempt);
  expect_published(published(credit, now), {turn});
}

}  // namespace platoon
