#!/usr/bin/python3
"""The audit's own theory of losses in bursts (audit/loss_chains.py), against the second moments of the whole state of two followers
in all modes of their chains, by one sparse linear system in 120 digits; and of unlike cars with radios, by a table's late step."""

import itertools
import unittest

from mpmath import mp, mpf

import burst_theory_test
import link_reference
from audit import tables
from audit.received_strings import String

PAPER = {"plant": {"numerator": [1.0], "denominator": [1.0, -2.0, 1.0]}, "time_headway": 3.2, "sample_period": 0.1,
         "noise_variance": 0.6,
         "controller": {"numerator": [1.35, 0.0], "denominator": [1.0, 0.89], "divide_by_one_plus_headway": True},
         "leader": {"speed": [{"from_step": 0, "value": 20.0}]}, "initial_position": {"mean": 0.0, "variance": 0.0}}


def paper(q, burst, on_loss="hold"):
    return dict(PAPER, channel={"loss": {"probability": q, "mean_burst": burst, "on_loss": on_loss}})


def solved(rows, right):
    """The solution of a sparse system, rows as dictionaries."""
    order, free = [], set(range(len(rows)))
    while free:
        i = min(free, key=lambda row: len(rows[row]))
        j = max(rows[i], key=lambda column: abs(rows[i][column]))
        free.discard(i)
        order.append((i, j))
        for row in free:
            if j in rows[row]:
                factor = rows[row].pop(j) / rows[i][j]
                for column, x in rows[i].items():
                    if column != j:
                        rows[row][column] = rows[row].get(column, mpf(0)) - factor * x
                right[row] -= factor * right[i]
    x = [None] * len(rows)
    for i, j in reversed(order):
        x[j] = (right[i] - sum(a * x[column] for column, a in rows[i].items() if column != j)) / rows[i][j]
    return x


class Whole:
    """Deviations from a steady drive: y(k), y(k - 1), c(k - 1) of every follower and the positions that it used before."""

    def __init__(self, model, followers=2):
        loss = model["channel"]["loss"]
        self.q, burst, self.h = mpf(loss["probability"]), mpf(loss["mean_burst"]), mpf(model["time_headway"])
        self.c = [mpf(x) for x in link_reference.predictor_of(loss)]
        self.followers, self.own = followers, 3 + len(self.c)
        self.size = self.own * followers
        self.speed = mpf(model["leader"]["speed"][0]["value"]) * mpf(model["sample_period"])
        self.noise = mpf(model["noise_variance"])
        self.gain, self.pole = mpf(1.35) / (1 + self.h), mpf(0.89)
        leave, stay = self.q / (1 - self.q) / burst, 1 - 1 / burst
        chain = [[1 - leave, leave], [1 - stay, stay]]
        self.modes = list(itertools.product((0, 1), repeat=followers))
        self.chances = [[mp.fprod(chain[a][b] for a, b in zip(before, after)) for after in self.modes] for before in self.modes]
        self.stationary = [mp.fprod(self.q if lost else 1 - self.q for lost in mode) for mode in self.modes]

    def step(self, mode):
        """The rows of the next state over the state, one noise per follower and 1."""
        rows, width, ahead = [], self.size + self.followers + 1, {}
        for i, lost in enumerate(mode):
            y, before, command, used = (self.own * i + j for j in range(4))
            sent = {**ahead, self.size + i: mpf(1)}
            if lost:
                sent = {used + j: c for j, c in enumerate(self.c)}
                sent[width - 1] = -self.speed * sum((j + 1) * c for j, c in enumerate(self.c))
            error = dict(sent)
            for place, factor in ((y, -1 - self.h), (before, self.h), (width - 1, -self.h * self.speed)):
                error[place] = error.get(place, mpf(0)) + factor
            steered = {place: self.gain * factor for place, factor in error.items()}
            steered[command] = steered.get(command, mpf(0)) - self.pole
            rows += [{y: mpf(2), before: mpf(-1), command: mpf(1)}, {y: mpf(1)}, steered, sent]
            rows += [{used + j: mpf(1)} for j in range(len(self.c) - 1)]
            ahead = {y: mpf(1)}
        return rows

    def variances(self):
        n, last, steps = self.size, self.size + self.followers, [self.step(mode) for mode in self.modes]
        rows, right = [], []
        for c, step in enumerate(steps):
            for i in range(n):
                row = {c * n + i: mpf(1)}
                for m in range(len(steps)):
                    for j, a in step[i].items():
                        if j < n:
                            row[m * n + j] = row.get(m * n + j, mpf(0)) - self.chances[m][c] * a
                rows.append(row)
                right.append(self.stationary[c] * step[i].get(last, mpf(0)))
        mean = solved(rows, right)
        pairs = [(i, j) for i in range(n) for j in range(i + 1)]
        place = {pair: k for k, (i, j) in enumerate(pairs) for pair in ((i, j), (j, i))}
        rows, right = [], []
        for c, step in enumerate(steps):
            for i, j in pairs:
                row, given = {c * len(pairs) + place[i, j]: mpf(1)}, mpf(0)
                for (x, a), (y, b) in itertools.product(step[i].items(), step[j].items()):
                    if x < n and y < n:
                        for m in range(len(steps)):
                            at = m * len(pairs) + place[x, y]
                            row[at] = row.get(at, mpf(0)) - self.chances[m][c] * a * b
                    elif x == y:
                        given += self.stationary[c] * a * b * (self.noise if x < last else 1)
                    elif last in (x, y) and min(x, y) < n:
                        given += a * b * sum(self.chances[m][c] * mean[m * n + min(x, y)] for m in range(len(steps)))
                rows.append(row)
                right.append(given)
        second = solved(rows, right)
        found = []
        for i in range(self.followers):
            error = {self.own * i: -1 - self.h, self.own * i + 1: self.h}
            if i:
                error[self.own * (i - 1)] = mpf(1)
            first = sum(a * mean[m * n + x] for x, a in error.items() for m in range(len(steps)))
            square = sum(a * b * second[m * len(pairs) + place[x, y]] for m in range(len(steps))
                         for (x, a), (y, b) in itertools.product(error.items(), repeat=2))
            found.append(square - first * first)
        return found


