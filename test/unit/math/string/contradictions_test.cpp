#include "stochastic_platoon/math/string/contradictions.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/math/string/stationary_signals.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
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
        moments(error_moments(of, followers, steps)),
        of_signals(stationary_signals(of, names, followers, verdict.string_stable)),
        signals(signal_moments(of, names, followers, steps)) {}

  std::vector<std::string> contradictions() const {
    std::vector<TheoryFigures> figures{{stationary, moments.variance, verdict.limit_variance}};
    for (std::size_t s = 0; s < names.size(); ++s)
      figures.push_back(
          {of_signals[s].followers.variance, signals[s].variance, of_signals[s].limit_variance(), names[s]});
    return platoon::contradictions(model, figures, moments.steps);
  }

  std::vector<std::string> names = signal_names("gap,speed,acceleration,jerk,relative_speed");
  PlatoonModel model;
  StringStability verdict;
  std::vector<double> stationary;
  SignalMoments moments;
  std::vector<StationarySignal> of_signals;
  std::vector<SignalMoments> signals;
};

TEST(Contradictions, AreNoneInAnyTheory) {
  PlatoonModel unlike = radio_platoon(0.5, 0.01, 0.02);
  add_trucks(unlike, 0.25, 0.213, 0.9);
  PlatoonModel losing = unlike;
  lose_inputs(losing, 0.2, {1.0});
  for (const PlatoonModel& model : {paper_platoon(3.2), paper_platoon(2.4), lossy_platoon({0.1, {}, {1.0}}),
                                    lossy_platoon({0.1, 3.0, {2.0, -1.0}}), unlike, losing}) {
    const Figures figures(model, 5, 500);
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

// Without noise the initial positions alone have a variance, which decays below every number.
TEST(Contradictions, AreNoneWhereOnlyTheStartIsRandom) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().position().noise_variance = 0.0;
  model.default_vehicle().initial_position.variance = 0.5;
  const Figures figures(model, 3, 300);
  EXPECT_EQ(settled_followers(model, 3, 300), 3U);
  EXPECT_GT(figures.moments.variance[299], 0.0);
  EXPECT_EQ(figures.stationary[0], 0.0);
  EXPECT_EQ(figures.contradictions(), std::vector<std::string>());
}

TEST(Contradictions, AreFoundInSignals) {
  Figures figures(paper_platoon(), 20, 300);
  figures.signals[1].variance[3 * 300 + 299] *= 1.001;
  figures.of_signals[4].limit->variance.front() *= 0.5;
  const std::vector<std::string> found = figures.contradictions();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].find("the variance of the speed of follower 4 at step 299 is "), 0U) << found[0];
  EXPECT_NE(found[0].find(" (m/s)^2, but the stationary variance is "), std::string::npos) << found[0];
  EXPECT_EQ(found[1].find("the stationary variance of the relative speed of follower 20 is "), 0U) << found[1];
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
