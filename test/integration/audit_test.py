#!/usr/bin/env python3
"""Holds what analyze says of random platoons to an independent computation in 120 digits (mpmath).

Draws admissible models of orders 1 to 6 of the kinds that have broken something before: plain ones, sampled at a
kilohertz, with long headways, near the border of string stability, with factors that nearly cancel, and A, B, C in
skewed coordinates. For each the tables, stationary variances, verdict, headways and bounds are computed here again,
from the numbers in the model file, by other methods: the moments by recursion in 120 digits, norms by the recursion of
Astrom, Jury and Agniel (IEEE Trans. Automat. Control 15, 1970) in place of quadrature, poles, peaks and spectral
factors by polynomial roots.

audit_test.py ANALYZE [--seconds S] [--seed SEED] [--keep FOLDER]
"""

import argparse
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

from mpmath import mp, mpf, polyroots

mp.dps = 120
FOLLOWERS = 4
STEPS = 40

# What is promised, relative to the largest of the kind but for the variances and norms, which are relative each.
MEAN = 1e-13          # of the largest mean and displacement times headway
VARIANCE = 1e-12      # of a cell
STATIONARY = 1e-12
LIMIT = 1e-9
DECAY = 1e-11         # of 1 - rho(A)
UNDECIDED = 1e-11     # of |D|^2 - |N|^2 over the sum of its terms: the digits of the coefficients end there


# Polynomials: lists of coefficients, of the highest power first.

def times(p, q):
    product = [mpf(0)] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
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


def zeros(p):
    p = trimmed(p)
    at_origin = 0
    while len(p) > 1 and p[-1] == 0:
        p, at_origin = p[:-1], at_origin + 1
    if len(p) < 2:
        return [mpf(0)] * at_origin
    largest = max(abs(a) for a in p)
    return [mpf(0)] * at_origin + polyroots([a / largest for a in p], maxsteps=400, extraprec=600)


def without_factor(p, zero):
    """p / (z - zero), the remainder dropped."""
    quotient, carried = [], mpf(0)
    for a in p[:-1]:
        carried = carried * zero + a
        quotient.append(carried)
    return quotient


def squared_norm(n, d):
    """(1/2pi) integral of |N/D|^2 over the unit circle, by reducing the degree of D one at a time."""
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


