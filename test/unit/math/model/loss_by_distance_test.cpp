#include "stochastic_platoon/math/model/loss_by_distance.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/channel/link.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/transmitted.hpp"

namespace platoon {
namespace {

TEST(LossByDistance, IsLinearBetweenThePointsAndConstantOutside) {
  const LossByDistance loss({{20.0, 0.01}, {100.0, 0.2}, {110.0, 0.1}});
  const std::vector<double> gaps{-5.0, 20.0, 60.0, 100.0, 105.0, 110.0, 1e300};
  std::vector<double> probabilities(gaps.size());
  loss.probabilities(gaps.data(), gaps.size(), probabilities.data());
  const std::vector<double> expected{0.01, 0.01, 0.105, 0.2, 0.15, 0.1, 0.1};
  for (std::size_t j = 0; j < gaps.size(); ++j) EXPECT_NEAR(probabilities[j], expected[j], 1e-15) << gaps[j];
  EXPECT_EQ(loss.largest(), 0.2);
}

TEST(LossByDistance, RejectsAnInvalidTable) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using Points = std::vector<LossByDistance::Point>;
  for (const Points& points :
       {Points{}, Points{{1.0, 1.0}}, Points{{1.0, -0.1}}, Points{{1.0, nan}}, Points{{nan, 0.1}, {2.0, 0.1}},
        Points{{2.0, 0.1}, {2.0, 0.2}}, Points{{2.0, 0.1}, {1.0, 0.2}}})
    EXPECT_THROW(LossByDistance{points}, std::invalid_argument);
}

// With a car of 3 m, a position is lost at a gap of 7 m except with probability 1e-12, and never at a gap of 6 m.
TEST(Link, LosesByTheGapOfThePreviousStep) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().position().noise_variance = 0.0;
  model.default_vehicle().length = 3.0;
  LossModel loss;
  loss.by_distance.emplace(std::vector<LossByDistance::Point>{{6.0, 0.0}, {7.0, 1.0 - 1e-12}});
  loss.probability = loss.by_distance->largest();
  model.default_vehicle().position().link.loss = loss;
  Link link(model, 1, 1);
  ASSERT_TRUE(link.depends_on_gap());
  EXPECT_EQ(transmitted(link, -1, 0, {50.0, 60.0}), (std::vector<double>{50.0, 60.0}));
  const std::vector<double> predecessor{50.0, 60.0}, own{41.0, 50.0};
  EXPECT_EQ(transmitted(link, 0, 0, {51.0, 61.0}, LinkEnds{predecessor.data(), own.data()}),
            (std::vector<double>{51.0, 60.0}));
  EXPECT_THROW(transmitted(link, 1, 0, {52.0, 62.0}), std::logic_error);
}

}  // namespace
}  // namespace platoon
