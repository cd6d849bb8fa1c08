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
#include "unit/monte_carlo.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Report, SaysThatMeasurementAndTheoryAgree) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  const std::string text = report(configuration, prediction, result_with(configuration, prediction, 0.5));
  EXPECT_NE(text.find("Measurement agrees with Lemma 1"), std::string::npos);
  EXPECT_NE(text.find("tracking errors at step 2 (0.2 s), 20 realizations"), std::string::npos);
  EXPECT_NE(text.find("Theory: "), std::string::npos);
  EXPECT_NE(text.find("Stationary variance along an endless string: "), std::string::npos);
}

TEST(Report, SaysThatMeasurementAndTheoryDisagree) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  for (const double score : {5.0, -5.0}) {
    const std::string text = report(configuration, prediction, result_with(configuration, prediction, score));
    EXPECT_NE(text.find("MEASUREMENT AND LEMMA 1 DISAGREE"), std::string::npos) << score;
  }
  RunResult only_mean = result_with(configuration, prediction);
  only_mean.moments.back().mean += 3.0;
  EXPECT_NE(report(configuration, prediction, only_mean).find("MEASUREMENT AND LEMMA 1 DISAGREE"), std::string::npos);
  RunResult only_variance = result_with(configuration, prediction);
  only_variance.moments.back().squared_deviations *= 5.0;
  EXPECT_NE(report(configuration, prediction, only_variance).find("MEASUREMENT AND LEMMA 1 DISAGREE"),
            std::string::npos);
}

TEST(Report, GivesTheMeasuredStandardErrorOfAnExternalVehicle) {
  Configuration configuration = paper_run("");
  const Prediction whole = predict(configuration);
  const RunResult result = result_with(configuration, whole);
  configuration.run.external = {2};
  const Prediction prediction = predict(configuration);
  ASSERT_EQ(prediction.followers_with_theory, 1u);
  const double variance = result.moments.back().variance(), error = variance * std::sqrt(2.0 / 19.0);
  const std::string row = formatted("%8d %16.6g %16.2g %14s %9s\n", 2, variance, error, "-", "-");
  EXPECT_NE(report(configuration, prediction, result).find(row), std::string::npos)
      << report(configuration, prediction, result);
}

TEST(Report, GivesTheMeasuredStandardErrorOfAnExternalVehicleOverTime) {
  Configuration configuration = paper_run("");
  configuration.run.steps = 0;
  configuration.run.burn_in = 200;
  configuration.run.external = {2};
  const Prediction prediction = predict(configuration);
  RunResult result;
  result.realizations = 1;
  result.last_step = 20199;
  result.moments = {Moments{20000, 0.1, 79.9}, Moments{20000, 0.2, 2.0 * 19999.0}};
  result.last_steps = {20199, 20199};
  result.shares = {{0.1, 0.1, kNaN}, {0.1, 0.01, kNaN}};
  const std::string text = report(configuration, prediction, result);
  const std::string row = formatted("%8d %16s %16s %14s %9s\n", 2, "2", "0.2", "-", "-");  // 2 sqrt(2 / 199.99)
  EXPECT_NE(text.find(row), std::string::npos) << text;
}

TEST(Report, SaysThatSomethingUndefinedDoesNotAgree) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  for (std::size_t c = 0; c < prediction.mean.size(); ++c) {
    RunResult result = result_with(configuration, prediction, 0.5);
    result.moments[c].mean = kNaN;
    EXPECT_NE(report(configuration, prediction, result).find("MEASUREMENT AND LEMMA 1 DISAGREE"), std::string::npos)
        << "NaN in cell " << c;
  }
}

/// The report of a Monte Carlo of two followers and twenty steps.
std::string report_of(const Configuration& configuration, const Prediction& prediction, std::uint64_t realizations,
                      std::uint64_t seed, double noise_factor = 1.0) {
  RunResult result;
  result.realizations = realizations;
  PlatoonModel model = configuration.model;
  model.default_vehicle().noise_variance *= noise_factor;
  result.moments = monte_carlo(model, {seed, 2, 20, 1024}, realizations).moments.totals();
  return report(configuration, prediction, result);
}

Configuration lossy_run(double probability, double noise_variance, std::vector<double> predictor) {
  Configuration configuration = paper_run("");
  configuration.run.steps = 20;
  configuration.model.default_vehicle().noise_variance = noise_variance;
  configuration.model.default_vehicle().link.loss = LossModel{probability, {}, std::move(predictor)};
  return configuration;
}

// A run of 1000 realizations has about 40 losses, two per step: most cells have seen a few losses or none.
TEST(Report, GivesNoVerdictBehindLossesThatAreTooRare) {
  const Configuration configuration = lossy_run(0.001, 1e-4, {1.0});
  const Prediction prediction = predict(configuration);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::string text = report_of(configuration, prediction, 1000, seed);
    EXPECT_NE(text.find("No verdict: the tracking errors are not normal, and 1000 realizations are too few"),
              std::string::npos)
        << text;
    const std::size_t about = text.find("from chance: about ");
    ASSERT_NE(about, std::string::npos) << text;
    const double needed = std::stod(text.substr(about + 19));
    EXPECT_GE(needed, 23000.0) << "that of single losses is known";
    EXPECT_LE(needed, 100000.0);
    EXPECT_EQ(text.find("DISAGREE"), std::string::npos) << text;
  }
  EXPECT_NE(report_of(configuration, prediction, 30000, 1).find("Measurement agrees with the theory"),
            std::string::npos);
  EXPECT_NE(report_of(configuration, prediction, 30000, 1).find("at most once in 1000 runs"), std::string::npos);
}

