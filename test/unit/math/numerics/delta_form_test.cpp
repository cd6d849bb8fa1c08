#include "stochastic_platoon/math/numerics/delta_form.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace platoon {
namespace {

std::vector<double> moduli(const DeltaPolynomial& p) {
  std::vector<double> sizes;
  for (const std::complex<long double>& s : zeros(p)) sizes.push_back(static_cast<double>(std::abs(s)));
  std::sort(sizes.begin(), sizes.end());
  return sizes;
}

// s^3 + a s^2 + b s + c with zeros 1, 2 and 3 times x.
TEST(DeltaForm, HasZerosOfAnySize) {
  for (const int power : {-150, -60, -12, 0, 12, 60, 150, 300}) {
    const long double x = std::pow(10.0L, power);
    const std::vector<double> found = moduli({-6.0L * x * x * x, 11.0L * x * x, -6.0L * x, 1.0L});
    ASSERT_EQ(found.size(), 3u);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(found[static_cast<std::size_t>(i)] / std::pow(10.0, power), i + 1, 1e-14) << power;
    }
  }
}

TEST(DeltaForm, HasZerosCloseToEachOther) {
  const long double apart = 1e-8L;
  const std::vector<double> found = moduli({0.5L * (0.5L + apart), -1.0L - apart, 1.0L});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0], 0.5, 1e-10);
  EXPECT_NEAR(found[1] - found[0], 1e-8, 1e-10);
}

// z^2 + g: |z| = sqrt(g).
TEST(DeltaForm, HasTheSpectralRadiusOfLargeCoefficients) {
  for (const double power : {4.0, 24.0, 60.0, 154.0, 300.0}) {
    const double g = std::pow(10.0, power);
    EXPECT_NEAR(spectral_radius(delta_form(Eigen::Vector3d(1.0, 0.0, g))) / std::sqrt(g), 1.0, 1e-12) << power;
  }
}

}  // namespace
}  // namespace platoon
