#include "stochastic_platoon/run/results/run_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"
#include "stochastic_platoon/math/statistics/time_statistics.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"
#include "unit/messages.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class ReportTest : public ResultTest {
protected:
  std::string report_of(const RunResult& result) const { return report(configuration_, prediction_, result); }

  /// The report of a Monte Carlo of two followers and twenty steps.
  std::string report_of_run(std::uint64_t realizations, std::uint64_t seed, double noise_factor = 1.0) const {
    RunResult result;
    result.realizations = realizations;
    PlatoonModel model = configuration_.model;
    model.default_vehicle().position().noise_variance *= noise_factor;
    result.moments = monte_carlo(model, {seed, 2, 20, 1024}, realizations).moments.totals();
    return report_of(result);
  }

  /// The report of a run of the platoon whose verdict has this limit [m^2].
  std::string report_with_limit(double limit) {
    configuration_.run.steps = 200;
    prediction_ = predict(configuration_);
    prediction_.stability.limit_variance = limit;
    RunResult result;
    result.realizations = 2000;
    result.moments = monte_carlo(configuration_.model, {7, 2, 200, 1000}, 2000).moments.totals();
    return report_of(result);
  }

  void make_lossy(double probability, double noise_variance, std::vector<double> predictor) {
    configuration_.run.steps = 20;
    configuration_.model.default_vehicle().position().noise_variance = noise_variance;
    lose_packets({probability, {}, std::move(predictor)});
  }
};

TEST_F(ReportTest, ReportsThatMeasurementAndTheoryAgree) {
  const std::string text = report_of(result());
  EXPECT_TRUE(contains(text, "Measurement agrees with Lemma 1"));
  EXPECT_TRUE(contains(text, "tracking errors at 0.2 s (step 2), 20 realizations"));
  EXPECT_TRUE(contains(text, "Theory: "));
  EXPECT_TRUE(contains(text, "Stationary variance along an endless string: "));
}

TEST_F(ReportTest, ReportsThatMeasurementAndTheoryDisagree) {
  RunResult only_mean = result(), only_variance = result();
  only_mean.moments.back().mean += 3.0;
  only_variance.moments.back().squared_deviations *= 5.0;
  for (const RunResult& other : {result(5.0), result(-5.0), only_mean, only_variance})
    EXPECT_TRUE(contains(report_of(other), "MEASUREMENT AND LEMMA 1 DISAGREE"));
}

TEST_F(ReportTest, ReportsWhetherEverySignalAgrees) {
  configuration_.run.signals = {"gap", "speed"};
  predict_again();
  const std::string agreeing = report_of(result());
  EXPECT_TRUE(contains(agreeing, "), agrees (largest |z| 0.5")) << agreeing;
  EXPECT_FALSE(contains(agreeing, "DISAGREE"));
  RunResult of_mean = result(), of_variance = result();
  of_mean.signals[1].back().mean += 3.0;
  of_variance.signals[1][2].squared_deviations *= 9.0;
  for (const RunResult& other : {of_mean, of_variance}) {
    const std::string text = report_of(other), speed = text.substr(text.find("\nspeed of follower 2"));
    EXPECT_TRUE(contains(speed.substr(0, speed.find('\n', 1)), "), DISAGREES WITH THE THEORY (largest |z| ")) << speed;
    EXPECT_FALSE(contains(text.substr(0, text.find("\nspeed")), "DISAGREE")) << text;
  }
}

TEST_F(ReportTest, JudgesSignalsBehindLossesByTheirMeans) {
  configuration_.run.signals = {"speed"};
  lose_packets({0.1, {}, {1.0}});
  RunResult of_mean = result(), of_variance = result();
  of_mean.signals[0].back().mean += 30.0;
  of_variance.signals[0].back().squared_deviations *= 9.0;
  EXPECT_TRUE(contains(report_of(of_mean), "DISAGREES WITH THE THEORY"));
  EXPECT_FALSE(contains(report_of(of_variance), "DISAGREES")) << report_of(of_variance);
}

TEST_F(ReportTest, DoesNotJudgeSignalsOfUnknownVarianceOrBehindAnExternalVehicle) {
  configuration_.run.signals = {"speed"};
  predict_again();
  RunResult other = result();
  other.signals[0].back().mean += 30.0;
  EXPECT_TRUE(contains(report_of(other), "DISAGREES"));
  prediction_.signals[0].variance.back() = kNaN;
  EXPECT_TRUE(contains(report_of(other), ", agrees (largest"));
  configuration_.run.external = {2};
  predict_again();
  EXPECT_FALSE(contains(report_of(other), "DISAGREES"));
  other.realizations = 1;
  EXPECT_FALSE(signal_agreement(configuration_.run, prediction_, other, 0));
}

