#include "stochastic_platoon/run/report/analysis_report.hpp"
#include "stochastic_platoon/run/report/stability_map.hpp"
#include "stochastic_platoon/run/report/string_text.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "unit/messages.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/paper_run.hpp"

namespace platoon {
namespace {

PlatoonModel model_at(double headway) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().design = paper_design();
  model.default_vehicle().headway = headway;
  model.default_vehicle().loop = close_loop(*model.default_vehicle().design, headway);
  return model;
}

/// The analysis of a model over some steps.
struct Analyzed {
  Analyzed(const PlatoonModel& model, std::size_t followers, std::int64_t steps, const SignalRequest& signals = {},
           std::int64_t burn_in = 0)
      : configuration(paper_run("")) {
    configuration.model = model;
    configuration.run.followers = followers;
    configuration.run.steps = steps;
    configuration.run.burn_in = burn_in;
    analysis = analyze(configuration, signals);
  }
  nlohmann::json json() const { return to_json(configuration, analysis); }
  std::string text() const { return report(configuration, analysis); }

  Configuration configuration;
  Analysis analysis;
};

TEST(Analysis, HasEveryKeyWithItsShape) {
  const PlatoonModel model = model_at(3.2);
  const nlohmann::json document = Analyzed(model, 7, 30).json();
  for (const char* key :
       {"spectral_radius", "peak_gain", "peak_frequency", "critical_headway", "limit_variance", "string_margin"}) {
    EXPECT_TRUE(document.at(key).is_number()) << key;
  }
  EXPECT_EQ(document.at("mean_square_stable"), true);
  EXPECT_EQ(document.at("string_stable"), true);
  EXPECT_EQ(document.at("stationary_variance").size(), 7u);
  EXPECT_EQ(document.at("mean").size(), 7u);
  EXPECT_EQ(document.at("variance").at(6).size(), 30u);
  EXPECT_EQ(document.at("norms").at("mean_l2").size(), 7u);
  EXPECT_EQ(document.at("norms").at("variance_linf").size(), 7u);
  EXPECT_TRUE(document.at("norms").at("mean_bound").is_number());
  EXPECT_TRUE(document.at("norms").at("variance_bound").is_number());
  EXPECT_EQ(document.at("transfer").at("denominator").size(), 4u);
  ASSERT_EQ(document.at("stable_headways").size(), 1u);
  // 2 * 1.89 / 1.35
  EXPECT_NEAR(document.at("stable_headways").at(0).at(0).get<double>(), 2.8, 1e-9);
  EXPECT_NEAR(document.at("critical_headway").get<double>(), 2.8, 1e-9);
}

TEST(Analysis, ComputesForAKeyAloneWhatTheWholeDocumentHas) {
  for (const double headway : {3.2, 2.4}) {
    Analyzed whole(model_at(headway), 3, 10, {{"gap"}, 1e-6});
    const nlohmann::json document = whole.json();
    for (const auto& entry : document.items()) {
      const Analysis alone = analyze(whole.configuration, {{"gap"}, 1e-6}, [](const char*) {}, {entry.key()});
      EXPECT_EQ(to_json(whole.configuration, alone).at(entry.key()), entry.value()) << entry.key();
    }
  }
}

TEST(Analysis, HasTheGainAlongTheStringWithItsPeak) {
  const nlohmann::json document = Analyzed(model_at(2.4), 2, 5).json(), &curve = document.at("gain_along_string");
  const std::vector<double> frequencies = curve.at("frequency"), gains = curve.at("gain");
  ASSERT_EQ(frequencies.size(), gains.size());
  EXPECT_TRUE(std::is_sorted(frequencies.begin(), frequencies.end()));
  const auto peak = std::max_element(gains.begin(), gains.end());
  EXPECT_NEAR(*peak, document.at("peak_gain").get<double>(), 1e-12);
  EXPECT_EQ(frequencies[static_cast<std::size_t>(peak - gains.begin())], document.at("peak_frequency"));
}

TEST(Analysis, NamesTheSpacing) {
  PlatoonModel model = model_at(3.2);
  EXPECT_EQ(spacing_text(model), "h = 0.32 s (3.2 sample periods)");
  model.default_vehicle().constant_spacing = true;
  model.default_vehicle().standstill_distance = 9.2;
  EXPECT_EQ(spacing_text(model), "constant spacing of 9.2 m");
}

TEST(Analysis, NamesWhatTheVehiclesOfTheStringHave) {
  PlatoonModel model = model_at(3.2);
  model.types.push_back({"near", model_at(2.4).default_vehicle()});
  model.types.push_back({"noisy", model_at(2.8).default_vehicle()});
  model.types.back().vehicle.position().noise_variance = 4.0;
  model.string = {1};
  EXPECT_EQ(string_text(model), "h = 0.24 s (2.4 sample periods), P_d = 0.6 m^2");
  model.string = {1, 2};
  EXPECT_EQ(string_text(model), "h = 0.24 to 0.28 s (2.4 to 2.8 sample periods), P_d = 0.6 to 4 m^2");
  model.types[1].vehicle.constant_spacing = true;
  model.types[1].vehicle.standstill_distance = 9.2;
  EXPECT_EQ(
      string_text(model),
      "h = 0.28 s (2.8 sample periods), constant spacing of 9.2 m, P_d = 0.6 to 4 m^2, hears position of vehicle i-1 (1)");
  model.types[1].vehicle.inputs.push_back({});
  model.types[1].vehicle.inputs.back().ahead = 2;
  model.types[1].vehicle.inputs.back().gain = 0.25;
  model.types[1].vehicle.inputs.push_back({InputSignal::speed, 0.25});
  EXPECT_EQ(
      string_text(model),
      "h = 0.28 s (2.8 sample periods), constant spacing of 9.2 m, P_d = 0 to 4 m^2, speed 0.25 (m/s)^2, near hears position of vehicle i-1 (1), position of vehicle i-2 (0.25), speed of vehicle i-1 (1), noisy hears position of vehicle i-1 (1)");
}

TEST(Analysis, NamesTheFirstOfManyTypes) {
  const auto headline = [](int count) {
    PlatoonModel model = model_at(3.2);
    for (int t = 1; t < count; ++t) {
      model.types.push_back(model.types.front());
      model.types.back().name = "car_" + std::to_string(t);
      model.string.push_back(static_cast<std::size_t>(t));
    }
    model.string.push_back(0);
    const std::string text = Analyzed(model, 2, 5).text();
    const std::size_t at = text.find("Critical headway of ");
    return at == std::string::npos ? "" : text.substr(at + 20, text.find(':', at) - at - 20);
  };
  EXPECT_EQ(headline(3), "default, car_1, car_2");
  EXPECT_EQ(headline(8), "default, car_1, car_2, car_3, car_4, car_5, car_6, car_7");
  EXPECT_EQ(headline(9), "default, car_1, car_2, car_3 and 5 others");
}

TEST(Analysis, HasTheMarginsOfTheLoop) {
  const nlohmann::json document = Analyzed(model_at(3.2), 2, 5).json();
  const LoopMargins margins = *loop_margins(model_at(3.2));
  EXPECT_EQ(document.at("phase_margin"), margins.phase);
  EXPECT_EQ(document.at("delay_margin"), margins.delay * 0.1);
  EXPECT_EQ(document.at("sensitivity_peak"), margins.sensitivity_peak);
  EXPECT_TRUE(document.at("critical_delay").is_null()) << "no radio";
  const nlohmann::json point = to_json(stability_map(model_at(3.2), {{3.2}, {}, {}}), 0.1).at(0);
  EXPECT_EQ(point.at("phase_margin"), margins.phase);
}

TEST(Analysis, WarnsIfTheCoefficientsAreTooCoarse) {
  PlatoonModel model = model_at(3.2);
  const StateSpace exact = model.default_vehicle().loop.realization;
  model.default_vehicle().design.reset();
  model.default_vehicle().loop = closed_loop_from(exact);
  const std::string warning = "Warning: the closed loop's matrices A, B and C have T(1) = 1";
  EXPECT_FALSE(contains(Analyzed(model, 2, 10).text(), warning));
  EXPECT_TRUE(contains(Analyzed(model, 2, 10).text(), "of one follower sqrt(sum of mean(k)^2)"));
  model.default_vehicle().loop = closed_loop_from(StateSpace(exact.a(), exact.b() * (1.0 + 1e-6), exact.c()));
  const Analyzed analyzed(model, 2, 10);
  EXPECT_NEAR(analyzed.analysis.integral_defect, 1e-6 * (1.0 + 3.2 / 4.2), 1e-12);
  EXPECT_TRUE(contains(analyzed.text(), warning));
}

TEST(Analysis, HasNullForAQuantityThatDoesNotExist) {
  const PlatoonModel unstable_string = model_at(2.4);
  const nlohmann::json document = Analyzed(unstable_string, 3, 10).json();
  EXPECT_TRUE(document.at("limit_variance").is_null());
  EXPECT_TRUE(document.at("norms").at("variance_bound").is_null());
  PlatoonModel unstable_loop = model_at(0.3);
  unstable_loop.allow_unstable = true;
  ASSERT_GT(spectral_radius(unstable_loop.default_vehicle().loop.realization), 1.0);
  const Analyzed analyzed(unstable_loop, 3, 10);
  const nlohmann::json other = analyzed.json();
  EXPECT_TRUE(other.at("stationary_variance").at(0).is_null());
  EXPECT_TRUE(other.at("peak_gain").is_null());
  EXPECT_TRUE(contains(analyzed.text(), "not mean square stable"));
}

TEST(Analysis, HasNoCriticalHeadwayOfAGivenClosedLoop) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().design.reset();
  const nlohmann::json document = Analyzed(model, 2, 5).json();
  EXPECT_TRUE(document.at("critical_headway").is_null());
  EXPECT_TRUE(document.at("stable_headways").is_null());
  EXPECT_THROW(stability_map(model, {{3.0}, {}, {}}), std::invalid_argument);
}

