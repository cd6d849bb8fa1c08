#include "stochastic_platoon/math/numerics/quadrature.hpp"

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

namespace {

using boost::math::double_constants::pi;

constexpr int kMostHalvings = 26;
constexpr double kShortest = 1e-13;  // panel length; shorter panels have nodes that nearly coincide

struct Panel {
  long double from;
  long double to;
  long double length() const { return to - from; }
};

double squared_distance(const Panel& panel, std::complex<double> point) {
  const long double nearest = std::min(std::max<long double>(point.real(), panel.from), panel.to);
  return std::norm(point - static_cast<double>(nearest));
}

/// The images in and around [0, pi] of a frequency under w -> -w and w -> w + 2 pi.
std::vector<std::complex<double>> images(const std::vector<std::complex<double>>& frequencies) {
  std::vector<std::complex<double>> result;
  for (const std::complex<double>& w : frequencies) {
    if (w.imag() == 0.0) {
      throw std::invalid_argument("singular frequency " + std::to_string(w.real()) + ": must not be real");
    }
    for (const double turn : {-2.0 * pi, 0.0, 2.0 * pi}) {
      result.push_back(w + turn);
      result.push_back(turn - w);
    }
  }
  return result;
}

/// Halves a panel until every singularity is at least half its length away; kGaussNodes nodes then have an error of
/// 4e-19.
void add_resolved(std::vector<Panel>& panels, const Panel& panel, const std::vector<std::complex<double>>& singular) {
  double clearance = 0.0625;
  for (const std::complex<double>& w : singular) clearance = std::min(clearance, squared_distance(panel, w));
  if (panel.length() * panel.length() <= 4.0 * clearance || panel.length() <= kShortest) {
    panels.push_back(panel);
    return;
  }
  const long double middle = panel.from + panel.length() / 2.0L;
  add_resolved(panels, {panel.from, middle}, singular);
  add_resolved(panels, {middle, panel.to}, singular);
}

/// Number of halvings towards a peak of a product of this number of factors with these singularities.
int halvings_towards(double peak, const std::vector<std::complex<double>>& singular, std::size_t factors) {
  double distance = 1.0;
  for (const std::complex<double>& w : singular) distance = std::min(distance, std::abs(w - peak));
  const double narrowest = 0.25 * distance / std::sqrt(static_cast<double>(factors));
  return std::min(kMostHalvings, static_cast<int>(std::ceil(-std::log2(narrowest))));
}

/// Adds cuts of [0, pi] whose spacing halves towards the peak from both sides.
void add_graded_cuts(double peak, int halvings, std::vector<long double>& cuts) {
  if (peak < 0.0 || peak > pi) return;
  cuts.push_back(peak);
  for (int j = 0; j <= halvings; ++j) {
    const double offset = std::ldexp(1.0, -j);
    if (peak - offset > 0.0) cuts.push_back(peak - offset);
    if (peak + offset < pi) cuts.push_back(peak + offset);
  }
}

/// The nodes as zeros of the Legendre polynomial P_n, by Newton's method.
Quadrature computed_gauss_legendre() {
  constexpr int n = kGaussNodes;
  Quadrature rule;
  for (int i = 0; i < n; ++i) {
    double x = -std::cos(pi * (i + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p = x, before = 1.0;
      for (unsigned l = 1; l < n; ++l) before = std::exchange(p, boost::math::legendre_next(l, x, p, before));
      slope = n * (before - x * p) / (1.0 - x * x);
      const double step = p / slope;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule.node.push_back(x);
    rule.weight.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

/// Adds the nodes of a panel that begins at `from`, cut into equal pieces.
void add_pieces(long double from, long double half_length, int pieces, Quadrature& rule) {
  const Quadrature& gauss = gauss_legendre();
  const long double half = half_length / pieces;
  for (int piece = 0; piece < pieces; ++piece) {
    const long double middle = from + (2.0L * piece + 1.0L) * half;
    rule.middle.push_back(middle);
    rule.half_length.push_back(half);
    for (std::size_t k = 0; k < gauss.node.size(); ++k) {
      rule.node.push_back(middle + half * gauss.node[k]);
      rule.weight.push_back(gauss.weight[k] * static_cast<double>(half) / pi);
    }
  }
}

/// Factors of the values at the Gauss nodes in the last two Legendre coefficients of their interpolation.
std::array<std::array<double, kGaussNodes>, 2> legendre_tail() {
  std::array<std::array<double, kGaussNodes>, 2> factors;
  for (std::size_t k = 0; k < kGaussNodes; ++k) {
    const auto x = static_cast<double>(gauss_legendre().node[k]);
    const double weight = gauss_legendre().weight[k];
    double before = 1.0, legendre = x;  // P_0, P_1
    for (unsigned l = 1; l + 2 < kGaussNodes; ++l)
      before = std::exchange(legendre, boost::math::legendre_next(l, x, legendre, before));
    factors[0][k] = (kGaussNodes - 1.5) * weight * legendre;
    factors[1][k] = (kGaussNodes - 0.5) * weight * boost::math::legendre_next(kGaussNodes - 2, x, legendre, before);
  }
  return factors;
}

}  // namespace

const Quadrature& gauss_legendre() {
  static const Quadrature rule = computed_gauss_legendre();
  return rule;
}

bool is_converged(double change, double change_before) {
  return change <= 1e-13 || (change <= 1e-10 && change >= 0.1 * change_before);
}

OscillatingWeights::OscillatingWeights(const Quadrature& rule, double m) {
  constexpr double kResolved = 4.0;  // largest theta at which a panel's own weights integrate to the last digit
  if (rule.half_length.empty() || m * *std::max_element(rule.half_length.begin(), rule.half_length.end()) <= kResolved)
    return;
  weights_.resize(rule.node.size());
  for (std::size_t panel = 0; panel < rule.half_length.size(); ++panel) {
    const auto theta = static_cast<double>(m * rule.half_length[panel]);
    applies_.push_back(theta > kResolved ? 1 : 0);
    if (theta <= kResolved) continue;
    std::vector<std::complex<double>> moments;  // (2 l + 1) (-j)^l j_l(theta)
    std::complex<double> turn = std::polar(1.0, static_cast<double>(-m * rule.middle[panel]));
    for (unsigned l = 0; l < kGaussNodes; ++l, turn *= std::complex<double>(0.0, -1.0))
      moments.push_back(turn * (2.0 * l + 1.0) * boost::math::sph_bessel(l, theta));
    for (std::size_t k = panel * kGaussNodes; k < (panel + 1) * kGaussNodes; ++k) {
      const auto x = static_cast<double>((rule.node[k] - rule.middle[panel]) / rule.half_length[panel]);
      double before = 0.0, legendre = 1.0;
      std::complex<double> sum = 0.0;
      for (unsigned l = 0; l < kGaussNodes; ++l) {
        sum += moments[l] * legendre;
        before = std::exchange(legendre, boost::math::legendre_next(l, x, legendre, before));
      }
      weights_[k] = rule.weight[k] * sum;
    }
  }
}

Quadrature half_circle_quadrature(const std::vector<std::complex<double>>& singular, const std::vector<double>& peaks,
                                  int refinement, std::optional<std::size_t> factors) {
  const std::vector<std::complex<double>> around = images(singular);
  std::vector<long double> cuts{0.0L, boost::math::long_double_constants::pi};
  for (const double peak : peaks)
    add_graded_cuts(peak, factors ? halvings_towards(peak, around, *factors) : kMostHalvings, cuts);
  std::sort(cuts.begin(), cuts.end());
  const auto close = [](long double a, long double b) { return b - a < 1e-14L; };
  cuts.erase(std::unique(cuts.begin(), cuts.end(), close), cuts.end());
  cuts.back() = boost::math::long_double_constants::pi;  // and not a peak there, in double
  std::vector<Panel> panels;
  for (std::size_t i = 1; i < cuts.size(); ++i) add_resolved(panels, {cuts[i - 1], cuts[i]}, around);
  Quadrature rule;
  for (const Panel& panel : panels) add_pieces(panel.from, panel.length() / 2.0L, 1 << refinement, rule);
  return rule;
}

Quadrature with_panels_cut(const Quadrature& rule, const std::vector<int>& pieces) {
  Quadrature finer;
  for (std::size_t panel = 0; panel < pieces.size(); ++panel) {
    const long double half = rule.half_length[panel];
    add_pieces(rule.middle[panel] - half, half, pieces[panel], finer);
  }
  return finer;
}

std::vector<double> interpolation_errors(const Quadrature& rule, const double* values) {
  constexpr std::size_t n = kGaussNodes;
  static const auto tail = legendre_tail();
  std::vector<double> errors;
  for (std::size_t panel = 0; panel < rule.middle.size(); ++panel, values += n) {
    double error = 0.0;
    for (const std::array<double, n>& factors : tail)
      error = std::max(error, std::abs(std::inner_product(factors.begin(), factors.end(), values, 0.0)));
    errors.push_back(error);
  }
  return errors;
}

}  // namespace platoon
