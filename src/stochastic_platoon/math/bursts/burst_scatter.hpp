#pragma once

#include <Eigen/Dense>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "stochastic_platoon/math/bursts/burst_link.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

/// The losses of one link at the nodes of a quadrature: one row per node in (0, pi).
class BurstScatter {
public:
  /// `rule`: the half_circle_quadrature() with these nodes, applied in O(nodes^2); null for equally spaced nodes, on
  /// which the memory of the chain is a convolution in O(nodes log nodes).
  BurstScatter(const BurstLink& link, const Eigen::ArrayXd& node, const Eigen::ArrayXd& weight, const Quadrature* rule);

  Eigen::ArrayXcd passed;   ///< T_L
  Eigen::ArrayXd margin;    ///< 1 - |T_L|^2
  Eigen::ArrayXd surprise;  ///< |u|^2
  Eigen::ArrayXd moving;    ///< scattered spectrum of a motion of 1 m per step

  /// < g(w, nu) driven(nu) >_nu of each column: the spectrum that the losses scatter from a drive |u|^2 Phi.
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& driven) const;

private:
  void add_kernel(const Eigen::ArrayXd& node, const Quadrature& rule);
  Eigen::ArrayXd recalled(const Eigen::ArrayXd& driven) const;

  std::vector<std::complex<double>> memories_;
  Eigen::ArrayXd weight_;
  Eigen::MatrixXcd recalling_, remembered_, mirrored_;  ///< a, b and b at -nu, one row per node
  Eigen::MatrixXd outward_;                             ///< 2 Re l, one row per node
  Eigen::MatrixXd scattered_;                           ///< Re V, one column per node
  Eigen::RowVectorXd itself_;                           ///< e' sum_c V_c = itself V
  /// Mean over +-nu of 2 Re sum_m a_m(w) b_m(nu) y_m / (1 - y_m), one column per w; empty without rule.
  Eigen::MatrixXd kernel_;
  mutable Eigen::FFT<double> fft_;  ///< keeps its plan
};

}  // namespace platoon
