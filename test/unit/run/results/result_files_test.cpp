#include "stochastic_platoon/run/results/result_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/checksum.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "unit/csv_rows.hpp"
#include "unit/messages.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

std::set<std::string> keys_of(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& entry : object.items()) keys.insert(entry.key());
  return keys;
}

class ResultFilesTest : public ResultTest {
protected:
  std::vector<std::vector<std::string>> rows(const RunResult& result) const {
    write_results(configuration_, prediction_, result);
    return csv_rows(content_of(folder_ / "statistics.csv"));
  }
  nlohmann::json summary(const RunResult& result) const {
    write_results(configuration_, prediction_, result);
    return nlohmann::json::parse(content_of(folder_ / "summary.json"));
  }
  nlohmann::json summary() const { return summary(result()); }
};

TEST_F(ResultFilesTest, TheRunCountsThePositionsThatMustArrive) {
  RunOptions run = configuration_.run;
  EXPECT_EQ(positions_expected(run, 20), 3u * 4u * 20u);
  run.followers = 20;
  run.steps = 100;
  EXPECT_EQ(positions_expected(run, 100000), 21u * 101u * 100000u);
}

TEST_F(ResultFilesTest, TheTableHasARowPerVehicleAndStep) {
  const auto rows = this->rows(result());
  EXPECT_EQ(rows[0], (std::vector<std::string>{"vehicle", "step", "count", "mean", "variance", "theoretical_mean",
                                               "theoretical_variance"}));
  ASSERT_EQ(rows.size(), 1u + 6u);
  for (std::size_t i = 1; i <= 2; ++i) {
    for (std::int64_t k = 0; k < 3; ++k) {
      const std::size_t c = cell(i, k, 3);
      const auto& row = rows[1 + c];
      ASSERT_EQ(row.size(), 7u);
      EXPECT_EQ(row[0], std::to_string(i));
      EXPECT_EQ(row[1], std::to_string(k));
      EXPECT_EQ(row[2], "20");
      EXPECT_EQ(std::stod(row[3]), result().moments[c].mean) << "to the bit";
      EXPECT_EQ(std::stod(row[4]), result().moments[c].variance());
      EXPECT_EQ(std::stod(row[5]), prediction_.mean[c]);
      EXPECT_EQ(std::stod(row[6]), prediction_.variance[c]);
    }
  }
}

TEST_F(ResultFilesTest, UndefinedValuesAreNaN) {
  RunResult undefined = result();
  undefined.moments[0] = Moments{};
  undefined.moments[1] = Moments{1, 0.25, 0.0};
  const auto rows = this->rows(undefined);
  EXPECT_EQ(rows[1][3], "nan");
  EXPECT_EQ(rows[1][4], "nan");
  EXPECT_EQ(rows[2][3], "0.25");
  EXPECT_EQ(rows[2][4], "nan");
}

TEST_F(ResultFilesTest, TheSummaryHasEveryKey) {
  const nlohmann::json summary = this->summary();
  const std::set<std::string> keys = keys_of(summary);
  for (const char* key : {"complete", "followers", "steps", "realizations", "seed", "hosting", "attempts",
                          "positions_received", "positions_lost", "wall_seconds", "vehicle_steps_per_second",
                          "agreement", "theory", "configuration", "revision", "date", "host", "command_line"}) {
    EXPECT_EQ(keys.count(key), 1u) << key;
  }
  EXPECT_EQ(keys_of(summary["agreement"]),
            (std::set<std::string>{"max_abs_z_mean", "max_abs_z_variance", "plausible_z"}));
  EXPECT_EQ(keys_of(summary["theory"]),
            (std::set<std::string>{"spectral_radius", "peak_gain", "peak_frequency", "mean_square_stable",
                                   "string_stable", "loss_gain", "limit_variance", "reason", "stationary_variance"}));
}

TEST_F(ResultFilesTest, TheSummaryHasTheFiguresOfTheRun) {
  const nlohmann::json summary = this->summary(result(1.25));
  EXPECT_EQ(summary["complete"], true);
  EXPECT_EQ(summary["followers"], 2);
  EXPECT_EQ(summary["steps"], 3);
  EXPECT_EQ(summary["realizations"], 20);
  EXPECT_EQ(summary["seed"], 1);
  EXPECT_EQ(summary["hosting"], "processes");
  EXPECT_EQ(summary["attempts"], 3);
  EXPECT_EQ(summary["positions_received"], 240);
  EXPECT_EQ(summary["positions_lost"], 0);
  EXPECT_EQ(summary["wall_seconds"], 0.5);
  EXPECT_EQ(summary["vehicle_steps_per_second"], 2 * 3 * 20 / 0.5);
  EXPECT_NEAR(summary["agreement"]["max_abs_z_mean"].get<double>(), 1.25, 1e-9);
  // The tail of chi-squared with 19 degrees of freedom beyond 19 + 1.25 sqrt(38), as a normal score.
  EXPECT_NEAR(summary["agreement"]["max_abs_z_variance"].get<double>(), 1.217528450878455, 1e-9);
  EXPECT_EQ(summary["theory"]["string_stable"], true);
  EXPECT_EQ(summary["theory"]["mean_square_stable"], true);
  EXPECT_EQ(summary["theory"]["stationary_variance"].size(), 2u);
  EXPECT_EQ(summary["theory"]["limit_variance"].get<double>(), *prediction_.stability.limit_variance);
}

