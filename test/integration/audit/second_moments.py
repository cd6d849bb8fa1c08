"""Mean and variance of every tracking error of the first followers, from the covariance of the string's whole state: positions
and the registers of every loop, filter, delay and predictor.

Each new quantity enters the table as a linear combination of its entries plus an innovation that is uncorrelated with them, and
replaces one that is no longer needed. For a lossy link r = predicted + theta e = predicted + p e + w the innovation is
w = (theta - p) e with variance p q E e^2, as theta is independent of all entries. All numbers are integers in units of 2^-400.
"""

import numpy as np
from mpmath import mp, mpf

import link_reference
from audit.loops import loop_of

BITS = 400


def fixed(x):
    return int(mp.nint(mp.ldexp(mpf(x), BITS)))


class Table:
    def __init__(self, size):
        self.covariance = np.zeros((size, size), dtype=object)
        self.means = np.zeros(size, dtype=object)

    def combined(self, terms):
        row, mean = 0, 0
        for factor, place in terms:
            row = row + factor * self.covariance[place]
            mean += factor * self.means[place]
        if not terms:
            return np.zeros(len(self.means), dtype=object), 0, 0
        row = row >> BITS
        return row, sum(factor * row[place] for factor, place in terms) >> BITS, mean >> BITS

    def put(self, place, combined, innovation=0):
        row, variance, mean = combined
        self.covariance[place, :] = row
        self.covariance[:, place] = row
        self.covariance[place, place] = variance + innovation
        self.means[place] = mean


class Ring:
    """The last values of a sequence: index 1 is the newest."""

    def __init__(self, first, size):
        self.places = list(range(first, first + size))

    def __getitem__(self, age):
        return self.places[age - 1]

    def turn(self):
        """Makes the oldest place the newest one; returns it."""
        self.places.insert(0, self.places.pop())
        return self.places[0]


class Follower:
    def __init__(self, vehicle, loop, start):
        link = vehicle.get("channel", {})
        loss = link.get("loss", {"probability": 0.0, "on_loss": [1.0]})
        self.q = mpf(loss["probability"])
        self.c = [fixed(x) for x in link_reference.predictor_of(loss)] if self.q else []
        self.a, self.b = [fixed(x) for x in loop.d[1:]], [fixed(x) for x in loop.n]
        self.lead, self.order, self.h = len(loop.d) - len(loop.n), len(loop.d) - 1, loop.h
        self.at_one = sum(loop.n), sum(loop.d)
        filter_ = link.get("noise_filter", {"numerator": [1.0], "denominator": [1.0]})
        first = mpf(filter_["denominator"][0])
        numerator = [fixed(mpf(x) / first) for x in filter_["numerator"]]
        self.wa = [fixed(mpf(x) / first) for x in filter_["denominator"][1:]]
        self.wb = [0] * (len(self.wa) + 1 - len(numerator)) + numerator
        self.noise, self.dither = fixed(vehicle["noise_variance"]), fixed(mpf(link.get("quantisation_step", 0.0)) ** 2 / 12)
        self.initial = vehicle["initial_position"]
        sizes = [self.order, len(self.wb), link.get("delay", 0) + 1, max(len(self.c), 1), 2]
        self.registers, self.colour, self.sent, self.used, self.y = (
            Ring(start + sum(sizes[:i]), n) for i, n in enumerate(sizes))
        self.end = start + sum(sizes)

    def begin(self, own, ahead):
        """Sets the coefficients of the initial positions of the vehicle and of its predecessor in every place after step -1."""
        gain, rest = self.at_one
        for place in self.registers.places:
            own[place] = 1 / gain
        own[self.registers[1]], ahead[self.registers[1]] = (1 - rest) / gain, mpf(1)
        for place in self.y.places:
            own[place] = mpf(1)
        for place in self.sent.places + self.used.places:
            ahead[place] = mpf(1)

    def step(self, table, ahead, leader):
        """One step behind the vehicle whose position is at place `ahead` (None: the leader, at position `leader`): mean and
        variance of the error."""
        one = 1 << BITS
        y = table.combined([(b, self.registers[self.lead + i]) for i, b in enumerate(self.b)])
        table.put(self.y.turn(), y)
        h = fixed(self.h)
        _, variance, mean = table.combined(([] if ahead is None else [(one, ahead)]) +
                                           [(-one - h, self.y[1]), (h, self.y[2])])
        error = mean + leader, variance
        u = table.combined([(-a, self.colour[i + 1]) for i, a in enumerate(self.wa)])
        table.put(self.colour.turn(), u, self.noise)
        row, variance, mean = table.combined(([] if ahead is None else [(one, ahead)]) +
                                             [(b, self.colour[i + 1]) for i, b in enumerate(self.wb) if b])
        table.put(self.sent.turn(), (row, variance, mean + leader), self.dither)
        arriving = self.sent[len(self.sent.places)]
        predicted = [(c, self.used[i + 1]) for i, c in enumerate(self.c)]
        innovation = 0
        if self.q:
            _, variance, mean = table.combined([(one, arriving)] + [(-c, place) for c, place in predicted])
            innovation = fixed(self.q * (1 - self.q)) * (variance + (mean * mean >> BITS)) >> BITS
        received = table.combined([(fixed(1 - self.q), arriving)] +
                                  [(fixed(self.q) * c >> BITS, place) for c, place in predicted])
        table.put(self.used.turn(), received, innovation)
        v = table.combined([(one, self.used[1])] + [(-a, self.registers[i + 1]) for i, a in enumerate(self.a) if a])
        table.put(self.registers.turn(), v)
        return error


