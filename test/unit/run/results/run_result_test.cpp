#include "stochastic_platoon/run/results/run_result.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"
#include "stochastic_platoon/run/io/checksum.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "unit/paper_run.hpp"
#include "unit/run/results/result_with.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

std::set<std::string> keys_of(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& entry : object.items()) keys.insert(entry.key());
  return keys;
}

struct Written {
  std::vector<std::vector<std::string>> rows;
  nlohmann::json summary;
};

Written written(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  write_results(configuration, prediction, result);
  return {rows_of(content_of(configuration.run.output + "/statistics.csv")),
          nlohmann::json::parse(content_of(configuration.run.output + "/summary.json"))};
}

TEST(RunResult, CountsThePositionsThatMustCome) {
  RunOptions run = paper_run("").run;
  EXPECT_EQ(positions_expected(run, 20), 3u * 4u * 20u);
  run.followers = 20;
  run.steps = 100;
  EXPECT_EQ(positions_expected(run, 100000), 21u * 101u * 100000u);
}

TEST(WriteResults, PutsARowPerVehicleAndStepIntoTheTable) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  const RunResult result = result_with(configuration, prediction);
  const auto rows = written(configuration, prediction, result).rows;
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
      EXPECT_EQ(std::stod(row[3]), result.moments[c].mean) << "to the bit";
      EXPECT_EQ(std::stod(row[4]), result.moments[c].variance());
      EXPECT_EQ(std::stod(row[5]), prediction.mean[c]);
      EXPECT_EQ(std::stod(row[6]), prediction.variance[c]);
    }
  }
}

TEST(WriteResults, WritesWhatIsUndefinedAsNaN) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction);
  result.moments[0] = Moments{};
  result.moments[1] = Moments{1, 0.25, 0.0};
  const auto rows = written(configuration, prediction, result).rows;
  EXPECT_EQ(rows[1][3], "nan");
  EXPECT_EQ(rows[1][4], "nan");
  EXPECT_EQ(rows[2][3], "0.25");
  EXPECT_EQ(rows[2][4], "nan");
}

TEST(WriteResults, PutsEveryKeyIntoTheSummary) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  const nlohmann::json summary = written(configuration, prediction, result_with(configuration, prediction)).summary;
  const std::set<std::string> keys = keys_of(summary);
  for (const char* key : {"complete", "followers", "steps", "realizations", "seed", "hosting", "attempts",
                          "positions_received", "positions_lost", "wall_seconds", "vehicle_steps_per_second",
                          "agreement", "theory", "configuration", "revision", "date", "host", "command_line"}) {
    EXPECT_EQ(keys.count(key), 1u) << key;
  }
  EXPECT_EQ(keys_of(summary["agreement"]), (std::set<std::string>{"max_abs_z_mean", "max_abs_z_variance"}));
  EXPECT_EQ(keys_of(summary["theory"]),
            (std::set<std::string>{"spectral_radius", "peak_gain", "mean_square_stable", "string_stable",
                                   "stationary_variance", "limit_variance"}));
}

// zlib.crc32(b"123456789"), the check value of CRC-32.
TEST(Checksum, IsCrc32) {
  EXPECT_EQ(checksum("123456789"), "cbf43926");
}

TEST(WriteResults, PutsTheChecksumsOfBothFilesIntoTheSummary) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  const nlohmann::json summary = written(configuration, prediction, result_with(configuration, prediction)).summary;
  EXPECT_EQ(summary["crc32"]["statistics"], checksum(content_of(folder.path() + "/statistics.csv")));
  std::string text = content_of(folder.path() + "/summary.json");
  const std::string own = summary["crc32"]["summary"];
  text.replace(text.find(own), own.size(), "00000000");
  EXPECT_EQ(own, checksum(text));
}