class Loop:
    """T = N / D at headway h, S = 1 - HT, with D's leading coefficient 1."""

    def __init__(self, n, d, h):
        d = trimmed(d)
        self.n, self.d = [a / d[0] for a in trimmed(n)], [a / d[0] for a in d]
        self.h = mpf(h)
        self.poles = zeros(self.d)
        self.rho = max(abs(z) for z in self.poles)
        self.hn = times([1 + self.h, -self.h], self.n)           # HT = hn / (z d)
        self.zd = self.d + [mpf(0)]
        self.s = plus(self.zd, [-a for a in self.hn])            # S = s / (z d)

    def margin(self):
        """|D|^2 - |N|^2 over 1 - x in x = cos w, and the size of the terms it is the difference of."""
        def squared(p):
            m = len(p) - 1
            lag = [sum(p[i] * p[i + k] for i in range(m + 1 - k)) for k in range(m + 1)]
            before, current = [mpf(1)], [mpf(1), mpf(0)]
            result = [lag[0]]
            for k in range(1, m + 1):
                result = plus(result, [2 * lag[k] * a for a in current])
                before, current = current, plus([2 * a for a in current] + [mpf(0)], [-a for a in before])
            return result
        difference = plus(squared(self.d), [-a for a in squared(self.n)])
        return [-a for a in without_factor(difference, mpf(1))]

    def is_string_stable(self):
        """None where the digits of double do not tell."""
        if self.rho >= 1:
            return False
        margin = self.margin()
        points = [mpf(-1), mpf(1)]
        for x in zeros(slope(margin)):
            if abs(x.imag) < mpf(10) ** -40 and -1 < x.real < 1:
                points.append(x.real)
        least = mp.inf
        for x in points:
            # What a change of each coefficient by its last digit, T(1) = 1 kept, does to the margin.
            z = x + mp.sqrt(x * x - 1 + 0j) if x < 1 else mpf(1)
            spread = sum(abs(a) * i * i for p in (self.n, self.d) for i, a in enumerate(p[::-1]))
            doubt = spread * (abs(value(self.d, z)) + abs(value(self.n, z)))
            least = min(least, value(margin, x) / doubt)
        if abs(least) < UNDECIDED:
            return None
        return least > 0

    def filtered(self, u):
        """T u from the zero state."""
        lead = len(self.d) - len(self.n)
        y = []
        for k in range(len(u)):
            total = mpf(0)
            for i, b in enumerate(self.n):
                if k - lead - i >= 0:
                    total += b * u[k - lead - i]
            for i, a in enumerate(self.d[1:], 1):
                if k - i >= 0:
                    total -= a * y[k - i]
            y.append(total)
        return y

    def with_headway(self, u):
        return [(1 + self.h) * a - self.h * b for a, b in zip(u, [mpf(0)] + u)]

    def integral_defect(self):
        """By how much T misses double integral action, T(1) = 1 and dT/dz(1) = -h."""
        at_one = value(self.d, mpf(1))
        gain = value(self.n, mpf(1)) / at_one
        rise = (value(slope(self.n), mpf(1)) - gain * value(slope(self.d), mpf(1))) / at_one
        return abs(gain - 1) + abs(rise + self.h) / (1 + self.h)

    def limit(self):
        """||S/M||^2 - 1, M M~ = 1 - T T~: the variance along an endless string over that of the noise."""
        margin = self.margin()
        factor = [mpf(1)]
        for x in zeros(margin):
            z = x + mp.sqrt(x * x - 1)
            factor = times(factor, [mpf(1), -(z if abs(z) < 1 else 1 / z)])
        factor = [a.real for a in factor]
        # |D|^2 - |N|^2 = (1 - x) margin(x) and |z - 1|^2 = 2 (1 - x)
        scale = value(margin, mpf(1)) / 2 / value(factor, mpf(1)) ** 2
        s = without_factor(self.s, mpf(1))
        return squared_norm(s, times([mpf(1), mpf(0)], factor)) / scale - 1


def moments(loop, model):
    """Means and variances of zeta_i(k)."""
    n_delta = STEPS + 1
    delta = [mpf(1)] + [mpf(0)] * (STEPS - 1)
    noise, variance_noise = mpf(model["noise_variance"]), [mpf(0)] * STEPS
    initial = model["initial_position"]
    mean_0, variance_0 = mpf(initial["mean"]), mpf(initial["variance"])
    # The leader from its equilibrium at 0: zeta_0 = S r_0.
    period = mpf(model["sample_period"])
    position, reference, speeds = mpf(0), [], model["leader"]["speed"]
    for k in range(STEPS):
        reference.append(position)
        current = [entry["value"] for entry in speeds if entry["from_step"] <= k]
        position += period * mpf(current[-1] if current else 0)
    y = loop.filtered(reference)
    leader = [a - b for a, b in zip(reference, loop.with_headway(y))]
    # Free motion from y = 1 at step -1 with the input 0 from then on: 1 - T applied to a step, over T(1).
    gain = value(loop.n, mpf(1)) / value(loop.d, mpf(1))
    held = loop.filtered([mpf(1)] * n_delta)
    free = [1 - a / gain for a in held]
    means, variances = [], []
    g = [-a for a in loop.with_headway(loop.filtered(delta))]
    following = loop.filtered([a + b for a, b in zip(delta, g)])
    a_m = [-a for a in loop.with_headway(free)]
    a_following = [w - b for w, b in zip(free, loop.with_headway(loop.filtered(free)))]
    shift, total = [mpf(0)] * STEPS, [mpf(0)] * STEPS
    for _ in range(FOLLOWERS):
        leader = loop.filtered(leader)
        energy = mpf(0)
        for k in range(STEPS):
            energy += g[k] ** 2
            shift[k] += mean_0 * a_m[k + 1]
            total[k] += noise * energy + variance_0 * a_m[k + 1] ** 2
        means.append([a + b for a, b in zip(leader, shift)])
        variances.append(list(total))
        g, following = following, loop.filtered(following)
        a_m, a_following = a_following, loop.filtered(a_following)
    return means, variances


