#pragma once

#include <complex>

namespace platoon {

/// a b without the checks of std::complex for infinities, which are slow.
template <typename Real>
std::complex<Real> product(const std::complex<Real>& a, const std::complex<Real>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Re(a b), likewise.
template <typename Real>
Real real_product(const std::complex<Real>& a, const std::complex<Real>& b) {
  return a.real() * b.real() - a.imag() * b.imag();
}

}  // namespace platoon
