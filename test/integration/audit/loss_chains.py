"""Links on the unit circle: losses that are independent, or come in bursts (a Markov chain of two modes), behind a delay.

With theta = 1 for an arrival and 0 for a loss, u = (1 - L) s and d = s - r: at a loss d(k) = u(k) + sum_l c_l d(k - l), at an
arrival 0. Let x = (d(k), ..., d(k - n + 1)), Z = (theta x, (1 - theta) x), l = 1 - theta - q, and m(k) = l(k) - mu l(k - 1) the
innovation of the chain, which has mean 0 whatever happened before. Then

    Z(k) = A Z(k - 1) + q e u(k) + w(k),   w(k) = e l(k) u(k) + m(k) J x(k - 1),

where w is uncorrelated with s, because l and m are independent of s and have mean 0. The first two terms are the mean effect of
the link. The spectrum of w follows from E l(k) l(k + t) = p q mu^|t| and E[m^2 | mode] alone: p q mu^|t| R_u(t) from the first
term, the second moments of x from the second, and mu^t E[m^2 x(k - 1) u(k + t)] from the two of them.
"""

import itertools

import numpy as np
from mpmath import mp, mpf

import link_reference
from audit.convolution import shifted
from audit.followers import LONG, long
from audit.integers import Points, fixed, quotient
from audit.polynomials import plus, squared_norm, times, zeros

WHITE = 1e-15  # smaller abs(mu) are rounding


def resolvent(a):
    """The matrices B_0, B_1, ... of adj(I - x a) = sum x^k B_k, and the coefficients of det(I - x a), lowest power first."""
    size, one = a.rows, mp.eye(a.rows)
    terms, determinant, product = [one], [mpf(1)], a
    for k in range(1, size + 1):
        determinant.append(-sum(product[i, i] for i in range(size)) / k)
        terms.append(product + determinant[-1] * one)
        product = a * terms[-1]
    return terms[:-1], determinant


