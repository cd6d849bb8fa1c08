#include "stochastic_platoon/math/string/error_moments.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

// y_0(-1) .. y_0(steps - 1) of the model's own leader.
std::vector<double> own_leader(const PlatoonModel& model, std::int64_t steps) {
  LeaderVehicle leader(model);
  std::vector<double> positions{leader.start()};
  for (std::int64_t k = 0; k < steps; ++k) positions.push_back(leader.step());
  return positions;
}

TEST(RecordedLeader, OfTheModelHasTheMeansOfItsTheory) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 5.0;
  model.default_vehicle().initial_position = {0.7, 0.4};
  const SignalMoments expected = error_moments(model, 6, 80);
  model.recorded_leader = own_leader(model, 80);
  const SignalMoments found = error_moments(model, 6, 80);
  ASSERT_EQ(found.mean.size(), expected.mean.size());
  for (std::size_t c = 0; c < found.mean.size(); ++c) {
    EXPECT_NEAR(found.mean[c], expected.mean[c], 1e-11) << c;  // the recorded positions, up to 160 m, are rounded
    EXPECT_NEAR(found.variance[c], expected.variance[c], 1e-12 * expected.variance[c]) << c;
  }
}

TEST(RecordedLeader, ReplacesTheLoopOfTheLeader) {
  PlatoonModel model = paper_platoon();
  model.recorded_leader = {0.5, 1.5, -2.0};
  EXPECT_EQ(own_leader(model, 2), model.recorded_leader);
  LeaderVehicle leader(model);
  leader.start();
  leader.step();
  EXPECT_EQ(leader.start(), 0.5);
  leader.step();
  leader.step();
  EXPECT_THROW(leader.step(), std::out_of_range);
}

TEST(RecordedLeader, MustHaveAPositionForEveryStep) {
  PlatoonModel model = paper_platoon();
  model.recorded_leader = own_leader(model, 10);
  EXPECT_EQ(error_moments(model, 2, 10).mean.size(), 20u);
  EXPECT_THROW(error_moments(model, 2, 11), std::invalid_argument);
  EXPECT_THROW(error_moments(model, 0, 10), std::invalid_argument);
  EXPECT_THROW(error_moments(model, 2, 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
