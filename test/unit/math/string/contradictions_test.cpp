#include "stochastic_platoon/math/string/contradictions.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/math/lossy_platoon.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

/// The figures of a platoon, to be changed.
struct Figures {
  Figures(const PlatoonModel& of, std::size_t followers, std::int64_t steps)
      : model(of),
        verdict(string_stability(of)),
        stationary(stationary_variances(of, followers)),
        moments(error_moments(of, followers, steps)) {}

  std::vector<std::string> contradictions() const {
    return platoon::contradictions(model, {verdict, stationary, moments.variance, moments.steps});
  }

  PlatoonModel model;
  StringStability verdict;
  std::vector<double> stationary;
  SignalMoments moments;
};

TEST(Contradictions, AreNoneInAnyTheory) {
  PlatoonModel unlike = radio_platoon(0.5, 0.01, 0.02);
  add_trucks(unlike, 0.25, 0.213, 0.9);
  PlatoonModel losing = unlike;
  lose_inputs(losing, 0.2, {1.0});
  for (const PlatoonModel& model : {paper_platoon(3.2), paper_platoon(2.4), lossy_platoon({0.1, {}, {1.0}}),
                                    lossy_platoon({0.1, 3.0, {2.0, -1.0}}), unlike, losing}) {
    const Figures figures(model, 12, 900);
    EXPECT_EQ(figures.contradictions(), std::vector<std::string>());
  }
}

TEST(Contradictions, AreFoundBetweenTheTableAndTheStationaryVariance) {
  Figures figures(paper_platoon(), 20, 300);
  EXPECT_GT(settled_followers(figures.model, 20, 300), 10U);
  figures.moments.variance[3 * 300 + 299] *= 1.001;
  ASSERT_EQ(figures.contradictions().size(), 1U);
  EXPECT_NE(figures.contradictions().front().find("follower 4 at step 299"), std::string::npos);
}

TEST(Contradictions, AreFoundBetweenAGrowingStringAndItsVerdict) {
  Figures figures(paper_platoon(2.4), 20, 100);
  figures.verdict = string_stability(paper_platoon(3.2));
  ASSERT_EQ(figures.contradictions().size(), 1U);
  EXPECT_NE(figures.contradictions().front().find("judged string stable"), std::string::npos);
}

TEST(Contradictions, AreFoundIfTheStationaryVarianceFalls) {
  Figures figures(paper_platoon(), 20, 100);
  figures.stationary[7] = 1.0;
  EXPECT_FALSE(figures.contradictions().empty());
}

// The leader's speed acts on the variance through losses.
TEST(Contradictions, AreNotSoughtBeforeTheVariancesHaveSettled) {
  PlatoonModel model = lossy_platoon({0.1, {}, {1.0}});
  model.leader = LeaderProfile({{0, 20.0}, {250, 0.0}}, 0.1);
  EXPECT_EQ(settled_followers(model, 5, 300), 0U);
  EXPECT_EQ(settled_followers(model, 5, 3000), 5U);
  model.recorded_leader = std::vector<double>(4000, 0.0);
  EXPECT_EQ(settled_followers(model, 5, 3000), 0U);
}

}  // namespace
}  // namespace platoon