class Link:
    """A link of a vehicle: its noise, delay and losses."""

    def __init__(self, link, noise):
        loss = link.get("loss", {"probability": 0.0, "on_loss": "hold"})
        self.q, self.delay = mpf(loss["probability"]), link.get("delay", 0)
        self.p = 1 - self.q
        self.c = [mpf(x) for x in ([] if loss["on_loss"] == "zero" else link_reference.predictor_of(loss))] if self.q else []
        self.burst = mpf(loss["mean_burst"]) if "mean_burst" in loss else 1 / self.p
        self.apart = 1 / (self.p * self.burst)  # 1 - mu
        self.mu = 1 - self.apart
        self.white = abs(self.mu) < WHITE
        self.noise, self.dither = mpf(noise), mpf(link.get("quantisation_step", 0.0)) ** 2 / 12
        colour = link.get("noise_filter", {"numerator": [1.0], "denominator": [1.0]})
        self.colour = [[mpf(x) for x in colour[key]] for key in ("numerator", "denominator")]
        self.surprise = [mpf(1)] + [-x for x in self.c]  # 1 - L
        self.slope = sum((j + 1) * x for j, x in enumerate(self.c))
        self.registers = [mpf(1)] + [-self.q * x for x in self.c]
        if self.q and not self.white:
            self._chain()
        self.poles = zeros(self.colour[1]) + (self._poles() if self.q else [])

    def _chain(self):
        """A, e, J; n registers. Modes: 0 arrived, 1 lost."""
        n, leave, stay = len(self.c), self.q / self.p / self.burst, 1 - 1 / self.burst
        self.n, self.to_lost, self.spread = n, (leave, stay), (leave * (1 - leave), stay / self.burst)
        shift, predict = mp.zeros(n), mp.zeros(n)
        for j in range(n):
            predict[0, j] = self.c[j]
            if j:
                shift[j, j - 1] = predict[j, j - 1] = mpf(1)
        self.maps = (shift, predict)
        self.a, self.j = mp.zeros(2 * n), mp.zeros(2 * n, n)
        for i, k in itertools.product(range(n), range(n)):
            for mode in (0, 1):
                self.a[i, mode * n + k] = (1 - self.to_lost[mode]) * shift[i, k]
                self.a[n + i, mode * n + k] = self.to_lost[mode] * predict[i, k]
            self.j[i, k], self.j[n + i, k] = -shift[i, k], predict[i, k]
        self.terms, self.determinant = resolvent(self.a)

    def _poles(self):
        return zeros(self.registers) if self.white else zeros(self.determinant)

    def feedback(self):
        """p q ||L F||^2 of independent losses."""
        if not self.c:
            return mpf(0)
        inside = max([abs(z) for z in zeros(self.registers)]) < 1
        return self.p * self.q * squared_norm(self.c, self.registers) if inside else mp.inf

    def settles(self):
        """Whether the second moments of the registers settle: a map of positive matrices to positive ones whose inverse of 1 - map
        keeps them positive has a spectral radius below 1."""
        if not self.q:
            return True
        if self.white:
            return self.feedback() < 1
        growth, drives = self._growth()
        return all(mp.eigsy(moment, eigvals_only=True)[0] > -mpf(10) ** -50 for moment in self._solved(growth, drives[:, 0]))

    def settling(self):
        """The poles of the noise, of the mean response and of the second moments of the registers."""
        if not self.q:
            return self.poles
        if self.white and not self.c:
            return self.poles + [mpf(0)]
        if self.white:
            shift, predict = np.eye(len(self.c), k=-1), np.eye(len(self.c), k=-1)
            predict[:1] = [float(x) for x in self.c]
            growth = float(self.p) * np.kron(shift, shift) + float(self.q) * np.kron(predict, predict)
            return self.poles + [mp.sqrt(max(abs(np.linalg.eigvals(growth)), default=0.0))]
        return self.poles + [self.mu, 1 - 1 / self.burst]

    def response(self):
        """The mean effect as numerator and denominator by descending powers of z, without the delay."""
        if not self.q:
            return [mpf(1)], [mpf(1)]
        if self.white:
            return [self.p] + [mpf(0)] * len(self.c), self.registers
        # 1 - q (1 - L) D, D = (e' e') (I - x A)^-1 e; by powers of x = 1 / z, lowest first, which is highest first in z
        n, product = self.n, times(self.surprise, [t[0, self.n] + t[self.n, self.n] for t in self.terms])
        return plus_low(self.determinant + [mpf(0)] * n, [-self.q * a for a in product]), self.determinant + [mpf(0)] * n

    def lag(self):
        """The mean delay of a position at constant speed [steps]."""
        if not self.q:
            return mpf(self.delay)
        if self.white:
            return self.delay + self.q * self.slope / self.p
        return self.delay + self.q * self.slope * sum(t[0, self.n] + t[self.n, self.n] for t in self.terms) / sum(self.determinant)

    def scatter(self, panels):
        """The operator from the spectrum of u, at the nodes of panels, to the spectrum of the scattered signal."""
        return White(self, panels) if self.white else Chain(self, panels)

    def _growth(self):
        """E[x x'; mode] of a step as a matrix times those of the step before, and columns that multiply R_u(0) and the entries of
        h = E[Z(k - 1) u(k)]."""
        n = self.n
        size = 2 * n * n
        growth = mp.zeros(size)
        for to, mode in itertools.product((0, 1), (0, 1)):
            chance = self.to_lost[mode] if to else 1 - self.to_lost[mode]
            for i, j, k, l in itertools.product(range(n), repeat=4):
                growth[(to * n + i) * n + j, (mode * n + k) * n + l] += chance * self.maps[to][i, k] * self.maps[to][j, l]
        drives = mp.zeros(size, 2 * n + 1)
        drives[n * n, 0] = self.q
        for mode, k, i in itertools.product((0, 1), range(n), range(n)):
            amount = self.to_lost[mode] * self.maps[1][i, k]
            drives[(n + i) * n, 1 + mode * n + k] += amount
            drives[n * n + i, 1 + mode * n + k] += amount
        return growth, drives

    def _solved(self, growth, drive):
        """The stationary E[x x'; mode] for one column."""
        n, found = self.n, mp.lu_solve(mp.eye(growth.rows) - growth, drive)
        return [mp.matrix([[found[(mode * n + i) * n + j] for j in range(n)] for i in range(n)]) for mode in (0, 1)]

    def moments(self):
        """The matrices N_0, N_1, ...: V sum_c E[m^2 | c] E[x x'; c] V' = N_0 R_u(0) + sum_j N_j h_j, where V takes differences of
        successive entries, in which nothing cancels."""
        (growth, drives), v = self._growth(), self.differences()
        solved = [self._solved(growth, drives[:, column]) for column in range(drives.cols)]
        return [v * (self.spread[0] * arrived + self.spread[1] * lost) * v.T for arrived, lost in solved]

    def differences(self):
        """V: row i takes the i-th difference."""
        return mp.matrix([[(-1) ** j * mp.binomial(i, j) for j in range(self.n)] for i in range(self.n)])

    def innovation(self, points):
        """abs(1 - L)^2"""
        return points.gain(self.surprise, [mpf(1)] + [mpf(0)] * len(self.c))


