#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace platoon {

/// Loss probability as a function of the gap: linear between the points of a table, constant before the first and
/// beyond the last one.
class LossByDistance {
public:
  using Point = std::array<double, 2>;  ///< gap [m], probability

  /// Throws std::invalid_argument unless there is at least one point, the gaps increase and the probabilities are in
  /// [0, 1).
  explicit LossByDistance(std::vector<Point> points);

  const std::vector<Point>& points() const { return points_; }
  double largest() const;  ///< of the probabilities
  bool operator==(const LossByDistance& other) const { return points_ == other.points_; }

  /// The probability at each of `count` gaps [m].
  void probabilities(const double* gaps, std::size_t count, double* probabilities) const;

private:
  std::vector<Point> points_;
};

}  // namespace platoon
