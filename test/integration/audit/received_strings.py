"""Stationary values, limits and verdict for strings of receivers.py over links of loss_chains.py: one walk along the string, with
the scattered spectrum of every link as an operator on the spectrum that it receives."""

import functools

import numpy as np
import scipy.linalg
import scipy.sparse.linalg
from mpmath import mp, mpf

from audit.convolution import interpolating
from audit.followers import LONG, Circle, long, once
from audit.integers import Points
from audit.quadrature import PI, Panels, panels
from audit.receivers import Pair, Receiver
from audit.string_theory import UNDECIDED_GAIN, pattern_of, perron_root, refined, speed_of

UNDECIDED = 1e-11  # slope at w = 0 that counts as 0, relative to the sum over the vehicles of (1 + h)^2
BORDER = 1e-9      # of poles and second moments
MOST_PHASE = 12.0  # radians that a delay turns on one panel


made = once(Receiver, ("plant", "controller", "time_headway", "noise_variance", "channel", "inputs", "sample_period"))


@functools.lru_cache(maxsize=256)
def paired(own, ahead):
    return Pair(own, ahead)


class String:
    """One pattern of a model's string."""

    def __init__(self, model):
        self.vehicles = [made(vehicle) for vehicle in pattern_of(model)]
        self.types = list(dict.fromkeys(self.vehicles))
        self.pairs = [paired(own, ahead) for own, ahead in zip(self.vehicles, self.vehicles[-1:] + self.vehicles[:-1])]
        self.speed = speed_of(model)
        self.lossy = any(link.q for own in self.types for link in own.links)
        self.undetermined = 0
        self.grid = self.known = (None,)

    def rho(self):
        return max(own.rho for own in self.types)

    def mean_square_stable(self):
        return all(own.settles() for own in self.types)

    def settling(self):
        """All poles, of second moments as well."""
        return [z for own in self.types for z in own.poles + sum((link.settling() for link in own.links), [])]

    # The verdict.

    def log(self, circle):
        """log |T^|^2 of the pattern."""
        points = Points(circle.w)
        each = {pair: pair.log_at(points)[1] for pair in dict.fromkeys(self.pairs)}
        return sum(each[pair] for pair in self.pairs)

    def slope(self, circle):
        return -self.log(circle) / circle.t

    def singular(self):
        return [complex(-1j * mp.log(z)) for own in self.types for z in own.singular()]

    def frequencies(self):
        grid = [np.geomspace(1e-8, float(PI), 600), np.linspace(0, float(PI), 601)[1:]]
        for w in self.singular():
            around = max(abs(w.imag), 1e-10) * np.concatenate([np.geomspace(1e-2, 1e4, 40), [0.0]])
            grid += [abs(w.real) + around, abs(w.real) - around]
        grid = np.unique(np.concatenate(grid))
        return np.asarray(np.append(grid[(grid > 1e-9) & (grid < float(PI))], PI), LONG)

    def minima(self, function):
        """Frequencies of the smallest minima of a function, and their values."""
        grid = self.frequencies()
        values = function(Circle(grid))
        low = np.append(np.flatnonzero((values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:])) + 1, len(grid) - 1)
        low = low[np.argsort(values[low])][:6]
        near = np.unique(np.clip(np.concatenate([low - 1, low, low + 1]), 0, len(grid) - 1))
        places = np.append(refined(function, values[near], grid[near]), [grid[-1], grid[np.argmin(values)]])
        return places, function(Circle(places))

    def peak(self):
        """The largest |T^| of the pattern, at least 1."""
        _, least = self.minima(lambda circle: -self.log(circle))
        return float(np.exp(max(0, -least.min()) / 2))

    def attenuates(self):
        """Whether |T^| of the pattern stays below 1 on a coarse grid."""
        return self.slope(Circle(self.frequencies()[::5])).min() > -1e-9

    def verdict(self):
        """(string stable, reason); None where digits end."""
        for own in self.types:
            if abs(1 - own.rho) < BORDER or any(abs(1 - link.feedback()) < BORDER for link in own.links if link.white):
                return None, "at the border of mean square stability"
        if not self.mean_square_stable():
            return False, "not mean square stable"
        doubt = UNDECIDED * float(sum((1 + own.h) ** 2 for own in self.vehicles))
        start = float(sum(pair.slope_at_zero() for pair in self.pairs))
        if start < -doubt:
            return False, "|T^| > 1 about w = 0, slope %.3g" % start
        places, slopes = self.minima(self.slope)
        worst = int(np.argmin(slopes))
        if min(abs(start), abs(float(slopes[worst]))) < doubt:
            return None, "|T^| = 1 to the digits, at w = %.4g" % places[worst]
        if slopes[worst] < 0:
            return False, "|T^| > 1 at w = %.6g" % places[worst]
        if not self.lossy:
            return True, "least slope %.3g at w = %.4g" % (slopes[worst], places[worst])
        gain = self.loss_gain()
        if abs(gain - 1) < UNDECIDED_GAIN:
            return None, "loss gain 1 to the digits"
        return bool(gain < 1), "loss gain %.12g" % gain

    # Spectra.

    def values(self, circle):
        key = circle.w.tobytes()
        if self.known[0] != key:
            points = Points(circle.w)
            each = {pair: pair.at(points) for pair in dict.fromkeys(self.pairs)}
            self.known = key, [each[pair] for pair in self.pairs]
        return self.known[1]

    def margin(self, values):
        return -np.expm1(sum(v["log"] for v in values))

    @staticmethod
    def added(v):
        """Spectra of psi from the noise of each input."""
        return [link["enters"] * link["passed"] * link["noise"] for link in v["links"]]

    def nodes(self, followers, endless):
        """Panels that resolve all spectra of the first followers, and of an endless string."""
        if self.grid[0] is not None and self.grid[0] >= followers and (self.grid[1] or not endless):
            return self.grid[2]

        def integrands(circle):
            values = self.values(circle)
            gain, most = np.exp(sum(v["log"] for v in values)), 1
            for _ in range(followers // len(values)):
                most = 1 + gain * most
            inputs = sum(sum(self.added(v)) + sum(link["enters"] * link["scatters"] for link in v["links"]) for v in values)
            all_ = sum(v["headway"] + v["complement"] for v in values) * inputs
            found = [all_ * most, all_]
            if self.lossy:
                drawn = sum(link["innovation"] * (link["sent"] * inputs + link["noise"]) * (1 + link["scatters"])
                            for v in values for link in v["links"])
                found += [drawn * most, drawn]
            if endless:
                margin = self.margin(values)
                found += [sum(v["complement"] for v in values) * inputs / margin]
                if self.lossy:
                    found += [sum(link["innovation"] * link["sent"] for v in values for link in v["links"]) * inputs / margin]
            return found
        coarse = panels(self.singular(), integrands).edges[::2]  # which agree with the finer ones
        if any(link.q and not link.white for own in self.types for link in own.links):
            coarse = interpolating(coarse, integrands)
        phase = max(link.delay for own in self.types for link in own.links) + 2
        longest, edges = MOST_PHASE / phase, [coarse[:1]]
        for low, high in zip(coarse, coarse[1:]):
            edges.append(np.linspace(low, high, int(np.ceil(float((high - low) / longest))) + 1)[1:])
        self.grid = followers, endless, Panels(np.concatenate(edges))
        self.operators = {}
        return self.grid[2]

    def scatter(self, link, resolved):
        if link not in self.operators:
            self.operators[link] = link.scatter(resolved)
        return self.operators[link]

    def drift(self, link, operator, kind):
        """The states of a link's scatter that the mean speed causes: positions only."""
        return operator.drift * long(self.speed) ** 2 if kind == 0 else 0 * operator.drift

    def stationary(self, followers):
        """Stationary variances and means of the first followers, and shares of positions and inputs in the variances."""
        resolved = self.nodes(followers, False)
        values, ahead, rows = self.values(resolved.circle), [0 * resolved.circle.w] * 2, []
        for i in range(followers):
            v, own = values[i % len(values)], self.vehicles[i % len(values)]
            added = self.added(v) + [0 * resolved.circle.w] * (2 - len(own.links))
            for kind, (link, at) in enumerate(zip(own.links, v["links"])):
                if link.q:
                    operator = self.scatter(link, resolved)
                    drawn = at["innovation"] * (at["sent"] * sum(ahead) + at["noise"])
                    states = operator.into @ drawn + self.drift(link, operator, kind)
                    added[kind] = added[kind] + at["enters"] * (states if operator.out is None else operator.out @ states)
            rows.append([resolved.mean(v["complement"] * a + v["headway"] * b) for a, b in zip(ahead, added)])
            ahead = [v["gain"] * a + b for a, b in zip(ahead, added)]
        means = [self.speed * self.vehicles[i % len(values)].links[0].lag() for i in range(followers)]
        rows = [[mpf(str(x)) for x in row] for row in rows]
        return [sum(row) for row in rows], means, rows

    def ahead_of(self, values, margin, added):
        """The spectrum ahead of each follower of the pattern in an endless string in which each follower adds `added`."""
        spectrum = 0
        for v, a in zip(values, added):
            spectrum = v["gain"] * spectrum + a
        spectrum, found = spectrum / margin, []
        for v, a in zip(values, added):
            found.append(spectrum)
            spectrum = v["gain"] * spectrum + a
        return found

    def endless(self):
        """The map of the states of all links' scatter to those that it causes behind, what the noise and the speed cause, and
        (values, margin, places)."""
        resolved = self.nodes(2, True)
        values = self.values(resolved.circle)
        margin, none = self.margin(values), 0 * resolved.circle.w
        places, count = [], 0
        for i, own in enumerate(self.vehicles):
            for kind, link in enumerate(own.links):
                if link.q:
                    operator = self.scatter(link, resolved)
                    places.append((i, kind, link, operator, slice(count, count + operator.states)))
                    count += operator.states
        matrix, given = np.zeros((count, count), LONG), np.zeros(count, LONG)
        noise = self.ahead_of(values, margin, [sum(self.added(v)) for v in values])
        through = {}
        for i, kind, *_ in places:
            added = [values[i]["links"][kind]["enters"] if j == i else none for j in range(len(values))]
            through[i, kind] = self.ahead_of(values, margin, added)
        for i, kind, link, operator, rows in places:
            at = values[i]["links"][kind]
            given[rows] = operator.into @ (at["innovation"] * (at["sent"] * noise[i] + at["noise"])) + \
                self.drift(link, operator, kind)
            for source, source_kind, _, other, columns in places:
                drawn = operator.into * (at["innovation"] * at["sent"] * through[source, source_kind][i])[None, :]
                matrix[rows, columns] = drawn if other.out is None else drawn @ other.out
        return matrix, given, (resolved, values, margin, places)

    def loss_gain(self):
        return float(spectral_radius(self.endless()[0]))

    def limits(self):
        """The loss gain, and the limit variance of every follower of the pattern."""
        matrix, given, (resolved, values, margin, places) = self.endless()
        states = settled(matrix, given) if len(given) else given
        added = [sum(self.added(v)) for v in values]
        for i, kind, _, operator, rows in places:
            spectrum = states[rows] if operator.out is None else operator.out @ states[rows]
            added[i] = added[i] + values[i]["links"][kind]["enters"] * spectrum
        ahead = self.ahead_of(values, margin, added)
        limits = [resolved.mean(v["complement"] * a + v["headway"] * own) for v, a, own in zip(values, ahead, added)]
        return float(spectral_radius(matrix)) if len(given) else 0.0, [mpf(str(x)) for x in limits]


def settled(matrix, given):
    """The solution x of x - matrix x = given, refined from double precision."""
    factors = scipy.linalg.lu_factor(np.eye(len(given)) - np.asarray(matrix, float))
    x = np.zeros(len(given), LONG)
    for _ in range(60):
        change = scipy.linalg.lu_solve(factors, np.asarray(given - (x - matrix @ x), float))
        x = x + change
        if np.abs(change).max() <= 1e-19 * float(np.abs(x).max()):
            break
    return x


def spectral_radius(matrix):
    """The Perron root of a map of spectra, refined from double precision."""
    if len(matrix) < 60:
        return LONG(perron_root(matrix))
    narrow = np.asarray(matrix, float)
    roots, vectors = scipy.sparse.linalg.eigs(narrow, k=1, which="LR", v0=np.ones(len(matrix)))
    root, vector = LONG(roots[0].real), np.asarray(vectors[:, 0].real, LONG)
    place = int(np.argmax(np.abs(vector)))
    vector = vector / vector[place]
    bordered = np.zeros((len(matrix) + 1,) * 2)
    bordered[:-1, :-1], bordered[-1, place] = narrow - float(root) * np.eye(len(matrix)), 1
    bordered[:-1, -1] = -np.asarray(vector, float)
    factors = scipy.linalg.lu_factor(bordered)
    for _ in range(20):
        change = scipy.linalg.lu_solve(factors, np.append(np.asarray(root * vector - matrix @ vector, float), 0.0))
        vector, root = vector + change[:-1], root + change[-1]
    return root