TEST(Analysis, HasTheRequestedSignals) {
  const PlatoonModel model = model_at(3.2);
  const Analyzed analyzed(model, 3, 10, {{"jerk", "relative_speed"}, 1e-6});
  const nlohmann::json document = analyzed.json();
  ASSERT_EQ(document.at("signals").size(), 3u) << "collisions imply the gap";
  for (const char* name : {"gap", "jerk", "relative_speed"}) {
    const nlohmann::json& signal = document.at("signals").at(name);
    for (const char* key : {"mean", "variance"}) {
      EXPECT_EQ(signal.at(key).size(), 3u) << key;
      EXPECT_EQ(signal.at(key).at(2).size(), 10u) << key;
    }
    EXPECT_EQ(signal.at("stationary_mean").size(), 3u);
    EXPECT_EQ(signal.at("stationary_variance").size(), 3u);
    EXPECT_TRUE(signal.at("limit_variance").is_number());
  }
  const nlohmann::json& collision = document.at("collision");
  for (const char* key : {"probability", "rate", "bound", "required_standstill_distances"})
    EXPECT_EQ(collision.at(key).size(), 3u) << key;
  for (const char* key :
       {"limit_probability", "limit_rate", "required_standstill_distance", "required_standstill_distance_of_platoon"})
    EXPECT_TRUE(collision.at(key).is_number()) << key;
  EXPECT_EQ(collision.at("speed"), 20.0);
  const std::string text = analyzed.text();
  EXPECT_TRUE(contains(text, "; for any of the 3 followers "));
  EXPECT_TRUE(contains(text, "at the leader's last speed, 20 m/s"));
  EXPECT_TRUE(contains(text, "Jerk: stationary variance "));
  EXPECT_TRUE(contains(text, "Relative speed: stationary variance "));
  EXPECT_TRUE(contains(text, "Required standstill distance for 1e-06 per step: "));
}

