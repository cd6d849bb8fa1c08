"""Mean and variance of every tracking error of the first followers that receive positions and inputs, step by step from the
difference equations of vehicles and links, with the table of second_moments.py. A radio transmits at step k the input of step
k - 1."""

from mpmath import mp, mpf

import link_reference
from audit.loss_chains import Link
from audit.receivers import controller_of, inputs_of, plant_of
from audit.polynomials import times
from audit.second_moments import BITS, Ring, Table, fixed, leader_positions, place_at_start
from audit.loops import loop_of

ONE = 1 << BITS


class Line:
    """The registers of a link: noise, values sent, values used."""

    def __init__(self, entry, start, known_after=0):
        self.link = Link(entry.get("channel", {}), entry["noise_variance"])
        numerator, denominator = self.link.colour
        self.back = [fixed(-a / denominator[0]) for a in denominator[1:]]
        numerator = [fixed(b / denominator[0]) for b in numerator]
        self.forth = [0] * (len(denominator) - len(numerator)) + numerator
        self.c = [fixed(x) for x in self.link.c]
        sizes = [len(self.forth), self.link.delay + 1 - known_after, max(len(self.c), 1)]
        self.colour, self.sent, self.used = (Ring(start + sum(sizes[:i]), n) for i, n in enumerate(sizes))
        self.end = start + sum(sizes)

    def pass_on(self, table, ahead, offset):
        """One step behind the entry `ahead` (None: a value `offset`); the terms of the received value are those of used[1]."""
        link = self.link
        colour = table.combined([(a, self.colour[i + 1]) for i, a in enumerate(self.back) if a])
        table.put(self.colour.turn(), colour, fixed(link.noise))
        row, variance, mean = table.combined(([] if ahead is None else [(ONE, ahead)]) +
                                             [(b, self.colour[i + 1]) for i, b in enumerate(self.forth) if b])
        table.put(self.sent.turn(), (row, variance, mean + offset), fixed(link.dither))
        arriving = self.sent[len(self.sent.places)]
        innovation = 0
        if link.q:
            _, variance, mean = table.combined([(ONE, arriving)] + [(-c, self.used[i + 1]) for i, c in enumerate(self.c)])
            innovation = fixed(link.p * link.q) * (variance + (mean * mean >> BITS)) >> BITS
        q = fixed(link.q)
        received = table.combined([(ONE - q, arriving)] + [(q * c >> BITS, self.used[i + 1]) for i, c in enumerate(self.c)])
        table.put(self.used.turn(), received, innovation)


class Follower:
    """y(k) from u(k - 1), u(k - 2), ...; c = K e; u = (c + F v + h u(k - 1)) / (1 + h) with a headway filter, else c + F v."""

    def __init__(self, vehicle, start):
        position, radio = inputs_of(vehicle)
        n, d = plant_of(vehicle)
        d = times(d, [mpf(1), mpf(-2), mpf(1)])
        self.lead = len(d) - len(n)
        self.n, self.d = [fixed(b / d[0]) for b in n], [fixed(-a / d[0]) for a in d[1:]]
        above, below = controller_of(vehicle)
        above = [mpf(0)] * (len(below) - len(above)) + above
        self.above, self.below = [fixed(b / below[0]) for b in above], [fixed(-a / below[0]) for a in below[1:]]
        self.h = mpf(vehicle["time_headway"])
        self.filtered = vehicle["controller"].get("headway_filter", False)
        self.initial = vehicle["initial_position"]
        self.position = Line(position, start)
        self.radio = Line(radio, self.position.end, 1) if radio else None
        start = (self.radio or self.position).end
        self.gain = fixed(radio.get("gain", 1.0)) if radio else 0
        sizes = [len(self.d) + 1, max(len(d), 2), len(self.above), max(len(self.below), 1)]
        self.y, self.u, self.e, self.c = (Ring(start + sum(sizes[:i]), size) for i, size in enumerate(sizes))
        self.end = start + sum(sizes)

    def begin(self, own, ahead):
        """All vehicles stand; the coefficients of the own initial position and of that ahead."""
        for place in self.y.places:
            own[place] = mpf(1)
        for place in self.position.sent.places + self.position.used.places:
            ahead[place] = mpf(1)

    def move(self, table):
        """y(k)"""
        y = table.combined([(a, self.y[i + 1]) for i, a in enumerate(self.d) if a] +
                           [(b, self.u[self.lead + i]) for i, b in enumerate(self.n) if b])
        table.put(self.y.turn(), y)

    def error(self, table, ahead, offset):
        h = fixed(self.h)
        _, variance, mean = table.combined(([] if ahead is None else [(ONE, ahead.y[1])]) +
                                           [(-ONE - h, self.y[1]), (h, self.y[2])])
        return mean + offset, variance

    def control(self, table):
        """u(k), with the values received at this step."""
        h = fixed(self.h)
        table.put(self.e.turn(), table.combined([(ONE, self.position.used[1]), (-ONE - h, self.y[1]), (h, self.y[2])]))
        command = table.combined([(b, self.e[i + 1]) for i, b in enumerate(self.above) if b] +
                                 [(a, self.c[i + 1]) for i, a in enumerate(self.below) if a])
        table.put(self.c.turn(), command)
        terms = [(ONE, self.c[1])] + ([(self.gain, self.radio.used[1])] if self.radio else [])
        if self.filtered:
            terms = [(fixed(mpf(a) / ONE / (1 + self.h)), place) for a, place in terms]
            terms.append((fixed(self.h / (1 + self.h)), self.u[1]))
        table.put(self.u.turn(), table.combined(terms))