// Errors that are not normal: the fourth moments determine the standard error of a variance.
TEST(WriteResults, PutsTheStandardErrorsOfTheVariancesIntoTheSummary) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction);
  Moments& last = result.moments[cell(2, 2, 3)];
  const double gaussian = standard_error_of_variance(prediction.variance[cell(2, 2, 3)], last.count);
  EXPECT_EQ(written(configuration, prediction, result).summary["standard_error_of_variance"][1], gaussian);
  last.cubed_deviations = 0.0;
  last.fourth_deviations = 9.0 * last.variance() * last.variance() * static_cast<double>(last.count);
  const double own = written(configuration, prediction, result).summary["standard_error_of_variance"][1];
  EXPECT_EQ(own, standard_error_of_variance(last));
  EXPECT_GT(own, 1.5 * gaussian);
}

TEST(WriteResults, SaysHowManyRealizationsAVerdictNeedsWherePacketsAreLost) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  EXPECT_TRUE(written(configuration, predict(configuration), result_with(configuration, predict(configuration)))
                  .summary["realizations_needed"]
                  .is_null())
      << "errors are normal";
  configuration.model.default_vehicle().link.loss = LossModel{0.01, {}, {1.0}};
  const Prediction prediction = predict(configuration);
  const RunResult result = result_with_fourth_moments(configuration, prediction, 0.5);
  const nlohmann::json summary = written(configuration, prediction, result).summary;
  const std::vector<double> fourth = fourth_moments(configuration.run, prediction, result);
  ASSERT_EQ(fourth.size(), 6u);
  double needed = 0.0;
  for (std::size_t c = 0; c < 6; ++c) {
    EXPECT_GE(fourth[c], 3.0 * prediction.variance[c] * prediction.variance[c] + prediction.fourth_cumulant[c]);
    needed = std::max(needed, values_needed(prediction.variance[c], fourth[c], 12));
  }
  EXPECT_EQ(summary["realizations_needed"], std::ceil(needed));
  EXPECT_GT(needed, 20.0);
  EXPECT_TRUE(summary["agreement"]["max_abs_z_mean"].is_null());
  const std::size_t last = cell(2, 2, 3);
  const double square = prediction.variance[last] * prediction.variance[last];
  EXPECT_NEAR(summary["standard_error_of_variance"][1].get<double>(), std::sqrt((fourth[last] - square) / 20.0), 1e-12);
}

TEST(WriteResults, HasTheTheoryAndNoVerdictWhereLossesComeInBursts) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  configuration.model.default_vehicle().link.loss = LossModel{0.1, 2.0, {1.0}};
  const Prediction prediction = predict(configuration);
  RunResult result = result_with_fourth_moments(configuration, prediction, 0.5);
  result.realizations = 1000000;
  const nlohmann::json summary = written(configuration, prediction, result).summary;
  EXPECT_TRUE(summary["theory"]["stationary_variance"].at(1).is_number());
  EXPECT_TRUE(summary["agreement"]["max_abs_z_variance"].is_null());
  EXPECT_TRUE(summary["realizations_needed"].is_null());
  EXPECT_NE(summary["warning"].get<std::string>().find("losses in bursts"), std::string::npos);
}

TEST(WriteResults, PutsTheRunsFiguresIntoTheSummary) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  const nlohmann::json summary =
      written(configuration, prediction, result_with(configuration, prediction, 1.25)).summary;
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
  EXPECT_EQ(summary["theory"]["limit_variance"].get<double>(), *prediction.stability.limit_variance);
}

TEST(WriteResults, CountsThePositionsThatWereLost) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction);
  result.tally.positions_received -= 8;
  EXPECT_EQ(written(configuration, prediction, result).summary["positions_lost"], 8);
  result.tally.positions_received += 16;
  EXPECT_EQ(written(configuration, prediction, result).summary["positions_lost"], -8);
}

TEST(WriteResults, HasNoLimitForAStringUnstablePlatoon) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path(), 2.4);
  const Prediction prediction = predict(configuration);
  const nlohmann::json summary = written(configuration, prediction, result_with(configuration, prediction)).summary;
  EXPECT_EQ(summary["theory"]["string_stable"], false);
  EXPECT_TRUE(summary["theory"]["limit_variance"].is_null());
}

