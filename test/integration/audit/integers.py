"""Polynomials on the unit circle in integers of 320 fractional bits, and their quotients with a 64-bit mantissa: no numerator or
denominator loses digits where it nearly vanishes."""

import numpy as np
from mpmath import mp, mpf

from audit.followers import COMPLEX, LONG, long

BITS = 320


def fixed(values):
    return np.array([int(mp.nint(mp.ldexp(mpf(x), BITS))) for x in values] + [None], dtype=object)[:-1]


def exact(x):
    """A number with a 64-bit mantissa in mpmath."""
    above, below = x.as_integer_ratio()
    return mpf(int(above)) / int(below)


def quotient(above, below):
    """above / below, element by element; below > 0."""
    result = np.zeros(len(above), LONG)
    for i, (a, b) in enumerate(zip(above, below)):
        if a:
            shift = max(0, 90 - abs(a).bit_length() + b.bit_length())
            result[i] = np.ldexp(LONG(int((a << shift) // b)), -shift)
    return result


class Points:
    """The points z = e^{jw}, or z = e^{-jw}."""

    def __init__(self, w, back=False):
        z = [mp.expj(-exact(x) if back else exact(x)) for x in np.asarray(w, LONG)]
        self.x, self.y = fixed([a.real for a in z]), fixed([a.imag for a in z])

    def __call__(self, p):
        """Real and imaginary parts of the polynomial p (highest power first), in units of 2^-BITS."""
        a, b = np.full(len(self.x), 0, dtype=object), np.full(len(self.x), 0, dtype=object)
        for c in fixed(p):
            a, b = ((a * self.x - b * self.y) >> BITS) + c, (a * self.y + b * self.x) >> BITS
        return a, b

    def square(self, p):
        """|p|^2 in units of 2^(-2 BITS)."""
        while len(p) > 1 and p[-1] == 0:  # |z| = 1
            p = p[:-1]
        a, b = self(p)
        return a * a + b * b

    def gain(self, n, d):
        """|n / d|^2"""
        if not any(n[:-1]) and not any(d[:-1]):
            return np.full(len(self.x), long(n[-1] / d[-1])) ** 2
        return quotient(self.square(n), self.square(d))

    def ratio(self, n, d):
        """n / d"""
        (a, b), (c, e) = self(n), self(d)
        result = np.zeros(len(a), COMPLEX)
        result.real, result.imag = quotient(a * c + b * e, c * c + e * e), quotient(b * c - a * e, c * c + e * e)
        return result
