#include "stochastic_platoon/math/numerics/quadrature.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace platoon {
namespace {

template <typename Function>
double integrate(const Quadrature& rule, const Function& f) {
  double sum = 0.0;
  for (std::size_t k = 0; k < rule.node.size(); ++k) sum += rule.weight[k] * f(static_cast<double>(rule.node[k]));
  return sum;
}

TEST(Quadrature, OfGaussAndLegendreIsExactBelowTwiceItsCount) {
  for (int power = 0; power < 2 * kGaussNodes; ++power) {
    const double exact = power % 2 == 0 ? 2.0 / (power + 1) : 0.0;
    EXPECT_NEAR(integrate(gauss_legendre(), [&](double x) { return std::pow(x, power); }), exact, 1e-14) << power;
  }
}

TEST(Quadrature, HasTheMeanOverTheCircleForPolesCloseToIt) {
  // The mean of 1 / |z - a|^2 is 1 / (1 - |a|^2) for |a| < 1, and of its real pairs accordingly.
  for (const double radius : {0.0, 0.5, 0.9, 0.999, 0.999999}) {
    for (const double angle : {0.0, 0.4, 2.0, 3.141592653589793}) {
      const std::complex<double> a = std::polar(radius, angle);
      const auto even = [&](double w) {
        const std::complex<double> z = std::polar(1.0, w);
        return 0.5 / std::norm(z - a) + 0.5 / std::norm(z - std::conj(a));
      };
      std::vector<std::complex<double>> singular;
      if (radius > 0.0) singular.push_back(std::complex<double>(0.0, -1.0) * std::log(a));
      const double exact = 1.0 / ((1.0 - radius) * (1.0 + radius));
      const double tolerance = 1e-13 + 1e-15 / (1.0 - radius);  // of z itself
      EXPECT_NEAR(integrate(half_circle_quadrature(singular, {}), even), exact, tolerance * exact) << a;
    }
  }
}

TEST(Quadrature, ResolvesFunctionsThatAreNarrowAtAPeak) {
  const double peak = 1.3;
  for (const double width : {1e-2, 1e-4, 1e-6}) {
    const auto bump = [&](double w) { return std::exp(-std::pow((w - peak) / width, 2)); };
    const double exact = width / std::sqrt(3.141592653589793);  // its integral, divided by pi
    EXPECT_NEAR(integrate(half_circle_quadrature({}, {peak}), bump), exact, 1e-9 * exact) << width;
  }
}

TEST(Quadrature, CutsEachPanelIntoItsNumberOfPieces) {
  const Quadrature rule = half_circle_quadrature({{1.0, 0.1}}, {}), twice = half_circle_quadrature({{1.0, 0.1}}, {}, 1);
  std::vector<int> pieces(rule.middle.size(), 2);
  const Quadrature same = with_panels_cut(rule, pieces);
  ASSERT_EQ(same.node.size(), twice.node.size());
  for (std::size_t k = 0; k < same.node.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(same.node[k]), static_cast<double>(twice.node[k]), 1e-15);
    EXPECT_NEAR(same.weight[k], twice.weight[k], 1e-15);
  }
  pieces.assign(pieces.size(), 1);
  pieces.back() = 3;
  EXPECT_EQ(with_panels_cut(rule, pieces).middle.size(), rule.middle.size() + 2);
  EXPECT_NEAR(integrate(with_panels_cut(rule, pieces), [](double w) { return std::cos(w / 2.0); }), 0.6366197723675814,
              1e-15);
}

// The coefficient of P_l in x^l is 2^l l!^2 / (2 l)!.
TEST(Quadrature, KnowsThePanelsOnWhichItsNodesDoNotInterpolate) {
  const Quadrature rule = half_circle_quadrature({{1.0, 0.1}}, {});
  const std::size_t chosen = 3;
  for (const int power : {13, 14, 15}) {
    std::vector<double> values(rule.node.size(), 1.0);
    for (std::size_t k = 0; k < kGaussNodes; ++k)
      values[chosen * kGaussNodes + k] = std::pow(static_cast<double>(gauss_legendre().node[k]), power);
    const std::vector<double> errors = interpolation_errors(rule, values.data());
    ASSERT_EQ(errors.size(), rule.middle.size());
    double leading = 1.0;
    for (int l = 1; l <= power; ++l) leading *= l / (2.0 * l - 1.0);
    for (std::size_t panel = 0; panel < errors.size(); ++panel)
      EXPECT_NEAR(errors[panel], panel == chosen && power > 13 ? leading : 0.0, 1e-14) << panel << " " << power;
  }
}

TEST(Quadrature, StaysConsistentUnderRefinement) {
  const auto one = [](double) { return 1.0; };
  const Quadrature coarse = half_circle_quadrature({{1.0, 0.1}}, {0.0, 2.0});
  const Quadrature fine = half_circle_quadrature({{1.0, 0.1}}, {0.0, 2.0}, 2);
  EXPECT_EQ(fine.node.size(), 4 * coarse.node.size());
  EXPECT_NEAR(integrate(coarse, one), 1.0, 1e-14);
  EXPECT_NEAR(integrate(fine, one), 1.0, 1e-14);
}

// The mean of (1 - a^2) / (1 - 2 a cos w + a^2) e^{-j m w} over the circle is a^m.
TEST(OscillatingWeights, IntegrateOscillationsWithinAPanel) {
  for (const double a : {0.5, 0.9, 0.999}) {
    const Quadrature rule = half_circle_quadrature({{0.0, -std::log(a)}}, {0.0}, 1);
    for (const double m : {0.0, 3.0, 40.0, 1000.0, 10000.0}) {
      const OscillatingWeights weights(rule, m);
      double sum = 0.0;
      for (std::size_t k = 0; k < rule.node.size(); ++k) {
        const double w = static_cast<double>(rule.node[k]), sine = std::sin(w / 2.0);
        const double value = (1.0 - a) * (1.0 + a) / ((1.0 - a) * (1.0 - a) + 4.0 * a * sine * sine);
        sum += value * (weights.applies_to(k) ? weights[k].real() : rule.weight[k] * std::cos(m * w));
      }
      EXPECT_NEAR(sum, std::pow(a, m), 1e-12) << a << " " << m;
    }
  }
}

TEST(Quadrature, RejectsSingularitiesOnTheAxis) {
  EXPECT_THROW(half_circle_quadrature({{1.0, 0.0}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
