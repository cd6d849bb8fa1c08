#include "stochastic_platoon/statistics/agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace platoon {
namespace {

const double kNaN = std::numeric_limits<double>::quiet_NaN();

Moments measured(std::uint64_t count, double mean, double variance) {
  return {count, mean, variance * static_cast<double>(count - 1)};
}

TEST(Scores, AreDistancesInStandardErrors) {
  const Scores z = scores(measured(201, 1.3, 0.9), 1.0, 0.6);
  EXPECT_NEAR(z.mean, 0.3 / std::sqrt(0.6 / 201.0), 1e-12);
  EXPECT_NEAR(z.variance, 0.3 / (0.6 * std::sqrt(2.0 / 200.0)), 1e-12);
  EXPECT_LT(scores(measured(201, 0.7, 0.9), 1.0, 0.6).mean, 0.0);
  EXPECT_LT(scores(measured(201, 0.7, 0.5), 1.0, 0.6).variance, 0.0);
}

TEST(Scores, WhereNothingIsRandomAreZeroUpToRounding) {
  const Scores z = scores(measured(100, 5.0 + 1e-12, 1e-20), 5.0, 0.0);
  EXPECT_EQ(z.mean, 0.0);
  EXPECT_EQ(z.variance, 0.0);
}

TEST(Scores, WhereNothingIsRandomAreInfiniteForAnyDifference) {
  EXPECT_TRUE(std::isinf(scores(measured(100, 5.0001, 0.0), 5.0, 0.0).mean));
  EXPECT_TRUE(std::isinf(scores(measured(100, 5.0, 1e-4), 5.0, 0.0).variance));
}

TEST(Scores, OfSomethingUndefinedAreNeverPlausible) {
  EXPECT_FALSE(std::abs(scores(measured(100, kNaN, 1.0), 5.0, 1.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, kNaN, 0.0), 5.0, 0.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, 5.0, kNaN), 5.0, 1.0).variance) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, 5.0, 1.0), kNaN, 1.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, 5.0, 1.0), 5.0, kNaN).variance) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(1, 5.0, 0.0), 5.0, 1.0).variance) < 40.0);
}

TEST(Scores, OfAnEmptySampleAreNeverPlausible) {
  EXPECT_FALSE(std::abs(scores(Moments{}, 5.0, 1.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(Moments{}, 5.0, 1.0).variance) < 40.0);
}

TEST(Agreement, IsTheLargestModulusOverAllCells) {
  const Agreement found =
      agreement({measured(101, 0.1, 1.0), measured(101, -0.4, 1.3), measured(101, 0.2, 0.5)}, {0.0, 0.0, 0.0},
                {1.0, 1.0, 1.0});
  EXPECT_NEAR(found.max_abs_z_mean, 0.4 * std::sqrt(101.0), 1e-12);
  EXPECT_NEAR(found.max_abs_z_variance, 0.5 * std::sqrt(50.0), 1e-12);
}

TEST(Agreement, OfNoCellsIsZero) {
  EXPECT_EQ(agreement({}, {}, {}).max_abs_z_mean, 0.0);
  EXPECT_EQ(agreement({}, {}, {}).max_abs_z_variance, 0.0);
}

TEST(Agreement, DoesNotPassOverANaNWhereverItStands) {
  const Moments good = measured(101, 0.1, 1.1), bad = measured(101, kNaN, kNaN);
  const std::vector<double> zero(3, 0.0), one(3, 1.0);
  for (std::size_t place = 0; place < 3; ++place) {
    std::vector<Moments> cells(3, good);
    cells[place] = bad;
    const Agreement found = agreement(cells, zero, one);
    EXPECT_FALSE(found.max_abs_z_mean < 40.0) << "NaN in cell " << place;
    EXPECT_FALSE(found.max_abs_z_variance < 40.0) << "NaN in cell " << place;
  }
}

TEST(Agreement, RefusesSizesThatDiffer) {
  const Moments good = measured(101, 0.1, 1.1);
  EXPECT_THROW(agreement({good}, {0.0, 0.0}, {1.0}), std::invalid_argument);
  EXPECT_THROW(agreement({good}, {0.0}, {1.0, 1.0}), std::invalid_argument);
}

// The two-sided quantiles of the standard normal at 0.001, 0.0001 and 0.000001.
TEST(LargestPlausibleScore, IsTheNormalQuantileOfAThousandthSharedByAll) {
  EXPECT_NEAR(largest_plausible_score(1), 3.290526731491896, 1e-12);
  EXPECT_NEAR(largest_plausible_score(10), 3.890591886413120, 1e-12);
  EXPECT_NEAR(largest_plausible_score(1000), 4.891638475699428, 1e-11);
  EXPECT_EQ(largest_plausible_score(0), largest_plausible_score(1));
}

}  // namespace
}  // namespace platoon
