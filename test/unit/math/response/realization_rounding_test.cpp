#include "stochastic_platoon/math/response/realization_rounding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "stochastic_platoon/math/numerics/exact.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

/// ln |T|^2 in extended precision.
long double logarithm(const StateSpace& system, const CirclePoint& point) {
  const Resolvent r = resolvent(system);
  const auto about = [&point](const DeltaPolynomial& p) {
    return std::norm(evaluate(point.centre == Centre::kOne ? p : recentred(p), point.offset));
  };
  return std::log(about(rounded_delta(r.delta_transfer->numerator)) / about(r.delta_denominator));
}

// Roundings to a third of the digits of double have the effect of those to double, enlarged.
TEST(RealizationRounding, BoundsTheEffectOfRoundedEntriesOnTheGain) {
  constexpr double kEnlarged = 1 << 20;
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  const auto moved = [&](double entry) {
    return entry * (1.0 + kEnlarged * part(generator) * std::numeric_limits<double>::epsilon());
  };
  for (const ExampleLoop& example : example_loops()) {
    const StateSpace& given = example.loop.realization;
    const RealizationRounding rounding(given, resolvent(given));
    for (const double w : {0.01, 0.3, 1.5, 1.6, 3.0}) {
      const CirclePoint point(w), one(0.0);
      double largest = 0.0;
      for (int draw = 0; draw < 40; ++draw) {
        const StateSpace system(given.a().unaryExpr(moved), given.b().unaryExpr(moved), given.c().unaryExpr(moved));
        const long double change =
            (logarithm(system, point) - logarithm(system, one)) - (logarithm(given, point) - logarithm(given, one));
        largest = std::max(largest, static_cast<double>(std::abs(change)) / kEnlarged);
      }
      EXPECT_LE(largest, 1.01 * rounding.at(point)) << example.name << " at " << w;
      EXPECT_GE(largest, 0.1 * rounding.at(point)) << example.name << " at " << w;
    }
  }
}

}  // namespace
}  // namespace platoon
