#!/usr/bin/python3
"""Gap, speed, acceleration, jerk and relative speed: the same bits in every hosting, after kills, from shards and from a bag;
agreement with the theory; replay of the worst realization."""

import csv
import json
import math
import os
import subprocess
import unittest

import numpy as np
import stochastic_platoon as sp
import yaml

import live_platoon
from live_platoon import tool
from terminal import LaunchTest

FOLLOWERS, STEPS, REALIZATIONS = 4, 50, 4000
SIGNALS = "gap,speed,acceleration,jerk,relative_speed"
SETTINGS = dict(followers=FOLLOWERS, steps=STEPS, realizations=REALIZATIONS, seed=5)
TABLES = ("statistics.csv", "signals.csv", "gaps.csv", "amplification.csv")


def rows_of(*path):
    with open(os.path.join(*path)) as file:
        return list(csv.DictReader(file))


def tables_of(folder):
    contents = {}
    for name in TABLES:
        with open(os.path.join(folder, name), "rb") as file:
            contents[name] = file.read()
    return contents


class Signals(LaunchTest):
    def setUp(self):
        super().setUp()
        with open(live_platoon.shared("config", "paper.yaml")) as file:
            model = yaml.safe_load(file)
        model.update(standstill_distance=2.0, vehicle_length=0.25, safe_gap=0.5, leader={"speed": [{"from_step": 0, "value": 0.0}]})
        self.model = self.write("model.yaml", json.dumps(model))

    def measure(self, name, **options):
        """The output of monte_carlo."""
        found = tool("monte_carlo", signals=SIGNALS, output=self.path(name), **dict(SETTINGS, **{"model": self.model, **options}))
        self.assertEqual(found.returncode, 0, found.stderr)
        return found.stdout

    def test_the_same_bits_in_every_hosting_after_a_kill_of_shards_and_from_a_bag(self):
        self.measure("monte_carlo")
        expected = tables_of(self.path("monte_carlo"))
        shards = [self.path("shard_%d" % i) for i in range(3)]
        for i, shard in enumerate(shards):
            self.measure(os.path.basename(shard), shard="%d/3" % i)
        self.assertEqual(tool("merge", *shards, output=self.path("merged")).returncode, 0)
        self.assertEqual(tables_of(self.path("merged")), expected)
        for hosting in ("processes", "one_process"):
            output, bag = self.path(hosting), self.path(hosting + ".bag")
            # The bag of the processes is recorded without signals.
            signals = SIGNALS if hosting == "one_process" else ""
            self.run_to_the_end(model=self.model, hosting=hosting, output=output, record=bag, batch=500, signals=signals, **SETTINGS)
            if signals:
                self.assertEqual(tables_of(output), expected)
            found = tool("bag_statistics", bag, signals=SIGNALS, output=self.path("of_" + hosting))
            self.assertEqual(found.returncode, 0, found.stderr)
            self.assertEqual(tables_of(self.path("of_" + hosting)), expected)

    def test_the_report_has_the_collisions_of_the_table_beside_their_theory(self):
        for distance in (0.5, 20.0):
            with open(self.model) as file:
                model = json.load(file)
            report = self.measure("at_%g" % distance, model=self.write("near.json", json.dumps(dict(model, standstill_distance=distance))))
            worst = max(rows_of(self.path("at_%g" % distance), "gaps.csv"),
                        key=lambda row: (int(row["collisions"]), float(row["theoretical_collision_bound"])))
            count = int(worst["collisions"])
            self.assertEqual(count > 0, distance < 1.0)
            share = float(worst["theoretical_collision_bound"])
            self.assertLessEqual(count / REALIZATIONS, share + 5 * math.sqrt(share / REALIZATIONS))
            self.assertIn("Collisions (a gap below 0): in {}; by theory at most a share of {:.6g} (follower {})\n".format(
                "{} of {} realizations of follower {}, the most".format(count, REALIZATIONS, worst["vehicle"]) if count
                else "none of {} realizations".format(REALIZATIONS), share, worst["vehicle"]), report)

    def test_a_kill_9_of_follower_and_monitor_changes_no_bit(self):
        slow = dict(SETTINGS, realizations=800)
        self.measure("monte_carlo", **slow)
        terminal = self.launch(model=self.model, output=self.path("killed"), batch=100, rate=150, signals=SIGNALS, **slow)
        checkpoint = self.path("killed/checkpoint.cbor")
        for node in ("vehicle_2", "monitor"):
            live_platoon.wait_for(lambda: os.path.exists(checkpoint), "a checkpoint")
            live_platoon.kill("/platoon/" + node, terminal.master)
        self.completed(terminal, self.path("killed"))
        self.assertEqual(tables_of(self.path("killed")), tables_of(self.path("monte_carlo")))

    def test_measurement_and_theory_agree_within_the_standard_error(self):
        realizations = 100000
        self.measure("many", realizations=realizations)
        scores = {"mean": [], "variance": []}
        for row in rows_of(self.path("many"), "signals.csv"):
            mean, variance, of_mean, of_variance = (float(row[name]) for name in
                                                    ("mean", "variance", "theoretical_mean", "theoretical_variance"))
            if of_variance < 1e-12:  # noise has not reached the vehicle: only rounding errors
                self.assertLess(abs(mean - of_mean) + variance, 1e-6, row)
                continue
            scores["mean"].append(abs(mean - of_mean) / math.sqrt(of_variance / realizations))
            scores["variance"].append(abs(variance - of_variance) / (of_variance * math.sqrt(2 / (realizations - 1))))
        for name, of_cells in scores.items():  # 800 cells of each: the largest of as many normal scores; NaN if one is
            self.assertTrue(2 < np.max(of_cells) < 5.5, (name, np.max(of_cells)))
        for row in rows_of(self.path("many"), "gaps.csv"):
            share, bound = int(row["collisions"]) / realizations, float(row["theoretical_collision_bound"])
            self.assertLess(share, bound + 5 * math.sqrt(bound / realizations), row)
            self.assertGreater(share, 0.5 * bound, "the bound is close, as collisions seldom come twice")
            bins = {name: int(count) for name, count in row.items() if name.startswith("bin_")}
            self.assertEqual(sum(bins.values()), realizations)
            below = sum(count for name, count in bins.items() if float(name[4:]) < -1e-9)
            self.assertEqual(below, int(row["collisions"]))
            self.assertGreater(int(row["below_safe_gap"]), int(row["collisions"]))

    def test_the_worst_realization_is_replayed(self):
        text = self.measure("run")
        folder = self.path("run")
        worst = live_platoon.summary_of(folder)["smallest_gap"]
        self.assertIn("--repeat {}/summary.json --only {} --trajectories".format(folder, worst["realization"]), text)
        found = tool("monte_carlo", "--trajectories", repeat=os.path.join(folder, "summary.json"), only=worst["realization"],
                    output=self.path("worst"))
        self.assertEqual(found.returncode, 0, found.stderr)
        rows = rows_of(self.path("worst"), "trajectories.csv")
        self.assertEqual(len(rows), (FOLLOWERS + 1) * (STEPS + 1))
        gaps = {(int(row["vehicle"]), int(row["step"])): float(row["gap"]) for row in rows if row["gap"]}
        self.assertEqual(min(gaps.values()), worst["gap"])
        self.assertEqual(gaps[worst["vehicle"], worst["step"]], worst["gap"])
        position = {(int(row["vehicle"]), int(row["step"])): float(row["position"]) for row in rows}
        i, k = worst["vehicle"], worst["step"]
        self.assertEqual(position[i - 1, k] - position[i, k] - 0.25, worst["gap"])
        again = tool("monte_carlo", "--trajectories", repeat=os.path.join(folder, "summary.json"), only=0, output=self.path("worst"))
        self.assertIn("exists and is never overwritten", again.stderr)

    def test_a_trajectory_has_the_control_input_of_every_car_that_has_one(self):
        for model in ("acc.yaml", "cacc.yaml", "acc_limits.yaml"):
            folder, settings = self.path(model), dict(followers=2, steps=50, realizations=1)
            self.assertEqual(tool("monte_carlo", model=model, signals="input", output=folder, **settings).returncode, 0)
            measured = np.array([float(row["mean"]) for row in rows_of(folder, "signals.csv")]).reshape(2, 50)
            self.assertGreater(np.ptp(measured), 0.0)
            self.assertEqual(tool("monte_carlo", "--trajectories", repeat=folder + "/summary.json", only=0, output=folder + "_0").returncode, 0)
            for found in (sp.Trajectories.load(folder + "_0"), sp.trajectories(sp.Model.load(model), 0, **settings)):
                np.testing.assert_array_equal(found["input"][1:, 1:], measured)
        self.assertTrue(np.isnan(sp.trajectories(sp.Model.load("paper.yaml"), 0, **settings)["input"]).all())

    def test_behind_losses_signals_have_a_theory_but_collisions_none(self):
        for burst in ("", 3.0):
            folder = "lossy{}".format(burst)
            text = self.measure(folder, loss=0.1, **({"mean_burst": burst} if burst else {}))
            self.assertRegex(text, r"gap of follower 4 at 4.9 s \(step 49\): mean .* \(theory ")
            self.assertNotIn("by theory at most", text)
            rows = rows_of(self.path(folder), "signals.csv")
            mean, variance, expected_mean, expected = (
                np.array([float(row[name]) for row in rows]) for name in ("mean", "variance", "theoretical_mean", "theoretical_variance"))
            error = np.sqrt(np.maximum(expected, 1e-12) / REALIZATIONS)
            self.assertLess(np.max(abs(mean - expected_mean) / error), 5.0)
            self.assertLess(np.max(abs(variance - expected)[expected <= 1e-9]), 1e-6)
            self.check_variances_behind_losses({"probability": 0.1, **({"mean_burst": burst} if burst else {})})
            self.assertEqual({row["theoretical_collision_bound"] for row in rows_of(self.path(folder), "gaps.csv")}, {""})

    def check_variances_behind_losses(self, loss):
        """No formula has the scatter of a variance behind losses: that of 32 seeds takes its place, 1 to 2 % of their mean in every cell."""
        model, names, seeds = sp.Model.load(self.model).replace({"channel/loss": loss}), SIGNALS.split(","), 32
        found = [sp.monte_carlo(model, signals=names, seed=seed, followers=FOLLOWERS, steps=STEPS, realizations=500).signals for seed in range(1, 1 + seeds)]
        expected = np.array([found[0][name].theoretical_variance for name in names])
        moves = expected > 1e-9
        self.assertGreater(np.mean(moves), 0.8)
        measured = np.array([[of[name].variance for name in names] for of in found])[:, moves]
        error = measured.std(axis=0, ddof=1) / math.sqrt(seeds)
        self.assertLess(np.max(error / expected[moves]), 0.02)
        # Student's t with 31 degrees of freedom is beyond 6.9 in 1e-7 of cases: in 1e-4 for 1000 cells.
        self.assertLess(np.max(abs(measured.mean(axis=0) - expected[moves]) / error), 6.9)

    def test_bad_input_is_named(self):
        for options, message in (
                (dict(signals="distance"), "run/signals: distance: must be some of gap, speed, acceleration, jerk, input, relative_speed, each once"),
                (dict(only=REALIZATIONS, trajectories="true"), "only: 4000: must be a whole number from 0 to 3999"),
                (dict(only=3), "only: given: must be with --trajectories"),
                (dict(only=-1, trajectories="true"), "only: -1: must be a whole number from 0 to 3999")):
            found = subprocess.run([live_platoon.executable("monte_carlo"), "--model", self.model, "--output", self.path("none")]
                                   + ["--%s=%s" % (name.replace("_", "-"), value) for name, value in dict(SETTINGS, **options).items()],
                                   stderr=subprocess.PIPE, universal_newlines=True)
            self.assertEqual(found.returncode, 1)
            self.assertIn(message, found.stderr)
        for key in ("vehicle_length", "safe_gap"):
            with open(self.model) as file:
                model = dict(json.load(file), **{key: -1.0})
            found = tool("monte_carlo", model=self.write("bad.yaml", json.dumps(model)), output=self.path("none"))
            self.assertIn("model/%s: -1.0: must be a finite number >= 0" % key, found.stderr)


if __name__ == "__main__":
    unittest.main()
