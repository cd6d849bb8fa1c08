#pragma once

#include <Eigen/Core>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "stochastic_platoon/math/links/loss_kernel.hpp"

namespace platoon {

/// The losses that the inputs of a packet share, at the frequencies w_k = 2 pi (k + 1/2) / n, k = 0 .. n / 2 - 1: what
/// they pass on average, and the cross spectra that they scatter. See LossKernel for the symbols.
class HearingScatter {
public:
  HearingScatter(const LossModel& loss, std::size_t n);

  const Eigen::ArrayXcd& passed() const { return passed_; }  ///< T_L

  /// < g(w, nu) |u(nu)|^2 f(nu) >_nu of a cross spectrum f sent over two links with these losses.
  Eigen::ArrayXcd operator()(const Eigen::ArrayXcd& sent) const;

  /// g(w, 0): from the squared drive of a steady motion.
  const Eigen::ArrayXd& of_steady_motion() const { return of_steady_; }
  double slope() const { return kernel_.slope(); }  ///< c_1 + 2 c_2 + ...
  bool forgets() const { return forgets_; }         ///< a lost value is 0
  double passed_at_rest() const { return passed_at_rest_; }

private:
  Eigen::ArrayXcd remembered(const Eigen::ArrayXcd& driven) const;

  LossKernel kernel_;
  bool forgets_;
  double passed_at_rest_;
  Eigen::ArrayXcd passed_;
  Eigen::ArrayXd drive_, of_steady_, itself_;         ///< |u|^2; g(w, 0); e' sum_c V_c
  Eigen::MatrixXcd outward_, scattered_, recalling_;  ///< l, V and a, a column per frequency
  Eigen::MatrixXcd inward_, mirrored_;                ///< b at nu and at -nu, a column per frequency
  mutable Eigen::FFT<double> fft_;
};

}  // namespace platoon
