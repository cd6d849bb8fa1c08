#include "stochastic_platoon/run/results/result_check.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "unit/damage.hpp"
#include "unit/messages.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

class ResultCheckTest : public ResultTest {
protected:
  ResultCheckTest() {
    configuration_.run.record_compression = "none";
    configuration_.model.default_vehicle().design = paper_design();
  }

  std::vector<std::string> problems(const RunResult& result) const {
    write_results(configuration_, prediction_, result);
    return check_results(folder_.path()).problems;
  }

  // The only problem, which contains the text.
  void expect_problem(const RunResult& result, const std::string& text) const {
    const std::vector<std::string> found = problems(result);
    ASSERT_EQ(found.size(), 1u) << ::testing::PrintToString(found);
    EXPECT_NE(found[0].find(text), std::string::npos) << found[0];
  }
};

TEST_F(ResultCheckTest, AWholeRunInAgreementPasses) {
  EXPECT_TRUE(problems(result()).empty());
  const std::string passed = check_results(folder_.path()).passed;
  EXPECT_EQ(passed.find("string stable; complete, undamaged, in agreement (largest |z| 0.5"), 0u) << passed;
}

TEST_F(ResultCheckTest, OfErrorsThatAreNotComparedItReportsWhyAndWhatWasCompared) {
  configuration_.run.signals = {"gap", "relative_speed"};
  lose_packets({0.001, {}, {1.0}});
  EXPECT_EQ(problems(result_with_fourth_moments()), std::vector<std::string>());
  const std::string passed = check_results(folder_.path()).passed;
  EXPECT_TRUE(contains(passed,
                       "complete, undamaged, tracking errors not compared with the theory (the tracking errors are "
                       "not normal, and 20 realizations are too few to tell a difference from chance: about "))
      << passed;
  EXPECT_TRUE(
      contains(passed, " are needed, as far as these tell), signals in agreement (gap, relative speed): 2 followers"))
      << passed;
}

TEST_F(ResultCheckTest, OfARunWithoutATheoryItReportsThatNothingWasCompared) {
  configuration_.run.external = {1};
  predict_again();
  EXPECT_EQ(problems(result()), std::vector<std::string>());
  EXPECT_TRUE(contains(check_results(folder_.path()).passed, "complete, undamaged, not compared with a theory: 2 "));
}

TEST_F(ResultCheckTest, AnIncompleteRunDoesNotPass) {
  RunResult half = result();
  half.realizations = 10;
  half.tally.positions_received /= 2;
  for (const bool is_called_complete : {false, true}) {
    half.complete = is_called_complete;
    expect_problem(half, "not complete: 10 of 20 realizations");
  }
}

TEST_F(ResultCheckTest, AResumedRunWithoutItsFirstRealizationsPassesAsAPart) {
  configuration_.run.realizations = 10;
  const RunResult half = result();
  configuration_.run.realizations = 20;
  configuration_.run.first_realization = 10;
  EXPECT_EQ(problems(half), std::vector<std::string>());
  const std::string passed = check_results(folder_.path()).passed;
  EXPECT_NE(passed.find("10 realizations (a part of the run, realizations 10 to 19 of 20), seed"), std::string::npos);
}

TEST_F(ResultCheckTest, PositionsMissingFromTheStatisticsAreAProblem) {
  RunResult lossy = result();
  --lossy.tally.positions_received;
  expect_problem(lossy, "positions_lost: 1: must be 0 positions missing from the statistics");
}

TEST_F(ResultCheckTest, AFlippedBitInATableIsAProblem) {
  write_results(configuration_, prediction_, result());
  const std::string text = content_of(folder_ / "statistics.csv");
  folder_.file("statistics.csv", with_flipped_bit(text, 4 * text.size()));
  const std::vector<std::string> found = check_results(folder_.path()).problems;
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("statistics.csv: is not as it was written"), std::string::npos);
}

