#include "stochastic_platoon/math/response/attenuation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/polynomial.hpp"

namespace platoon {
namespace {

using Complex = std::complex<long double>;

/// s = z - 1 of places z.
std::vector<Complex> offsets(const std::vector<Complex>& places) {
  std::vector<Complex> s;
  for (const Complex& z : places) s.push_back(z - 1.0L);
  return s;
}

/// -ln |T(e^{jw})|^2 of one factor by its definition.
long double by_definition(const GainFactor& factor, long double w) {
  const Complex z = std::polar(1.0L, w);
  long double sum = 0.0L;
  for (const Complex& s : factor.poles) sum += 2.0L * std::log(std::abs((z - 1.0L - s) / s));
  for (const Complex& s : factor.zeros) sum -= 2.0L * std::log(std::abs((z - 1.0L - s) / s));
  return factor.count * sum;
}

std::vector<GainFactor> random_factors(std::mt19937& random) {
  std::uniform_real_distribution<double> radius(0.0, 0.999), angle(0.0, 3.1), real(-0.99, 0.99), zero(-2.0, 2.0);
  std::vector<GainFactor> factors;
  for (int i = 0; i < 3; ++i) {
    std::vector<Complex> poles, zeros;
    for (int k = 0; k < 4; ++k) {
      const Complex pole =
          std::polar(static_cast<long double>(radius(random)), static_cast<long double>(angle(random)));
      poles.insert(poles.end(), {pole, std::conj(pole)});
    }
    for (int k = 0; k < 2; ++k) {
      poles.push_back(real(random));
      zeros.push_back(zero(random));
    }
    factors.push_back({offsets(poles), offsets(zeros), 1.0L + i});
  }
  return factors;
}

long double quotient(const std::vector<GainFactor>& factors, long double w, int order) {
  long double sum = 0.0L;
  for (const GainFactor& factor : factors) sum += by_definition(factor, w);
  return sum / std::pow(std::min(1.0L - std::cos(w), 1.0L), static_cast<long double>(order));
}

TEST(Attenuation, FollowsItsDefinitionWithItsDerivatives) {
  std::mt19937 random(3);
  for (int model = 0; model < 20; ++model) {
    const std::vector<GainFactor> factors = random_factors(random);
    const Attenuation attenuation(factors);
    for (const long double w : {1e-4L, 0.01L, 0.3L, 1.0L, 2.0L, 3.1L}) {
      const long double half = std::sin(w / 2.0L), t = 2.0L * half * half;
      const Attenuation::Value at = attenuation.at(t);
      EXPECT_NEAR(static_cast<double>(at.value), static_cast<double>(quotient(factors, w, 0)), 1e-13);
      const long double step = 1e-7L * t;
      const Attenuation::Value ahead = attenuation.at(t + step), behind = attenuation.at(t - step);
      EXPECT_NEAR(static_cast<double>((ahead.value - behind.value) / (2.0L * step * at.slope)), 1.0, 1e-6) << w;
      EXPECT_NEAR(static_cast<double>((ahead.slope - behind.slope) / (2.0L * step * at.curvature)), 1.0, 1e-4) << w;
    }
  }
}

TEST(Attenuation, HasItsLeastValueBelowAGrid) {
  std::mt19937 random(4);
  for (int model = 0; model < 100; ++model) {
    const std::vector<GainFactor> factors = random_factors(random);
    const Attenuation attenuation(factors);
    for (const int order : {0, 1}) {
      const Attenuation::Minimum least = attenuation.least(order);
      const long double w = 2.0L * std::asin(std::sqrt(least.t / 2.0L));
      if (least.t > 1e-9L) {
        EXPECT_NEAR(static_cast<double>(quotient(factors, w, order) / least.value), 1.0, 1e-9) << model;
      }
      for (int i = 1; i <= 2000; ++i) {
        const long double value = quotient(factors, 3.14159265358979L * i / 2000, order);
        EXPECT_GE(static_cast<double>(value - least.value), -1e-10 * std::abs(static_cast<double>(least.value)))
            << model << " at " << i;
      }
    }
  }
}

// |T|^2 = 1 / (1 + c t ((t - t_0)^2 + gap)): the attenuation comes down to c t_0 gap in a dip of width sqrt(gap).
TEST(Attenuation, FindsADipNarrowerThanAnyGrid) {
  for (const double t0 : {0.01, 0.3, 1.0, 1.7}) {
    const double gap = 1e-8 * t0 * t0, c = 1e4 / (t0 * t0 * t0);
    Polynomial p(4);
    p << c, -2.0 * c * t0, c * (t0 * t0 + gap), 1.0;
    GainFactor factor;
    for (const Complex t : roots(p))
      factor.poles.push_back(-t + std::sqrt(t * t - 2.0L * t));  // t = -s^2 / (2 (1 + s))
    const Attenuation::Minimum least = Attenuation({factor}).least(1);
    EXPECT_NEAR(static_cast<double>(least.t) / t0, 1.0, 1e-6) << t0;
    EXPECT_NEAR(static_cast<double>(least.value) * std::min(t0, 1.0) / 1e-4, 1.0, 1e-3) << t0;
  }
}

TEST(Attenuation, ReportsASearchThatEndsEarly) {
  std::mt19937 random(4);
  const Attenuation attenuation(random_factors(random));
  EXPECT_TRUE(attenuation.least(1).is_global);
  EXPECT_FALSE(attenuation.least(1, 1e-12L, 2).is_global);
}

TEST(Attenuation, CountsAFactorByItsMultiplicity) {
  GainFactor pole{offsets({0.5L}), {}, 1.0L};
  const long double once = Attenuation({pole}).at(1.3L).value;
  pole.count = 1000.0L;
  EXPECT_NEAR(static_cast<double>(Attenuation({pole}).at(1.3L).value / once), 1000.0, 1e-9);
}

TEST(Attenuation, HasTheCoefficientsOfTheLogarithm) {
  // One pole p: a(t) = ln (1 + 2 p t / (1-p)^2) = 4 t - 8 t^2 + ... for p = 1/2
  const Attenuation attenuation({{offsets({0.5L}), {}, 1.0L}});
  EXPECT_DOUBLE_EQ(static_cast<double>(attenuation.coefficient(1)), 4.0);
  EXPECT_DOUBLE_EQ(static_cast<double>(attenuation.coefficient(2)), -8.0);
}

TEST(Attenuation, IsInfiniteAtAZeroOnTheCircle) {
  const Attenuation attenuation({{offsets({0.5L}), offsets({-1.0L}), 1.0L}});
  EXPECT_TRUE(std::isinf(attenuation.at(2.0L).value));
  // ln(1 + 4 t) - ln(1 - t / 2), over min(t, 1)
  EXPECT_NEAR(static_cast<double>(attenuation.least(1).t), 1.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(attenuation.least(1).value), std::log(10.0), 1e-12);
}

TEST(Attenuation, OfPureDelaysIsZero) {
  EXPECT_TRUE(Attenuation({{offsets({0.0L, 0.0L}), {}, 3.0L}}).is_zero());
}

TEST(Attenuation, RejectsAPoleAtOne) {
  EXPECT_THROW(Attenuation({{offsets({1.0L}), {}, 1.0L}}), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
