#include "stochastic_platoon/run/configuration/inputs_section.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

const std::string kCar =
    "plant: {actuator_lag: 0.1, input_delay: 0.2}\n"
    "controller: {kp: 0.2, kd: 0.7, headway_filter: true}\n"
    "time_headway_seconds: 0.5\n"
    "standstill_distance: 5.0\n"
    "sample_period: 0.01\n"
    "leader: {speed: [{from_step: 0, value: 20.0}]}\n"
    "initial_position: {mean: 0.0, variance: 0.0}\n";
const std::string kRadar = "  - {signal: position, from: predecessor, noise_variance: 0.01, channel: {delay: 1}}\n";
const std::string kRadio =
    "  - {signal: input, from: predecessor, gain: 0.9, noise_variance: 0.02, channel: {delay: 2, loss: {probability: 0.1, on_loss: zero}}}\n";

PlatoonModel parse(const std::string& text) {
  return parse_model(YAML::Load(text));
}

std::vector<std::string> problems_with(const std::string& text) {
  return problems_of([&text] { parse(text); });
}

void expect_problem(const std::string& text, const std::string& expected) {
  const std::vector<std::string> problems = problems_with(text);
  ASSERT_EQ(problems.size(), 1u) << expected;
  EXPECT_EQ(problems[0].substr(0, expected.size()), expected);
}

std::string with_radio(const std::string& part, const std::string& other) {
  std::string radio = kRadio;
  return kCar + "inputs:\n" + kRadar + radio.replace(radio.find(part), part.size(), other);
}

TEST(InputsSection, GivesRadarAndRadio) {
  const PlatoonModel model = parse(kCar + "inputs:\n" + kRadar + kRadio);
  const VehicleModel& vehicle = model.default_vehicle();
  EXPECT_EQ(vehicle.noise_variance, 0.01);
  EXPECT_EQ(vehicle.link.delay, 1);
  ASSERT_TRUE(vehicle.feed_forward);
  EXPECT_EQ(vehicle.feed_forward->gain, 0.9);
  EXPECT_EQ(vehicle.feed_forward->noise_variance, 0.02);
  EXPECT_EQ(vehicle.feed_forward->link.delay, 2);
  EXPECT_TRUE(vehicle.feed_forward->link.loss->predictor.empty());
  EXPECT_TRUE(vehicle.loop.parts);
  EXPECT_TRUE(sends_input(model, 0, 3));
  EXPECT_TRUE(sends_input(model, 2, 3));
  EXPECT_FALSE(sends_input(model, 3, 3)) << "nobody hears the last vehicle";
}

TEST(InputsSection, TakesThePositionsNoiseAndChannelAlsoFromTheVehicle) {
  const PlatoonModel model =
      parse(kCar + "noise_variance: 0.3\nchannel: {delay: 4}\ninputs:\n  - {signal: position}\n" + kRadio);
  EXPECT_EQ(model.default_vehicle().noise_variance, 0.3);
  EXPECT_EQ(model.default_vehicle().link.delay, 4);
}

TEST(InputsSection, IsTheSameToTheBitWhenWrittenAndReadAgain) {
  const std::string types =
      "vehicle_types:\n"
      "  human: {time_headway: 150.0, inputs: [{signal: position}]}\n"
      "  other: {plant: {numerator: [5.0e-5, 5.0e-5], denominator: [1, -2, 1]}}\n"
      "string: [default, human, other]\n";
  const PlatoonModel model = parse(kCar + "inputs:\n" + kRadar + kRadio + types);
  EXPECT_FALSE(model.types[1].vehicle.feed_forward);
  EXPECT_TRUE(model.types[2].vehicle.feed_forward);
  EXPECT_TRUE(model.types[2].vehicle.loop.parts) << "G(z) and a radio: its input is known part by part";
  const PlatoonModel again = parse(to_json(model).dump());
  EXPECT_EQ(to_json(again), to_json(model));
  for (std::size_t type = 0; type < model.types.size(); ++type) {
    EXPECT_EQ(again.types[type].vehicle.feed_forward, model.types[type].vehicle.feed_forward);
    EXPECT_EQ(again.types[type].vehicle.loop.realization.a(), model.types[type].vehicle.loop.realization.a());
  }
  EXPECT_TRUE(with_loss(again, 0.2).types[2].vehicle.feed_forward->link.loss->probability == 0.2) << "inherited";
}