// zlib.crc32(b"123456789"), the check value of CRC-32.
TEST(Checksum, IsCrc32) {
  EXPECT_EQ(checksum("123456789"), "cbf43926");
}

TEST_F(ResultFilesTest, TheSummaryHasTheChecksumsOfBothFiles) {
  const nlohmann::json summary = this->summary();
  EXPECT_EQ(summary["crc32"]["statistics"], checksum(content_of(folder_ / "statistics.csv")));
  std::string text = content_of(folder_ / "summary.json");
  const std::string own = summary["crc32"]["summary"];
  text.replace(text.find(own), own.size(), "00000000");
  EXPECT_EQ(own, checksum(text));
}

// Errors that are not normal: the fourth moments determine the standard error of a variance.
TEST_F(ResultFilesTest, TheSummaryHasTheStandardErrorsOfTheVariances) {
  RunResult measured = result();
  Moments& last = measured.moments[cell(2, 2, 3)];
  const double gaussian = standard_error_of_variance(prediction_.variance[cell(2, 2, 3)], last.count);
  EXPECT_EQ(summary(measured)["standard_error_of_variance"][1], gaussian);
  last.cubed_deviations = 0.0;
  last.fourth_deviations = 9.0 * last.variance() * last.variance() * static_cast<double>(last.count);
  const double own = summary(measured)["standard_error_of_variance"][1];
  EXPECT_EQ(own, standard_error_of_variance(last));
  EXPECT_GT(own, 1.5 * gaussian);
  // The largest of follower 1 is that of another step than the last.
  Moments& middle = measured.moments[cell(1, 1, 3)];
  middle.cubed_deviations = 0.0;
  middle.fourth_deviations = 100.0 * static_cast<double>(middle.count);
  const nlohmann::json all = summary(measured);
  EXPECT_EQ(all["largest_standard_error_of_variance"][0], standard_error_of_variance(middle));
  EXPECT_GT(standard_error_of_variance(middle), all["standard_error_of_variance"][0].get<double>());
  EXPECT_EQ(all["largest_standard_error_of_variance"][1], own);
}

TEST_F(ResultFilesTest, TheSummaryHasTheRealizationsThatAVerdictNeedsIfPacketsAreLost) {
  EXPECT_TRUE(summary()["realizations_needed"].is_null()) << "errors are normal";
  lose_packets({0.01, {}, {1.0}});
  const RunResult result = result_with_fourth_moments();
  const nlohmann::json summary = this->summary(result);
  const std::vector<double> fourth = fourth_moments(configuration_.run, prediction_, result);
  ASSERT_EQ(fourth.size(), 6u);
  double needed = 0.0;
  for (std::size_t c = 0; c < 6; ++c) {
    const double v = prediction_.variance[c];
    EXPECT_GE(fourth[c], 3.0 * v * v + prediction_.fourth_cumulant[c]);
    needed = std::max(needed, values_needed(v, fourth[c], 12));
  }
  EXPECT_EQ(summary["realizations_needed"], std::ceil(needed));
  EXPECT_GT(needed, 20.0);
  EXPECT_TRUE(summary["agreement"]["max_abs_z_mean"].is_null());
  EXPECT_TRUE(
      contains(summary["agreement"]["reason"], "20 realizations are too few to tell a difference from chance: about "));
  const std::size_t last = cell(2, 2, 3);
  const double square = prediction_.variance[last] * prediction_.variance[last];
  EXPECT_NEAR(summary["standard_error_of_variance"][1].get<double>(), std::sqrt((fourth[last] - square) / 20.0), 1e-12);
}

TEST_F(ResultFilesTest, LossesInBurstsHaveATheoryAndNoVerdict) {
  lose_packets({0.1, 2.0, {1.0}});
  RunResult result = result_with_fourth_moments();
  result.realizations = 1000000;
  const nlohmann::json summary = this->summary(result);
  EXPECT_TRUE(summary["theory"]["stationary_variance"].at(1).is_number());
  EXPECT_TRUE(summary["agreement"]["max_abs_z_variance"].is_null());
  EXPECT_TRUE(summary["realizations_needed"].is_null());
  EXPECT_TRUE(contains(summary["warning"], "losses in bursts: the theory has means and variances"));
}

