#include "stochastic_platoon/math/response/designed_gain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "stochastic_platoon/math/links/linked_vehicle.hpp"
#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/numerics/exact.hpp"

namespace platoon {
namespace {

/// A point of the circle, and a value there, to a hundred digits.
struct ExactComplex {
  Exact real, imag;
};

ExactComplex value(const ExactPolynomial& p, const ExactComplex& s) {
  ExactComplex sum{0, 0};
  for (auto c = p.rbegin(); c != p.rend(); ++c)
    sum = {sum.real * s.real - sum.imag * s.imag + *c, sum.real * s.imag + sum.imag * s.real};
  return sum;
}

Exact norm(const ExactComplex& z) {
  return z.real * z.real + z.imag * z.imag;
}

LoopDesign car(double delay, bool filter, double ki) {
  LoopDesign design{{car_with_actuator_lag(0.1, delay), 0.01}, {ControllerGains{0.2, 0.7, ki}, 0.01}};
  design.headway_filter = filter;
  return design;
}

// The reference evaluates the coefficients of T, which have a hundred digits.
TEST(DesignedGain, KeepsItsDigitsBehindAnyDelay) {
  for (const double delay : {0.0, 0.123, 0.2, 0.995}) {
    for (const bool filter : {false, true}) {
      for (const double ki : {0.0, 0.001}) {
        const LoopDesign design = car(delay, filter, ki);
        const ExactFraction exact = exact_fraction(close_loop(design, 350.0));
        const DesignedGain gain(design, 350.0, 0.0, design.plant);
        for (const double w : {1e-7, 1e-4, 0.003, 0.01, 0.3, 1.5, 1.6, 3.0, 3.14159}) {
          const Exact half = Exact(w) / 2, sine = sin(half), cosine = cos(half);
          const ExactComplex s{-2 * sine * sine, 2 * sine * cosine};
          const ExactComplex n = value(exact.numerator, s), d = value(exact.denominator, s);
          const Exact over = norm(d), excess = over / norm(n) - 1;
          const DesignedGain::Value found = gain.at(CirclePoint(w), {});
          const std::complex<long double> transfer(
              Exact((n.real * d.real + n.imag * d.imag) / over).convert_to<long double>(),
              Exact((n.imag * d.real - n.real * d.imag) / over).convert_to<long double>());
          EXPECT_LE(std::abs(found.position - transfer), 1e-15L * std::abs(transfer)) << delay << ", " << w;
          EXPECT_NEAR(Exact(found.excess / excess).convert_to<double>(), 1.0, 1e-12) << delay << ", " << w;
        }
      }
    }
  }
}

TEST(DesignedGain, EqualsTheGainOfAFollowerWithoutLosses) {
  VehicleModel vehicle(close_loop(car(0.2, true, 0.0), 350.0), 350.0);
  vehicle.design = car(0.2, true, 0.0);
  const DesignedGain gain(*vehicle.design, vehicle.headway, 0.0, vehicle.design->plant);
  const LinkedVehicle linked(vehicle);
  for (const double w : {1e-6, 0.01, 1.0, 3.0}) {
    const DesignedGain::Value found = gain.at(CirclePoint(w), {});
    const LinkedVehicleValue value = linked.at(w);
    EXPECT_NEAR(value.gain, static_cast<double>(std::norm(found.position)), 1e-15 * value.gain);
    EXPECT_NEAR(value.margin, static_cast<double>(found.excess / (1.0L + found.excess)),
                1e-15 * std::abs(value.margin));
  }
}

// (z + 1) in the numerator of G: T vanishes at w = pi.
TEST(DesignedGain, IsZeroAtAZeroOfThePlant) {
  LoopDesign design{{ContinuousPlant{Polynomial::Constant(1, 1.0), Eigen::Vector3d(1.0, 0.0, 0.0), 0.0}, 0.1},
                    {ControllerGains{0.2, 0.7, 0.0}, 0.1}};
  const DesignedGain gain(design, 30.0, 0.0, design.plant);
  EXPECT_LT(std::abs(gain.at(CirclePoint(3.141592653589793), {}).position), 1e-15L);
}

}  // namespace
}  // namespace platoon
