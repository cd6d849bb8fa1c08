"""Polynomials in 120 digits: lists of coefficients, highest power first."""

import numpy as np
from mpmath import mp, mpc, mpf, polyroots


def times(p, q):
    product = [mpf(0)] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        if a != 0:
            for j, b in enumerate(q):
                product[i + j] += a * b
    return product


def plus(p, q):
    size = max(len(p), len(q))
    p = [mpf(0)] * (size - len(p)) + list(p)
    q = [mpf(0)] * (size - len(q)) + list(q)
    return [a + b for a, b in zip(p, q)]


def value(p, z):
    result = mpf(0)
    for a in p:
        result = result * z + a
    return result


def slope(p):
    degree = len(p) - 1
    return [a * (degree - i) for i, a in enumerate(p[:-1])] or [mpf(0)]


def trimmed(p):
    first = next((i for i, a in enumerate(p) if a != 0), len(p) - 1)
    return p[first:]


def without_factor(p, zero):
    """The quotient p / (z - zero) without the remainder."""
    quotient, carried = [], mpf(0)
    for a in p[:-1]:
        carried = carried * zero + a
        quotient.append(carried)
    return quotient


def taylor_about_one(p, terms):
    """The coefficients of p in powers of z - 1, lowest power first, at most `terms`."""
    coefficients = []
    while p and len(coefficients) < terms:
        coefficients.append(value(p, mpf(1)))
        p = without_factor(p, mpf(1))
    return coefficients


BITS = 800  # fractional bits of the fixed-point numbers in the root finder


def fixed(values):
    return np.array([int(mp.nint(mp.ldexp(x, BITS))) for x in values] + [None], dtype=object)[:-1]


def horner(p, x, y):
    """Real and imaginary parts of p at x + i y, all in units of 2^-BITS."""
    a, b = np.full(len(x), 0, dtype=object), np.full(len(x), 0, dtype=object)
    for c in p:
        a, b = ((a * x - b * y) >> BITS) + c, (a * y + b * x) >> BITS
    return a, b


def improved(p, start):
    """All roots simultaneously by the iteration of Ehrlich and Aberth; None if it does not converge."""
    p, slope_of_p = fixed(p), fixed(slope(p))
    x, y = fixed([mpf(z.real) for z in start]), fixed([mpf(z.imag) for z in start])
    settled = 0
    for _ in range(80):
        (a, b), (c, d) = horner(p, x, y), horner(slope_of_p, x, y)
        # p' - p sum 1 / (z - other): the sum needs few digits.
        apart = [[complex((x[i] - x[j]) / (1 << BITS), (y[i] - y[j]) / (1 << BITS)) for j in range(len(x)) if j != i]
                 for i in range(len(x))]
        if any(z == 0 for row in apart for z in row):
            return None
        sums = [sum(1 / z for z in row) for row in apart]
        e, f = (np.array([int(mp.ldexp(part, 60)) for part in parts] + [None], dtype=object)[:-1]
                for parts in zip(*((z.real, z.imag) for z in sums))) if len(x) > 1 else (0 * x, 0 * x)
        c, d = c - ((a * e - b * f) >> 60), d - ((a * f + b * e) >> 60)
        size = c * c + d * d
        if any(s == 0 for s in size):
            return None
        dx, dy = ((a * c + b * d) << BITS) // size, ((b * c - a * d) << BITS) // size
        x, y = x - dx, y - dy
        largest = max((abs(u) + abs(v)) / (1 + abs(r) + abs(t)) for u, v, r, t in zip(dx, dy, x, y))
        settled = settled + 1 if largest < 1e-20 else 0
        if settled == 4:  # convergence is at least quadratic: the remaining error is below the digits
            return [mpc(mp.ldexp(mpf(r), -BITS), mp.ldexp(mpf(t), -BITS)) for r, t in zip(x, y)]
    return None


def zeros(p, start=None):
    """The roots of p, refined from the given approximations or from those of double precision."""
    p = trimmed(p)
    at_origin = 0
    while len(p) > 1 and p[-1] == 0:
        p, at_origin = p[:-1], at_origin + 1
    if len(p) < 2:
        return [mpf(0)] * at_origin
    largest = max(abs(a) for a in p)
    p = [a / largest for a in p]
    found = None
    if start is None or len(start) != len(p) - 1:
        with np.errstate(all="ignore"):
            start = np.roots([float(a) for a in p])
    if len(start) == len(p) - 1 and np.isfinite(start).all() and (start != 0).all():
        # Separates the start values and moves them off the real axis: the iteration cannot leave it.
        start = start * (1 + 1e-9 * np.exp(1j * np.arange(1, len(start) + 1)))
        found = improved(p, start)
    if found is None:
        found = polyroots(p, maxsteps=400, extraprec=600)
    return [mpf(0)] * at_origin + found


def zeros_of_margin(n, d, margin):
    """Roots in x = cos w of margin = (|D|^2 - |N|^2) / (1 - x), from those in z, which double precision separates."""
    size = len(d)
    n = [mpf(0)] * (size - len(n)) + n
    lag = [sum(d[i] * d[i + k] - n[i] * n[i + k] for i in range(size - k)) for k in range(size)]
    lag = lag[:max(k for k, a in enumerate(lag) if a != 0) + 1]
    around = without_factor(without_factor(lag[:0:-1] + lag, mpf(1)), mpf(1))  # palindromic
    largest = max(abs(a) for a in around)
    with np.errstate(all="ignore"):
        z = np.roots([float(a / largest) for a in around])
    z = np.array(sorted(z, key=abs)[:len(z) // 2])
    return zeros(margin, (z + 1 / z) / 2 if (z != 0).all() else None)


def squared_norm(n, d):
    """(1/2pi) integral of |N/D|^2 over the unit circle, by reducing the degree of D by one in each step
    (Astrom, Jury, Agniel, IEEE Trans. Automat. Control 15, 1970)."""
    d = trimmed(d)
    n = [mpf(0)] * (len(d) - len(trimmed(n))) + trimmed(n)
    total = mpf(0)
    leading = d[0]
    while len(d) > 1:
        alpha, beta = d[-1] / d[0], n[-1] / d[0]
        total += beta * n[-1]
        back = d[::-1]
        n = [a - beta * b for a, b in zip(n, back)][:-1]
        d = [a - alpha * b for a, b in zip(d, back)][:-1]
        if d[0] <= 0:
            raise ArithmeticError("not stable")
    total += n[0] / d[0] * n[0]
    return total / leading


def squared_modulus(p):
    """|p|^2 on the unit circle as a polynomial in x = cos w."""
    m = len(p) - 1
    lag = [sum(p[i] * p[i + k] for i in range(m + 1 - k)) for k in range(m + 1)]
    before, current = [mpf(1)], [mpf(1), mpf(0)]
    result = [lag[0]]
    for k in range(1, m + 1):
        result = plus(result, [2 * lag[k] * a for a in current])
        before, current = current, plus([2 * a for a in current] + [mpf(0)], [-a for a in before])
    return result
