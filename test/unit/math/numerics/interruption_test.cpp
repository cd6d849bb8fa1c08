#include "stochastic_platoon/math/numerics/interruption.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "stochastic_platoon/math/string/error_moments.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

TEST(Interruption, EndsAComputationOfItsThreadOnly) {
  int checks = 0;
  const Interruptible interruptible([&checks] {
    if (++checks == 3) throw Interrupted();
  });
  EXPECT_THROW(error_moments(paper_platoon(), 20, 100), Interrupted);
  EXPECT_EQ(checks, 3);
  std::thread([] { EXPECT_NO_THROW(error_moments(paper_platoon(), 20, 100)); }).join();
  EXPECT_EQ(checks, 3);
}

TEST(Interruption, ByAnOuterObjectStaysInForce) {
  check_interruption();  // nothing outside
  int outer = 0, inner = 0;
  {
    const Interruptible first([&outer] { ++outer; });
    {
      const Interruptible second([&inner] { ++inner; });
      check_interruption();
    }
    check_interruption();
  }
  check_interruption();
  EXPECT_EQ(outer, 2);
  EXPECT_EQ(inner, 1);
}

}  // namespace
}  // namespace platoon
