#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace platoon {

/// Nodes and weights of a quadrature rule: integral f ~ sum_k weight[k] f(node[k]). Nodes in extended precision: next
/// to a peak of width 1e-4, rounding to double would move them by 1e-12 of the width.
struct Quadrature {
  std::vector<long double> node;
  std::vector<double> weight;
  std::vector<long double> middle, half_length;  ///< per panel of kGaussNodes nodes, in order; empty without panels
};

constexpr int kGaussNodes = 16;  ///< per panel

/// Gauss-Legendre rule of kGaussNodes nodes on [-1, 1].
const Quadrature& gauss_legendre();

/// Weights at the rule's nodes for integrals of f(w) e^{-j m w}, with f smooth on each panel. Exact for polynomials f
/// of degree 15 on a panel, however fast e^{-j m w} oscillates (L. N. G. Filon, Proc. R. Soc. Edinburgh 49, 1928, with
/// Legendre polynomials: the integral of P_l(x) e^{-j theta x} over [-1, 1] is 2 (-j)^l j_l(theta), j_l the spherical
/// Bessel function).
class OscillatingWeights {
public:
  OscillatingWeights(const Quadrature& rule, double m);

  /// Whether e^{-j m w} oscillates too fast on the node's panel for the rule's own weights.
  bool applies_to(std::size_t node) const { return !weights_.empty() && applies_[node / kGaussNodes] != 0; }
  std::complex<double> operator[](std::size_t node) const { return weights_[node]; }

private:
  std::vector<char> applies_;  ///< per panel
  std::vector<std::complex<double>> weights_;
};

/// Whether further refinement of a quadrature gains nothing, given its last two relative changes: it has settled, or it
/// changes only by the rounding of the integrand, which refinement does not reduce.
bool is_converged(double change, double change_before);

/// Quadrature over w in [0, pi] for even 2 pi periodic functions, with weights divided by pi: the sum is their mean
/// over the circle, (1/2pi) integral from -pi to pi.
///
/// Panels have kGaussNodes nodes. A panel is at most twice as long as its distance to the nearest complex frequency in
/// `singular` (or its mirror images), so convergence is geometric however close to the real axis that frequency lies.
/// Towards the real frequencies in `peaks` the panels halve 26 times, for functions that narrow there, or as often as
/// resolves a product of this number of `factors`, whose peaks narrow like its square root. Every panel is then cut
/// into 2^refinement pieces. Throws std::invalid_argument for a singular frequency on the real axis.
Quadrature half_circle_quadrature(const std::vector<std::complex<double>>& singular, const std::vector<double>& peaks,
                                  int refinement = 0, std::optional<std::size_t> factors = {});

/// The rule with each panel cut into its number of equal pieces.
Quadrature with_panels_cut(const Quadrature& rule, const std::vector<int>& pieces);

/// Error per panel of the interpolation of these values at the rule's nodes: the larger of the last two Legendre
/// coefficients. For a mean over the panel it is the square of that, relatively.
std::vector<double> interpolation_errors(const Quadrature& rule, const double* values);

/// The largest relative change from a to b, ignoring entries of b that are 0 or not finite.
inline double largest_change(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(b[i]) || b[i] == 0.0) continue;
    const double change = std::abs((a[i] - b[i]) / b[i]);
    largest = std::isnan(change) ? std::numeric_limits<double>::infinity() : std::max(largest, change);
  }
  return largest;
}

/// values(refinement) of a quadrature, refined until the values settle, at most four times.
template <class Values>
std::vector<double> refined(const Values& values) {
  std::vector<double> coarse = values(0);
  double before = std::numeric_limits<double>::infinity();
  for (int refinement = 1; refinement <= 4; ++refinement) {
    std::vector<double> fine = values(refinement);
    const double change = largest_change(coarse, fine);
    if (is_converged(change, before)) return fine;
    coarse.swap(fine);
    before = change;
  }
  return coarse;
}

}  // namespace platoon