def leader_positions(model, loop, steps):
    """y_0(0), y_0(1), ..., starting from the equilibrium at 0."""
    position, reference, speeds = mpf(0), [], model["leader"]["speed"]
    for k in range(steps):
        reference.append(position)
        current = [entry["value"] for entry in speeds if entry["from_step"] <= k]
        position += mpf(model["sample_period"]) * mpf(current[-1] if current else 0)
    return loop.filtered(reference)


def place_at_start(parts, table):
    """Puts the moments of all initial positions into a table of zeros."""
    columns = [[mpf(0)] * len(table.means) for _ in parts]
    for i, part in enumerate(parts):
        part.begin(columns[i], columns[i - 1] if i else [mpf(0)] * len(table.means))
    for part, column in zip(parts, columns):
        if part.initial["mean"] or part.initial["variance"]:
            whole = np.array([fixed(x) for x in column], dtype=object)
            table.means = table.means + (fixed(part.initial["mean"]) * whole >> BITS)
            table.covariance += fixed(part.initial["variance"]) * (np.outer(whole, whole) >> BITS) >> BITS


def moments(model, followers, steps):
    """Means and variances of zeta_i(k), i = 1, ..., followers, k = 0, ..., steps - 1, each as a list per follower."""
    parts, start, loops = [], 0, {}
    for vehicle in link_reference.vehicles_of(model, followers):
        loop = loops.setdefault(id(vehicle), None) or loop_of(vehicle)
        loops[id(vehicle)] = loop
        parts.append(Follower(vehicle, loop, start))
        start = parts[-1].end
    table = Table(start)
    place_at_start(parts, table)
    leader = leader_positions(model, loop_of(link_reference.merged(model, {})), steps)
    means, variances = [[] for _ in parts], [[] for _ in parts]
    for k in range(steps):
        ahead, position = None, fixed(leader[k])
        for i, part in enumerate(parts):
            mean, variance = part.step(table, ahead, position)
            means[i].append(mp.ldexp(mpf(mean), -BITS))
            variances[i].append(mp.ldexp(mpf(variance), -BITS))
            ahead, position = part.y[1], 0
    return means, variances
