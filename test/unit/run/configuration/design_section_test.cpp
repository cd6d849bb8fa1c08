#include "stochastic_platoon/run/configuration/design_section.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "unit/run/configuration/model_text.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

const std::string kCar = kCarText + "noise_variance: 0.01\n";

std::string car_with(const std::string& part, const std::string& other) {
  return replaced(kCar, part, other);
}

TEST(DesignSection, DescribesACarByLagDelayAndGains) {
  const PlatoonModel model = model_of(kCar);
  EXPECT_EQ(model.default_vehicle().headway, 350.0);
  const LoopParts& parts = *model.default_vehicle().loop.parts;
  EXPECT_EQ(parts.delay, 20u);
  EXPECT_TRUE(parts.headway_filter);
  EXPECT_EQ(parts.plant.order(), 3u);
  EXPECT_EQ(parts.controller.order(), 1u);
  const PlatoonModel continuous =
      model_of(car_with("{actuator_lag: 0.1, input_delay: 0.2}",
                        "{continuous: {numerator: [2], denominator: [0.2, 2, 0, 0], input_delay: 0.2}}"));
  EXPECT_EQ(continuous.default_vehicle().loop.parts->plant.b[1], parts.plant.b[1]);
  const PlatoonModel sampled = model_of(
      car_with("{actuator_lag: 0.1, input_delay: 0.2}", "{numerator: [5.0e-5, 5.0e-5], denominator: [1, -2, 1]}"));
  EXPECT_TRUE(sampled.default_vehicle().loop.parts) << "gains alone, too";
}

TEST(DesignSection, IsReadBackToTheBit) {
  const std::string types =
      "vehicle_types:\n"
      "  truck: {plant: {actuator_lag: 0.4, input_delay: 0.123}}\n"
      "  bold: {time_headway_seconds: 3.21, controller: {kp: 0.3, kd: 0.8, ki: 0.001, headway_filter: true}}\n"
      "string: [default, truck, bold]\n";
  const PlatoonModel model = model_of(kCar + types), again = model_of(to_json(model).dump());
  ASSERT_EQ(again.types.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const VehicleModel &one = model.types[i].vehicle, &other = again.types[i].vehicle;
    EXPECT_EQ(one.headway, other.headway);
    EXPECT_EQ(one.loop.parts->plant.a, other.loop.parts->plant.a);
    EXPECT_EQ(one.loop.parts->plant.b, other.loop.parts->plant.b);
    EXPECT_EQ(one.loop.parts->controller.b, other.loop.parts->controller.b);
    EXPECT_EQ(one.loop.realization.a(), other.loop.realization.a());
  }
  EXPECT_EQ(to_json(again), to_json(model));
  EXPECT_EQ(model.types[2].vehicle.headway, 350.0) << "inherited by the truck";
}

// A headway of the command line replaces that of the file, in either unit.
TEST(DesignSection, IsOverriddenByAHeadwayInEitherUnit) {
  const TemporaryFolder folder;
  const std::string file = folder.file("car.yaml", kCar);
  const auto headway_with = [&file](const std::string& setting, const std::string& value) {
    return parse_configuration(configuration_document({{"model", file}, {"steps", "10"}, {setting, value}}))
        .model.default_vehicle()
        .headway;
  };
  EXPECT_EQ(headway_with("headway", "400"), 400.0);
  EXPECT_EQ(headway_with("headway_seconds", "4.5"), 450.0);
  const Problems both = problems_of([&file] {
    configuration_document({{"model", file}, {"headway", "400"}, {"headway_seconds", "4"}});
  });
  EXPECT_EQ(both, Problems{"headway_seconds: given: must be absent beside headway, which sets it too"});
}

}  // namespace
}  // namespace platoon
