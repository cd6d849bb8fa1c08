#pragma once

#include <Eigen/Core>
#include <functional>

namespace platoon {

/// A linear map between vectors of the same size that maps nonnegative vectors to nonnegative vectors.
using NonnegativeMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// The spectral radius of a nonnegative map, its Perron root; 0 for size 0.
///
/// The entries of the map may differ by many orders of magnitude, as losses of one vehicle act on those of another. The
/// map is therefore balanced by a change of units (E. E. Osborne, J. ACM 7, 1960), which leaves no entry of a cycle far
/// above the root. Maps of up to 60 dimensions are written out as a matrix. Larger ones use Arnoldi's method (Y. Saad,
/// Numerical Methods for Large Eigenvalue Problems, 2011, section 6.2), in units given by the sum of the images under
/// powers of the map, until the root settles to 1e-14, or in two successive steps to this share of its distance from 1.
double perron_root(const NonnegativeMap& map, Eigen::Index size, double share_of_distance = 0.0);

/// The eigenvector of the root to some digits, by Arnoldi's method in the same units.
Eigen::VectorXd perron_vector(const NonnegativeMap& map, Eigen::Index size);

/// Bounds of the root: the smallest and the largest ratio of map(x) to x, x > 0 (L. Collatz, Math. Z. 48, 1942), after
/// a few steps of power iteration. Cheaper than perron_root().
struct RootBounds {
  double least, most;
};
RootBounds perron_bounds(const NonnegativeMap& map, Eigen::Index size);

/// The root on its exact side of 1, to compare it with 1: from the bounds, at less cost, if they lie beyond a factor of
/// 2; otherwise perron_root().
double perron_root_beside_one(const NonnegativeMap& map, Eigen::Index size, double share_of_distance = 0.0);

/// Solves x - map(x) = b for a map of spectral radius below 1, in the same units. Larger maps use full
/// orthogonalization (Y. Saad, Iterative Methods for Sparse Linear Systems, 2003, section 6.4).
Eigen::VectorXd solve_one_minus(const NonnegativeMap& map, const Eigen::VectorXd& b);

}  // namespace platoon
