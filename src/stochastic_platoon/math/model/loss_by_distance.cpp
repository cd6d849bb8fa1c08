#include "stochastic_platoon/math/model/loss_by_distance.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace detail {

// Adds the rise of the probability between two points, up to each gap.
PLATOON_VECTOR_CLONES
void add_rise(const double* gaps, std::size_t count, double from, double length, double rise, double* probabilities) {
  for (std::size_t r = 0; r < count; ++r) {
    const double way = (gaps[r] - from) / length;
    probabilities[r] += rise * (way < 0.0 ? 0.0 : way < 1.0 ? way : 1.0);
  }
}

}  // namespace detail

LossByDistance::LossByDistance(std::vector<Point> points) : points_(std::move(points)) {
  if (points_.empty()) throw std::invalid_argument("no points: must be at least one");
  for (std::size_t j = 0; j < points_.size(); ++j) {
    const auto [gap, probability] = points_[j];
    if (!(probability >= 0.0 && probability < 1.0))
      throw std::invalid_argument(formatted("probability %g: must be from 0 to below 1", probability));
    if (j > 0 && !(gap > points_[j - 1][0]))
      throw std::invalid_argument(formatted("gap %g after %g: gaps must increase", gap, points_[j - 1][0]));
  }
}

double LossByDistance::largest() const {
  return (*std::max_element(points_.begin(), points_.end(),
                            [](const Point& one, const Point& other) { return one[1] < other[1]; }))[1];
}

void LossByDistance::probabilities(const double* gaps, std::size_t count, double* probabilities) const {
  std::fill_n(probabilities, count, points_.front()[1]);
  for (std::size_t j = 1; j < points_.size(); ++j) {
    const auto [from, before] = points_[j - 1];
    const auto [to, after] = points_[j];
    detail::add_rise(gaps, count, from, to - from, after - before, probabilities);
  }
}

bool operator==(const LossByDistance& one, const LossByDistance& other) {
  return one.points() == other.points();
}

}  // namespace platoon
