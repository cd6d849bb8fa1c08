"""Stationary values, limits and verdict for a string over links with independent losses: the formulas of link_theory_test.py,
with the quadrature nodes and digits that random models need."""

import numpy as np
from mpmath import mp, mpf

import link_reference
from audit.followers import LONG, Circle, long, made
from audit.quadrature import PI, panels

UNDECIDED = 1e-11  # relative to the doubt from the last digit of T's coefficients, as for the paper's platoon
UNDECIDED_GAIN = 1e-9


def refined(function, values, grid):
    """The local minima of a function with these values on a grid, by golden section search."""
    middle = np.arange(1, len(grid) - 1)
    middle = middle[(values[middle] <= values[middle - 1]) & (values[middle] <= values[middle + 1])]
    low, high, golden = grid[middle - 1], grid[middle + 1], LONG("0.6180339887498948482")
    for _ in range(50):
        a, b = high - golden * (high - low), low + golden * (high - low)
        left = function(Circle(a)) < function(Circle(b))
        low, high = np.where(left, low, a), np.where(left, b, high)
    return (low + high) / 2


def perron_root(matrix):
    """The Perron root of a nonnegative matrix by repeated squaring, which keeps the relative accuracy of every entry."""
    power, logarithm, share = matrix, LONG(0), LONG(1)
    for _ in range(80):
        most = power.max()
        if most == 0:
            return 0.0
        logarithm += share * np.log(most)
        power = (power / most) @ (power / most)
        share /= 2
    return float(np.exp(logarithm))


def solved(gains, given):
    """The solution x of x - gains x = given."""
    count = len(given)
    matrix = mp.matrix(count, count)
    for i in range(count):
        for j in range(count):
            matrix[i, j] = (1 if i == j else 0) - mpf(str(gains[i, j]))
    return [long(x) for x in mp.lu_solve(matrix, mp.matrix([mpf(str(x)) for x in given]))]


def pattern_of(model):
    """The vehicles of one repetition of the string."""
    names = model.get("string", ["default"])
    return link_reference.vehicles_of(model, 1 if set(names) == {"default"} else len(names))


def speed_of(model):
    """The leader's last speed, in metres per step."""
    last = model["leader"]["speed"][-1]["value"] if model["leader"]["speed"] else 0.0
    return mpf(model["sample_period"]) * mpf(last)


