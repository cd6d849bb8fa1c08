#include "stochastic_platoon/math/numerics/krylov.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "stochastic_platoon/math/numerics/eigenvalues.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

constexpr Eigen::Index kMostDimensions = 60;

/// Orthonormal basis of b, A b, A^2 b, ... and the projection of A onto it.
class KrylovSpace {
public:
  KrylovSpace(const NonnegativeMap& map, const Eigen::VectorXd& start)
      : map_(map),
        most_(std::min(start.size(), kMostDimensions)),
        basis_(start.size(), most_ + 1),
        hessenberg_(Eigen::MatrixXd::Zero(most_ + 1, most_)) {
    basis_.col(0) = start / start.norm();
  }

  /// Adds one dimension. False if the space is invariant or has its maximum dimension.
  bool extend() {
    check_interruption();
    Eigen::VectorXd next = map_(basis_.col(dimensions_));
    const double size = next.norm();
    for (int pass = 0; pass < 2; ++pass) {  // two passes give orthogonality to rounding
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

Eigen::MatrixXd written_out(const NonnegativeMap& map, Eigen::Index size) {
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    check_interruption();
    matrix.col(j) = map(Eigen::VectorXd::Unit(size, j));
  }
  return matrix;
}

/// Scales the matrix to units in which row i and column i have the same sum without the diagonal; returns these units.
Eigen::VectorXd balance(Eigen::MatrixXd& matrix) {
  constexpr int kSweeps = 100;
  Eigen::VectorXd units = Eigen::VectorXd::Ones(matrix.rows());
  const Eigen::VectorXd diagonal = matrix.diagonal();
  matrix.diagonal().setZero();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double most = 1.0;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const double row = matrix.row(i).sum(), column = matrix.col(i).sum();
      if (!(row > 0.0 && column > 0.0)) continue;
      const double unit = std::sqrt(row / column);
      matrix.row(i) /= unit;
      matrix.col(i) *= unit;
      units(i) *= unit;
      most = std::max({most, unit, 1.0 / unit});
    }
    if (most < 2.0) break;
  }
  matrix.diagonal() = diagonal;
  return units;
}

/// Units in which no component of map(1, ..., 1) is far above the root.
Eigen::VectorXd units_of_powers(const NonnegativeMap& map, Eigen::Index size) {
  constexpr int kPowers = 12;
  constexpr double kLeast = 1e-250;
  std::vector<Eigen::VectorXd> images{Eigen::VectorXd::Ones(size)};
  std::vector<double> logarithms{0.0};  // of the factors that the images were divided by
  for (int k = 0; k < kPowers; ++k) {
    check_interruption();
    const Eigen::VectorXd next = map(images.back());
    const double largest = next.maxCoeff();
    if (!(largest > 0.0)) break;
    images.emplace_back(next / largest);
    logarithms.push_back(logarithms.back() + std::log(largest));
  }
  const double growth = logarithms.back() / static_cast<double>(std::max<std::size_t>(images.size() - 1, 1));
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(size);
  for (std::size_t k = 0; k < images.size(); ++k)
    sum += std::exp(logarithms[k] - static_cast<double>(k) * growth) * images[k];
  return sum.cwiseMax(kLeast * sum.maxCoeff());
}

NonnegativeMap in_units(const Eigen::VectorXd& units, const NonnegativeMap& map) {
  return [&units, &map](const Eigen::VectorXd& y) -> Eigen::VectorXd {
    return map(units.cwiseProduct(y)).cwiseQuotient(units);
  };
}

Eigen::VectorXd solution(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& b) {
  return (Eigen::MatrixXd::Identity(matrix.rows(), matrix.rows()) - matrix).partialPivLu().solve(b);
}

}  // namespace

double perron_root(const NonnegativeMap& map, Eigen::Index size, double share_of_distance) {
  if (size == 0) return 0.0;
  if (size <= kMostDimensions) {
    Eigen::MatrixXd matrix = written_out(map, size);
    balance(matrix);
    return spectral_radius(matrix);
  }
  const Eigen::VectorXd units = units_of_powers(map, size);
  const NonnegativeMap scaled = in_units(units, map);
  KrylovSpace space(scaled, Eigen::VectorXd::Ones(size));
  double root = 0.0;
  for (int close = 0; close < 2;) {
    const bool goes_on = space.extend();
    const double before = root;
    root = spectral_radius(space.projected());
    const double change = std::abs(root - before);
    if (!goes_on || change <= 1e-14 * root) break;
    close = change <= share_of_distance * std::abs(root - 1.0) ? close + 1 : 0;
  }
  return root;
}

Eigen::VectorXd perron_vector(const NonnegativeMap& map, Eigen::Index size) {
  constexpr double kSettled = 1e-10;
  const Eigen::VectorXd units = units_of_powers(map, size);
  const NonnegativeMap scaled = in_units(units, map);
  KrylovSpace space(scaled, Eigen::VectorXd::Ones(size));
  double root = 0.0, before = -1.0;
  while (space.extend() && std::abs(root - before) > kSettled * root) {
    before = root;
    root = spectral_radius(space.projected());
  }
  return units.cwiseProduct(space.combined(leading_eigenvector(space.projected())));
}

RootBounds perron_bounds(const NonnegativeMap& map, Eigen::Index size) {
  constexpr int kSteps = 3;
  Eigen::VectorXd x = Eigen::VectorXd::Ones(size);
  RootBounds bounds{0.0, std::numeric_limits<double>::infinity()};
  for (int step = 0; step < kSteps && x.minCoeff() > 0.0; ++step) {
    const Eigen::VectorXd next = map(x);
    const Eigen::VectorXd ratios = next.cwiseQuotient(x);
    bounds = {std::max(bounds.least, ratios.minCoeff()), std::min(bounds.most, ratios.maxCoeff())};
    x = next / next.maxCoeff();
  }
  return bounds;
}

double perron_root_beside_one(const NonnegativeMap& map, Eigen::Index size, double share_of_distance) {
  constexpr double kFar = 2.0;
  if (size == 0) return 0.0;
  const RootBounds bounds = perron_bounds(map, size);
  if (bounds.most < 1.0 / kFar || bounds.least > kFar) return std::sqrt(bounds.least * bounds.most);
  return perron_root(map, size, share_of_distance);
}

Eigen::VectorXd solve_one_minus(const NonnegativeMap& map, const Eigen::VectorXd& b) {
  if (b.norm() == 0.0) return b;
  if (b.size() <= kMostDimensions) {
    Eigen::MatrixXd matrix = written_out(map, b.size());
    const Eigen::VectorXd units = balance(matrix);
    return units.cwiseProduct(solution(matrix, b.cwiseQuotient(units)));
  }
  const Eigen::VectorXd units = units_of_powers(map, b.size());
  const NonnegativeMap scaled = in_units(units, map);
  const Eigen::VectorXd start = b.cwiseQuotient(units);
  KrylovSpace space(scaled, start);
  Eigen::VectorXd x;
  for (bool goes_on = true; goes_on;) {
    goes_on = space.extend();
    const Eigen::MatrixXd h = space.projected();
    x = solution(h, start.norm() * Eigen::VectorXd::Unit(h.rows(), 0));
    if (std::abs(x(x.size() - 1)) <= 1e-15 * x.norm()) break;
  }
  return units.cwiseProduct(space.combined(x));
}

}  // namespace platoon
