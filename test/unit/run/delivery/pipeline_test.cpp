#include "stochastic_platoon/run/delivery/pipeline.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

constexpr std::size_t kLongest = 128;

std::size_t lead_of(std::size_t follower, std::size_t followers) {
  std::size_t lead = 0;
  for (std::size_t i = 1; i <= follower; ++i) lead += publishes_ahead(i, followers, kLongest) ? 1 : 0;
  return lead;
}

TEST(Lead, AllLeadInAShortString) {
  for (const std::size_t followers : {std::size_t{1}, std::size_t{20}, kLongest}) {
    EXPECT_EQ(lead_of(followers, followers), followers);
  }
}

TEST(Lead, IsBoundedAndSpreadAlongALongString) {
  for (const std::size_t followers : {kLongest + 1, std::size_t{500}, std::size_t{100000}}) {
    EXPECT_EQ(lead_of(followers, followers), kLongest);
    EXPECT_EQ(lead_of(followers / 2, followers), kLongest * (followers / 2) / followers);
  }
}

TEST(Lead, MessagesOfTheFirstStep) {
  EXPECT_EQ(messages_of_first_step(4, 4, 100), 1u + 2u + 3u + 4u + 5u);
  EXPECT_EQ(messages_of_first_step(4, 4, 0), 15u);
  EXPECT_EQ(messages_of_first_step(4, 4, 2), 1u + 2u + 3u + 3u + 3u);  // a batch has three messages per vehicle
  EXPECT_EQ(messages_of_first_step(4, 2, 100), 1u + 1u + 2u + 2u + 3u);
  EXPECT_EQ(messages_of_first_step(4, 0, 100), 5u);
}

TEST(Lead, CanBeNone) {
  for (std::size_t i = 1; i <= 9; ++i) EXPECT_FALSE(publishes_ahead(i, 9, 0));
}

}  // namespace
}  // namespace platoon
