#include "stochastic_platoon/math/response/attenuation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

constexpr long double kRounding = std::numeric_limits<long double>::epsilon();
constexpr long double kInfinite = std::numeric_limits<long double>::infinity();
constexpr std::size_t kSeriesTerms = 36;  // at a quarter of the radius of convergence
constexpr long double kSeriesReach = 0.25L;
constexpr long double kSmooth = 0.5L;  // fraction of the distance to a singularity that a Taylor bound may cover

long double power_of(long double x, int exponent) {
  long double result = 1.0L;
  for (int i = 0; i < exponent; ++i) result *= x;
  return result;
}

/// Whether two places are one pair to the accuracy of a search for zeros. Both then attenuate alike.
bool are_conjugate(const Complex& one, const Complex& other) {
  return one.imag() != 0.0L && std::abs(one - std::conj(other)) <= 64.0L * kRounding * std::abs(one);
}

/// The minimum of (v + s x + k x^2 / 2) / (c + x)^order over |x| <= r, c + x > 0.
struct QuotientMinimum {
  long double x, value;
};

QuotientMinimum least_quotient(long double v, long double s, long double k, long double c, long double r, int order) {
  const auto value_at = [&](long double x) { return (v + x * (s + 0.5L * k * x)) / power_of(c + x, order); };
  QuotientMinimum least{-r, value_at(-r)};
  const auto consider = [&](long double x) {
    if (!(std::abs(x) <= r)) return;
    const long double value = value_at(x);
    if (value < least.value) least = {x, value};
  };
  consider(r);
  // Zero slope: (s + k x) (c + x) = order (v + s x + k x^2 / 2).
  const auto power = static_cast<long double>(order);
  const long double a = k * (1.0L - power / 2.0L), b = k * c + (1.0L - power) * s, d = s * c - power * v;
  if (a == 0.0L) {
    if (b != 0.0L) consider(-d / b);
    return least;
  }
  const long double discriminant = b * b - 4.0L * a * d;
  if (discriminant < 0.0L) return least;
  const long double q = -0.5L * (b + std::copysign(std::sqrt(discriminant), b));
  consider(q / a);
  if (q != 0.0L) consider(d / q);
  return least;
}

}  // namespace

/// t in [centre - radius, centre + radius].
struct Attenuation::Piece {
  long double centre, radius;
};

struct Attenuation::Bounds {
  long double lower;      ///< lower bound of the quotient over the piece
  long double candidate;  ///< t of a possible minimum of the quotient
  long double noise;      ///< rounding error of the quotient
};

Attenuation::Attenuation(const std::vector<GainFactor>& factors) {
  long double largest = 0.0L;
  series_.assign(kSeriesTerms + 1, 0.0L);
  const auto add = [&](const Complex& s, long double weight) {
    if (s == 0.0L) throw std::invalid_argument("T(z): a pole or zero at z = 1: must have none");
    const Complex u = -2.0L * (1.0L + s) / (s * s);
    if (u == 0.0L) return;
    terms_.push_back({u.real(), u.imag(), std::abs(u)});
    largest = std::max(largest, terms_.back().size);
    Complex power = 1.0L;
    for (std::size_t m = 1; m <= kSeriesTerms; ++m) {
      power = {power.real() * u.real() - power.imag() * u.imag(), power.real() * u.imag() + power.imag() * u.real()};
      series_[m] -= weight * power.real() / static_cast<long double>(m);
    }
  };
  const auto add_all = [&](const std::vector<Complex>& places, long double weight) {
    std::vector<Complex> alone;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (k + 1 < places.size() && are_conjugate(places[k], places[k + 1])) {
        add(places[k++], 2.0L * weight);
      } else {
        alone.push_back(places[k]);
      }
    }
    groups_.push_back({terms_.size(), 2.0L * weight});
    for (const Complex& s : alone) add(s, weight);
    groups_.push_back({terms_.size(), weight});
  };
  for (const GainFactor& factor : factors) {
    add_all(factor.poles, factor.count);
    add_all(factor.zeros, -factor.count);
    zeros_at_one_ += factor.count * static_cast<long double>(factor.zeros_at_one);
  }
  series_end_ = terms_.empty() ? 1.0L : std::min(0.5L, kSeriesReach / largest);
}

