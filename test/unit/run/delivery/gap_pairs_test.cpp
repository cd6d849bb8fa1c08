#include "stochastic_platoon/run/delivery/gap_pairs.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <tuple>
#include <vector>

namespace platoon {
namespace {

struct Message {
  std::uint64_t run;
  std::uint32_t attempt;
  std::uint64_t first_realization;
  std::int64_t step;
};

using Pointer = std::shared_ptr<const Message>;

Pointer message(std::uint32_t attempt, std::uint64_t first, std::int64_t step, std::uint64_t run = 1) {
  return std::make_shared<const Message>(Message{run, attempt, first, step});
}

constexpr std::int64_t kNone = -9;
using Sent =
    std::vector<std::tuple<std::uint32_t, std::uint64_t, std::int64_t, std::int64_t>>;  // the last: step of the ends

Sent sent_by(GapPairs<Pointer>& pairs) {
  Sent found;
  pairs.visit(1, [&found](const Message& sent, const Message* predecessor, const Message* own) {
    EXPECT_EQ(predecessor == nullptr, own == nullptr);
    if (own != nullptr) {
      EXPECT_EQ(std::tie(own->run, own->attempt, own->first_realization, own->step),
                std::tie(predecessor->run, predecessor->attempt, predecessor->first_realization, predecessor->step));
      EXPECT_EQ(std::tie(own->attempt, own->first_realization), std::tie(sent.attempt, sent.first_realization));
    }
    found.emplace_back(sent.attempt, sent.first_realization, sent.step, own == nullptr ? kNone : own->step);
  });
  return found;
}

void add_both(GapPairs<Pointer>& pairs, const Pointer& message) {
  pairs.add_sent(message);
  pairs.add_predecessor(message);
}

TEST(GapPairs, HaveAMessageOnceBothEndsOfTheStepBeforeHaveArrived) {
  GapPairs<Pointer> pairs;
  add_both(pairs, message(1, 0, -1));
  add_both(pairs, message(1, 0, 0));
  add_both(pairs, message(1, 0, 1));
  EXPECT_EQ(sent_by(pairs), (Sent{{1, 0, -1, kNone}}));
  pairs.add_own(message(1, 0, -1));
  EXPECT_EQ(sent_by(pairs), (Sent{{1, 0, 0, -1}}));
  pairs.add_own(message(1, 0, 0));
  EXPECT_EQ(sent_by(pairs), (Sent{{1, 0, 1, 0}}));
}

TEST(GapPairs, ContinueWithTheNextBatch) {
  GapPairs<Pointer> pairs;
  Sent all;
  for (const std::uint64_t first : {0, 10, 20}) {
    for (const std::int64_t step : {-1, 0, 1}) {
      add_both(pairs, message(1, first, step));
      for (const auto& sent : sent_by(pairs)) all.push_back(sent);
      pairs.add_own(message(1, first, step));
      for (const auto& sent : sent_by(pairs)) all.push_back(sent);
    }
  }
  ASSERT_EQ(all.size(), 9u);
  for (std::size_t j = 0; j < all.size(); ++j) {
    const auto step = static_cast<std::int64_t>(j % 3) - 1;
    EXPECT_EQ(all[j], std::make_tuple(1u, 10 * (j / 3), step, step == -1 ? kNone : step - 1));
  }
}

// The follower answers step -1 of the new attempt, even if it has not answered messages of the older one.
TEST(GapPairs, OmitAnOlderAttempt) {
  GapPairs<Pointer> pairs;
  for (const std::int64_t step : {-1, 0, 1}) add_both(pairs, message(1, 0, step));
  pairs.add_own(message(1, 0, -1));
  EXPECT_EQ(sent_by(pairs), (Sent{{1, 0, -1, kNone}, {1, 0, 0, -1}}));
  add_both(pairs, message(2, 0, -1));
  EXPECT_EQ(sent_by(pairs), (Sent{{2, 0, -1, kNone}}));
  pairs.add_own(message(1, 0, 0));
  add_both(pairs, message(2, 0, 0));
  EXPECT_TRUE(sent_by(pairs).empty());
  pairs.add_own(message(2, 0, -1));
  EXPECT_EQ(sent_by(pairs), (Sent{{2, 0, 0, -1}}));
}

TEST(GapPairs, OmitAnotherRun) {
  GapPairs<Pointer> pairs;
  for (const std::int64_t step : {-1, 0}) pairs.add_own(message(5, 0, step, 7));
  for (const std::int64_t step : {-1, 0}) pairs.add_own(message(1, 0, step));
  for (const std::int64_t step : {-1, 0, 1}) add_both(pairs, message(1, 0, step));
  EXPECT_EQ(sent_by(pairs), (Sent{{1, 0, -1, kNone}, {1, 0, 0, -1}, {1, 0, 1, 0}}));
}

}  // namespace
}  // namespace platoon
