#include "stochastic_platoon/run/results/signal_results.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "unit/run/results/result_with.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

constexpr double kEmpty = -1.0;

// The values per vehicle by column; kEmpty for an empty cell.
std::map<std::string, std::vector<double>> columns_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, name;
  std::getline(lines, line);
  std::vector<std::string> names;
  for (std::istringstream heading(line); std::getline(heading, name, ',');) names.push_back(name);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    for (const std::string& column : names) {
      std::string cell;
      std::getline(cells, cell, ',');
      columns[column].push_back(cell.empty() ? kEmpty : std::stod(cell));
    }
  }
  return columns;
}

// A run whose leader changes its speed twice.
Configuration changing_run(const std::string& output) {
  Configuration configuration = paper_run(output);
  configuration.model = eventful_platoon(3.2);
  configuration.model.default_vehicle().noise_variance = 1e-6;
  configuration.model.default_vehicle().initial_position = {};
  configuration.run.steps = 40;
  configuration.run.signals = {"gap", "speed", "acceleration"};
  return configuration;
}

// A result whose measured moments equal those of the theory, or of `other` if `prediction` has none.
RunResult exact_result(const Configuration& configuration, const Prediction& prediction, const Prediction& other) {
  RunResult result = result_with(configuration, prediction);
  const auto count = static_cast<double>(result.realizations);
  for (const SignalMoments& signal : other.signals) {
    result.signals.emplace_back();
    for (std::size_t c = 0; c < signal.mean.size(); ++c)
      result.signals.back().push_back({result.realizations, signal.mean[c], signal.variance[c] * count});
  }
  return result;
}

TEST(AmplificationResults, HaveARowPerVehicleMeasuredAndInTheory) {
  const Configuration configuration = changing_run("");
  const Prediction prediction = predict(configuration);
  const auto of =
      columns_of(amplification_csv(configuration, prediction, exact_result(configuration, prediction, prediction)));
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

TEST(AmplificationResults, LeaveTheoryEmptyWhereThereIsNone) {
  Configuration configuration = changing_run("");
  const Prediction normal = predict(configuration);
  configuration.run.external = {2};
  const Prediction before = predict(configuration);
  auto of = columns_of(amplification_csv(configuration, before, exact_result(configuration, before, normal)));
  EXPECT_GT(of.at("theoretical_l2_ratio")[1], 0.0);
  EXPECT_EQ(of.at("theoretical_l2_ratio")[2], kEmpty) << "external";
  EXPECT_GT(of.at("l2_ratio")[2], 0.0);
  configuration.run.external.clear();
  configuration.model.default_vehicle().link.loss = LossModel{0.1, {}, {1.0}};
  const Prediction lossy = predict(configuration);
  const RunResult result = exact_result(configuration, lossy, normal);
  of = columns_of(amplification_csv(configuration, lossy, result));
  EXPECT_EQ(of.at("theoretical_rms_acceleration"), std::vector<double>(3, kEmpty));
  EXPECT_GT(of.at("rms_acceleration")[1], 0.0);
  EXPECT_EQ(signals_report(configuration, lossy, result).find("theory"), std::string::npos);
}

TEST(AmplificationResults, BeginAtTheBurnIn) {
  Configuration configuration = changing_run("");
  const Prediction prediction = predict(configuration);
  const RunResult result = exact_result(configuration, prediction, prediction);
  const auto all = columns_of(amplification_csv(configuration, prediction, result));
  configuration.run.burn_in = 15;
  const auto later = columns_of(amplification_csv(configuration, prediction, result));
  EXPECT_LT(later.at("rms_mean_speed")[0], 0.8 * all.at("rms_mean_speed")[0]) << "without the first of three changes";
}

TEST(AmplificationResults, AreWrittenWithTheSpeedAlone) {
  const TemporaryFolder folder;
  Configuration configuration = changing_run(folder / "with");
  const auto written = [&] {
    const Prediction prediction = predict(configuration);
    std::filesystem::create_directory(configuration.run.output);
    write_results(configuration, prediction, exact_result(configuration, prediction, prediction));
    return std::filesystem::exists(configuration.run.output + "/amplification.csv");
  };
  EXPECT_TRUE(written());
  const nlohmann::json summary = nlohmann::json::parse(content_of(folder / "with/summary.json"));
  EXPECT_TRUE(summary.at("crc32").contains("amplification"));
  configuration.run.output = folder / "gap";
  configuration.run.signals = {"gap", "acceleration"};
  EXPECT_FALSE(written());
  configuration.run.output = folder / "short";
  configuration.run.signals = {"speed"};
  configuration.run.burn_in = 39;
  EXPECT_FALSE(written()) << "one step is left";
}

TEST(AmplificationResults, ReportTheReasonWhyThereIsNone) {
  Configuration configuration = changing_run("");
  Prediction prediction = predict(configuration);
  RunResult result = exact_result(configuration, prediction, prediction);
  std::string text = report(configuration, prediction, result);
  EXPECT_NE(text.find("Amplification of the speed (L2): largest "), std::string::npos) << text;
  EXPECT_NE(text.find(" (theory: largest "), std::string::npos) << text;
  for (std::vector<Moments>& signal : result.signals) {
    for (Moments& of : signal) of.squared_deviations *= 1e8;
  }
  EXPECT_NE(report(configuration, prediction, result).find("(L2): none, as noise hides it (theory: largest "),
            std::string::npos);
  configuration.model.leader = LeaderProfile({{0, 0.0}}, 0.1);
  prediction = predict(configuration);
  text = report(configuration, prediction, exact_result(configuration, prediction, prediction));
  EXPECT_NE(text.find("Amplification: none, as the leader drives at constant speed from step 0 on\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace platoon
