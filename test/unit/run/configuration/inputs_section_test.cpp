#include "stochastic_platoon/run/configuration/inputs_section.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

const std::string kRadar = "  - {signal: position, from: predecessor, noise_variance: 0.01, channel: {delay: 1}}\n";
const std::string kRadio =
    "  - {signal: input, from: predecessor, gain: 0.9, noise_variance: 0.02, channel: {delay: 2, loss: {probability: 0.1, on_loss: zero}}}\n";

const std::string kInputs = "inputs:\n" + kRadar + kRadio;

TEST(InputsSection, DescribesRadarAndRadio) {
  const PlatoonModel model = model_of(kCarText + kInputs);
  const VehicleModel& vehicle = model.default_vehicle();
  EXPECT_EQ(vehicle.position().noise_variance, 0.01);
  EXPECT_EQ(vehicle.position().link.delay, 1);
  ASSERT_TRUE(vehicle.radio());
  EXPECT_EQ(vehicle.radio()->gain, 0.9);
  EXPECT_EQ(vehicle.radio()->noise_variance, 0.02);
  EXPECT_EQ(vehicle.radio()->link.delay, 2);
  EXPECT_TRUE(vehicle.radio()->link.loss->predictor.empty());
  EXPECT_TRUE(vehicle.loop.parts);
  EXPECT_TRUE(sends_input(model, 0, 3));
  EXPECT_TRUE(sends_input(model, 2, 3));
  EXPECT_FALSE(sends_input(model, 3, 3)) << "nobody hears the last vehicle";
}

TEST(InputsSection, MayLeaveNoiseAndChannelOfThePositionToTheVehicle) {
  const PlatoonModel model =
      model_of(kCarText + "noise_variance: 0.3\nchannel: {delay: 4}\ninputs:\n  - {signal: position}\n" + kRadio);
  EXPECT_EQ(model.default_vehicle().position().noise_variance, 0.3);
  EXPECT_EQ(model.default_vehicle().position().link.delay, 4);
}

TEST(InputsSection, IsReadBackToTheBit) {
  const std::string types =
      "vehicle_types:\n"
      "  human: {time_headway: 150.0, inputs: [{signal: position}]}\n"
      "  other: {plant: {numerator: [5.0e-5, 5.0e-5], denominator: [1, -2, 1]}}\n"
      "string: [default, human, other]\n";
  const PlatoonModel model = model_of(kCarText + kInputs + types);
  EXPECT_FALSE(model.types[1].vehicle.radio());
  EXPECT_TRUE(model.types[2].vehicle.radio());
  EXPECT_TRUE(model.types[2].vehicle.loop.parts) << "G(z) and a radio: its input is known part by part";
  const PlatoonModel again = model_of(to_json(model).dump());
  EXPECT_EQ(to_json(again), to_json(model));
  for (std::size_t type = 0; type < model.types.size(); ++type) {
    EXPECT_EQ(again.types[type].vehicle.inputs, model.types[type].vehicle.inputs);
    EXPECT_EQ(again.types[type].vehicle.loop.realization.a(), model.types[type].vehicle.loop.realization.a());
  }
  EXPECT_TRUE(with_loss(again, 0.2).types[2].vehicle.radio()->link.loss->probability == 0.2) << "inherited";
}

TEST(InputsSection, OfATypeReplaceTheChannelsOfTheDefaultVehicle) {
  const std::string lossy = kCarText + "noise_variance: 0.3\nchannel: {delay: 4, loss: {probability: 0.2}}\n";
  const PlatoonModel model =
      model_of(lossy +
               "vehicle_types:\n"
               "  bare: {inputs: [{signal: position}]}\n"
               "  inner: {inputs: [{signal: position, noise_variance: 0.1, channel: {loss: {probability: 0.1}}}]}\n"
               "  outer: {inputs: [{signal: position}], channel: {delay: 1}}\n"
               "  without: {time_headway: 360.0}\n"
               "string: [bare, inner, outer, without]\n");
  for (const PlatoonModel& of : {model, model_of(to_json(model).dump())}) {
    const auto vehicle = [&of](std::size_t type) { return of.types.at(type).vehicle; };
    EXPECT_EQ(of.types[1].name, "bare");
    EXPECT_TRUE(vehicle(1).position().link == LinkModel());
    EXPECT_EQ(vehicle(1).position().noise_variance, 0.3);
    EXPECT_EQ(vehicle(2).position().link.delay, 0);
    EXPECT_EQ(vehicle(2).position().link.loss->probability, 0.1);
    EXPECT_EQ(vehicle(2).position().noise_variance, 0.1);
    EXPECT_EQ(vehicle(3).position().link.delay, 1);
    EXPECT_FALSE(vehicle(3).position().link.loss);
    EXPECT_TRUE(vehicle(4).position().link == of.default_vehicle().position().link);
    EXPECT_FALSE(with_loss(of, 0.4).types[1].vehicle.position().link.loss) << "not inherited";
    EXPECT_EQ(with_loss(of, 0.4).types[4].vehicle.position().link.loss->probability, 0.4);
  }
}

