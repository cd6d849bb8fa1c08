"""One follower and its link on the unit circle, with a 64-bit mantissa. Every polynomial is a product over its roots, which are
computed in 120 digits, so that nothing cancels near a root."""

import functools
import json

import numpy as np
from mpmath import mp, mpf

import link_reference
from audit.loops import loop_of
from audit.polynomials import plus, squared_modulus, squared_norm, taylor_about_one, times, value, without_factor, \
    zeros, zeros_of_margin

LONG, COMPLEX = np.longdouble, np.clongdouble
TERMS = 24  # terms of a series
FLAT = mpf(10) ** -10  # smaller values are zeros at w = 0, up to the rounding of the coefficients


def long(x):
    return LONG(mp.nstr(mpf(x), 24))


def longs(values):
    result = np.zeros(len(values), COMPLEX)
    for i, z in enumerate(values):
        z = mp.mpmathify(z)
        result[i] = long(z.real) + COMPLEX(1j) * long(z.imag)
    return result


class Circle:
    """Points of the upper half of the unit circle."""

    def __init__(self, w):
        self.w = np.asarray(w, LONG)
        sine, cosine = np.sin(self.w / 2), np.cos(self.w / 2)
        self.t = 2 * sine * sine                          # 1 - cos w
        self.s = np.empty(self.w.shape, COMPLEX)          # z - 1
        self.s.real, self.s.imag = -self.t, 2 * sine * cosine
        self.z = self.s + 1

    def back(self, m):
        """z^-m"""
        result = np.empty(self.w.shape, COMPLEX)
        result.real, result.imag = np.cos(m * self.w), -np.sin(m * self.w)
        return result


class Factors:
    """A polynomial given by its leading coefficient and its roots."""

    def __init__(self, p, roots=None):
        self.leading = long(p[0])
        self.roots = longs([r - 1 for r in (zeros(p) if roots is None else roots)])

    def __call__(self, circle):
        result = np.full(circle.w.shape, self.leading, COMPLEX)
        for r in self.roots:
            result = result * (circle.s - r)
        return result


def once(kind, keys):
    """A function that makes one object of this kind for all vehicles of link_reference.vehicles_of() with the same values at these
    keys."""
    made_of = functools.lru_cache(maxsize=64)(lambda vehicle: kind(json.loads(vehicle)))
    return lambda vehicle: made_of(json.dumps({key: vehicle[key] for key in keys if key in vehicle}, sort_keys=True))


