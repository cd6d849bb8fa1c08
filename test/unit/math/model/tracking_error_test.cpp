#include "stochastic_platoon/math/model/tracking_error.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace platoon {
namespace {

TEST(TrackingError, IsTheDistanceLessStandstillDistanceLessHeadwayTimesDisplacement) {
  const TrackingError zeta{3.0, 2.0};
  EXPECT_EQ(zeta(30.0, 20.0, 18.5), 30.0 - 20.0 - 2.0 - 3.0 * 1.5);
}

TEST(TrackingError, VanishesInFormation) {
  const TrackingError zeta{2.5, 7.0};
  EXPECT_EQ(zeta(-7.0, -14.0, -14.0), 0.0);
  const double displacement = 2.0;  // [m] per step, driven by both
  EXPECT_EQ(zeta(100.0, 100.0 - 7.0 - 2.5 * displacement, 100.0 - 7.0 - 3.5 * displacement), 0.0);
}

TEST(TrackingError, IsTheSameOneByOneAndByTheBatch) {
  const TrackingError zeta{3.2, 0.7};
  const std::vector<double> predecessor = {1.1, 2.3, -3.7}, own = {0.3, 0.1, 9.2}, before = {0.2, -0.6, 8.8};
  std::vector<double> errors(3);
  zeta(predecessor.data(), own.data(), before.data(), 3, errors.data());
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(errors[r], zeta(predecessor[r], own[r], before[r]));
}

}  // namespace
}  // namespace platoon
