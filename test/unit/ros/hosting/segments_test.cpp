#include "stochastic_platoon/ros/hosting/segments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace platoon {
namespace {

std::vector<std::size_t> threads_of(const Segments& segments, std::size_t followers) {
  std::vector<std::size_t> threads;
  for (std::size_t i = 1; i <= followers; ++i) threads.push_back(segments.thread_of(i));
  return threads;
}

TEST(Segments, AlternateTheirDirection) {
  EXPECT_EQ(threads_of(Segments(20, 2), 20),
            (std::vector<std::size_t>{0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(threads_of(Segments(6, 3), 6), (std::vector<std::size_t>{0, 1, 2, 2, 1, 0}));
}

TEST(Segments, UseEveryThreadAndNoOther) {
  for (std::size_t followers = 1; followers <= 60; ++followers) {
    for (std::size_t threads = 1; threads <= 9; ++threads) {
      const Segments segments(followers, threads);
      EXPECT_EQ(segments.threads(), std::min(followers, threads));
      std::vector<std::size_t> load(segments.threads(), 0);
      for (const std::size_t thread : threads_of(segments, followers)) ++load.at(thread);
      if (followers >= 5 * 2 * threads) {
        EXPECT_GT(*std::min_element(load.begin(), load.end()), 0u);
      }
      EXPECT_EQ(segments.thread_of(0), 0u) << "the leader";
    }
  }
}

TEST(Segments, KeepAtMostFiveNeighboursTogether) {
  const std::vector<std::size_t> threads = threads_of(Segments(500, 2), 500);
  std::size_t run = 1, longest = 1;
  for (std::size_t i = 1; i < threads.size(); ++i) {
    run = threads[i] == threads[i - 1] ? run + 1 : 1;
    longest = std::max(longest, run);
  }
  EXPECT_EQ(longest, 10u) << "two segments meet where the dealing turns";
}

}  // namespace
}  // namespace platoon