TEST(InputsSection, IsOverriddenInTheInputOfTheSetting) {
  const auto overridden = [](const std::string& model, const std::string& name, const std::string& value) {
    YAML::Node document;
    document["model"] = YAML::Load(model);
    override_value(document, name, YAML::Node(value));
    return parse_model(document["model"]).default_vehicle();
  };
  const std::string listed = kCarText + kInputs,
                    two = listed +
                          "  - {signal: position, from: 2, noise_variance: 0.05, weight: 0, channel: {delay: 1}}\n",
                    apart = kCarText + "noise_variance: 0.3\ninputs:\n  - {signal: position}\n" + kRadio;
  for (const std::string& model : {listed, apart, two}) {
    EXPECT_EQ(overridden(model, "noise_variance", "0.7").position().noise_variance, 0.7);
    EXPECT_EQ(overridden(model, "noise_variance", "0.7").inputs[1].noise_variance, 0.02);
    EXPECT_EQ(overridden(model, "delay", "5").position().link.delay, 5);
    const VehicleModel lossy = overridden(model, "loss", "0.4");
    EXPECT_EQ(lossy.inputs[1].link.loss->probability, 0.4);
    EXPECT_FALSE(lossy.position().link.loss);
  }
  EXPECT_EQ(overridden(kCarText + "noise_variance: 0.3\n", "loss", "0.4").position().link.loss->probability, 0.4);
}

TEST(InputsSection, LosesByTheSettingWhatCriticalValuesVary) {
  const std::string
      car = kCarText + "inputs:\n",
      near = "  - {signal: position, noise_variance: 0.01, weight: 0.6, channel: {loss: {probability: 0.2}}}\n",
      far = "  - {signal: position, from: 2, noise_variance: 0.01, weight: 0.4}\n",
      alone = "  - {signal: position, noise_variance: 0.01, channel: {loss: {probability: 0.2}}}\n",
      speed =
          "  - {signal: speed, from: leader, gain: 0.1, noise_variance: 0.1, channel: {packet: of leader, loss: "
          "{probability: 0.1, mean_burst: 2}}}\n",
      acceleration =
          "  - {signal: acceleration, from: leader, gain: 0.1, noise_variance: 0.1, channel: {packet: of leader}}\n",
      quiet = "  - {signal: acceleration, from: 2, gain: 0.1, noise_variance: 0.1}\n",
      types =
          "vehicle_types: {slow: {time_headway: 400}, deaf: {inputs: [{signal: position, noise_variance: 0.02}]}}\n"
          "string: [default, slow, deaf]\n";
  const auto lossy = [](const std::string& text) {
    YAML::Node document;
    document["model"] = YAML::Load(text);
    override_value(document, "loss", YAML::Node("0.4"));
    return to_json(parse_model(document["model"]));
  };
  const std::pair<std::string, std::size_t> cases[] = {
      {near + far, 0},
      {far + near, 1},
      {alone + speed + acceleration, 1},
      {acceleration + alone + replaced(speed, "loss: {probability: 0.1, mean_burst: 2}", "delay: 1"), 0},
      {alone + speed + acceleration + quiet, 1},
      {alone + replaced(speed, "probability: 0.1, mean_burst: 2", "markov: {transition: [[1]], probability: [0.1]}"),
       1},
      {quiet + alone, 0},
      {alone + kRadio + quiet, 1}};
  for (const auto& [inputs, varied] : cases) {
    const PlatoonModel model = model_of(car + inputs + types);
    EXPECT_EQ(model.default_vehicle().varied_inputs().front(), varied) << inputs;
    const std::string copy = to_json(model).dump();
    const nlohmann::json changed = lossy(car + inputs + types);
    EXPECT_EQ(lossy(copy), changed) << inputs;
    EXPECT_EQ(changed["inputs"][varied]["channel"]["loss"]["probability"], 0.4) << inputs;
    if (model.default_vehicle().varied_link().loss && !model.default_vehicle().varied_link().loss->mean_burst) {
      EXPECT_EQ(to_json(with_loss(model, 0.4)), changed) << inputs;
    }
    EXPECT_FALSE(changed["vehicle_types"]["slow"].contains("inputs")) << "inherited";
    EXPECT_EQ(changed["vehicle_types"]["deaf"]["inputs"], to_json(model)["vehicle_types"]["deaf"]["inputs"]);
  }
}

TEST(InputsSection, RejectsAPacketThatCountsALostPositionAs0) {
  const auto packet = [](const std::string& input) {
    return kCarText +
           "inputs:\n  - {signal: speed, gain: 0.3, noise_variance: 0, channel: {packet: v2v, loss: {probability: 0.1, "
           "on_loss: zero}}}\n  - {signal: position, noise_variance: 0, channel: {" +
           input;
  };
  EXPECT_TRUE(is_problem(problems_of([&] { model_of(packet("packet: v2v}}\n")); }),
                         "inputs: on_loss zero of packet v2v, which holds a position: must be hold, extrapolate or"));
  const std::string apart =
      packet("delay: 1}}\n  - {signal: acceleration, gain: 0.3, noise_variance: 0, channel: {packet: v2v}}\n");
  EXPECT_TRUE(model_of(apart).default_vehicle().inputs[2].link.loss->predictor.empty());
}

TEST(InputsSection, AcceptsARecordedLeader) {
  const std::string recorded = replaced(kCarText, "{speed: [{from_step: 0, value: 20.0}]}", "{positions: [0, 0, 0]}");
  EXPECT_EQ(problems_in(recorded + kInputs), Problems{});
}

}  // namespace
}  // namespace platoon
