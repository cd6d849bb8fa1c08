#include "stochastic_platoon/ros/orders/run_change.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/model/input.hpp"
#include "unit/paper_run.hpp"
#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

/// Changes of an endless run of three followers.
class RunChangeTest : public testing::Test {
protected:
  using Settings = std::map<std::string, std::string>;

  Configuration changed_by(const std::string& types, const Settings& given) const {
    Configuration present = paper_run("/nowhere/run");
    present.run.followers = 3;
    present.run.steps = 0;
    present.run.realizations = present.run.batch = 1;
    present.run.burn_in = 10;
    present.run.record_compression = "none";
    present.model = model_of(kModelText + types);
    return changed(present, given);
  }

  Problems rejection(const std::string& types, const Settings& given) const {
    return problems_of([&] { changed_by(types, given); });
  }
};

constexpr char kNobody[] = ": must be left out: no vehicle of the string takes it from the default vehicle";

TEST_F(RunChangeTest, ReachesTheVehiclesThatInheritIt) {
  const std::string types = "vehicle_types: {a: {time_headway: 5.0}, b: {noise_variance: 0.1}}\nstring: [a, b]\n";
  const Configuration next = changed_by(types, {{"headway", "4.0"}, {"noise_variance", "0.3"}, {"loss", "0.2"}});
  EXPECT_EQ(vehicle(next.model, 1).headway, 5.0);
  EXPECT_EQ(vehicle(next.model, 2).headway, 4.0);
  EXPECT_EQ(vehicle(next.model, 1).position().noise_variance, 0.3);
  EXPECT_EQ(vehicle(next.model, 2).position().noise_variance, 0.1);
  for (const std::size_t follower : {1, 2})
    EXPECT_EQ(vehicle(next.model, follower).position().link.loss->probability, 0.2);
  EXPECT_EQ(next.run.output, "/nowhere/run-run2");
  for (const auto& [key, value] : Settings{{"headway", "4.0"}, {"noise_variance", "0.3"}, {"loss", "0.2"}})
    EXPECT_TRUE(rejection("", {{key, value}}).empty()) << key;
}

TEST_F(RunChangeTest, IsRejectedIfNoVehicleTakesIt) {
  const std::string own =
      "vehicle_types: {a: {time_headway: 5.0, noise_variance: 0.1, "
      "channel: {loss: {probability: 0.05, on_loss: hold}}}}\n";
  const Settings all{{"headway", "4.0"}, {"noise_variance", "0.3"}, {"loss", "0.2"}};
  const Problems of_all{std::string("headway: 4.0") + kNobody, std::string("loss: 0.2") + kNobody,
                        std::string("noise_variance: 0.3") + kNobody};
  EXPECT_EQ(rejection(own + "string: [a]\n", all), of_all);
  EXPECT_EQ(rejection(own + "string: [a, a, a, default]\n", all), of_all) << "the fourth follower alone takes it";
  EXPECT_TRUE(rejection(own + "string: [a, a, default]\n", all).empty());
  EXPECT_EQ(rejection(own + "string: [a]\n", {{"headway", "3.2"}}), Problems{std::string("headway: 3.2") + kNobody})
      << "the present value";
  const std::string inputs = "vehicle_types: {a: {inputs: [{signal: position, noise_variance: 0.1}]}}\nstring: [a]\n";
  EXPECT_EQ(rejection(inputs, {{"loss", "0.2"}}), Problems{std::string("loss: 0.2") + kNobody});
  EXPECT_EQ(rejection(inputs, {{"noise_variance", "0.2"}}), Problems{std::string("noise_variance: 0.2") + kNobody});
  EXPECT_TRUE(rejection(inputs, {{"headway", "4.0"}}).empty());
}

}  // namespace
}  // namespace platoon