Attenuation::Value Attenuation::at(long double t) const {
  Value sum = without_zeros_at_one(t);
  if (zeros_at_one_ == 0.0L) return sum;
  return {sum.value - zeros_at_one_ * std::log(t), sum.slope - zeros_at_one_ / t,
          sum.curvature + zeros_at_one_ / (t * t)};
}

// -ln t is convex and falls: near t = 0 its value at the end of the piece bounds it, elsewhere its Taylor polynomial.
Attenuation::Logarithm Attenuation::logarithm(const Piece& piece) const {
  if (zeros_at_one_ == 0.0L) return {0.0L, 0.0L, 0.0L, 0.0L};
  const long double c = piece.centre, from = c - piece.radius;
  if (from <= kSmooth * c) return {-zeros_at_one_ * std::log(c + piece.radius), 0.0L, 0.0L, 0.0L};
  return {-zeros_at_one_ * std::log(c), -zeros_at_one_ / c, zeros_at_one_ / (c * c),
          2.0L * zeros_at_one_ / (from * from * from)};
}

Attenuation::Value Attenuation::without_zeros_at_one(long double t) const {
  Value sum{0.0L, 0.0L, 0.0L};
  if (t < series_end_) {
    for (std::size_t m = kSeriesTerms; m >= 1; --m) {  // of a(t) / t
      sum.curvature = sum.curvature * t + 2.0L * sum.slope;
      sum.slope = sum.slope * t + sum.value;
      sum.value = sum.value * t + series_[m];
    }
    return {t * sum.value, t * sum.slope + sum.value, t * sum.curvature + 2.0L * sum.slope};
  }
  std::size_t k = 0;
  for (const Group& group : groups_) {
    long double sizes = 1.0L, slope = 0.0L, curvature = 0.0L;
    for (; k < group.end; ++k) {
      const Term& u = terms_[k];
      const long double real = 1.0L - u.real * t, imag = -u.imag * t, size = real * real + imag * imag;
      if (size == 0.0L) return {-group.weight * kInfinite, 0.0L, 0.0L};
      sizes *= size;
      const long double q_real = (u.real * real + u.imag * imag) / size,
                        q_imag = (u.imag * real - u.real * imag) / size;
      slope -= q_real;
      curvature -= q_real * q_real - q_imag * q_imag;
    }
    sum.value += group.weight * 0.5L * std::log(sizes);
    sum.slope += group.weight * slope;
    sum.curvature += group.weight * curvature;
  }
  return sum;
}

long double Attenuation::slope(long double t) const {
  if (t < series_end_) return at(t).slope;
  long double sum = zeros_at_one_ == 0.0L ? 0.0L : -zeros_at_one_ / t;
  std::size_t k = 0;
  for (const Group& group : groups_) {
    for (; k < group.end; ++k) {
      const Term& u = terms_[k];
      const long double real = 1.0L - u.real * t, imag = -u.imag * t, size = real * real + imag * imag;
      if (size == 0.0L) return 0.0L;
      sum -= group.weight * (u.real * real + u.imag * imag) / size;
    }
  }
  return sum;
}

long double Attenuation::quotient(long double t, int order) const {
  if (t < series_end_) {
    long double sum = 0.0L;
    for (std::size_t m = kSeriesTerms; m >= static_cast<std::size_t>(order) && m >= 1; --m) sum = sum * t + series_[m];
    if (zeros_at_one_ > 0.0L) return sum * t - zeros_at_one_ * std::log(t);
    return order == 0 ? sum * t : sum;
  }
  return at(t).value / power_of(std::min(t, 1.0L), order);
}

Attenuation::Bounds Attenuation::bounds_by_series(const Piece& piece, int order) const {
  const long double end = piece.centre + piece.radius;
  long double value = 0.0L, slope = 0.0L, half_curvature = 0.0L, third = 0.0L, size = 0.0L;
  for (std::size_t m = kSeriesTerms + 1; m-- > static_cast<std::size_t>(order);) {
    half_curvature = half_curvature * piece.centre + slope;
    slope = slope * piece.centre + value;
    value = value * piece.centre + series_[m];
    size = size * piece.centre + std::abs(series_[m]);
    const auto j = static_cast<long double>(m) - static_cast<long double>(order);
    if (j >= 3.0L) third = third * end + j * (j - 1.0L) * (j - 2.0L) * std::abs(series_[m]);
  }
  const long double cube = piece.radius * piece.radius * piece.radius;
  const Logarithm zeros = logarithm(piece);
  const QuotientMinimum least =
      least_quotient(value + zeros.value - (third + zeros.third) * cube / 6.0L, slope + zeros.slope,
                     2.0L * half_curvature + zeros.curvature, 1.0L, piece.radius, 0);
  return {least.value, piece.centre + least.x, 8.0L * kRounding * size};
}