# Models, whose numbers are all doubles, and their loops.

def dyadic(x, bits=12):
    return round(x * 2 ** bits) / 2 ** bits


def expanded(*factors):
    """The product of factors that are exact in double; refuses one that is not."""
    product = [mpf(1)]
    for factor in factors:
        product = times(product, [mpf(a) for a in factor])
    result = [float(a) for a in product]
    return result if all(mpf(a) == b for a, b in zip(result, product)) else None


def design_loop(model, h=None):
    h = mpf(model["time_headway"] if h is None else h)
    plant, controller = model["plant"], model["controller"]
    n = times([mpf(a) for a in plant["numerator"]], [mpf(a) for a in controller["numerator"]])
    d = times([mpf(a) for a in plant["denominator"]], [mpf(a) for a in controller["denominator"]])
    if controller.get("divide_by_one_plus_headway", False):
        d = [a * (1 + h) for a in d]
    numerator, denominator = times(n, [1, 0]), plus(times(d, [1, 0]), times(n, [1 + h, -h]))
    while numerator[-1] == 0 and denominator[-1] == 0:
        numerator, denominator = numerator[:-1], denominator[:-1]
    return Loop(numerator, denominator, h)


def given_loop(model):
    given = model["closed_loop"]
    a = mp.matrix([[mpf(x) for x in row] for row in given["A"]])
    b, c = [mpf(x) for x in given["B"]], [mpf(x) for x in given["C"]]
    size = a.rows
    # N(z) and D(z) from their values at size + 1 points: D = det(zI - A), N = D C (zI - A)^-1 B.
    points = [mpf(2 + i) for i in range(size + 1)]
    n_values, d_values = [], []
    scale = 1 + max(abs(x) for x in a)
    with mp.workdps(400):
        for z in points:
            shifted = mp.eye(size) * z * scale - a
            d = mp.det(shifted)
            x = mp.lu_solve(shifted, mp.matrix(b))
            d_values.append(d)
            n_values.append(d * sum(c[i] * x[i] for i in range(size)))
        vandermonde = mp.matrix([[(z * scale) ** (size - i) for i in range(size + 1)] for z in points])
        n = list(mp.lu_solve(vandermonde, mp.matrix(n_values)))
        d = list(mp.lu_solve(vandermonde, mp.matrix(d_values)))
    n = [x if abs(x) > mpf(10) ** -100 * max(abs(y) for y in n) else mpf(0) for x in n]
    return Loop(n, d, model["time_headway"])


def rest_of_model(draw, period):
    speeds = [{"from_step": 0, "value": dyadic(draw.uniform(-30, 30), 3)}]
    if draw.random() < 0.5:
        speeds.append({"from_step": draw.randrange(1, 30), "value": dyadic(draw.uniform(-30, 30), 3)})
    placed = draw.random() < 0.5
    return {"standstill_distance": draw.choice([0.0, 3.5]), "sample_period": period,
            "noise_variance": dyadic(draw.uniform(0.1, 5)), "leader": {"speed": speeds},
            "initial_position": {"mean": dyadic(draw.uniform(-2, 2)) if placed else 0.0,
                                 "variance": dyadic(draw.uniform(0, 2)) if placed else 0.0}}


def plain(draw):
    extra = [[1, -dyadic(draw.uniform(-0.8, 0.9))] for _ in range(draw.randrange(0, 3))]
    lead = [1, -dyadic(draw.uniform(0.3, 0.97))]
    poles = [[1, -dyadic(draw.uniform(-0.9, 0.6))] for _ in range(draw.randrange(1, 3))]
    plant = expanded([1, -1], [1, -1], *extra)
    if plant is None:
        return None
    return dict(rest_of_model(draw, 0.125), time_headway=draw.uniform(0.5, 12),
                plant={"numerator": [1.0], "denominator": plant},
                controller={"numerator": [math.exp(draw.uniform(-6, 0)) * a for a in lead],
                            "denominator": expanded(*poles),
                            "divide_by_one_plus_headway": draw.random() < 0.5})


