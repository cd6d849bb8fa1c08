#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stochastic_platoon/external_vehicle.hpp>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "unit/messages.hpp"
#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

VehicleSettings settings_in(const PlatoonModel& model, std::size_t index) {
  return vehicle_settings_in(nlohmann::json{{"model", to_json(model)}}.dump(), index);
}

// Expects the model's own values for followers 1 to 6.
void expect_those_of(const std::string& text) {
  SCOPED_TRACE(text);
  const PlatoonModel model = model_of(text);
  for (std::size_t i = 1; i <= 6; ++i) {
    SCOPED_TRACE(i);
    const VehicleModel& own = vehicle(model, i);
    const VehicleSettings settings = settings_in(model, i);
    EXPECT_EQ(settings.headway, own.headway);
    EXPECT_EQ(settings.standstill_distance, own.standstill_distance);
    EXPECT_EQ(settings.sample_period, model.sample_period);
    EXPECT_NEAR(settings.initial_position, start_place(model, i), 1e-9);
    EXPECT_NEAR(settings.initial_speed, start_slope(model) / model.sample_period, 1e-12);
    ASSERT_EQ(settings.inputs.size(), own.inputs.size());
    for (std::size_t n = 0; n < own.inputs.size(); ++n) {
      EXPECT_EQ(settings.inputs[n].signal, name_of(own.inputs[n].signal));
      EXPECT_EQ(settings.inputs[n].source, source_of(own.inputs[n], i));
      EXPECT_EQ(settings.inputs[n].gain, own.inputs[n].gain);
    }
  }
}

const std::string kCommonChannel = "noise_variance: 0.01\nchannel: {delay: 3}\n";
const std::string kTwoAhead =
    "inputs: [{signal: position, weight: 0.6, noise_variance: 0.02, channel: {delay: 2}},"
    " {signal: position, from: 2, weight: 0.4, noise_variance: 0.05}]";

// What a type may set otherwise than the default vehicle.
const std::vector<std::string> kTrucks{
    "standstill_distance: 12.0",
    "spacing: constant, standstill_distance: 12.0",
    "spacing: headway, time_headway: 250",
    "channel: {delay: 1}",
    "inputs: [{signal: position, noise_variance: 0.1}]",
    "inputs: [{signal: position, noise_variance: 0.1}], channel: {delay: 5}",
    "inputs: [{signal: position, noise_variance: 0.1, channel: {delay: 7}}]",
    kTwoAhead,
    "inputs: [{signal: position, noise_variance: 0.1}, {signal: speed, from: leader, gain: 0.1, noise_variance: 0.1}]"};

// Every type in a string with each of three default vehicles.
std::vector<std::string> texts_with(const std::string& start) {
  const std::string constant = replaced(kCarText, "time_headway_seconds: 3.5", "spacing: constant");
  std::vector<std::string> texts;
  for (const std::string& car : {kCarText + kCommonChannel, kCarText + kTwoAhead + "\n", constant + kCommonChannel}) {
    for (const std::string& truck : kTrucks) {
      texts.push_back("start: " + start + "\nallow_unstable: true\n" + car + "vehicle_types: {truck: {" + truck +
                      "}}\nstring: [default, truck]\n");
    }
  }
  return texts;
}

TEST(VehicleSettings, AreTheModelsForEveryKindOfVehicleType) {
  for (const char* start : {"steady", "rest"}) {
    for (const std::string& text : texts_with(start)) expect_those_of(text);
  }
}

TEST(VehicleSettings, OfATypeWithConstantSpacingHaveNoHeadway) {
  const PlatoonModel model =
      model_of(kCarText +
               "noise_variance: 0.01\nstart: steady\n"
               "vehicle_types: {truck: {spacing: constant, standstill_distance: 12.0}}\nstring: [default, truck]\n");
  EXPECT_EQ(settings_in(model, 2).headway, 0.0);
  EXPECT_NEAR(settings_in(model, 2).initial_position, -87.2, 1e-9);
  EXPECT_NEAR(settings_in(model, 4).initial_position, -174.2, 1e-9);
}

TEST(VehicleSettings, RejectTheLeaderAndATextThatIsNoConfiguration) {
  EXPECT_EQ(message_of<std::invalid_argument>([] { vehicle_settings_in("{}", 0); }),
            "index: 0: must be the number of a follower, 1 or more");
  EXPECT_TRUE(begins_with(message_of<std::runtime_error>([] { vehicle_settings_in("{}", 1); }),
                          "is no configuration of a platoon: "));
}

}  // namespace
}  // namespace platoon
