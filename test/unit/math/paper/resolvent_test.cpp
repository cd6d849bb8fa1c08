#include "stochastic_platoon/math/paper/resolvent.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/paper/string_matrices.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

Eigen::RowVectorXcd dense_resolvent(const StateSpace& loop, std::complex<double> z) {
  const Eigen::MatrixXcd shifted =
      z * Eigen::MatrixXcd::Identity(loop.order(), loop.order()) - loop.a().cast<std::complex<double>>();
  return loop.c().cast<std::complex<double>>() * shifted.inverse();
}

StateSpace unstable_loop() {
  return {Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Ones(1), Eigen::RowVectorXd::Ones(1)};
}

TEST(Resolvent, IsTheInverseOfTheShiftedMatrix) {
  for (const ExampleLoop& example : example_loops()) {
    const Resolvent r = resolvent(example.loop.realization);
    for (const std::complex<double> z : {std::polar(1.0, 0.3), std::polar(1.0, 2.5), std::polar(1.3, 1.0)}) {
      const Eigen::RowVectorXcd expected = dense_resolvent(example.loop.realization, z);
      for (Eigen::Index a = 0; a < expected.size(); ++a) {
        const std::complex<long double> s = static_cast<std::complex<long double>>(z) - 1.0L;
        const std::complex<long double> entry =
            evaluate(r.delta_numerators[static_cast<std::size_t>(a)], s) / evaluate(r.delta_denominator, s);
        EXPECT_LT(std::abs(static_cast<std::complex<double>>(entry) - expected(a)), 1e-10 * expected.norm())
            << example.name << " " << z;
      }
    }
  }
}

TEST(Resolvent, HasTheLargestNormOnTheCircleAsItsPeak) {
  for (const ExampleLoop& example : example_loops()) {
    double largest = 0.0;
    for (int i = 0; i <= 20000; ++i) {
      const std::complex<double> z = std::polar(1.0, 3.141592653589793 * i / 20000);
      largest = std::max(largest, dense_resolvent(example.loop.realization, z).norm());
    }
    const double peak = resolvent_peak(example.loop.realization);
    EXPECT_GE(peak, largest * (1.0 - 1e-9)) << example.name;
    EXPECT_LE(peak, largest * 1.01) << example.name;
  }
}

TEST(Resolvent, HasTheEnergyOfTheGramian) {
  for (const double h : {3.2, 2.4}) {
    const StateSpace loop = paper_loop(h).realization;
    for (const std::size_t followers : {1u, 2u, 8u}) {
      const StringMatrices string = string_matrices(loop, h, followers);
      const Eigen::RowVectorXd last = string.c.bottomRows(1);
      const double trace = solve_discrete_lyapunov(string.a.transpose(), last.transpose() * last).trace();
      EXPECT_NEAR(resolvent_energy(loop, followers), trace, 1e-10 * trace) << h << " " << followers;
    }
  }
}

TEST(Resolvent, RejectsUnstableVehiclesAndEmptyStrings) {
  EXPECT_THROW(resolvent_peak(unstable_loop()), std::invalid_argument);
  EXPECT_THROW(resolvent_energy(unstable_loop(), 1), std::invalid_argument);
  EXPECT_THROW(resolvent_energy(paper_loop(3.2).realization, 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