def sampled_fast(draw):
    """A vehicle with an engine's lag and a controller of gains in SI units, sampled at a kilohertz."""
    period, lag = 0.001, draw.uniform(0.1, 1.0)
    pole = dyadic(math.exp(-period / lag), 20)
    gain = dyadic((1 - pole) * period ** 2 / 2 * 2 ** 30, 20) / 2 ** 30
    k_v, k_p = draw.uniform(0.3, 3), draw.uniform(0.05, 1)
    filtered = dyadic(draw.uniform(-0.5, 0.95))
    damping = k_v / period
    return dict(rest_of_model(draw, period), time_headway=float(draw.randrange(300, 3000)),
                plant={"numerator": [gain, gain], "denominator": expanded([1, -1], [1, -1], [1, -pole])},
                controller={"numerator": [damping + k_p, -damping], "denominator": [1.0, -filtered]})


def long_headway(draw):
    model = plain(draw)
    if model is None:
        return None
    h = math.exp(draw.uniform(math.log(20), math.log(3000)))
    model["time_headway"] = h
    model["controller"]["divide_by_one_plus_headway"] = True
    return model


def near_border(draw):
    model = plain(draw)
    if model is None:
        return None
    low, high = 0.05, 60.0
    if design_loop(model, low).is_string_stable() or not design_loop(model, high).is_string_stable():
        return None
    for _ in range(44):
        middle = (low + high) / 2
        low, high = (low, middle) if design_loop(model, middle).is_string_stable() else (middle, high)
    model["time_headway"] = high * (1 + draw.choice([-1, 1]) * 10 ** draw.uniform(-9, -3))
    return model


def near_cancellation(draw):
    model = plain(draw)
    if model is None:
        return None
    pole = dyadic(draw.uniform(-0.8, 0.9), 8)
    apart = round(10 ** draw.uniform(-10, -3) * 2 ** 40) / 2 ** 40
    denominator = expanded(model["plant"]["denominator"], [1, -pole])
    if denominator is None:
        return None
    model["plant"]["denominator"] = denominator
    model["controller"]["numerator"] = [
        float(a) for a in times([mpf(a) for a in model["controller"]["numerator"]], [1, -mpf(pole) - mpf(apart)])]
    if len(model["controller"]["numerator"]) > len(model["controller"]["denominator"]):
        model["controller"]["denominator"] += [0.0]
    return model


def turning(draw, size):
    if size == 1:
        return mp.eye(1)
    return mp.qr(mp.matrix([[draw.gauss(0, 1) for _ in range(size)] for _ in range(size)]))[0]


def skewed(draw):
    """T = N / D with double integral action by its choice of N, in coordinates of a drawn condition."""
    h = draw.uniform(0.5, 10)
    poles, size = [], draw.randrange(1, 7)
    while size - len(poles) > 1 and draw.random() < 0.5:
        z = mp.expj(draw.uniform(0.05, 3)) * draw.uniform(0.1, 0.95)
        poles += [z, z.conjugate()]
    while len(poles) < size:
        poles.append(mpf(draw.uniform(-0.5, 0.95)))
    d = [mpf(1)]
    for z in poles:
        d = times(d, [mpf(1), -z])
    d = [a.real for a in d]
    at_one, rise = value(d, mpf(1)), value(slope(d), mpf(1))
    if size == 1:
        h = float(rise / at_one)
        n = [at_one]
    else:
        n = [rise - h * at_one, at_one - (rise - h * at_one)]
    canonical = mp.zeros(size)
    for i in range(size):
        canonical[i, 0] = -d[i + 1]
        if i + 1 < size:
            canonical[i, i + 1] = 1
    column = [mpf(0)] * (size - len(n)) + n
    turn = [turning(draw, size) for _ in range(2)]
    condition = 10 ** draw.uniform(0, 5)
    stretch = mp.diag([mpf(condition) ** (mpf(i) / max(size - 1, 1)) for i in range(size)])
    basis = turn[0] * stretch * turn[1]
    inverse = basis ** -1
    a, b, c = basis * canonical * inverse, basis * mp.matrix(column), inverse[0, :]
    return dict(rest_of_model(draw, 0.125), time_headway=h,
                closed_loop={"A": [[float(a[i, j]) for j in range(size)] for i in range(size)],
                             "B": [float(x) for x in b], "C": [float(x) for x in c]})


