#include "stochastic_platoon/math/model/state_space.hpp"

#include <Eigen/LU>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/math/numerics/exact_resolvent.hpp"
#include "stochastic_platoon/math/numerics/zeros.hpp"

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
  return spectral_radius(zeros(resolvent(system).delta_transfer->denominator));
}

namespace {

/// Powers of two that bring the largest entry of each row next to 1; 1 for a row of zeros.
Eigen::VectorXd row_scales(const Eigen::MatrixXd& m) {
  return m.rowwise().lpNorm<Eigen::Infinity>().unaryExpr(
      [](double largest) { return largest > 0.0 ? std::ldexp(1.0, -std::ilogb(largest)) : 1.0; });
}

/// The solution of (I - A) x = b. The rates of a loop that is sampled fast are small numbers, in a matrix that is
/// regular only in their units.
Eigen::VectorXd solve_at_one(const StateSpace& system, const Eigen::VectorXd& b) {
  const Eigen::Index n = system.order();
  const Eigen::MatrixXd given = Eigen::MatrixXd::Identity(n, n) - system.a();
  const Eigen::FullPivLU<Eigen::MatrixXd> resolvent(given);
  if (resolvent.isInvertible()) return resolvent.solve(b);
  const Eigen::VectorXd rows = row_scales(given);
  const Eigen::MatrixXd by_rows = rows.asDiagonal() * given;
  const Eigen::VectorXd columns = row_scales(by_rows.transpose());
  const Eigen::FullPivLU<Eigen::MatrixXd> scaled(by_rows * columns.asDiagonal());
  if (!scaled.isInvertible()) throw std::invalid_argument("A: has an eigenvalue at 1: no equilibrium exists");
  return columns.cwiseProduct(scaled.solve(rows.cwiseProduct(b)));
}

}  // namespace

Eigen::VectorXd unit_equilibrium(const StateSpace& system) {
  const Eigen::VectorXd state = solve_at_one(system, system.b());
  const double output = system.c() * state;
  if (output == 0.0) throw std::invalid_argument("T(1) = 0: no equilibrium with output 1 exists");
  return state / output;
}

// x(k) = r + k q: q is the equilibrium, and (I - A) r + q = B l with C r = 0.
Eigen::VectorXd unit_ramp(const StateSpace& system) {
  const Eigen::VectorXd rest = unit_equilibrium(system);
  const Eigen::VectorXd lagging = solve_at_one(system, rest);
  return rest * (system.c() * lagging).value() - lagging;
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

Resolvent resolvent(const StateSpace& system) {
  const ExactMatrix a = system.a().cast<Exact>(), b = system.b().cast<Exact>();
  const ExactResolvent exact = exact_resolvent(a, system.c().cast<Exact>());
  const ExactPolynomial transfer = exact.numerator(b);
  const ExactFraction by_powers_of_s{shifted_to_one(transfer), shifted_to_one(exact.denominator)};
  Resolvent result{{},
                   {},
                   rounded_delta(by_powers_of_s.denominator),
                   {rounded(transfer), rounded(exact.denominator)},
                   std::make_shared<const ExactFraction>(by_powers_of_s)};
  for (const ExactPolynomial& numerator : exact.numerators)
    result.delta_numerators.push_back(rounded_delta(shifted_to_one(numerator)));
  std::vector<ExactPolynomial> states(exact.numerators.size());
  ExactMatrix term = b;  // coefficient of adj(zI - A) B, from the highest power of z on
  for (std::size_t k = 1; k < exact.denominator.size(); ++k) {
    for (std::size_t i = 0; i < states.size(); ++i) states[i].push_back(term(static_cast<Eigen::Index>(i), 0));
    term = product(a, term) + b * exact.denominator[k];
  }
  for (const ExactPolynomial& state : states) result.delta_states.push_back(rounded_delta(shifted_to_one(state)));
  return result;
}

}  // namespace platoon
