#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace platoon {

/// Nodes and weights of a quadrature rule: integral f ~ sum_k weight[k] f(node[k]).
struct Quadrature {
  std::vector<double> node;
  std::vector<double> weight;
  std::vector<double> middle, half_length;  ///< of the panels, of equally many nodes each, in their order
};

/// Gauss-Legendre rule on [-1, 1]. Throws std::invalid_argument unless count >= 1.
Quadrature gauss_legendre(int count);

/// Weights of the rule's nodes for integrals of f(w) e^{-j m w}, f smooth on each panel: exact for polynomials of
/// degree 15 there, however often e^{-j m w} turns (L. N. G. Filon, Proc. R. Soc. Edinburgh 49, 1928, with Legendre
/// polynomials: the integral of P_l(x) e^{-j theta x} over [-1, 1] is 2 (-j)^l j_l(theta), j_l the spherical Bessel
/// function).
class OscillatingWeights {
public:
  OscillatingWeights(const Quadrature& rule, double m);

  /// Whether e^{-j m w} turns so often on the node's panel that the rule's own weights do not resolve it.
  bool applies_to(std::size_t node) const { return !weights_.empty() && applies_[node / per_panel_] != 0; }
  std::complex<double> operator[](std::size_t node) const { return weights_[node]; }

private:
  std::size_t per_panel_ = 1;
  std::vector<char> applies_;
  std::vector<std::complex<double>> weights_;
};

/// Whether a quadrature that was refined twice, with these relative changes, will not get better: it has
/// settled, or it changes by the rounding of the integrand, which refinement does not reduce.
bool is_converged(double change, double change_before);

/// Quadrature over w in [0, pi] for even 2 pi periodic functions, weights divided by pi: their mean over the
/// circle, (1/2pi) integral from -pi to pi.
///
/// Panels of 16 Gauss nodes. A panel is no longer than twice its distance to the nearest complex frequency in
/// `singular` (or its mirror images), which makes convergence geometric however close to the circle that
/// lies; towards the real frequencies in `peaks` panels halve 26 times, for functions that narrow there.
/// Every panel is cut in 2^refinement. Throws std::invalid_argument for a singular frequency on the real
/// axis.
Quadrature half_circle_quadrature(const std::vector<std::complex<double>>& singular, const std::vector<double>& peaks,
                                  int refinement = 0);

}  // namespace platoon
