#pragma once

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/transfer_function.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {

struct ExactFraction;

/// The closed loop T of one vehicle, paper eq. (ith-closedloop):
/// \f[ x(k+1) = A x(k) + B u(k), \qquad y(k) = C x(k). \f]
/// A is n x n, B is n x 1, C is 1 x n, n >= 1. Throws std::invalid_argument if the shapes do not match or an entry is
/// not finite.
class StateSpace {
public:
  StateSpace(Eigen::MatrixXd a, Eigen::VectorXd b, Eigen::RowVectorXd c);

  const Eigen::MatrixXd& a() const { return a_; }
  const Eigen::VectorXd& b() const { return b_; }
  const Eigen::RowVectorXd& c() const { return c_; }
  Eigen::Index order() const { return a_.rows(); }

private:
  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
  Eigen::RowVectorXd c_;
};

/// rho(A), the largest modulus of an eigenvalue of A; 1 - rho(A) is as accurate as rho(A).
double spectral_radius(const StateSpace& system);

/// Equilibrium with output 1: the state x = A x + B u, C x = 1 of a constant input u, which is (I - A)^-1 B / T(1),
/// shape n x 1. Throws std::invalid_argument if there is none: I - A is singular (a mode at z = 1) or T(1) = 0.
Eigen::VectorXd unit_equilibrium(const StateSpace& system);

/// Steady motion with output k: the state x(0) of x(k+1) = A x(k) + B u(k), C x(k) = k for the input u(k) = k + l, with
/// the lag l of the loop, shape n x 1. For a loop with T(1) = 1. Throws std::invalid_argument as unit_equilibrium().
Eigen::VectorXd unit_ramp(const StateSpace& system);

/// Observable canonical realization of a strictly proper fraction: C = [1 0 ... 0]. Minimal if the fraction is in
/// lowest terms. Throws std::invalid_argument if the fraction is not strictly proper.
StateSpace observable_canonical(const TransferFunction& transfer);

/// R(z) = C (zI - A)^-1, 1 x n, from the states of one vehicle to its output, (zI - A)^-1 B, n x 1, from its input to
/// its states, and T = R B.
///
/// Computed by the Faddeev-LeVerrier recursion in a hundred digits, as it loses up to kappa^n in coordinates of
/// condition kappa. Every coefficient is that of the given A, B and C, rounded once.
struct Resolvent {
  std::vector<DeltaPolynomial> delta_numerators;  ///< of the n entries, those of C adj(zI - A), by powers of s = z - 1
  std::vector<DeltaPolynomial> delta_states;      ///< of the n entries, those of adj(zI - A) B
  DeltaPolynomial delta_denominator;              ///< det(zI - A), by powers of s
  TransferFunction transfer;                      ///< T, not reduced
  std::shared_ptr<const ExactFraction> delta_transfer;  ///< T by powers of s, to a hundred digits
};

Resolvent resolvent(const StateSpace& system);

}  // namespace platoon
