#pragma once

#include <Eigen/Core>
#include <functional>

namespace platoon {

/// A linear map of vectors to vectors of the same size, nonnegative: it maps nonnegative vectors to such.
using NonnegativeMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// The spectral radius of a nonnegative map, its Perron root; 0 for size 0.
///
/// The losses of one vehicle may act on those of another by many orders of magnitude: components are measured in units
/// that balance the map (E. E. Osborne, J. ACM 7, 1960), which leaves no entry of a cycle far above the root. Maps of
/// up to 60 dimensions are written out; larger ones by Arnoldi's method (Y. Saad, Numerical Methods for Large
/// Eigenvalue Problems, 2011, section 6.2), in units of the sum of their powers' images, until it settles to 1e-14.
double perron_root(const NonnegativeMap& map, Eigen::Index size);

/// Between what the root lies: the smallest and the largest ratio of map(x) to x, x > 0 (L. Collatz, Math. Z. 48,
/// 1942), after a few steps of power iteration, which is cheaper.
struct RootBounds {
  double least, most;
};
RootBounds perron_bounds(const NonnegativeMap& map, Eigen::Index size);

/// x with x - map(x) = b, for a map of spectral radius below 1, in the same units; larger maps by full
/// orthogonalization (Y. Saad, Iterative Methods for Sparse Linear Systems, 2003, section 6.4).
Eigen::VectorXd solve_one_minus(const NonnegativeMap& map, const Eigen::VectorXd& b);

}  // namespace platoon
