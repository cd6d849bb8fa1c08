#include "stochastic_platoon/run/results/signal_results.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "unit/csv_rows.hpp"
#include "unit/messages.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

constexpr double kEmpty = -1.0;

using Columns = std::map<std::string, std::vector<double>>;

/// A run whose leader changes its speed twice.
class AmplificationResultsTest : public ResultTest {
protected:
  AmplificationResultsTest() {
    configuration_.model = eventful_platoon(3.2);
    configuration_.model.default_vehicle().position().noise_variance = 1e-6;
    configuration_.model.default_vehicle().initial_position = {};
    configuration_.run.steps = 40;
    configuration_.run.signals = {"gap", "speed", "acceleration"};
    predict_again();
  }

  /// A result whose measured moments of the signals equal those of a theory.
  RunResult result_of(const Prediction& theory) const {
    RunResult exact = result();
    exact.signals.clear();
    const auto count = static_cast<double>(exact.realizations);
    for (const SignalMoments& signal : theory.signals) {
      exact.signals.emplace_back();
      for (std::size_t c = 0; c < signal.mean.size(); ++c)
        exact.signals.back().push_back({exact.realizations, signal.mean[c], signal.variance[c] * count});
    }
    return exact;
  }

  /// The values per vehicle by column; kEmpty for an empty cell.
  Columns columns_of(const RunResult& result) const {
    const auto rows = csv_rows(amplification_csv(configuration_, prediction_, result));
    Columns columns;
    for (std::size_t column = 0; column < rows[0].size(); ++column) {
      for (std::size_t row = 1; row < rows.size(); ++row) {
        const std::string& cell = rows[row][column];
        columns[rows[0][column]].push_back(cell.empty() ? kEmpty : std::stod(cell));
      }
    }
    return columns;
  }
};

TEST_F(AmplificationResultsTest, HaveARowPerVehicleMeasuredAndInTheory) {
  const Columns of = columns_of(result_of(prediction_));
  ASSERT_EQ(of.size(), 19u);
  EXPECT_EQ(of.at("vehicle"), (std::vector<double>{0.0, 1.0, 2.0}));
  for (const char* name : {"l2_ratio", "linf_ratio", "l2_head_to_tail", "linf_head_to_tail", "rms_mean_speed",
                           "rms_acceleration", "rms_mean_acceleration"}) {
    const std::vector<double>&found = of.at(name), &expected = of.at(std::string("theoretical_") + name);
    const bool is_ratio = std::string(name).find("rms") == std::string::npos;
    EXPECT_EQ(found[0] == kEmpty && expected[0] == kEmpty, is_ratio) << name;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-5 * std::abs(expected[i])) << name << i;
  }
  EXPECT_LT(of.at("l2_ratio")[2], of.at("theoretical_l2_ratio")[2]) << "less the noise of the means";
  EXPECT_EQ(of.at("rms_acceleration")[2], of.at("theoretical_rms_acceleration")[2]);
  EXPECT_GT(of.at("rms_acceleration")[2], of.at("rms_mean_acceleration")[2]);
  EXPECT_EQ(of.at("rms_jerk"), std::vector<double>(3, kEmpty)) << "not among the signals";
  EXPECT_EQ(of.at("theoretical_rms_jerk"), std::vector<double>(3, kEmpty));
}

TEST_F(AmplificationResultsTest, AreEmptyWithoutTheory) {
  const Prediction normal = prediction_;
  configuration_.run.external = {2};
  predict_again();
  Columns of = columns_of(result_of(normal));
  EXPECT_GT(of.at("theoretical_l2_ratio")[1], 0.0);
  EXPECT_EQ(of.at("theoretical_l2_ratio")[2], kEmpty) << "external";
  EXPECT_GT(of.at("l2_ratio")[2], 0.0);
  configuration_.run.external.clear();
  lose_packets({0.5, 1.0, {1.0}});  // losses and arrivals alternate
  of = columns_of(result_of(normal));
  EXPECT_EQ(of.at("theoretical_rms_acceleration"), std::vector<double>(3, kEmpty));
  EXPECT_GT(of.at("rms_acceleration")[1], 0.0);
  EXPECT_FALSE(contains(signals_report(configuration_, prediction_, result_of(normal)), "theory"));
}

TEST_F(AmplificationResultsTest, BeginAtTheBurnIn) {
  const RunResult result = result_of(prediction_);
  const double all = columns_of(result).at("rms_mean_speed")[0];
  configuration_.run.burn_in = 15;
  EXPECT_LT(columns_of(result).at("rms_mean_speed")[0], 0.8 * all) << "without the first of three changes";
}

TEST_F(AmplificationResultsTest, AreWrittenWithTheSpeedAlone) {
  const auto written = [this](const std::string& name) {
    configuration_.run.output = folder_ / name;
    predict_again();
    std::filesystem::create_directory(configuration_.run.output);
    write_results(configuration_, prediction_, result_of(prediction_));
    return std::filesystem::exists(configuration_.run.output + "/amplification.csv");
  };
  EXPECT_TRUE(written("with"));
  const nlohmann::json summary = nlohmann::json::parse(content_of(folder_ / "with/summary.json"));
  EXPECT_TRUE(summary.at("crc32").contains("amplification"));
  configuration_.run.signals = {"gap", "acceleration"};
  EXPECT_FALSE(written("gap"));
  configuration_.run.signals = {"speed"};
  configuration_.run.burn_in = 39;
  EXPECT_FALSE(written("short")) << "one step is left";
}

TEST_F(AmplificationResultsTest, ReportTheReasonWhyThereIsNone) {
  RunResult result = result_of(prediction_);
  const std::string text = report(configuration_, prediction_, result);
  EXPECT_TRUE(contains(text, "Amplification of the speed (L2): largest "));
  EXPECT_TRUE(contains(text, " (theory: largest "));
  for (std::vector<Moments>& signal : result.signals) {
    for (Moments& of : signal) of.squared_deviations *= 1e8;
  }
  EXPECT_TRUE(contains(report(configuration_, prediction_, result), "(L2): none, as noise hides it (theory: largest "));
  configuration_.model.leader = LeaderProfile({{0, 0.0}}, 0.1);
  predict_again();
  EXPECT_TRUE(contains(report(configuration_, prediction_, result_of(prediction_)),
                       "Amplification: none, as the leader drives at constant speed from step 0 on\n"));
}

TEST_F(AmplificationResultsTest, TheCommandThatReplaysTheSmallestGapWorksForAnyFolder) {
  RunResult found = result_of(prediction_);
  found.gaps = GapTable({2, 0.1, {}});
  found.gaps.merge(1, {{0.5, 7, 3}, 0, 0, {{5, 20}}});
  found.gaps.merge(2, {{1.5, 9, 3}, 0, 0, {{15, 20}}});
  for (const char* name : {"plain", "two words"}) {
    const std::string folder = configuration_.run.output = folder_ / name;
    const std::string quote = folder.find(' ') == std::string::npos ? "" : "'";
    EXPECT_TRUE(contains(signals_report(configuration_, prediction_, found),
                         "--repeat " + quote + folder + "/summary.json" + quote + " --only 7 --trajectories --output " +
                             quote + folder + "/realization_7" + quote + "\n"));
  }
}

}  // namespace
}  // namespace platoon
