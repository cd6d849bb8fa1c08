#include "stochastic_platoon/math/numerics/resolvent_terms.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <iterator>

namespace platoon {

namespace {

using DoubleComplex = std::complex<double>;

constexpr double kVanishing = 1e-14;   // modulus below which an eigenvalue counts as 0
constexpr double kConditioned = 20.0;  // |left| |right| of an accurate pair of eigenvectors

struct Cluster {
  std::vector<DoubleComplex> values;

  DoubleComplex centre() const {
    DoubleComplex sum = 0.0;
    for (const DoubleComplex& value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  double spread() const {
    double largest = 0.0;
    for (const DoubleComplex& value : values) largest = std::max(largest, std::abs(value - centre()));
    return largest;
  }
  double distance(const DoubleComplex& other) const {
    double least = 4.0;
    for (const DoubleComplex& value : values) least = std::min(least, std::abs(value - other));
    return least;
  }
};

/// Joins eigenvalues that are nearer to each other than a third of their distance from the unit circle.
std::vector<Cluster> clustered(const std::vector<DoubleComplex>& values) {
  std::vector<Cluster> clusters;
  for (const DoubleComplex& value : values) {
    Cluster joined{{value}};
    std::vector<Cluster> others;
    for (const Cluster& cluster : clusters) {
      if (cluster.distance(value) < (1.0 - std::abs(value)) / 3.0) {
        joined.values.insert(joined.values.end(), cluster.values.begin(), cluster.values.end());
      } else {
        others.push_back(cluster);
      }
    }
    others.push_back(joined);
    clusters.swap(others);
  }
  return clusters;
}

/// The Cauchy integral over a circle that is as many times wider than the cluster as it is nearer than what lies
/// outside.
void add_circle(const Eigen::MatrixXcd& matrix, const Cluster& cluster, const std::vector<DoubleComplex>& outside,
                std::vector<ResolventTerm>& terms) {
  constexpr double kDecay = 40.0;  // -ln of the last digit
  constexpr int kMostPoints = 200;
  const DoubleComplex centre = cluster.centre();
  double free = 1.0 - std::abs(centre);
  for (const DoubleComplex& other : outside) free = std::min(free, std::abs(other - centre));
  const double inner = std::max(cluster.spread(), 0.01 * free), radius = std::sqrt(inner * free);
  const int points = std::min(kMostPoints, static_cast<int>(std::ceil(kDecay / std::log(radius / inner))));
  const Eigen::MatrixXcd identity = Eigen::MatrixXcd::Identity(matrix.rows(), matrix.cols());
  for (int k = 0; k < points; ++k) {
    const DoubleComplex turn = std::polar(radius, 2.0 * boost::math::double_constants::pi * (k + 0.5) / points),
                        value = centre + turn;
    terms.push_back(
        {value, identity, turn / static_cast<double>(points) * (value * identity - matrix).partialPivLu().inverse()});
  }
}

}  // namespace

std::vector<ResolventTerm> memory_terms(const Eigen::MatrixXd& transposed) {
  const Eigen::MatrixXcd matrix = transposed.cast<DoubleComplex>();
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(matrix);
  const Eigen::MatrixXcd& columns = solver.eigenvectors();
  const Eigen::MatrixXcd rows = columns.partialPivLu().inverse();
  Eigen::Index one = 0;
  (solver.eigenvalues().array() - 1.0).abs().minCoeff(&one);
  std::vector<DoubleComplex> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (i != one) values.push_back(solver.eigenvalues()(i));
  }
  std::vector<ResolventTerm> terms;
  for (const Cluster& cluster : clustered(values)) {
    const auto is_member = [&](const DoubleComplex& value) {
      return std::find(cluster.values.begin(), cluster.values.end(), value) != cluster.values.end();
    };
    std::vector<ResolventTerm> own;
    bool conditioned = true;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const DoubleComplex value = solver.eigenvalues()(i);
      if (i == one || !is_member(value)) continue;
      conditioned = conditioned && columns.col(i).norm() * rows.row(i).norm() < kConditioned;
      if (std::abs(value) > kVanishing) own.push_back({value, columns.col(i), rows.row(i)});
    }
    if (conditioned) {
      terms.insert(terms.end(), own.begin(), own.end());
      continue;
    }
    std::vector<DoubleComplex> outside{1.0};
    std::copy_if(values.begin(), values.end(), std::back_inserter(outside),
                 [&](const DoubleComplex& value) { return !is_member(value); });
    add_circle(matrix, cluster, outside, terms);
  }
  return terms;
}

}  // namespace platoon
