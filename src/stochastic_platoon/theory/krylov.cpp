#include "stochastic_platoon/theory/krylov.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "stochastic_platoon/model/eigenvalues.hpp"

namespace platoon {

namespace {

constexpr Eigen::Index kMostDimensions = 60;

/// An orthonormal basis of b, A b, A^2 b, ... and A in it.
class KrylovSpace {
public:
  KrylovSpace(const NonnegativeMap& map, const Eigen::VectorXd& start)
      : map_(map),
        most_(std::min(start.size(), kMostDimensions)),
        basis_(start.size(), most_ + 1),
        hessenberg_(Eigen::MatrixXd::Zero(most_ + 1, most_)) {
    basis_.col(0) = start / start.norm();
  }

  /// One dimension more; false where the space is invariant, or has its most.
  bool extend() {
    Eigen::VectorXd next = map_(basis_.col(dimensions_));
    const double size = next.norm();
    for (int pass = 0; pass < 2; ++pass) {  // twice is enough for orthogonality to rounding
      for (Eigen::Index i = 0; i <= dimensions_; ++i) {
        const double part = basis_.col(i).dot(next);
        hessenberg_(i, dimensions_) += part;
        next -= part * basis_.col(i);
      }
    }
    const double left = next.norm();
    ++dimensions_;
    if (dimensions_ == most_ || !(left > 1e-15 * size)) return false;
    hessenberg_(dimensions_, dimensions_ - 1) = left;
    basis_.col(dimensions_) = next / left;
    return true;
  }

  Eigen::MatrixXd projected() const { return hessenberg_.topLeftCorner(dimensions_, dimensions_); }
  Eigen::VectorXd combined(const Eigen::VectorXd& x) const { return basis_.leftCols(dimensions_) * x; }

private:
  const NonnegativeMap& map_;
  Eigen::Index most_, dimensions_ = 0;
  Eigen::MatrixXd basis_, hessenberg_;
};

}  // namespace

double perron_root(const NonnegativeMap& map, Eigen::Index size) {
  if (size == 0) return 0.0;
  KrylovSpace space(map, Eigen::VectorXd::Ones(size));
  double root = 0.0;
  for (bool goes_on = true; goes_on;) {
    goes_on = space.extend();
    const double before = root;
    root = spectral_radius(space.projected());
    if (size > kMostDimensions && std::abs(root - before) <= 1e-14 * root) break;
  }
  return root;
}

Eigen::VectorXd solve_one_minus(const NonnegativeMap& map, const Eigen::VectorXd& b) {
  const double size = b.norm();
  if (size == 0.0) return b;
  KrylovSpace space(map, b);
  Eigen::VectorXd x;
  for (bool goes_on = true; goes_on;) {
    goes_on = space.extend();
    const Eigen::MatrixXd h = space.projected();
    const Eigen::VectorXd before = x;
    x = (Eigen::MatrixXd::Identity(h.rows(), h.rows()) - h)
            .partialPivLu()
            .solve(size * Eigen::VectorXd::Unit(h.rows(), 0));
    if (b.size() > kMostDimensions && std::abs(x(x.size() - 1)) <= 1e-15 * x.norm()) break;
  }
  return space.combined(x);
}

}  // namespace platoon
