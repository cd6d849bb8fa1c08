#include "stochastic_platoon/math/statistics/signal_reduction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "unit/math/noise/draw.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/same_bits.hpp"

namespace platoon {
namespace {

std::vector<double> positions(std::uint32_t vehicle, std::size_t count) {
  std::vector<double> x = draw(1, {vehicle, 0}, 0, count);
  for (double& value : x) value = 100.0 * vehicle + 0.7 * value;
  return x;
}

void expect_same_nodes(const std::vector<MomentNode>& found, const std::vector<MomentNode>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n) {
    EXPECT_TRUE(same_bits(found[n].mean, expected[n].mean));
    EXPECT_TRUE(same_bits(found[n].squared_deviations, expected[n].squared_deviations));
    EXPECT_TRUE(same_bits(found[n].fourth_deviations, expected[n].fourth_deviations));
  }
}

// Reduced together or one by one, for batches of any start and size, the signals have the bits of reduce_batch().
void expect_bits_of_the_values(const FollowerSignals& signals, KeptMoments kept) {
  for (const std::size_t count : {1, 2, 3, 5, 8, 16, 100, 511, 512, 1500, 9000}) {
    std::vector<std::vector<double>> y;
    for (std::uint32_t v = 0; v < 5; ++v) y.push_back(positions(v, count));
    const SignalPositions at{{y[0].data(), y[2].data()}, {y[1].data(), y[2].data(), y[3].data(), y[4].data()}, count};
    for (const std::uint64_t first : {0, 5, 512}) {
      SCOPED_TRACE(std::to_string(count) + " realizations from " + std::to_string(first));
      std::vector<double> errors(count), smallest(count, std::numeric_limits<double>::infinity());
      SignalReduction reduction(first, count, kept);
      reduction.reduce(signals, at, {errors.data(), smallest.data()});
      const std::vector<double> first_values = at.of(signals.requested.front());
      EXPECT_EQ(smallest, first_values);
      EXPECT_EQ(reduction.least(), *std::min_element(smallest.begin(), smallest.end()));
      // New values above and below the kept ones.
      for (std::size_t r = 0; r < count; ++r) smallest[r] = first_values[r] + (r % 3 == 0 ? -1.0 : 1.0);
      const auto found = reduction.reduce(signals, at, {errors.data(), smallest.data()});
      for (std::size_t r = 0; r < count; ++r)
        EXPECT_EQ(smallest[r], r % 3 == 0 ? first_values[r] - 1.0 : first_values[r]);
      EXPECT_EQ(reduction.least(), *std::min_element(first_values.begin(), first_values.end()));
      ASSERT_EQ(found.size(), signals.requested.size());
      EXPECT_EQ(errors, at.of(signals.error));
      const auto formed = [&errors](std::size_t offset, std::size_t, double*) { return errors.data() + offset; };
      expect_same_nodes(reduce_signal(first, signals.error, at, kept), reduce_batch(first, count, formed, kept));
      const auto without_values = SignalReduction(first, count, kept).reduce(signals, at, {});
      for (std::size_t s = 0; s < found.size(); ++s) {
        const std::vector<double> values = at.of(signals.requested[s]);
        const auto in_place = [&values](std::size_t offset, std::size_t, double*) { return values.data() + offset; };
        const std::vector<MomentNode> expected = reduce_batch(first, count, in_place, kept);
        expect_same_nodes(found[s], expected);
        expect_same_nodes(without_values[s], expected);
        expect_same_nodes(reduce_signal(first, signals.requested[s], at, kept), expected);
      }
    }
  }
}

FollowerSignals signals(const std::vector<std::string>& names) {
  PlatoonModel model = paper_platoon();
  model.sample_period = 0.3;
  return signals_of(model, names, 1);
}

TEST(SignalReduction, HasTheBitsOfEachSignalAlone) {
  expect_bits_of_the_values(signals({"gap"}), KeptMoments::two);
  expect_bits_of_the_values(signals({"speed", "acceleration"}), KeptMoments::two);
  expect_bits_of_the_values(signals({"gap", "speed", "jerk"}), KeptMoments::two);
  expect_bits_of_the_values(signals({"gap", "speed", "acceleration", "jerk"}), KeptMoments::two);
  expect_bits_of_the_values(signals({"relative_speed", "gap", "speed"}), KeptMoments::two);
}

TEST(SignalReduction, AcceptsSignalsOfAnyForm) {
  FollowerSignals odd = signals({"jerk", "gap", "speed"});
  odd.requested.front().own.factor = 1e-3;  // so that the least value is not that of the gap, either
  odd.error = {{1.0, 0}, 1.5, {-0.3, 2}};
  odd.requested.push_back({{1.0, 0}, 2.0, {-0.7, 1}});
  odd.requested.push_back(odd.requested.front());
  expect_bits_of_the_values(odd, KeptMoments::two);
}

TEST(SignalReduction, FormsErrorsWithoutRequestedSignals) {
  const std::vector<double> ahead = positions(0, 9), own = positions(1, 9), before = positions(2, 9);
  const SignalPositions at{{ahead.data()}, {own.data(), before.data(), nullptr, nullptr}, 9};
  std::vector<double> errors(9);
  EXPECT_TRUE(SignalReduction(3, 9, KeptMoments::two).reduce(signals({}), at, {errors.data(), nullptr}).empty());
  EXPECT_EQ(errors, at.of(signals({}).error));
}

TEST(SignalReduction, KeepsFourMomentsOneByOne) {
  expect_bits_of_the_values(signals({"gap", "acceleration"}), KeptMoments::four);
}

}  // namespace
}  // namespace platoon
