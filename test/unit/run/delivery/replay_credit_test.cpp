#include "stochastic_platoon/run/delivery/replay_credit.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

constexpr CreditLimits kLimits{4, 2.0, 0.1};  // window, stall_timeout [s], first_step_timeout [s]
constexpr std::int64_t kSteps = 5;            // of a batch

// Sends all allowed messages; returns their number.
std::int64_t send_all(ReplayCredit& credit, double now) {
  const std::int64_t before = credit.upcoming();
  while (credit.may_send()) credit.send(credit.upcoming() % kSteps == 0, now);
  return credit.upcoming() - before;
}

TEST(ReplayCredit, AllowsOneMessageUntilTheFirstAnswerAndThenAWindow) {
  ReplayCredit credit(kLimits);
  EXPECT_EQ(send_all(credit, 0.0), 1);
  credit.answer(true, 0.05);
  EXPECT_EQ(send_all(credit, 0.05), 4);
  credit.answer(false, 0.06);
  EXPECT_EQ(send_all(credit, 0.06), 1);
}

TEST(ReplayCredit, RepeatsTheFirstMessageWhoseAnswerWasLost) {
  ReplayCredit credit(kLimits);
  send_all(credit, 0.0);
  EXPECT_FALSE(credit.retry_if_stalled(0.09));
  EXPECT_TRUE(credit.retry_if_stalled(0.11));
  EXPECT_EQ(credit.upcoming(), 0);
  send_all(credit, 0.11);
  EXPECT_FALSE(credit.retry_if_stalled(0.24)) << "the second attempt has half as much time again";
  EXPECT_TRUE(credit.retry_if_stalled(0.27));
  EXPECT_EQ(credit.repetitions(), 2u);
  send_all(credit, 0.27);
  credit.answer(true, 0.3);
  EXPECT_EQ(send_all(credit, 0.3), 4);
}

TEST(ReplayCredit, RestartsWithTheUnansweredBatch) {
  ReplayCredit credit(kLimits);
  double now = 0.0;
  for (std::int64_t n = 0; n < 7; ++n, now += 0.01) {
    send_all(credit, now);
    credit.answer(n % kSteps == 0, now);
  }
  send_all(credit, now);
  EXPECT_EQ(credit.upcoming(), 11) << "it is in the third batch, the second is not answered";
  EXPECT_FALSE(credit.retry_if_stalled(now + 1.9));
  EXPECT_TRUE(credit.retry_if_stalled(now + 2.1));
  EXPECT_EQ(credit.upcoming(), 5);
  EXPECT_EQ(credit.last_progress(), now - 0.01);
  // Earlier answers are no progress.
  now += 2.2;
  send_all(credit, now);
  credit.answer(true, now);
  EXPECT_LT(credit.last_progress(), now);
}

TEST(ReplayCredit, AbandonsAnAttemptAtOnceOnlyIfItHasFlowed) {
  ReplayCredit credit(kLimits);
  send_all(credit, 0.0);
  EXPECT_FALSE(credit.give_up(0.01)) << "links may be coming up";
  credit.answer(true, 0.02);
  send_all(credit, 0.02);
  EXPECT_TRUE(credit.give_up(0.03));
  EXPECT_EQ(credit.upcoming(), 0);
  send_all(credit, 0.03);
  credit.answer(true, 0.04);
  EXPECT_FALSE(credit.give_up(0.05)) << "it fails at the same message again";
  send_all(credit, 0.05);
  EXPECT_TRUE(credit.retry_if_stalled(2.06));
}

TEST(ReplayCredit, RepeatsNoFlowingAttemptWithoutAStallTimeout) {
  ReplayCredit credit({4, 0.0, 0.1});
  send_all(credit, 0.0);
  EXPECT_TRUE(credit.retry_if_stalled(0.2));
  send_all(credit, 0.2);
  credit.answer(true, 0.3);
  send_all(credit, 0.3);
  EXPECT_FALSE(credit.retry_if_stalled(1000.0));
  EXPECT_FALSE(credit.give_up(1000.0));
}

// If an attempt was abandoned during the recording, one topic may hold more of its messages than the other.
TEST(ReplayCredit, MatchesTheAnswersOfABatchByTheFirstOne) {
  ReplayCredit credit(kLimits);
  credit.send(true, 0.0);
  credit.answer(true, 0.0);
  credit.send(false, 0.0);
  credit.send(false, 0.0);  // never answered in the recording
  credit.answer(false, 0.0);
  credit.send(true, 0.0);
  credit.answer(true, 0.0);
  EXPECT_FALSE(credit.retry_if_stalled(1000.0)) << "all is answered";
  credit.send(false, 1000.0);
  EXPECT_TRUE(credit.retry_if_stalled(1002.1));
  EXPECT_EQ(credit.upcoming(), 3);
}

}  // namespace
}  // namespace platoon