TEST(Analysis, HasTheAmplificationOfTheSpeed) {
  PlatoonModel model = model_at(3.2);
  model.leader = LeaderProfile({{0, 20.0}, {225, 15.0}}, 0.1);
  const auto analyzed = [&model](std::int64_t burn_in) {
    return Analyzed(model, 3, 300, {{"speed", "acceleration"}}, burn_in);
  };
  const nlohmann::json found = analyzed(150).json().at("amplification");
  EXPECT_EQ(found.at("from_step"), 150);
  for (const char* key : {"l2_ratio", "linf_ratio", "l2_head_to_tail", "linf_head_to_tail", "rms_jerk"}) {
    EXPECT_EQ(found.at(key).size(), 4u) << key;
    EXPECT_TRUE(found.at(key).at(0).is_null()) << key;
  }
  // A change of speed has mostly low frequencies, whose gain is just below 1. It is in the middle of the steps, because
  // elsewhere its delay would shift the average.
  const double first = found.at("l2_ratio").at(1);
  EXPECT_TRUE(first > 0.9 && first < 1.0) << first;
  EXPECT_NEAR(found.at("l2_head_to_tail").at(2), first * found.at("l2_ratio").at(2).get<double>(), 1e-12);
  EXPECT_TRUE(contains(analyzed(150).text(), "Amplification of the speed (L2): largest "));
  model.leader = LeaderProfile({{0, 20.0}}, 0.1);
  EXPECT_TRUE(
      contains(analyzed(210).text(), "Amplification: none, as the leader drives at constant speed from step 210"));
}

