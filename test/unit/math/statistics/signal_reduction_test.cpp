#include "stochastic_platoon/math/statistics/signal_reduction.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "stochastic_platoon/math/model/white_noise.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

bool same_bits(double left, double right) {
  return std::memcmp(&left, &right, sizeof left) == 0;
}

std::vector<double> positions(std::uint32_t vehicle, std::size_t count) {
  std::vector<double> x(count);
  WhiteNoise(1).fill({vehicle, 0}, 0, count, x.data());
  for (double& value : x) value = 100.0 * vehicle + 0.7 * value;
  return x;
}

// Together and one by one, for batches at any place and of any size, the signals have the bits of their own values.
void expect_bits_of_the_values(const std::vector<Signal>& signals, KeptMoments kept) {
  for (const std::size_t count : {1, 2, 3, 5, 8, 100, 511, 512, 1500}) {
    std::vector<std::vector<double>> y;
    for (std::uint32_t v = 0; v < 5; ++v) y.push_back(positions(v, count));
    const SignalPositions at{y[0].data(), {y[1].data(), y[2].data(), y[3].data(), y[4].data()}, count};
    for (const std::uint64_t first : {0, 5, 512}) {
      std::vector<double> first_values(count);
      const auto found = reduce_signals(first, signals, at, kept, first_values.data());
      ASSERT_EQ(found.size(), signals.size());
      EXPECT_EQ(first_values, at.of(signals.front()));
      for (std::size_t s = 0; s < signals.size(); ++s) {
        const std::vector<double> values = at.of(signals[s]);
        const auto in_place = [&values](std::size_t offset, std::size_t, double*) { return values.data() + offset; };
        const std::vector<MomentNode> expected = reduce_batch(first, count, in_place, kept);
        ASSERT_EQ(found[s].size(), expected.size());
        for (std::size_t n = 0; n < expected.size(); ++n) {
          EXPECT_TRUE(same_bits(found[s][n].mean, expected[n].mean)) << s << ", " << count;
          EXPECT_TRUE(same_bits(found[s][n].squared_deviations, expected[n].squared_deviations)) << s << ", " << count;
          EXPECT_TRUE(same_bits(found[s][n].fourth_deviations, expected[n].fourth_deviations)) << s << ", " << count;
        }
      }
    }
  }
}

std::vector<Signal> requested(const std::vector<std::string>& names) {
  return signals_of(paper_platoon(), names, 1).requested;
}

TEST(SignalReduction, HasTheBitsOfEachSignalAlone) {
  expect_bits_of_the_values({tracking_error(paper_platoon(), 1)}, KeptMoments::two);
  expect_bits_of_the_values(requested({"gap"}), KeptMoments::two);
  expect_bits_of_the_values(requested({"speed", "acceleration"}), KeptMoments::two);
  expect_bits_of_the_values(requested({"gap", "speed", "jerk"}), KeptMoments::two);
  expect_bits_of_the_values(requested({"gap", "speed", "acceleration", "jerk"}), KeptMoments::two);
}

TEST(SignalReduction, KeepsFourMomentsOneByOne) {
  expect_bits_of_the_values(requested({"gap", "acceleration"}), KeptMoments::four);
}

}  // namespace
}  // namespace platoon