TEST_F(ReportTest, ReportsAMeasuredVarianceAboveTheLimitOfTheVerdict) {
  EXPECT_EQ(report_with_limit(2.3).find("MEASUREMENT AND VERDICT DISAGREE"), std::string::npos);
  const std::string text = report_with_limit(0.5);
  EXPECT_NE(text.find("MEASUREMENT AND VERDICT DISAGREE: the measured variance of follower 1 is "), std::string::npos);
}

TEST_F(ReportTest, ReportsFiguresOfTheTheoryThatContradictEachOther) {
  prediction_.contradictions = {"one is 1, but the other is 2"};
  EXPECT_NE(
      report_of(result()).find("ERROR: figures of the theory contradict each other: one is 1, but the other is 2"),
      std::string::npos);
}

TEST_F(ReportTest, ReportsThatAnUndefinedMeanDisagrees) {
  for (std::size_t c = 0; c < prediction_.mean.size(); ++c) {
    RunResult undefined = result();
    undefined.moments[c].mean = kNaN;
    EXPECT_TRUE(contains(report_of(undefined), "MEASUREMENT AND LEMMA 1 DISAGREE")) << "NaN in cell " << c;
  }
}

TEST_F(ReportTest, HasTheMeasuredStandardErrorOfAnExternalVehicle) {
  const RunResult result = this->result();
  configuration_.run.external = {2};
  predict_again();
  ASSERT_EQ(prediction_.followers_with_theory, 1u);
  const double variance = result.moments.back().variance(), error = variance * std::sqrt(2.0 / 19.0);
  EXPECT_TRUE(contains(report_of(result), formatted("%8d %16.6g %16.2g %14s %9s\n", 2, variance, error, "-", "-")));
}

TEST_F(ReportTest, HasTheMeasuredStandardErrorOfAnExternalVehicleOverTime) {
  configuration_.run.external = {2};
  make_endless();
  RunResult result = result_over_time();
  result.moments = {Moments{20000, 0.1, 79.9}, Moments{20000, 0.2, 2.0 * 19999.0}};
  result.shares = {{0.1, 0.1, kNaN}, {0.1, 0.01, kNaN}};
  const std::string row = formatted("%8d %16s %16s %14s %9s\n", 2, "2", "0.2", "-", "-");  // 2 sqrt(2 / 199.99)
  EXPECT_TRUE(contains(report_of(result), row));
  lose_packets({0.1, {}, {1.0}});
  EXPECT_TRUE(contains(report_of(result), "No verdict: packets are lost, and averages over time may lack the rarest"));
}

// A run of 1000 realizations has about 40 losses, two per step: most cells have seen a few losses or none.
TEST_F(ReportTest, HasNoVerdictIfLossesAreTooRare) {
  make_lossy(0.001, 1e-4, {1.0});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::string text = report_of_run(1000, seed);
    EXPECT_TRUE(contains(text, "No verdict: the tracking errors are not normal, and 1000 realizations are too few"));
    const std::size_t about = text.find("from chance: about ");
    ASSERT_NE(about, std::string::npos) << text;
    const double needed = std::stod(text.substr(about + 19));
    EXPECT_GE(needed, 23000.0) << "the number that single losses need is known";
    EXPECT_LE(needed, 100000.0);
    EXPECT_FALSE(contains(text, "DISAGREE"));
  }
  const std::string text = report_of_run(30000, 1);
  EXPECT_TRUE(contains(text, "Measurement agrees with the theory"));
  EXPECT_TRUE(contains(text, "at most once in 1000 runs"));
}

// 400 runs, of which 0.4 are beyond the bound on average: three are beyond it with a probability of about 1 %.
TEST_F(ReportTest, DisagreesByChanceNoMoreOftenThanStatedIfPacketsAreLost) {
  make_lossy(0.1, 0.6, {2.0, -1.0});
  for (const std::uint64_t realizations : {100u, 400u, 1000u}) {
    int agreed = 0, disagreed = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      const std::string text = report_of_run(realizations, seed);
      agreed += contains(text, "Measurement agrees") ? 1 : 0;
      disagreed += contains(text, "DISAGREE") ? 1 : 0;
    }
    EXPECT_LE(disagreed, 2) << realizations;
    if (realizations == 1000) {
      EXPECT_GT(agreed, 300) << "it is a verdict";
    }
  }
}

TEST_F(ReportTest, HasNoScoreOfAVarianceWhoseScatterIsUnknown) {
  lose_packets({0.1, 2.0, {1.0}});
  const std::string text = report_of(result_with_fourth_moments());
  EXPECT_TRUE(contains(text, "agrees with the theory in the means: over all 6 (i, k)")) << text;
  for (const char* row : {"\n       1 ", "\n       2 "}) {
    const std::size_t begin = text.find(row) + 1;
    EXPECT_EQ(text.substr(text.find('\n', begin) - 2, 2), " -") << text;
  }
}

