#include "stochastic_platoon/run/delivery/pipeline.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

constexpr std::size_t kDepth = 128;

// The number of followers up to this one that publish ahead.
std::size_t ahead_of(std::size_t follower, std::size_t followers) {
  std::size_t ahead = 0;
  for (std::size_t i = 1; i <= follower; ++i) ahead += publishes_ahead(i, followers, kDepth) ? 1 : 0;
  return ahead;
}

TEST(Pipeline, HasAllFollowersOfAShortString) {
  for (const std::size_t followers : {std::size_t{1}, std::size_t{20}, kDepth}) {
    EXPECT_EQ(ahead_of(followers, followers), followers);
  }
}

TEST(Pipeline, IsBoundedAndSpreadAlongALongString) {
  for (const std::size_t followers : {kDepth + 1, std::size_t{500}, std::size_t{100000}}) {
    EXPECT_EQ(ahead_of(followers, followers), kDepth);
    EXPECT_EQ(ahead_of(followers / 2, followers), kDepth * (followers / 2) / followers);
  }
}

TEST(Pipeline, DeterminesTheMessagesOfTheFirstStep) {
  EXPECT_EQ(messages_of_first_step(4, 4, 100), 1u + 2u + 3u + 4u + 5u);
  EXPECT_EQ(messages_of_first_step(4, 4, 0), 15u);
  EXPECT_EQ(messages_of_first_step(4, 4, 2), 1u + 2u + 3u + 3u + 3u);  // a batch has three messages per vehicle
  EXPECT_EQ(messages_of_first_step(4, 2, 100), 1u + 1u + 2u + 2u + 3u);
  EXPECT_EQ(messages_of_first_step(4, 0, 100), 5u);
}

TEST(Pipeline, MayBeEmpty) {
  for (std::size_t i = 1; i <= 9; ++i) EXPECT_FALSE(publishes_ahead(i, 9, 0));
}

}  // namespace
}  // namespace platoon