TEST(Analysis, HasNoSignalsUnlessRequested) {
  const PlatoonModel model = model_at(3.2);
  const nlohmann::json document = Analyzed(model, 3, 10).json();
  EXPECT_FALSE(document.contains("signals"));
  EXPECT_FALSE(document.contains("collision"));
  EXPECT_FALSE(document.contains("amplification"));
}

TEST(Analysis, HasSignalsButNoCollisionsIfGapsAreNotNormal) {
  for (const bool in_bursts : {false, true}) {
    PlatoonModel model = model_at(3.2);
    model.default_vehicle().position().link.loss = LossModel{0.1, {}, {1.0}};
    if (in_bursts) model.default_vehicle().position().link.loss->mean_burst = 3.0;
    const Analyzed analyzed(model, 2, 5, {{"gap", "speed"}, 1e-6});
    const nlohmann::json document = analyzed.json();
    for (const char* name : {"gap", "speed"}) {
      const nlohmann::json& of = document.at("signals").at(name);
      EXPECT_GT(of.at("variance").at(1).at(4), 0.0) << name;
      EXPECT_GT(of.at("stationary_variance").at(1), of.at("variance").at(1).at(4)) << name;
    }
    EXPECT_TRUE(document.at("collision").is_null());
    EXPECT_TRUE(contains(analyzed.text(), "Collisions: measured only, as gaps are not normal"));
  }
}

TEST(StabilitySweep, CoversHeadwaysAndGains) {
  const std::vector<MapPoint> points = stability_map(model_at(3.2), {{2.4, 3.2}, {1.35, 9.0}, {}});
  ASSERT_EQ(points.size(), 4u);
  EXPECT_FALSE(points[0].stability.string_stable);
  EXPECT_TRUE(points[1].stability.string_stable);
  EXPECT_NEAR(points[1].stability.spectral_radius, string_stability(model_at(3.2)).spectral_radius, 1e-12);
  EXPECT_FALSE(points[3].stability.mean_square_stable);
  std::istringstream csv(to_csv(points));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "headway,gain,spectral_radius,peak_gain,string_stable");
  std::getline(csv, line);
  EXPECT_EQ(line.substr(line.size() - 2), ",0");
}

TEST(StabilitySweep, OverLossesKeepsTheMeanBurstThatATypeHasOfItsOwn) {
  PlatoonModel model = model_at(3.2);
  model.types[0].vehicle.inputs[0].link.loss = LossModel{0.1};
  model.types.push_back(model.types[0]);
  VehicleType& bursty = model.types[1];
  bursty.name = "bursty";
  bursty.inherited.mean_burst = false;
  bursty.vehicle.inputs[0].link.loss->mean_burst = 3.0;
  model.string = {1};
  const std::vector<MapPoint> points = stability_map(model, {{}, {}, {0.1, 0.2}});
  EXPECT_EQ(points[0].stability.loss_gain, string_stability(model).loss_gain);
  for (VehicleType& type : model.types) type.vehicle.inputs[0].link.loss->probability = 0.2;
  EXPECT_EQ(points[1].stability.loss_gain, string_stability(model).loss_gain);
}

}  // namespace
}  // namespace platoon