TEST_F(ResultFilesTest, TheSummaryCountsLostPositions) {
  RunResult result = this->result();
  result.tally.positions_received -= 8;
  EXPECT_EQ(summary(result)["positions_lost"], 8);
  result.tally.positions_received += 16;
  EXPECT_EQ(summary(result)["positions_lost"], -8);
}

TEST_F(ResultFilesTest, AStringUnstablePlatoonHasNoLimit) {
  configuration_ = paper_run(folder_.path(), 2.4);
  predict_again();
  EXPECT_EQ(summary()["theory"]["string_stable"], false);
  EXPECT_TRUE(summary()["theory"]["limit_variance"].is_null());
}

TEST_F(ResultFilesTest, NothingIsComparedBeforeTheFirstMeasurement) {
  RunResult nothing;
  nothing.moments.assign(6, Moments{});
  const nlohmann::json summary = this->summary(nothing);
  EXPECT_EQ(summary["complete"], false);
  EXPECT_TRUE(summary["agreement"]["max_abs_z_mean"].is_null());
  EXPECT_EQ(summary["vehicle_steps_per_second"], 0.0);
}

TEST_F(ResultFilesTest, AveragesOverTimeAreLabelled) {
  make_endless();
  const auto rows = this->rows(result_over_time());
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1][0], "1");
  EXPECT_EQ(rows[1][1], "999");
  EXPECT_EQ(rows[1][2], "800");
  EXPECT_EQ(rows[2][1], "998");
  const nlohmann::json summary = this->summary(result_over_time());
  EXPECT_EQ(summary["time_average"], true);
  EXPECT_TRUE(summary["agreement"]["max_abs_z_mean"].is_null()) << "800 steps are too few";
  EXPECT_EQ(
      summary["standard_error_of_variance"][1],
      standard_error_of_variance(prediction_.variance[1], 800, prediction_.error_correlation[1].of(800).variance));
}

TEST_F(ResultFilesTest, FilesAreReplacedWhole) {
  RunResult result = this->result();
  summary(result);
  result.tally.attempts = 7;
  EXPECT_EQ(summary(result)["attempts"], 7);
  EXPECT_EQ(folder_.entries().size(), 2u);
}

TEST_F(ResultFilesTest, TheSummaryHasTheScoresOfEverySignal) {
  EXPECT_FALSE(summary()["agreement"].contains("signals"));
  configuration_.run.signals = {"gap", "speed"};
  predict_again();
  RunResult result = this->result();
  result.signals[1][2].mean += 2.0 * standard_error_of_mean(prediction_.signals[1].variance[2], result.realizations);
  const nlohmann::json of = summary(result)["agreement"]["signals"];
  EXPECT_NEAR(of["gap"]["max_abs_z_mean"], 0.5, 1e-6);
  EXPECT_NEAR(of["speed"]["max_abs_z_mean"], 2.5, 1e-6);
  EXPECT_NEAR(of["speed"]["plausible_z"], largest_plausible_score(2 * prediction_.signals[1].mean.size()), 1e-12);
}

// As null they would read as if nothing had been compared.
TEST_F(ResultFilesTest, TheSummaryHasInfiniteAndUnknownScoresAsNumbers) {
  RunResult result = this->result();
  make_quiet();
  EXPECT_EQ(summary(result)["agreement"]["max_abs_z_variance"], 1e9);
  result.moments[0].mean = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(summary(result)["agreement"]["max_abs_z_mean"], 1e9);
}

TEST_F(ResultFilesTest, AFileThatCannotBeWrittenIsNamed) {
  configuration_.run.output = folder_ / "none";
  EXPECT_TRUE(
      contains(message_of<std::runtime_error>([this] { summary(); }), unfinished_summary_file(folder_ / "none")));
}

TEST_F(ResultFilesTest, TheoryEndsBeforeTheFirstExternalVehicle) {
  RunResult result = this->result();
  configuration_.run.external = {2};
  for (std::int64_t k = 0; k < 3; ++k) result.moments[cell(2, k, 3)].mean += 1000.0;  // as an external vehicle may
  predict_again();
  const auto rows = this->rows(result);
  for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(rows[1 + c][5], c < 3 ? formatted("%.17g", prediction_.mean[c]) : "");
  const auto judged = measured_agreement(configuration_.run, prediction_, result);
  ASSERT_TRUE(judged);
  EXPECT_LT(judged->max_abs_z_mean, 1.0) << "of follower 1 alone";
  const nlohmann::json theory = summary(result)["theory"];
  EXPECT_EQ(theory["stationary_variance"][1], nullptr);
  EXPECT_EQ(theory["limit_variance"], nullptr);
  EXPECT_EQ(theory["string_stable"], true);
  EXPECT_TRUE(contains(report(configuration_, prediction_, result), "over all 3 (i, k)"));
}

}  // namespace
}  // namespace platoon