// A large measured variance does not widen its own bound so far that the verdict is lost.
TEST_F(ReportTest, NoticesANoiseOfAnotherVarianceIfPacketsAreLost) {
  make_lossy(0.1, 0.6, {2.0, -1.0});
  for (const auto& [realizations, factor] : {std::pair(300000, 1.05), std::pair(300000, 0.95), std::pair(3000, 0.2),
                                             std::pair(3000, 5.0), std::pair(3000, 100.0)}) {
    EXPECT_TRUE(contains(report_of_run(realizations, 1, factor), "MEASUREMENT AND THE THEORY DISAGREE")) << factor;
  }
}

TEST_F(ReportTest, ShowsBothEndsOfALongString) {
  configuration_.run.followers = 100;
  predict_again();
  const std::string text = report_of(result());
  EXPECT_TRUE(contains(text, "\n      10 "));
  EXPECT_FALSE(contains(text, "\n      11 "));
  EXPECT_TRUE(contains(text, "     ...\n"));
  EXPECT_TRUE(contains(text, "\n      91 "));
  EXPECT_TRUE(contains(text, "\n     100 "));
}

TEST_F(ReportTest, LabelsAveragesOverTime) {
  make_endless();
  RunResult result = result_over_time();
  const std::string text = report_of(result);
  EXPECT_TRUE(contains(text, "time averages up to 99.8 s (step 998), behind a burn-in of 20 s (200 steps)"));
  EXPECT_TRUE(contains(text, "; standard errors include the correlation of successive errors\n"));
  EXPECT_FALSE(contains(text, "was begun"));
  EXPECT_FALSE(contains(text, "agrees"));
  EXPECT_TRUE(contains(text, "No verdict: the averages are worth fewer than 1000 independent errors so far"));
  result.tally.attempts = 3;
  EXPECT_TRUE(contains(report_of(result), "was begun 3 times, each time with a burn-in and new noise"));
}

TEST_F(ReportTest, NamesTheStepUpToWhichPausedAveragesReach) {
  make_endless();
  RunResult result = result_over_time();
  result.last_step = 1200;
  EXPECT_TRUE(
      contains(report_of(result), "time averages up to 99.8 s (step 998), paused at 120 s (step 1200), behind"));
  result.last_steps = {-1, -1};
  EXPECT_TRUE(contains(report_of(result), "time averages, paused at 120 s (step 1200), behind"));
}

constexpr char kSlowModel[] = R"(
plant:
  numerator: [1.2692469222752578e-05, 4.8330417095066025e-05, 1.148481245083488e-05]
  denominator: [1.0, -2.8187307530779817, 2.6374615061559634, -0.8187307530779818, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
controller: {numerator: [35.2, -35.0], denominator: [1.0, 0.0]}
time_headway: 25.0
standstill_distance: 2.0
sample_period: 0.02
noise_variance: 0.6
leader: {speed: [{from_step: 0, value: 20.0}]}
initial_position: {mean: 0.0, variance: 0.0}
)";

// Averages over time of a car with rho(A) = 0.9935, which starts with errors of tens of metres.
RunResult averages_over_time(const Configuration& configuration, std::int64_t steps) {
  const RunOptions& run = configuration.run;
  TimeStatistics averages(run.followers, run.burn_in);
  PlatoonString(configuration.model, run.seed, run.followers)
      .run(0, 1, steps, [&](std::size_t i, std::int64_t k, const SignalPositions& positions) {
        const double error = positions.of(tracking_error(configuration.model, i)).front();
        averages.add({i, k, 0, 1, {std::vector<MomentNode>{{error, 0.0}}}});
      });
  RunResult result;
  result.realizations = 1;
  result.last_step = steps - 1;
  result.tally.attempts = 1;
  result.moments = averages.moments();
  result.last_steps.assign(run.followers, steps - 1);
  return result;
}

TEST_F(ReportTest, JudgesAveragesOverTimeOnlyBehindASufficientBurnIn) {
  configuration_.model = parse_model(YAML::Load(kSlowModel));
  make_endless();
  configuration_.run.burn_in = *settling_steps(configuration_.model, 2);
  predict_again();
  const RunResult settled = averages_over_time(configuration_, 100000);
  EXPECT_NEAR(settled.moments[0].variance(), 0.0128559, 0.001);
  EXPECT_TRUE(contains(report_of(settled), "Measurement agrees with Lemma 1: over all 2 followers"));
  EXPECT_FALSE(contains(report_of(settled), "Warning: burn_in"));

  configuration_.run.burn_in = 100;
  predict_again();
  const RunResult unsettled = averages_over_time(configuration_, 100000);
  EXPECT_GT(unsettled.moments[0].variance(), 2.0 * 0.0128559) << "the transient counts";
  EXPECT_TRUE(contains(report_of(unsettled), "Warning: burn_in: 100: 2 s are below the "));
  EXPECT_FALSE(contains(report_of(unsettled), "standard errors include the correlation")) << "there are none";
  EXPECT_FALSE(measured_agreement(configuration_.run, prediction_, unsettled));
  EXPECT_FALSE(contains(report_of(unsettled), "agree"));
}

}  // namespace
}  // namespace platoon
