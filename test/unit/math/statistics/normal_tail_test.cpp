#include "stochastic_platoon/math/statistics/normal_tail.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace platoon {
namespace {

TEST(NormalTail, IsTheKnownValueAlsoBelowTheRangeOfDouble) {
  EXPECT_NEAR(log_normal_tail(0.0), std::log(0.5), 1e-15);
  EXPECT_NEAR(log_normal_tail(1.0), std::log(0.15865525393145705), 1e-15);
  EXPECT_NEAR(log_normal_tail(-3.0), -0.0013508099647481938, 1e-17);
  // ln Phi(-50) and ln Phi(-1000) in 50 digits
  EXPECT_NEAR(log_normal_tail(50.0), -1254.8313611394199, 1e-12);
  EXPECT_NEAR(log_normal_tail(1000.0), -500007.8266948122, 1e-9);
  EXPECT_NEAR(log_normal_tail(29.999999) - log_normal_tail(30.000001), 2e-6 * (30.0 + 1.0 / 30.0), 1e-9);
}

TEST(NormalTail, HasAnInverse) {
  for (const double a : {0.01, 0.5, 3.0, 12.0, 29.9, 30.1, 37.0, 200.0, 1e5})
    EXPECT_NEAR(normal_tail_quantile(log_normal_tail(a)), a, 1e-12 * (1.0 + 1.0 / a)) << a;
}

}  // namespace
}  // namespace platoon