class String:
    """One pattern of a model's string."""

    def __init__(self, model):
        self.followers = [made(vehicle) for vehicle in pattern_of(model)]
        self.kinds = list(dict.fromkeys(self.followers))
        self.order = [self.kinds.index(f) for f in self.followers]
        self.speed = speed_of(model)
        self.lossy = any(f.q for f in self.kinds)
        self.undetermined = max(f.undetermined for f in self.kinds)

    def rho(self):
        return max(f.loop.rho for f in self.kinds)

    def mean_square_stable(self):
        return all(f.mean_square_stable() for f in self.kinds)

    def singular(self):
        return [w for f in self.kinds for w in f.singular_frequencies()]

    def at(self, circle):
        values = [kind.at(circle) for kind in self.kinds]
        return [values[k] for k in self.order]

    def margin(self, circle):
        """1 - |T^|^2 of the pattern, from the sum of the logarithms of its factors."""
        return -np.expm1(sum(v["log"] for v in self.at(circle)))

    # The verdict.

    def counts(self):
        return [self.order.count(k) for k in range(len(self.kinds))]

    def flatness(self):
        return self.kinds[0].flatness() if len(self.kinds) == 1 else 0

    def grows_at_zero(self):
        """Whether 1 - |T^|^2 of the pattern has more zeros at w = 0 than the spectra that are divided by it."""
        orders = [f.zeros_at_one() for f in self.kinds]
        return 1 + self.flatness() > min(added for added, _ in orders) + min(divided for _, divided in orders)

    def slope(self, circle):
        """-log |T^|^2 of the pattern over 1 - cos w, zeros at w = 0 removed, and its doubt."""
        slope, doubt, power = 0, 0, 1 + self.flatness()
        for kind, count in zip(self.kinds, self.counts()):
            values = kind.at(circle)
            slope = slope - count * values["log"] / circle.t ** power
            doubt = doubt + count * kind.doubt_at(circle)
        return slope, doubt

    def grid(self):
        grid = [np.geomspace(1e-7, float(PI), 1500), np.linspace(0, float(PI), 1501)[1:]]
        for w in self.singular():
            around = max(abs(w.imag), 1e-10) * np.concatenate([np.geomspace(1e-2, 1e4, 50), [0.0]])
            grid += [abs(w.real) + around, abs(w.real) - around]
        grid = np.unique(np.concatenate(grid))
        return np.asarray(grid[(grid > 1e-8) & (grid <= float(PI))], LONG)

    def least(self):
        """The smallest ratio of slope() to its doubt, and its frequency w."""
        grid = self.grid()
        slope, _ = self.slope(Circle(grid))
        places = np.append(refined(lambda c: self.slope(c)[0], slope, grid), grid[-1])
        slope, doubt = self.slope(Circle(places))
        zero = [f.slope_at_zero() for f in self.followers]
        ratios = [(float(s / d), float(w)) for s, d, w in zip(slope, doubt, places)]
        ratios.append((float(sum(s for s, _ in zero) / sum(d for _, d in zero)), 0.0))
        return min(ratios)

    def peak(self):
        """The largest |T^| of the pattern, at least 1."""
        def log(circle):
            return self.slope(circle)[0] * circle.t ** (1 + self.flatness())
        grid = self.grid()
        places = np.append(refined(log, log(Circle(grid)), grid), grid[-1])
        return float(np.exp(max(0, -log(Circle(places)).min()) / 2))

    def verdict(self):
        """(string stable, reason); None if double precision of the coefficients does not determine it."""
        for f in self.kinds:
            if abs(1 - f.loop.rho) < 1e-9 or abs(1 - f.feedback) < 1e-9:
                return None, "at the border of mean square stability"
        if not self.mean_square_stable():
            return False, "not mean square stable"
        start, doubt = (sum(x) for x in zip(*(f.slope_at_zero() for f in self.followers)))
        if start < -UNDECIDED * doubt:
            return False, "|T^| > 1 about w = 0, by %.3g of its doubt" % (-start / doubt)
        least, w = self.least()
        if w == 0.0 and abs(least) < UNDECIDED:
            return None, "|T^| is flat at w = 0 to the digits"
        if abs(least) < UNDECIDED:
            return None, "|T^| = 1 to the digits, at w = %.4g" % w
        if least < 0:
            return False, "|T^| > 1 at w = %.6g, by %.3g of its doubt" % (w, -least)
        if self.flatness() and self.grows_at_zero():
            return False, "1 - |T^|^2 has %d zeros at w = 0" % (1 + self.flatness())
        if not self.lossy:
            return True, "least slope %.3g of its doubt at w = %.4g" % (least, w)
        gain = self.loss_gain()
        if abs(gain - 1) < UNDECIDED_GAIN:
            return None, "loss gain 1 to the digits"
        return bool(gain < 1), "loss gain %.12g" % gain

    # Loss gain and limits, for |T^| < 1.

    def panels_of_limit(self):
        def integrands(circle):
            values, margin = self.at(circle), self.margin(circle)
            after = 1
            for v in values:  # an upper bound of all spectra
                after = v["gain"] * after + v["gain"] * (1 + v["noise"])
            through = after / margin
            found = [sum(v["complement"] for v in values) * through, sum(v["headway"] * v["gain"] for v in values)]
            if self.lossy:
                found += [sum(v["innovation"] for v in values) * through,
                          sum(v["innovation"] for v in values) / margin * sum(v["loss_gain"] for v in values)]
            return found
        return panels(self.singular(), integrands)

    def spectra_ahead(self, values, margin, added):
        """The spectrum ahead of each follower of the pattern in an endless string in which each follower adds `added`."""
        spectrum = 0
        for v, a in zip(values, added):
            spectrum = v["gain"] * spectrum + a
        spectrum = spectrum / margin
        ahead = []
        for v, a in zip(values, added):
            ahead.append(spectrum)
            spectrum = v["gain"] * spectrum + a
        return ahead

    def gains(self, grid, values, margin):
        """Matrix (j, l): the gain from the variance of w_l, over all repetitions of the pattern, to that of w_j."""
        count = len(values)
        gains = np.zeros((count, count), LONG)
        for l, source in enumerate(self.followers):
            if not source.q:
                continue
            added = [v["loss_gain"] if i == l else 0 for i, v in enumerate(values)]
            for j, ahead in enumerate(self.spectra_ahead(values, margin, added)):
                if self.followers[j].q:
                    gains[j, l] = long(self.followers[j].kappa()) * grid.mean(values[j]["innovation"] * ahead)
        return gains

    def loss_gain(self):
        grid = self.panels_of_limit()
        values = self.at(grid.circle)
        return perron_root(self.gains(grid, values, self.margin(grid.circle)))

    def limits(self):
        """The loss gain, and the limit variance of every follower of the pattern."""
        grid = self.panels_of_limit()
        values, margin = self.at(grid.circle), self.margin(grid.circle)
        added = [v["gain"] * v["noise"] for v in values]
        gains = self.gains(grid, values, margin)
        ahead = self.spectra_ahead(values, margin, added)
        given = [long(f.kappa()) * (grid.mean(v["innovation"] * (v["noise"] + a)) + long(self.speed * f.ebar) ** 2)
                 for f, v, a in zip(self.followers, values, ahead)]
        sigma = solved(gains, given)
        added = [a + s * v["loss_gain"] for a, s, v in zip(added, sigma, values)]
        ahead = self.spectra_ahead(values, margin, added)
        limits = [grid.mean(v["complement"] * a + v["headway"] * own) for v, a, own in zip(values, ahead, added)]
        return perron_root(gains), [mpf(str(x)) for x in limits]

    # Finite strings.

    def stationary(self, followers):
        """Stationary variances and means of the first followers, and no shares of inputs."""
        def spectra(circle, mean):
            values, spectrum, found = self.at(circle), 0, []
            for i in range(followers):
                f, v = self.followers[i % len(values)], values[i % len(values)]
                sigma = 0
                if f.q:
                    sigma = long(f.kappa()) * (mean(v["innovation"] * (spectrum + v["noise"])) +
                                               long(self.speed * f.ebar) ** 2)
                added = v["gain"] * v["noise"] + v["loss_gain"] * sigma
                found.append(v["complement"] * spectrum + v["headway"] * added)
                spectrum = v["gain"] * spectrum + added
            return found

        def integrands(circle):
            values = self.at(circle)
            most = np.exp(sum(np.maximum(v["log"], 0) for v in values) * (followers // len(values) + 1))
            everything = sum(v["headway"] * (v["gain"] * v["noise"] + v["loss_gain"]) for v in values)
            found = [everything * most, everything]
            if self.lossy:
                found.append(sum(v["innovation"] for v in values) * (1 + everything) * most)
            return found
        grid = panels(self.singular(), integrands)
        variances = [mpf(str(grid.mean(p))) for p in spectra(grid.circle, grid.mean)]
        means = [self.speed * self.followers[i % len(self.followers)].lag for i in range(followers)]
        return variances, means, None
