#pragma once

#include <Eigen/Core>
#include <functional>

namespace platoon {

/// A linear map of vectors to vectors of the same size, nonnegative: it maps nonnegative vectors to such.
using NonnegativeMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// The spectral radius of a nonnegative map, its Perron root, from its Krylov space by Arnoldi's method (Y. Saad,
/// Numerical Methods for Large Eigenvalue Problems, 2011, section 6.2); exact for maps of up to 60 dimensions, and
/// until it settles to 1e-14 for larger ones. 0 for size 0.
double perron_root(const NonnegativeMap& map, Eigen::Index size);

/// x with x - map(x) = b, for a map of spectral radius below 1, from the same space (full orthogonalization, Y. Saad,
/// Iterative Methods for Sparse Linear Systems, 2003, section 6.4).
Eigen::VectorXd solve_one_minus(const NonnegativeMap& map, const Eigen::VectorXd& b);

}  // namespace platoon