TEST(InputsSection, TakesOverridesWhereTheirLinkIs) {
  const auto overridden = [](const std::string& model, const std::string& name, const std::string& value) {
    YAML::Node document;
    document["model"] = YAML::Load(model);
    override_value(document, name, YAML::Node(value));
    return parse_model(document["model"]).default_vehicle();
  };
  const std::string listed = kCar + "inputs:\n" + kRadar + kRadio,
                    apart = kCar + "noise_variance: 0.3\ninputs:\n  - {signal: position}\n" + kRadio;
  for (const std::string& model : {listed, apart}) {
    EXPECT_EQ(overridden(model, "noise_variance", "0.7").noise_variance, 0.7);
    EXPECT_EQ(overridden(model, "noise_variance", "0.7").feed_forward->noise_variance, 0.02);
    EXPECT_EQ(overridden(model, "delay", "5").link.delay, 5);
    const VehicleModel lossy = overridden(model, "loss", "0.4");
    EXPECT_EQ(lossy.feed_forward->link.loss->probability, 0.4);
    EXPECT_FALSE(lossy.link.loss);
  }
  EXPECT_EQ(overridden(kCar + "noise_variance: 0.3\n", "loss", "0.4").link.loss->probability, 0.4);
}

TEST(InputsSection, RejectsWhatNoRadioCanBe) {
  const std::string later = "inputs[1]/channel/delay: ";
  expect_problem(with_radio("delay: 2", "delay: 0"),
                 later + "0: must be 1 or more: the input of step k is known one step later");
  expect_problem(with_radio("delay: 2", "delay: 101"), later + "101: must be at most 100 steps for a radio");
  expect_problem(with_radio("delay: 2, ", ""), later + "missing: must be 1 or more");
  expect_problem(with_radio("gain: 0.9", "gain: 0"), "inputs[1]/gain: 0: must be other than 0");
  expect_problem(with_radio("noise_variance: 0.02, ", ""), "inputs[1]/noise_variance: missing");
  expect_problem(with_radio("from: predecessor", "from: leader"), "inputs[1]/from: leader: must be predecessor");
  expect_problem(with_radio("signal: input", "signal: speed"), "inputs[1]/signal: speed: must be position or input");
  expect_problem(kCar + "noise_variance: 0.1\ninputs:\n" + kRadio, "inputs: 0 positions: must be one position");
  expect_problem(kCar + "inputs:\n" + kRadar + kRadio + kRadio, "inputs: 2 inputs: must be one position");
  expect_problem(kCar + "noise_variance: 0.1\ninputs:\n" + kRadar + kRadio,
                 "noise_variance: given: must be absent beside");
  expect_problem(kCar + "noise_variance: 0.1\nchannel: {loss: {probability: 0.1, on_loss: zero}}\n",
                 "channel/loss/on_loss: zero: must be");
}

TEST(InputsSection, RejectsVehiclesThatHaveNoInputToSend) {
  const std::string radios = "inputs:\n" + kRadar + kRadio;
  expect_problem(
      kCar + radios +
          "vehicle_types: {given: {closed_loop: {A: [[1.3, 1], [-0.4, 0]], B: [0.3, -0.2], C: [1, 0]}}}\nstring: [given, default]\n",
      "vehicle_types/given/closed_loop: given: must be plant and controller");
  std::string single = kCar;
  single.replace(single.find("{actuator_lag: 0.1, input_delay: 0.2}"), 37, "{numerator: [0.1], denominator: [1, -1]}");
  single.replace(single.find("kp: 0.2, kd: 0.7"), 16, "kp: 0.2, kd: 0.7, ki: 0.1");
  expect_problem(single + radios, "plant: no double integrator");
  std::string recorded = kCar;
  recorded.replace(recorded.find("{speed: [{from_step: 0, value: 20.0}]}"), 38, "{positions: [0, 0, 0]}");
  expect_problem(recorded + radios, "leader/positions: given: must be speed");
}

TEST(InputsSection, ReportsGainsThatMakeTheLoopUnstable) {
  std::string fast = kCar;
  fast.replace(fast.find("kp: 0.2"), 7, "kp: 90.");
  const std::vector<std::string> problems = problems_with(fast + "inputs:\n" + kRadar + kRadio);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].find("unstable: rho(A) = 1."), std::string::npos) << problems[0];
}

}  // namespace
}  // namespace platoon