def moments(model, followers, steps):
    """Means and variances of zeta_i(k), i = 1, ..., followers, k = 0, ..., steps - 1, each as a list per follower."""
    parts, start = [], 0
    for vehicle in link_reference.vehicles_of(model, followers):
        parts.append(Follower(vehicle, start))
        start = parts[-1].end
    table = Table(start)
    place_at_start(parts, table)
    default = link_reference.merged(model, {})
    positions, inputs = leader_motion(default, model, steps)
    means, variances = [[] for _ in parts], [[] for _ in parts]
    for part in parts:  # step -1: no noise, no loss; the positions ahead, and inputs of 0
        part.control(table)
    for k in range(steps):
        ahead = None
        for i, part in enumerate(parts):
            part.move(table)
            mean, variance = part.error(table, ahead, positions[k] if ahead is None else 0)
            means[i].append(mp.ldexp(mpf(mean), -BITS))
            variances[i].append(mp.ldexp(mpf(variance), -BITS))
            part.position.pass_on(table, ahead.y[1] if ahead else None, 0 if ahead else positions[k])
            if part.radio:
                part.radio.pass_on(table, ahead.u[2] if ahead else None, 0 if ahead or k == 0 else inputs[k - 1])
            part.control(table)
            ahead = part
    return means, variances


def leader_motion(default, model, steps):
    """y_0(k) and u_0(k), k = 0, 1, ...: the default vehicle behind the virtual leader, without radio; u_0 by its controller."""
    loop = loop_of(default)
    positions = leader_positions(model, loop, steps)
    reference, position = [], mpf(0)
    for k in range(steps):
        reference.append(position)
        current = [entry["value"] for entry in model["leader"]["speed"] if entry["from_step"] <= k]
        position += mpf(model["sample_period"]) * mpf(current[-1] if current else 0)
    h, (above, below) = mpf(default["time_headway"]), controller_of(default)
    above = [mpf(0)] * (len(below) - len(above)) + above
    e, c, u = [], [], []
    for k in range(steps):
        y, before = positions[k], positions[k - 1] if k else mpf(0)
        e.append(reference[k] - (1 + h) * y + h * before)
        c.append((sum(b * e[k - i] for i, b in enumerate(above) if k >= i) -
                  sum(a * c[k - i] for i, a in enumerate(below[1:], 1) if k >= i)) / below[0])
        u.append((c[k] + h * (u[k - 1] if k else 0)) / (1 + h) if default["controller"].get("headway_filter") else c[k])
    return [fixed(x) for x in positions], [fixed(x) for x in u]
