#include "stochastic_platoon/model/state_space.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

StateSpace::StateSpace(Eigen::MatrixXd a, Eigen::VectorXd b, Eigen::RowVectorXd c)
    : a_(std::move(a)), b_(std::move(b)), c_(std::move(c)) {
  const auto shape = [](Eigen::Index rows, Eigen::Index cols) {
    return std::to_string(rows) + " x " + std::to_string(cols);
  };
  if (a_.rows() < 1 || a_.rows() != a_.cols()) {
    throw std::invalid_argument("A: " + shape(a_.rows(), a_.cols()) + ": must be square, n x n with n >= 1");
  }
  if (b_.size() != a_.rows() || c_.size() != a_.rows()) {
    throw std::invalid_argument("B: " + shape(b_.size(), 1) + ", C: " + shape(1, c_.size()) +
                                ": must be n x 1 and 1 x n with A's n = " + std::to_string(a_.rows()));
  }
  if (!a_.allFinite() || !b_.allFinite() || !c_.allFinite()) {
    throw std::invalid_argument("A, B, C: every entry must be finite");
  }
}

double spectral_radius(const StateSpace& system) {
  return system.a().eigenvalues().cwiseAbs().maxCoeff();
}

Eigen::VectorXd unit_equilibrium(const StateSpace& system) {
  const Eigen::Index n = system.order();
  const Eigen::FullPivLU<Eigen::MatrixXd> resolvent(Eigen::MatrixXd::Identity(n, n) - system.a());
  if (!resolvent.isInvertible())
    throw std::invalid_argument("A: has an eigenvalue at 1: no equilibrium exists");
  const Eigen::VectorXd state = resolvent.solve(system.b());
  const double output = system.c() * state;
  if (output == 0.0) throw std::invalid_argument("T(1) = 0: no equilibrium with output 1 exists");
  return state / output;
}

StateSpace observable_canonical(const TransferFunction& transfer) {
  if (!transfer.is_strictly_proper() || transfer.denominator().size() < 2) {
    throw std::invalid_argument("relative degree " + std::to_string(transfer.relative_degree()) +
                                ": T must be strictly proper (more poles than zeros)");
  }
  const Eigen::Index n = transfer.denominator().size() - 1;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  a.col(0) = -transfer.denominator().tail(n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) a(i, i + 1) = 1.0;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  b.tail(transfer.numerator().size()) = transfer.numerator();
  Eigen::RowVectorXd c = Eigen::RowVectorXd::Zero(n);
  c(0) = 1.0;
  return {a, b, c};
}

TransferFunction transfer_function(const StateSpace& system) {
  const Eigen::Index n = system.order();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Polynomial denominator = Polynomial::Zero(n + 1);
  Polynomial numerator(n);
  denominator(0) = 1.0;
  Eigen::MatrixXd adjugate_term = identity;
  for (Eigen::Index k = 1; k <= n; ++k) {
    numerator(k - 1) = system.c() * adjugate_term * system.b();
    const Eigen::MatrixXd product = system.a() * adjugate_term;
    denominator(k) = -product.trace() / static_cast<double>(k);
    adjugate_term = product + denominator(k) * identity;
  }
  return {numerator, denominator};
}

}  // namespace platoon