KINDS = [plain, sampled_fast, long_headway, near_border, near_cancellation, skewed]


def loop_of(model):
    return given_loop(model) if "closed_loop" in model else design_loop(model)


def drawn(draw, kind):
    """A model that the assumptions admit, and its loop."""
    while True:
        model = kind(draw)
        if model is None:
            continue
        loop = loop_of(model)
        if loop.rho >= 1 - mpf(10) ** -7:
            continue
        gain = value(loop.n, mpf(1)) / value(loop.d, mpf(1))
        if "closed_loop" in model:  # skewed so far that its digits do not hold double integral action
            slope_at_one = (value(slope(loop.n), mpf(1)) - gain * value(slope(loop.d), mpf(1))) / value(
                loop.d, mpf(1))
            if abs(gain - 1) > 5e-5 or abs(slope_at_one + loop.h) > 5e-4 * (1 + loop.h):
                continue
        return model, loop


class Audit:
    def __init__(self, analyze, folder):
        self.analyze, self.folder = analyze, pathlib.Path(folder)
        self.worst, self.failures, self.failed, self.count, self.slowest = {}, [], set(), {}, (0.0, "")

    def note(self, what, error, allowed, name):
        ratio = float(error / allowed) if allowed else (0.0 if error == 0 else math.inf)
        if ratio > self.worst.get(what, (0.0, ""))[0]:
            self.worst[what] = (ratio, name)
        if not ratio <= 1 and (name, what) not in self.failed:  # the first of a table
            self.failed.add((name, what))
            self.failures.append("%s: %s is off by %.3g, allowed are %.3g" % (name, what, error, allowed))

    def fail_unless(self, condition, name, what):
        if not condition:
            self.failures.append("%s: %s" % (name, what))

    def run(self, name, model, loop):
        file, result = self.folder / (name + ".yaml"), self.folder / (name + ".json")
        file.write_text(json.dumps(model, indent=1))
        before = os.times()
        done = subprocess.run([self.analyze, "--model", str(file), "--followers", str(FOLLOWERS), "--steps",
                               str(STEPS), "--json", str(result)], capture_output=True, text=True)
        after = os.times()
        seconds = after.children_user + after.children_system - before.children_user - before.children_system
        self.slowest = max(self.slowest, (seconds, name))
        if done.returncode != 0:
            self.failures.append("%s: refused: %s" % (name, done.stderr.strip()))
            return
        found = json.loads(result.read_text())
        self.check_moments(name, model, loop, found)
        self.check_stability(name, model, loop, found)
        if "plant" in model:
            self.check_headways(name, model, loop, found)
        if not any(failure.startswith(name + ":") for failure in self.failures):
            file.unlink()
            result.unlink()

    def check_moments(self, name, model, loop, found):
        means, variances = moments(loop, model)
        fastest = max(abs(entry["value"]) for entry in model["leader"]["speed"]) * model["sample_period"]
        scale = max(max(abs(x) for row in means for x in row), mpf(fastest) * (1 + loop.h))
        for ours, theirs in zip(means, found["mean"]):
            for a, b in zip(ours, theirs):
                self.note("mean", abs(a - mpf(b)), MEAN * scale, name)
        for ours, theirs in zip(variances, found["variance"]):
            for a, b in zip(ours, theirs):
                self.note("variance", abs(a - mpf(b)), VARIANCE * a, name)
        noise = mpf(model["noise_variance"])
        total, numerator, denominator = squared_norm(loop.hn, loop.zd), loop.s, loop.zd
        for theirs in found["stationary_variance"]:
            self.note("stationary variance", abs(total * noise - mpf(theirs)), STATIONARY * total * noise, name)
            numerator, denominator = times(numerator, loop.n), times(denominator, loop.d)
            total += squared_norm(numerator, denominator)
        if found["norms"]["mean_bound"] is not None:
            for row in means:
                norm = mp.sqrt(sum(x * x for x in row))
                self.fail_unless(norm <= mpf(found["norms"]["mean_bound"]) * (1 + mpf(10) ** -9), name,
                                 "the bound of the means is exceeded")
        if found["norms"]["variance_bound"] is not None:
            largest = max(x for row in variances for x in row)
            self.fail_unless(largest <= mpf(found["norms"]["variance_bound"]) * (1 + mpf(10) ** -9), name,
                             "the bound of the variances is exceeded")

    def check_stability(self, name, model, loop, found):
        self.note("1 - rho(A)", abs((1 - loop.rho) - (1 - mpf(found["spectral_radius"]))),
                  DECAY * (1 - loop.rho) + mpf(10) ** -15, name)
        stable = loop.is_string_stable()
        if stable is None:
            return
        self.fail_unless(found["string_stable"] == stable, name,
                         "string stable: %s, and analyze says %s" % (stable, found["string_stable"]))
        if stable and found["string_stable"]:
            limit = loop.limit() * mpf(model["noise_variance"])
            # Where T(1) is 1 to some digits only, so is what a limit along the string could mean.
            undetermined = loop.integral_defect() if "closed_loop" in model else 0
            self.note("limit variance", abs(limit - mpf(found["limit_variance"])), (LIMIT + undetermined) * limit, name)
            self.fail_unless(found["bounds"]["alpha_2"] == found["limit_variance"], name, "alpha_2 is the limit")

    def check_headways(self, name, model, loop, found):
        intervals, h = found["stable_headways"], model["time_headway"]

        def inside(x):
            return any(a <= x <= b for a, b in intervals)
        self.fail_unless(inside(h) == found["string_stable"], name, "verdict and headways contradict each other")
        low, high = h / 50, h * 50
        for i in range(3):
            probe = low * (high / low) ** ((i + 0.37) / 3)
            stable = design_loop(model, probe).is_string_stable()
            if stable is not None:
                self.fail_unless(inside(probe) == stable, name, "headway %r: %s" % (probe, stable))
        for a, _ in intervals[:1]:
            if low < a < high:
                for probe, expected in ((a * (1 + 1e-7), True), (a * (1 - 1e-7), False)):
                    stable = design_loop(model, probe).is_string_stable()
                    self.fail_unless(stable in (None, expected), name, "border %r is not one" % a)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("analyze")
    parser.add_argument("--seconds", type=float, default=45.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=[kind.__name__ for kind in KINDS])
    parser.add_argument("--keep", help="folder for the models that failed")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or temporary
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        audit = Audit(arguments.analyze, folder)
        kinds = [kind for kind in KINDS if arguments.kind in (None, kind.__name__)]
        until, number = time.monotonic() + arguments.seconds, 0
        while time.monotonic() < until or number < len(kinds):
            kind = kinds[number % len(kinds)]
            name = "%s_%d_%d" % (kind.__name__, arguments.seed, number)
            model, loop = drawn(random.Random(name), kind)
            audit.run(name, model, loop)
            audit.count[kind.__name__] = audit.count.get(kind.__name__, 0) + 1
            number += 1
    print("models: %s; slowest analyze %.3f s (%s)" % (audit.count, *audit.slowest))
    for what, (ratio, name) in sorted(audit.worst.items()):
        print("%-20s %.3g of what is allowed (%s)" % (what, ratio, name))
    for failure in audit.failures[:60]:
        print("FAILED", failure)
    return 1 if audit.failures else 0


if __name__ == "__main__":
    sys.exit(main())