// 400 runs, of which 0.4 are beyond the bound on average: three are beyond it with a probability of about 1 %.
TEST(Report, DisagreesByChanceNoMoreOftenThanItSaysBehindLosses) {
  for (const std::uint64_t realizations : {100u, 400u, 1000u}) {
    const Configuration configuration = lossy_run(0.1, 0.6, {2.0, -1.0});
    const Prediction prediction = predict(configuration);
    int agreed = 0, disagreed = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      const std::string text = report_of(configuration, prediction, realizations, seed);
      agreed += text.find("Measurement agrees") != std::string::npos ? 1 : 0;
      disagreed += text.find("DISAGREE") != std::string::npos ? 1 : 0;
    }
    EXPECT_LE(disagreed, 2) << realizations;
    if (realizations == 1000) {
      EXPECT_GT(agreed, 300) << "it is a verdict";
    }
  }
}

TEST(Report, FindsNoiseThatIsFivePercentOffBehindLosses) {
  const Configuration configuration = lossy_run(0.1, 0.6, {2.0, -1.0});
  const Prediction prediction = predict(configuration);
  for (const double factor : {1.05, 0.95}) {
    EXPECT_NE(report_of(configuration, prediction, 300000, 1, factor).find("MEASUREMENT AND THE THEORY DISAGREE"),
              std::string::npos)
        << factor;
  }
}

// A large measured variance does not widen its own bound so far that the verdict is lost.
TEST(Report, FindsAVarianceManyTimesTheTheorysBehindLosses) {
  const Configuration configuration = lossy_run(0.1, 0.6, {2.0, -1.0});
  const Prediction prediction = predict(configuration);
  for (const double factor : {0.2, 5.0, 100.0}) {
    EXPECT_NE(report_of(configuration, prediction, 3000, 1, factor).find("MEASUREMENT AND THE THEORY DISAGREE"),
              std::string::npos)
        << factor;
  }
}

TEST(Report, ShowsBothEndsOfALongString) {
  Configuration configuration = paper_run("");
  configuration.run.followers = 100;
  const Prediction prediction = predict(configuration);
  const std::string text = report(configuration, prediction, result_with(configuration, prediction, 0.5));
  EXPECT_NE(text.find("\n      10 "), std::string::npos);
  EXPECT_EQ(text.find("\n      11 "), std::string::npos);
  EXPECT_NE(text.find("     ...\n"), std::string::npos);
  EXPECT_NE(text.find("\n      91 "), std::string::npos);
  EXPECT_NE(text.find("\n     100 "), std::string::npos);
}

TEST(Report, LabelsTimeAveragesAsSuch) {
  Configuration configuration = paper_run("");
  configuration.run.steps = 0;
  configuration.run.realizations = 1;
  configuration.run.burn_in = 200;
  RunResult result;
  result.realizations = 1;
  result.last_step = 999;
  result.moments = {Moments{800, 0.1, 79.9}, Moments{800, 0.2, 159.8}};
  result.last_steps = {999, 998};
  const std::string text = report(configuration, predict(configuration), result);
  EXPECT_NE(text.find("time averages up to step 999 (99.9 s), behind a burn-in of 200 steps (20 s)"),
            std::string::npos);
  EXPECT_EQ(text.find("was begun"), std::string::npos);
  result.tally.attempts = 3;
  EXPECT_NE(report(configuration, predict(configuration), result)
                .find("was begun 3 times, each time with a burn-in and new noise"),
            std::string::npos);
  EXPECT_EQ(text.find("agrees"), std::string::npos);
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

TEST(Report, JudgesAveragesOverTimeOnlyBehindASufficientBurnIn) {
  Configuration configuration = paper_run("");
  configuration.model = parse_model(YAML::Load(kSlowModel));
  configuration.run.steps = 0;
  configuration.run.realizations = 1;
  configuration.run.burn_in = *settling_steps(configuration.model, 2);
  const RunResult settled = averages_over_time(configuration, 100000);
  const std::string text = report(configuration, predict(configuration), settled);
  EXPECT_NEAR(settled.moments[0].variance(), 0.0128559, 0.001);
  EXPECT_NE(text.find("Measurement agrees with Lemma 1: over all 2 followers"), std::string::npos) << text;
  EXPECT_EQ(text.find("Warning"), std::string::npos) << text;

  configuration.run.burn_in = 100;
  const Prediction prediction = predict(configuration);
  const RunResult unsettled = averages_over_time(configuration, 100000);
  const std::string warned = report(configuration, prediction, unsettled);
  EXPECT_GT(unsettled.moments[0].variance(), 2.0 * 0.0128559) << "the transient counts";
  EXPECT_NE(warned.find("Warning: burn_in: 100: 2 s are below the "), std::string::npos) << warned;
  EXPECT_FALSE(measured_agreement(configuration.run, prediction, unsettled)) << warned;
  EXPECT_EQ(warned.find("agree"), std::string::npos) << warned;
}

}  // namespace
}  // namespace platoon
