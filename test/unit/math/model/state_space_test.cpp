#include "stochastic_platoon/math/model/state_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "unit/messages.hpp"
#include "unit/zeros.hpp"

namespace platoon {
namespace {

StateSpace random_system(Eigen::Index order, std::mt19937& generator) {
  std::normal_distribution<double> entry;
  Eigen::MatrixXd a(order, order);
  Eigen::VectorXd b(order);
  Eigen::RowVectorXd c(order);
  for (Eigen::Index i = 0; i < order; ++i) {
    for (Eigen::Index j = 0; j < order; ++j) a(i, j) = 0.3 * entry(generator);
    b(i) = entry(generator);
    c(i) = entry(generator);
  }
  return {a, b, c};
}

std::string rejection(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::RowVectorXd& c) {
  return message_of<std::invalid_argument>([&] { StateSpace(a, b, c); });
}

TEST(StateSpace, NamesAMatrixThatDoesNotFit) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(2);
  const Eigen::RowVectorXd c = Eigen::RowVectorXd::Ones(2);
  EXPECT_EQ(rejection(a, b, c), "");
  EXPECT_EQ(rejection(Eigen::MatrixXd::Zero(2, 3), b, c), "A: 2 x 3: must be square, n x n with n >= 1");
  EXPECT_EQ(rejection(Eigen::MatrixXd(0, 0), b, c), "A: 0 x 0: must be square, n x n with n >= 1");
  EXPECT_EQ(rejection(a, Eigen::VectorXd::Ones(3), c), "B: 3 x 1, C: 1 x 2: must be n x 1 and 1 x n with A's n = 2");
  EXPECT_EQ(rejection(a, b, Eigen::RowVectorXd::Ones(1)), "B: 2 x 1, C: 1 x 1: must be n x 1 and 1 x n with A's n = 2");
  EXPECT_EQ(rejection(std::nan("") * a, b, c), "A, B, C: every entry must be finite");
  EXPECT_EQ(rejection(a, b, HUGE_VAL * c), "A, B, C: every entry must be finite");
}

TEST(StateSpace, HasTheSpectralRadiusOfItsEigenvalues) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  a << 0.6, -0.7, 5.0, 0.7, 0.6, -3.0, 0.0, 0.0, -0.5;
  EXPECT_NEAR(spectral_radius({a, Eigen::Vector3d::Ones(), Eigen::RowVector3d::Ones()}), std::hypot(0.6, 0.7), 1e-14);
}

TEST(StateSpace, HasTheTransferFunctionOfItsResolvent) {
  std::mt19937 generator(1);
  for (Eigen::Index order = 1; order <= 6; ++order) {
    const StateSpace system = random_system(order, generator);
    const TransferFunction transfer = resolvent(system).transfer;
    EXPECT_EQ(transfer.denominator().size(), order + 1);
    for (const std::complex<double>& z : {std::complex<double>(1.0, 0.0), {0.5, 2.0}, {-1.7, 0.3}}) {
      const Eigen::MatrixXcd resolvent = (z * Eigen::MatrixXcd::Identity(order, order) - system.a()).inverse();
      const std::complex<double> expected = (system.c() * resolvent * system.b())(0);
      EXPECT_LT(std::abs(transfer(z) - expected), 1e-12 * (1.0 + std::abs(expected))) << order << " " << z;
    }
  }
}