class AuditTheory(unittest.TestCase):
    def test_stationary_variances_behind_bursts_are_those_of_the_whole_state(self):
        held = [(0.1, 4.0), (0.5, 2000.0), (0.1, 1e6), (1e-16, 5.0), (0.45, 1.0), (0.85, 50.0)]
        for q, burst, on_loss in [loss + ("hold",) for loss in held] + [
                (0.2, 3.0, "extrapolate"), (1e-3, 300.0, "extrapolate"), (0.3, 2.0, [0.7, 0.6, -0.3])]:
            with self.subTest(loss=q, mean_burst=burst, on_loss=on_loss):
                ours, *_ = String(paper(q, burst, on_loss)).stationary(2)
                for one, other in zip(ours, Whole(paper(q, burst, on_loss)).variances()):
                    self.assertLess(abs(one / other - 1), 1e-14)

    def test_limits_are_those_of_a_long_string(self):
        string = String(paper(0.1, 3.0))
        variances, *_ = string.stationary(4000)
        first = [2 * variances[4 * n - 1] - variances[n - 1] for n in (250, 1000)]  # without the term in n^(-1/2), then in 1/n
        self.assertLess(abs((4 * first[1] - first[0]) / 3 / string.limits()[1][0] - 1), 1e-4)

    def test_loss_gains_are_those_of_the_kernel_summed_over_the_lags_of_the_chain(self):
        for model in (paper(0.2, 3.0), paper(0.6, 1.7), paper(0.1, 1.5, "extrapolate")):
            self.assertLess(abs(String(model).loss_gain() / burst_theory_test.loss_gain(model, 128)[1] - 1), 1e-10)

    def test_the_loss_gain_of_long_bursts_is_that_of_all_lags(self):
        model = dict(PAPER, **burst_theory_test.LONG_BURSTS)
        self.assertLess(abs(String(model).loss_gain() / burst_theory_test.loss_gain_by_lags(model, 1 << 19) - 1), 1e-12)

    def test_radios_of_unlike_cars_agree_with_the_table_at_a_late_step(self):
        def inputs(**radio):
            return [{"signal": "position", "from": "predecessor", "noise_variance": 0.5},
                    {"signal": "input", "from": "predecessor", "gain": 0.4, "noise_variance": 0.1, "channel": dict(radio)}]
        other = {"plant": {"numerator": [0.4, 0.1], "denominator": [1.0, -2.3, 1.6, -0.3]}, "time_headway": 4.0,
                 "inputs": inputs(delay=2, loss={"probability": 0.2, "on_loss": "hold"})}
        alone = {"time_headway": 3.0, "inputs": inputs()[:1]}
        types = {"other": other, "alone": alone}
        model = dict(PAPER, inputs=inputs(delay=1), vehicle_types=types, string=["other", "default", "alone"])
        string = String(model)
        self.assertLess(max(abs(z) for z in string.settling()), 0.86)
        ours, *_ = string.stationary(4)
        for one, row in zip(ours, tables.moments(model, 4, 300)[1]):
            self.assertLess(abs(one / row[-1] - 1), 1e-13)


if __name__ == "__main__":
    unittest.main()
