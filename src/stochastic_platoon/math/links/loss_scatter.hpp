#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/loss_filter.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

/// The nodes of a mean over the circle in (0, pi), and the weights of a mean over them.
struct SpectralNodes {
  /// Equally spaced frequencies w_j = 2 pi (j + 1/2) / n, which converge geometrically with n, a power of two.
  explicit SpectralNodes(std::size_t count);

  /// The nodes of a half_circle_quadrature(), which resolves narrow features of slow vehicles and near the border of
  /// stability with few nodes, and need not resolve the memory of losses (see MemoryWeights).
  explicit SpectralNodes(Quadrature quadrature);

  Eigen::Index count() const { return static_cast<Eigen::Index>(rule.node.size()); }

  Quadrature rule;
  bool equally_spaced;
  std::vector<CirclePoint> points;
  Eigen::ArrayXd weight;
};

/// The sum of at least one spectrum.
inline Eigen::ArrayXd sum_of(std::vector<Eigen::ArrayXd> spectra) {
  for (std::size_t j = 1; j < spectra.size(); ++j) spectra.front() += spectra[j];
  return std::move(spectra.front());
}

/// The losses of one link at the nodes: what the link passes, and the spectrum that it scatters from one that is sent.
class LossScatter {
public:
  /// The memory of a chain is a convolution in O(nodes log nodes) on equally spaced nodes, and O(nodes^2) on those of a
  /// quadrature.
  LossScatter(const LossFilter& losses, const SpectralNodes& nodes);

  const std::vector<LossFilter::Value>& effects() const { return effects_; }  ///< at each node

  /// g(w, 0), the spectrum that a constant drive of 1 scatters. A platoon that moves v metres per step drives the
  /// losses of a position by v slope().
  const Eigen::ArrayXd& of_constant_drive() const { return of_constant_drive_; }
  double slope() const { return slope_; }

  /// The drives of the losses, numbers >= 0: E e^2 alone for independent losses, the spectrum |u|^2 Phi at all nodes
  /// for a chain (see LossFilter, LossKernel). One column per spectrum.
  Eigen::Index dimensions() const { return returned_.size() > 0 ? 1 : weight_.size(); }
  Eigen::MatrixXd drives(const Eigen::Ref<const Eigen::MatrixXd>& sent) const;

  /// The scattered spectrum of each column of drives: < g(w, nu) |u(nu)|^2 Phi(nu) >_nu.
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& drives) const;

  /// The scattered cross spectrum of two signals that are lost together: < g(w, nu) |u(nu)|^2 Phi(nu) >_nu, with
  /// Phi(-nu) the conjugate of Phi(nu). Throws std::invalid_argument for losses with memory on nodes of a quadrature.
  Eigen::ArrayXcd of_cross_spectrum(const Eigen::ArrayXcd& sent) const;

private:
  void add_chain(const LossKernel& kernel, const SpectralNodes& nodes);
  void add_memory(const SpectralNodes& nodes);
  void add_decay(Eigen::Index n);
  Eigen::ArrayXd recalled(const Eigen::ArrayXd& driven, bool is_odd) const;
  /// < value y_m / (1 - y_m) >_nu at each node, of values ahead(nu) and behind(nu) at nu and -nu; hermitian: of a real
  /// lambda_m, with behind the conjugate of ahead.
  Eigen::ArrayXcd delayed(Eigen::Index memory, const Eigen::ArrayXcd& ahead, const Eigen::ArrayXcd& behind) const;
  Eigen::ArrayXcd delayed_hermitian(Eigen::Index memory, const Eigen::ArrayXcd& ahead) const;

  std::vector<LossFilter::Value> effects_;
  double slope_;
  Eigen::ArrayXd weight_, of_constant_drive_;
  Eigen::ArrayXd innovation_;  ///< |(1 - L) F|^2 of independent losses, |u|^2 of a chain
  Eigen::ArrayXd returned_;    ///< kappa |F|^2; empty for a chain
  std::vector<std::complex<double>> memories_;
  Eigen::MatrixXcd recalling_, remembered_, mirrored_;  ///< a, b and b at -nu, one row per node
  Eigen::MatrixXd outward_, odd_outward_;               ///< 2 Re l and -2 Im l, one row per node
  Eigen::MatrixXd scattered_, odd_scattered_;           ///< Re V and Im V, one column per node
  Eigen::RowVectorXd itself_;                           ///< e' sum_c V_c = itself V
  /// Mean over +-nu of 2 Re sum_m a_m(w) b_m(nu) y_m / (1 - y_m), one column per w; empty on equally spaced nodes.
  Eigen::MatrixXd kernel_;
  Eigen::ArrayXcd turn_;    ///< e^{-j pi t / n}, t from 0 to n / 2 - 1
  Eigen::MatrixXcd decay_;  ///< lambda_m^t / (1 - lambda_m^n), t from 1 to n, the last first; on equally spaced nodes
  mutable Eigen::FFT<double> fft_;  ///< keeps its plan
};

}  // namespace platoon