TEST(StateSpace, InObservableFormHasTheTransferFunctionOfItsFraction) {
  std::mt19937 generator(2);
  for (int trial = 0; trial < 60; ++trial) {
    const int degree = 1 + trial % 6;
    const int zeros = trial / 6 % degree;
    const TransferFunction fraction(-0.4 * random_polynomial(zeros, generator), random_polynomial(degree, generator));
    const StateSpace system = observable_canonical(fraction);
    EXPECT_EQ(system.order(), degree);
    EXPECT_EQ(system.c()(0), 1.0);
    EXPECT_EQ(system.c().tail(degree - 1).norm(), 0.0);
    const TransferFunction again = resolvent(system).transfer;
    ASSERT_EQ(again.numerator().size(), fraction.numerator().size());
    EXPECT_LT((again.numerator() - fraction.numerator()).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((again.denominator() - fraction.denominator()).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(StateSpace, InObservableFormHasTheCoefficientsOfItsFraction) {
  const StateSpace system = observable_canonical({Eigen::Vector2d(5.0, 6.0), Eigen::Vector4d(1.0, -0.2, 0.3, 0.4)});
  Eigen::Matrix3d a;
  a << 0.2, 1.0, 0.0, -0.3, 0.0, 1.0, -0.4, 0.0, 0.0;
  EXPECT_EQ(system.a(), a);
  EXPECT_EQ(system.b(), Eigen::Vector3d(0.0, 5.0, 6.0));
  EXPECT_EQ(system.c(), Eigen::RowVector3d(1.0, 0.0, 0.0));
}

TEST(StateSpace, RealizesStrictlyProperFractionsOnly) {
  const Polynomial quadratic = Eigen::Vector3d(1.0, 0.2, 0.3);
  EXPECT_THROW(observable_canonical({quadratic, quadratic}), std::invalid_argument);
  EXPECT_THROW(observable_canonical({quadratic, Eigen::Vector2d(1.0, 0.5)}), std::invalid_argument);
  EXPECT_THROW(observable_canonical({Polynomial::Zero(1), Polynomial::Ones(1)}), std::invalid_argument);
}

TEST(StateSpace, HasAStateOfRestWithTheOutputOne) {
  std::mt19937 generator(3);
  for (Eigen::Index order = 1; order <= 6; ++order) {
    const StateSpace system = random_system(order, generator);
    const Eigen::VectorXd state = unit_equilibrium(system);
    const double gain = resolvent(system).transfer(1.0).real();
    EXPECT_LT((system.a() * state + system.b() / gain - state).norm(), 1e-12 * (1.0 + state.norm()));
    EXPECT_NEAR(system.c() * state, 1.0, 1e-12);
  }
}

TEST(StateSpace, RejectsASystemWithoutAStateOfRest) {
  const Eigen::Vector2d b(1.0, 1.0);
  Eigen::Matrix2d integrator;
  integrator << 1.0, 0.0, 0.0, 0.5;
  EXPECT_THROW(unit_equilibrium({integrator, b, Eigen::RowVector2d(1.0, 1.0)}), std::invalid_argument);
  EXPECT_THROW(unit_equilibrium({0.5 * Eigen::Matrix2d::Identity(), b, Eigen::RowVector2d(1.0, -1.0)}),
               std::invalid_argument);
}

/// A product of integer shears and its inverse, also of integers: no coordinate is rounded.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> skewed_basis(Eigen::Index n, int shears, double entry) {
  Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(n, n), inverse = basis;
  for (int i = 0; i < shears; ++i) {
    Eigen::MatrixXd shear = Eigen::MatrixXd::Identity(n, n);
    shear(i % n, (i + 1) % n) = entry;
    basis = (basis * shear).eval();
    shear(i % n, (i + 1) % n) = -entry;
    inverse = (shear * inverse).eval();
  }
  return {basis, inverse};
}

TEST(Resolvent, KeepsAllDigitsOfTInSkewedCoordinates) {
  const Polynomial n = Eigen::Vector3d(0.25, -0.375, 0.1875);
  Polynomial d(5);
  d << 1.0, -1.5, 0.875, -0.25, 0.03125;
  const StateSpace canonical = observable_canonical({n, d});
  for (const int shears : {4, 8, 11}) {
    const auto [basis, inverse] = skewed_basis(4, shears, 3.0);
    const StateSpace skewed(basis * canonical.a() * inverse, basis * canonical.b(), canonical.c() * inverse);
    const TransferFunction t = resolvent(skewed).transfer;
    EXPECT_EQ(t.denominator(), d) << "condition " << basis.norm() * inverse.norm();
    EXPECT_EQ(t.numerator(), n) << "condition " << basis.norm() * inverse.norm();
    EXPECT_EQ(spectral_radius(skewed), spectral_radius(canonical));
  }
}

TEST(SpectralRadius, HasTheDigitsOfItsDistanceFromOne) {
  const double pole = 1.0 - std::ldexp(1.0, -30);
  Eigen::Matrix2d a;
  a << pole, 1.0, 0.0, 0.5;
  const StateSpace slow(a, Eigen::Vector2d(0.0, 1.0), Eigen::RowVector2d(1.0, 0.0));
  EXPECT_EQ(spectral_radius(slow), pole);
}

}  // namespace
}  // namespace platoon