Attenuation::Bounds Attenuation::bounds(const Piece& piece, int order) const {
  if (piece.centre < series_end_) return bounds_by_series(piece, order);
  long double value = 0.0L, slope = 0.0L, curvature = 0.0L, third = 0.0L, rounding = 0.0L;
  std::size_t k = 0;
  for (const Group& group : groups_) {
    long double sizes = 1.0L, smooth_slope = 0.0L, smooth_curvature = 0.0L, smooth_third = 0.0L;
    for (; k < group.end; ++k) {
      const Term& u = terms_[k];
      const long double real = 1.0L - u.real * piece.centre, imag = -u.imag * piece.centre;
      const long double size = real * real + imag * imag, length = std::sqrt(size), reach = u.size * piece.radius;
      const long double inverse = 1.0L / std::max(length, kRounding);
      rounding += std::abs(group.weight) * (1.0L + u.size * piece.centre * inverse);
      if (reach > kSmooth * length) {  // bounds |1 - u t| by its largest or smallest value
        const long double bound = group.weight < 0.0L ? length + reach : length - reach;
        if (bound <= 0.0L) return {-kInfinite, piece.centre, 0.0L};
        sizes *= bound * bound;
        continue;
      }
      sizes *= size;
      const long double q_real = (u.real * real + u.imag * imag) * inverse * inverse,
                        q_imag = (u.imag * real - u.real * imag) * inverse * inverse;
      smooth_slope -= q_real;
      smooth_curvature -= q_real * q_real - q_imag * q_imag;
      const long double nearest = u.size / (length - reach);
      smooth_third += 2.0L * nearest * nearest * nearest;
    }
    value += group.weight * 0.5L * std::log(sizes);
    slope += group.weight * smooth_slope;
    curvature += group.weight * smooth_curvature;
    third += std::abs(group.weight) * smooth_third;
  }
  const long double cube = piece.radius * piece.radius * piece.radius;
  const Logarithm zeros = logarithm(piece);
  const QuotientMinimum least =
      least_quotient(value + zeros.value - (third + zeros.third) * cube / 6.0L, slope + zeros.slope,
                     curvature + zeros.curvature, piece.centre, piece.radius, order);
  const long double noise = 8.0L * kRounding * rounding / power_of(std::min(piece.centre, 1.0L), order);
  return {least.value, piece.centre + least.x, noise};
}

Attenuation::Minimum Attenuation::least(int order, long double accuracy, int most_pieces) const {
  std::vector<Piece> pieces;
  const auto add = [&pieces](long double from, long double to) {
    pieces.push_back({from + (to - from) / 2.0L, (to - from) / 2.0L});
  };
  add(1.0L, 2.0L);
  long double from = series_end_;
  while (from < 1.0L) {
    add(from, std::min(2.0L * from, 1.0L));
    from *= 2.0L;
  }
  add(0.0L, series_end_);
  const long double first = zeros_at_one_ > 0.0L ? 2.0L : 0.0L;
  Minimum best{first, quotient(first, order), true};
  const auto consider = [&](long double t, int power) {
    const long double value = quotient(t, power);
    if (value < best.value) best = {t, value, true};
  };
  for (int count = 0; !pieces.empty() && count < most_pieces; ++count) {
    check_interruption();
    const Piece piece = pieces.back();
    pieces.pop_back();
    const int power = piece.centre > 1.0L ? 0 : order;
    const Bounds found = bounds(piece, power);
    const auto spent = [&] {
      return found.lower >= best.value - std::max(accuracy * std::abs(best.value), found.noise);
    };
    if (spent()) continue;
    consider(piece.centre, power);
    consider(found.candidate, power);
    if (spent() || piece.radius <= kRounding * piece.centre) continue;
    add(piece.centre - piece.radius, piece.centre);
    add(piece.centre, piece.centre + piece.radius);
  }
  best.is_global = pieces.empty();
  return best;
}

}  // namespace platoon