class Follower:
    """T^ = p z^-m F T with F = 1 / (1 - q L)."""

    def __init__(self, vehicle):
        self.vehicle, self.loop = vehicle, loop_of(vehicle)
        link = vehicle.get("channel", {})
        loss = link.get("loss")
        self.has_stage = loss is not None
        loss = loss or {"probability": 0.0, "on_loss": "hold"}
        self.q, self.c = mpf(loss["probability"]), [mpf(x) for x in link_reference.predictor_of(loss)]
        self.p, self.delay = 1 - self.q, link.get("delay", 0)
        if self.q == 0:
            self.c = [mpf(1)]
        self.registers = [mpf(1)] + [-self.q * x for x in self.c]                # z^l - q (c_1 z^(l-1) + ...)
        self.weight = sum((j + 1) * x for j, x in enumerate(self.c))
        self.ebar = self.weight / self.p if self.q else mpf(0)                   # mean of e per speed of 1 m/step
        self.lag = self.delay + self.q * self.weight / self.p
        self.feedback = mpf(0)                                                   # p q ||L F||^2
        self.register_poles = zeros(self.registers) if self.q else []
        if self.q:
            inside = max(abs(r) for r in self.register_poles) < 1
            self.feedback = self.p * self.q * squared_norm(self.c, self.registers) if inside else mp.inf
        self.noise_variance = mpf(vehicle["noise_variance"])
        self.dither = mpf(link.get("quantisation_step", 0.0)) ** 2 / 12
        filter_ = link.get("noise_filter", {"numerator": [1.0], "denominator": [1.0]})
        self.filter = [[mpf(x) for x in filter_[key]] for key in ("numerator", "denominator")]
        self._margin()

    def mean_square_stable(self):
        return self.loop.rho < 1 and self.feedback < 1

    def _margin(self):
        """Sets margin and its roots in t: |D^|^2 - |N^|^2 = t margin(t), t = 1 - cos w."""
        self.n = [self.p * a for a in self.loop.n]
        self.d = times(self.loop.d, self.registers) if self.q else self.loop.d
        difference = plus(squared_modulus(self.d), [-a for a in squared_modulus(self.n)])
        self.margin = [-a for a in without_factor(difference, mpf(1))]
        while len(self.margin) > 1 and abs(self.margin[0]) < mpf(10) ** -100 * max(abs(a) for a in self.margin):
            self.margin = self.margin[1:]
        roots = [1 - x for x in zeros_of_margin(self.n, self.d, self.margin)]
        least = FLAT * min(1, 1 - self.loop.rho) ** 2
        self.margin_roots = [mpf(0) if abs(t) < least else t for t in roots]
        # A zero at t_0 instead of 0 changes quotients up to w = sqrt(2 t_0): this share of a mean is undetermined.
        self.undetermined = 10 * mp.sqrt(max([abs(t) for t in roots if abs(t) < least] + [mpf(0)]))
        # (x - x_k) = (t_k - t)
        self.margin_leading = self.margin[0]
        self.factors = self.series = None

    def doubt_at(self, circle):
        """The change of log |T^|^2 / (1 - cos w), in units of the last digit, if each coefficient changes by its last digit and
        T(1) = 1 is kept. Values of |T^| below 1e-3 count as 1e-3."""
        f = self._factors()
        spread = float(sum(abs(a) * i * i for p in (self.n, self.d) for i, a in enumerate(p[::-1])))
        above, below = long(self.p) * np.abs(f["n"](circle)), np.abs(f["d"](circle) * f["r"](circle))
        return spread * (1 / below + 1 / np.maximum(above, 1e-3 * below))

    def _factors(self):
        if self.factors is None:
            self.factors = {"n": Factors(self.loop.n), "d": Factors(self.loop.d, self.loop.poles),
                            "r": Factors(self.registers, self.register_poles if self.q else [mpf(0)]),
                            "w": Factors(self.filter[0]), "v": Factors(self.filter[1]),
                            "m": longs(self.margin_roots)}
        return self.factors

    def flatness(self):
        """The number of zeros of 1 - |T^|^2 at t = 0, without the first."""
        return sum(1 for t in self.margin_roots if t == 0)

    def slope_at_zero(self):
        """The limit of 1 - |T^|^2 over t for t -> 0, further zeros at t = 0 removed, and its doubt."""
        at_one = value(self.d, mpf(1)) ** 2
        spread = sum(abs(a) * i * i for p in (self.n, self.d) for i, a in enumerate(p[::-1]))
        slope = self.margin_leading
        for t in self.margin_roots:
            slope = slope * (t if t != 0 else -1)
        return mp.re(slope) / at_one, 2 * spread / mp.sqrt(at_one)

    def zeros_at_one(self):
        """The powers of 1 - cos w in the spectrum that the link adds, and in |1 - H T^|^2 and |1 - L|^2 (the smaller one)."""
        def count(p):
            found, size = 0, sum(abs(a) for a in p)
            while len(p) > 1 and abs(value(p, mpf(1))) < FLAT * size:
                p, found = without_factor(p, mpf(1)), found + 1
            return found
        added = mp.inf
        if self.q or self.dither:
            added = 0
        elif self.noise_variance:
            added = count(self.filter[0])
        found = count(self._complement())
        if self.q:
            found = min(found, count([mpf(1)] + [-x for x in self.c]))
        return added, found

    def _complement(self):
        """The numerator of 1 - H T^ over z^-(m + 1) and D R."""
        hat = times([1 + self.loop.h, -self.loop.h], self.n) + [mpf(0)] * (len(self.c) if self.q else 0)
        return plus(self.d + [mpf(0)] * (self.delay + 1), [-a for a in hat])

    def complement_at(self, circle, hat, below):
        """|1 - H T^|^2; near z = 1 by its series in z - 1, as 1 and H T^ cancel there."""
        result = np.abs(1 - (1 + long(self.loop.h) * circle.s / circle.z) * hat) ** 2
        if self.series is None:
            p = self._complement()
            taylor = taylor_about_one(p, TERMS)
            of_policy = 2 if self.lag == 0 else 1  # zeros from T(1) = 1 and dT/dz(1) = -h, up to rounding
            self.series = longs([mpf(0)] * of_policy + taylor[of_policy:]), 0.1 / len(p)
        terms, radius = self.series
        near = np.abs(circle.s) < radius
        series = np.zeros(near.sum(), COMPLEX)
        for a in terms[::-1]:
            series = series * circle.s[near] + a
        result[near] = np.abs(series) ** 2 / below[near]
        return result

    def at(self, circle):
        """The quantities of these names in link_theory_test.py, the logarithm of |T^|^2, and 1 - |T^|^2."""
        f, l = self._factors(), len(self.c)
        r, h = f["r"](circle), long(self.loop.h)
        passed = f["n"](circle) / f["d"](circle) / r                              # F T z^-l
        below = np.abs(f["d"](circle)) ** 2 * np.abs(r) ** 2
        margin = np.full(circle.w.shape, long(self.margin_leading), COMPLEX)
        for t in f["m"]:
            margin = margin * (t - circle.t)
        margin = margin.real * circle.t / below
        hat = long(self.p) * circle.back(self.delay - l) * passed
        gain = np.abs(hat) ** 2
        with np.errstate(all="ignore"):
            log = np.where(margin < 0.5, np.log1p(-np.minimum(margin, 0.5)), np.log(gain))
        # 1 - L = sum c_j (1 - z^-j), as the c have sum 1
        surprise = sum(long(x) * circle.s * sum(circle.back(i + 1) for i in range(j + 1)) for j, x in enumerate(self.c))
        policy = 1 + h * circle.s / circle.z
        noise = np.abs(f["w"](circle) / f["v"](circle)) ** 2 * long(self.noise_variance) + long(self.dither)
        return {"margin": margin, "gain": gain, "log": log, "loss_gain": np.abs(passed) ** 2,
                "innovation": np.abs(surprise) ** 2 / np.abs(r) ** 2, "noise": noise,
                "complement": self.complement_at(circle, hat, below), "headway": np.abs(policy) ** 2}

    def kappa(self):
        return self.p * self.q / (1 - self.feedback)

    def singular_frequencies(self):
        """Complex w near which the values of at() change rapidly."""
        found = []
        for z in self.loop.poles + zeros(self.filter[1]) + self.register_poles:
            if abs(z) > mpf(10) ** -3:
                found.append(complex(-1j * mp.log(z)))
        for t in self.margin_roots:
            if t != 0:
                found.append(complex(2 * mp.asin(mp.sqrt(mpf(1) * t / 2))))
        return found


made = once(Follower, ("plant", "controller", "closed_loop", "time_headway", "noise_variance", "channel", "sample_period"))