def plus_low(p, q):
    """The sum of polynomials by ascending powers."""
    return plus(p[::-1], q[::-1])[::-1]


class White:
    """p q E e^2 / (1 - feedback) of white noise through F = 1 / (1 - q L); e = F u about its mean. States: the variance."""

    def __init__(self, link, panels):
        points = Points(panels.circle.w)
        passed = points.gain([mpf(1)] + [mpf(0)] * len(link.c), link.registers)
        kappa = link.p * link.q / (1 - link.feedback())
        self.states = 1
        self.into = (long(kappa) * panels.weights * passed)[None, :]
        self.out = passed[:, None]
        self.drift = np.array([long(kappa * (link.slope / link.p) ** 2)], LONG)  # at a speed of 1 m/step


class Chain:
    """States: the scattered spectrum at the nodes."""

    def __init__(self, link, panels):
        n, points = link.n, Points(panels.circle.w, back=True)
        determinant = link.determinant[::-1]

        def row(weights_of):  # of the matrices of adj(I - x A), by descending powers of x = e^{-jw}
            return [weights_of(t) for t in link.terms[::-1]]
        inverse = link.differences() ** -1
        seen = [row(lambda t, k=k: t[0, k] + t[n, k]) for k in range(2 * n)]  # (e' e') adj
        forced = link.j * inverse
        forced = [[sum(a[i] * forced[k, column] for k, a in enumerate(seen)) for i in range(2 * n)] for column in range(n)]
        v = link.differences()
        drawn = mp.matrix(n, 2 * n)
        for i, k, mode in itertools.product(range(n), range(n), (0, 1)):
            drawn[i, mode * n + k] = v[i, k] * link.spread[mode]
        answers = [row(lambda t, k=k: link.q * t[k, n]) + [mpf(0)] for k in range(2 * n)]  # q x adj e
        moved = [[sum(drawn[i, k] * a[j] for k, a in enumerate(answers)) for j in range(2 * n + 1)] for i in range(n)]

        moments = link.moments()
        self.states = len(panels.circle.w)
        self.out = None
        at = lambda p: points.ratio(p, determinant)
        through, forced, lagging = at(seen[n]), [at(p) for p in forced], [at(p) for p in moved]
        with_memory, mirrored = shifted(panels, long(link.apart), long(link.mu))
        poisson = 2 * (with_memory + mirrored).real - panels.weights[None, :]
        both = long(link.p * link.q)
        self.into = both * (np.abs(through) ** 2)[:, None] * poisson
        second = self._second(link, moments, points, answers, determinant)
        for i, j in itertools.product(range(n), range(n)):
            self.into = self.into + (forced[i] * np.conj(forced[j])).real[:, None] * (second[i][j] * panels.weights)[None, :]
        for i in range(n):
            cross = with_memory * np.conj(lagging[i])[None, :] + mirrored * lagging[i][None, :]
            self.into = self.into + 2 * ((through * np.conj(forced[i]))[:, None] * cross).real

        # The same for a constant u of mean square slope^2.
        total = sum(determinant)
        one = Points(np.zeros(1))
        second = self._second(link, moments, one, answers, determinant)
        sine, cosine = np.sin(panels.circle.w / 2), np.cos(panels.circle.w / 2)
        below = long(link.apart) + 2 * long(link.mu) * sine * (sine + 1j * cosine)  # 1 - mu x
        drift = both * np.abs(through) ** 2 * long(link.apart * (1 + link.mu)) / np.abs(below) ** 2
        for i, j in itertools.product(range(n), range(n)):
            drift = drift + (forced[i] * np.conj(forced[j])).real * second[i][j][0]
        for i in range(n):
            drift = drift + 2 * (through * np.conj(forced[i]) * long(sum(moved[i]) / total) / below).real
        self.drift = drift * long(link.slope) ** 2

    @staticmethod
    def _second(link, moments, points, answers, determinant):
        """V sum_c E[m^2 | c] E[x x'; c] V' per mean square of u at every node."""
        c, e = points(determinant)
        below = c * c + e * e
        parts = []
        for p in answers:
            a, b = points(p)
            parts.append(a * c + b * e)
        one = fixed([1])[0]
        table = []
        for i in range(link.n):
            table.append([])
            for j in range(link.n):
                factors = fixed([m[i, j] for m in moments])
                table[-1].append(quotient(factors[0] * below + sum(f * p for f, p in zip(factors[1:], parts)), below * one))
        return table