TEST_F(ResultCheckTest, AMeasurementFarFromTheTheoryIsAProblemByBothScores) {
  const std::vector<std::string> found = problems(result(8.0));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].find("measurement and theory disagree by the scores of summary.json"), std::string::npos);
  EXPECT_NE(found[1].find("measurement and theory disagree by the table"), std::string::npos);
}

TEST_F(ResultCheckTest, ASignalFarFromItsTheoryIsAProblemByBothScores) {
  configuration_.run.signals = {"gap", "relative_speed"};
  predict_again();
  EXPECT_TRUE(problems(result()).empty());
  RunResult other = result();
  other.signals[1][4].mean += 9.0;
  const std::vector<std::string> found = problems(other);
  ASSERT_EQ(found.size(), 2u) << ::testing::PrintToString(found);
  EXPECT_TRUE(contains(found[0], "disagree by the scores of summary.json for the relative speed: largest |z| "));
  EXPECT_TRUE(contains(found[1], "disagree by the table for the relative speed: largest |z| "));
}

TEST_F(ResultCheckTest, AnotherTheoryThanThatOfTheModelIsAProblem) {
  prediction_.variance[5] *= 1.0 + 1e-5;
  expect_problem(result(), "statistics.csv: line 7: a theoretical mean of");
}

TEST_F(ResultCheckTest, AnotherTheoryOfASignalThanThatOfTheModelIsAProblem) {
  configuration_.run.signals = {"gap", "relative_speed"};
  predict_again();
  const std::size_t cells = prediction_.mean.size();
  prediction_.signals[1].variance[5] *= 1.0 + 1e-5;
  expect_problem(result(), formatted("signals.csv: line %zu: a theoretical mean of", cells + 7));
}

TEST_F(ResultCheckTest, ACountThatLacksOneOfMillionsIsAProblem) {
  configuration_.run.realizations = 4000000;
  RunResult other = result();
  --other.moments[3].count;
  expect_problem(other, "statistics.csv: line 5: count: 3999999: must be 4000000, by the recorded model and run");
}

TEST_F(ResultCheckTest, FiguresThatContradictEachOtherAreAProblem) {
  prediction_.contradictions = {"one is not the other"};
  expect_problem(result(), "contradict each other: one is not the other");
}

TEST_F(ResultCheckTest, MeasuredGrowthOfAStringStablePlatoonIsAProblem) {
  configuration_.run.steps = 2000;
  predict_again();
  RunResult grown = result();
  Moments& last = grown.moments[2 * 2000 - 1];
  last.squared_deviations *= 40.0;
  const std::vector<std::string> found = problems(grown);
  ASSERT_FALSE(found.empty());
  EXPECT_NE(found.back().find("measurement and verdict disagree: the measured variance of follower 2"),
            std::string::npos)
      << found.back();
}

TEST_F(ResultCheckTest, WithoutResultsItThrows) {
  EXPECT_THROW(check_results(folder_.path()), std::exception);
}

TEST_F(ResultCheckTest, OfARunWithoutResultsItReportsWhatWasMeasured) {
  const auto problem_in = [](const std::string& folder) {
    return message_of<std::exception>([&] { check_results(folder); });
  };
  EXPECT_TRUE(contains(problem_in(folder_.path()), "not complete: nothing was measured ("))
      << problem_in(folder_.path());
  EXPECT_TRUE(contains(problem_in(folder_ / "none"), "must be a regular file"));
  Checkpoint checkpoint{
      statistics_identity(configuration_), "", {30, 1, 0.5, 0}, EnsembleTotals(cells_of(configuration_))};
  write_checkpoint(folder_.path(), checkpoint);
  EXPECT_EQ(problem_in(folder_.path()), "not complete: 0 realizations in its checkpoint; resume:=true continues");
  checkpoint.time_averages = {Moments{431, 0.0, 1.0}, Moments{430, 0.0, 1.0}};
  write_checkpoint(folder_.path(), checkpoint);
  EXPECT_EQ(problem_in(folder_.path()),
            "not complete: averages over 431 steps in its checkpoint; resume:=true continues");
}

}  // namespace
}  // namespace platoon