TEST(WriteResults, ComparesNothingThatWasNotMeasured) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction);
  result.complete = false;
  result.realizations = 0;
  result.tally = {};
  result.moments.assign(6, Moments{});
  const nlohmann::json summary = written(configuration, prediction, result).summary;
  EXPECT_EQ(summary["complete"], false);
  EXPECT_TRUE(summary["agreement"]["max_abs_z_mean"].is_null());
  EXPECT_EQ(summary["vehicle_steps_per_second"], 0.0);
}

TEST(WriteResults, LabelsTimeAveragesAsSuch) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  configuration.run.steps = 0;
  configuration.run.realizations = 1;
  configuration.run.burn_in = 200;
  const Prediction prediction = predict(configuration);
  RunResult result;
  result.realizations = 1;
  result.last_step = 999;
  result.moments = {Moments{800, 0.1, 79.9}, Moments{800, 0.2, 159.8}};
  result.last_steps = {999, 998};
  const Written files = written(configuration, prediction, result);
  ASSERT_EQ(files.rows.size(), 3u);
  EXPECT_EQ(files.rows[1][0], "1");
  EXPECT_EQ(files.rows[1][1], "999");
  EXPECT_EQ(files.rows[1][2], "800");
  EXPECT_EQ(files.rows[2][1], "998");
  EXPECT_EQ(files.summary["time_average"], true);
  EXPECT_TRUE(files.summary["agreement"]["max_abs_z_mean"].is_null()) << "800 steps are too few";
  EXPECT_EQ(files.summary["standard_error_of_variance"][1],
            standard_error_of_variance(prediction.variance[1], 800, prediction.error_correlation[1].of(800).variance));
}

TEST(WriteResults, ReplacesItsFilesWhole) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction);
  written(configuration, prediction, result);
  result.tally.attempts = 7;
  EXPECT_EQ(written(configuration, prediction, result).summary["attempts"], 7);
  EXPECT_EQ(folder.entries().size(), 2u);
}

TEST(WriteResults, NamesTheFileItCannotWrite) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder / "none");
  const Prediction prediction = predict(configuration);
  try {
    write_results(configuration, prediction, result_with(configuration, prediction));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(unfinished_summary_file(folder / "none")), std::string::npos);
  }
}

TEST(WriteResults, LeavesTheTheoryEmptyFromTheFirstOwnVehicleOn) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  const Prediction whole = predict(configuration);
  RunResult result = result_with(configuration, whole);
  configuration.run.external = {2};
  for (std::int64_t k = 0; k < 3; ++k) result.moments[cell(2, k, 3)].mean += 1000.0;  // as an external vehicle may
  const Prediction prediction = predict(configuration);
  const Written files = written(configuration, prediction, result);
  for (std::size_t c = 0; c < 6; ++c) {
    const std::string first = c < 3 ? formatted("%.17g", prediction.mean[c]) : "";
    const auto& row = files.rows[1 + c];
    ASSERT_EQ(row.size(), c < 3 ? 7u : 6u);  // getline omits the last of the empty fields
    EXPECT_EQ(row[5], first);
  }
  const auto judged = measured_agreement(configuration.run, prediction, result);
  ASSERT_TRUE(judged);
  EXPECT_LT(judged->max_abs_z_mean, 1.0) << "of follower 1 alone";
  EXPECT_EQ(files.summary["theory"]["stationary_variance"][1], nullptr);
  EXPECT_EQ(files.summary["theory"]["limit_variance"], nullptr);
  EXPECT_EQ(files.summary["theory"]["string_stable"], true);
  EXPECT_NE(report(configuration, prediction, result).find("over all 3 (i, k)"), std::string::npos);
}

}  // namespace
}  // namespace platoon
