#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace platoon {

/// The rows and columns of a square matrix at these places.
inline Eigen::MatrixXd selected(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& places) {
  const auto count = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd result(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j)
      result(i, j) = matrix(places[static_cast<std::size_t>(i)], places[static_cast<std::size_t>(j)]);
  }
  return result;
}

/// The entries of a vector at these places.
inline Eigen::VectorXd selected(const Eigen::VectorXd& vector, const std::vector<Eigen::Index>& places) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) result(static_cast<Eigen::Index>(i)) = vector(places[i]);
  return result;
}

}  // namespace platoon
