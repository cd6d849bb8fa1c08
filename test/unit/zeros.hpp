#pragma once

#include <complex>
#include <random>
#include <vector>

#include "stochastic_platoon/math/numerics/polynomial.hpp"

namespace platoon {

/// Monic polynomial with these zeros; a complex one stands for itself and its conjugate.
inline Polynomial polynomial_with_zeros(const std::vector<std::complex<double>>& zeros) {
  Polynomial p = Polynomial::Ones(1);
  for (const std::complex<double>& zero : zeros) {
    if (zero.imag() == 0.0) {
      p = multiply(p, Eigen::Vector2d(1.0, -zero.real()));
    } else {
      p = multiply(p, Eigen::Vector3d(1.0, -2.0 * zero.real(), std::norm(zero)));
    }
  }
  return p;
}

/// Monic polynomial with these zeros, which come in conjugate pairs.
inline Polynomial polynomial_with_all_zeros(const std::vector<std::complex<double>>& zeros) {
  Eigen::VectorXcd p = Eigen::VectorXcd::Ones(1);
  for (const std::complex<double>& zero : zeros) {
    Eigen::VectorXcd next = Eigen::VectorXcd::Zero(p.size() + 1);
    next.head(p.size()) = p;
    next.tail(p.size()) -= zero * p;
    p = next;
  }
  return p.real();
}

/// Monic polynomial of this degree with random real and complex zeros inside the circle of radius 0.95.
template <typename Generator>
Polynomial random_polynomial(int degree, Generator& generator) {
  std::uniform_real_distribution<double> real(-0.95, 0.95), modulus(0.05, 0.95), angle(0.1, 3.0);
  std::vector<std::complex<double>> zeros;
  while (degree > 0) {
    const bool pair = degree > 1 && generator() % 2 == 0;
    zeros.push_back(pair ? std::polar(modulus(generator), angle(generator)) : std::complex<double>(real(generator)));
    degree -= pair ? 2 : 1;
  }
  return polynomial_with_zeros(zeros);
}

}  // namespace platoon
