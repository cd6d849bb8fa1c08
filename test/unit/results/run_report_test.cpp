#include "stochastic_platoon/results/run_report.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "result_with.hpp"

namespace platoon {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Report, SaysThatMeasurementAndTheoryAgree) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  const std::string text = report(configuration, prediction, result_with(configuration, prediction, 0.5));
  EXPECT_NE(text.find("Measurement agrees with Lemma 1"), std::string::npos);
  EXPECT_NE(text.find("tracking errors at step 2, 20 realizations"), std::string::npos);
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
  EXPECT_NE(report(configuration, prediction, only_mean).find("MEASUREMENT AND LEMMA 1 DISAGREE"),
            std::string::npos);
  RunResult only_variance = result_with(configuration, prediction);
  only_variance.moments.back().squared_deviations *= 5.0;
  EXPECT_NE(report(configuration, prediction, only_variance).find("MEASUREMENT AND LEMMA 1 DISAGREE"),
            std::string::npos);
}

TEST(Report, SaysThatSomethingUndefinedDoesNotAgree) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  for (std::size_t c = 0; c < prediction.mean.size(); ++c) {
    RunResult result = result_with(configuration, prediction, 0.5);
    result.moments[c].mean = kNaN;
    EXPECT_NE(report(configuration, prediction, result).find("MEASUREMENT AND LEMMA 1 DISAGREE"),
              std::string::npos)
        << "NaN in cell " << c;
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
  EXPECT_NE(text.find("time averages up to step 999"), std::string::npos);
  EXPECT_EQ(text.find("was begun"), std::string::npos);
  result.tally.attempts = 3;
  EXPECT_NE(
      report(configuration, predict(configuration), result).find("was begun 3 times, each time left out"),
      std::string::npos);
  EXPECT_EQ(text.find("agrees"), std::string::npos);
}

}  // namespace
}  // namespace platoon
