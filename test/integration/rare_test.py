#!/usr/bin/python3
"""Probabilities of small gaps, however small: figures of an independent program, plain Monte Carlo, bits, and bad input."""

import csv
import json
import math
import os
import signal
import subprocess
import time
import unittest

import yaml

import live_platoon
from live_platoon import tool
from terminal import LaunchTest

# Probability of a collision in 100 steps of the paper's loop at h = 3.2 with the leader at rest, by an independent program, with its
# standard error: (follower, standstill distance [m]).
KNOWN = {(1, 2.0): (5.3295e-5, 6e-8), (5, 3.0): (7.955e-3, 1.4e-5), (20, 2.0): (0.5760, 0.0024), (20, 4.0): (5.160e-4, 9e-7),
         (1, 3.0): (1.46185e-11, 4e-15), (1, 4.0): (1.16197e-20, 8e-25)}
REST = {"speed": [{"from_step": 0, "value": 0.0}]}
COLUMNS = ["vehicle", "probability", "standard_error", "lower", "upper", "bound", "per_hour"]


class Rare(LaunchTest):
    def model(self, base="paper.yaml", name="model.yaml", **changes):
        with open(live_platoon.shared("config", base)) as file:
            model = yaml.safe_load(file)
        model.update(dict(dict(leader=REST), **changes))
        return self.write(name, json.dumps(model))

    def estimate(self, name, model, **options):
        """The rows of rare.csv by vehicle, with numbers."""
        found = tool("rare", model=model, output=self.path(name), **options)
        self.assertEqual(found.returncode, 0, found.stderr)
        return self.rows(name)

    def rows(self, name):
        with open(os.path.join(self.path(name), "rare.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), COLUMNS)
        return {row["vehicle"]: {key: float(value) if value else math.nan for key, value in row.items() if key != "vehicle"}
                for row in rows}

    def document(self, name):
        with open(os.path.join(self.path(name), "rare.json")) as file:
            return json.load(file)

    def content(self, name):
        with open(os.path.join(self.path(name), "rare.csv")) as file:
            return file.read()

    def error(self, **options):
        found = tool("rare", **dict(dict(output=self.path("refused"), followers=2, steps=50, realizations=1000), **options))
        self.assertEqual(found.returncode, 1, found.stdout)
        return found.stderr

    def assert_agree(self, one, error_of_one, other, error_of_other, scores=4.5):
        self.assertLess(abs(one - other), scores * math.hypot(error_of_one, error_of_other), (one, other))

    def assert_covered(self, row, known, error):
        """Twice the interval of 95 % of 20 repetitions contains a known probability: Student's t with 19 degrees of freedom is beyond it
        in 5 of 10,000 cases."""
        half = math.log(row["upper"] / row["lower"]) / 2.0
        self.assertLess(abs(math.log(row["probability"] / known)), math.hypot(2.0 * half, 4.0 * error / known), (row, known))

    def measured(self, name, model, below, **options):
        """Frequency of a gap below `below` per follower, and its standard error."""
        with open(model) as file:
            document = dict(json.load(file), safe_gap=below)
        file = self.write("measured_{}.yaml".format(name), json.dumps(document))
        folder = self.path("measured_" + name)
        found = tool("monte_carlo", model=file, signals="gap", output=folder, **options)
        self.assertEqual(found.returncode, 0, found.stderr)
        with open(os.path.join(folder, "gaps.csv")) as table:
            rows = list(csv.DictReader(table))
        n = int(options["realizations"])
        shares = [int(row["below_safe_gap"]) / n for row in rows]
        return [(p, math.sqrt(p * (1.0 - p) / n)) for p in shares]

    def test_known_probabilities_in_ten_thousand_realizations(self):
        for distance in sorted({distance for _, distance in KNOWN}):
            name = "known_{}".format(distance)
            rows = self.estimate(name, self.model(standstill_distance=distance), followers=20, steps=100, realizations=10000)
            self.assertEqual(list(rows), [str(i) for i in range(1, 21)] + ["any"])
            for (follower, at), (probability, error) in KNOWN.items():
                if at != distance:
                    continue
                row = rows[str(follower)]
                self.assertLess(row["standard_error"], 0.02 * row["probability"])
                self.assert_agree(row["probability"], row["standard_error"], probability, error)
                self.assertTrue(row["lower"] <= row["probability"] <= row["upper"] <= row["bound"])
                self.assertLess(row["lower"], row["upper"])
                self.assertAlmostEqual(row["per_hour"] / (-math.log1p(-row["probability"]) * 360.0), 1.0, places=12)
            largest = max(row["probability"] for vehicle, row in rows.items() if vehicle != "any")
            self.assertGreater(rows["any"]["upper"], largest)
            self.assertLess(rows["any"]["lower"], sum(row["probability"] for vehicle, row in rows.items() if vehicle != "any"))

    def test_below_the_range_of_double(self):
        rows = self.estimate("far", self.model(standstill_distance=30.0), followers=1, steps=100, realizations=500)
        row = self.document("far")["rows"][0]
        self.assertIn("e-1", self.content("far").split("\n")[1])
        self.assertEqual(rows["1"]["probability"], 0.0)  # as a double
        self.assertIsNone(row["probability"])
        # -ln P of a normal tail grows with the square of the distance.
        near = self.estimate("near", self.model(name="near.yaml", standstill_distance=4.0), followers=1, steps=100, realizations=500)
        self.assertAlmostEqual(row["log10_probability"] / (math.log10(near["1"]["probability"]) * (30.0 / 4.0) ** 2), 1.0, delta=0.1)

    def test_agrees_with_plain_monte_carlo_for_all_normal_models(self):
        noise = {"numerator": [1.0, 0.5], "denominator": [1.0, -0.6]}
        start = {"mean": 0.1, "variance": 0.05}
        with open(live_platoon.shared("config", "mixed.yaml")) as file:
            mixed = yaml.safe_load(file)
        for part in [mixed] + list(mixed["vehicle_types"].values()):
            part.get("channel", {}).pop("loss", None)
            part.get("channel", {}).pop("quantisation_step", None)
        cases = {
            "coloured": (self.model(name="c.yaml", standstill_distance=4.0, channel={"noise_filter": noise, "delay": 1}), 1.0),
            "placed": (self.model(name="p.yaml", standstill_distance=2.0, initial_position=start), 0.6),
            "mixed": (self.write("m.yaml", json.dumps(mixed)), None),
            "radio": (self.model("cacc.yaml", name="r.yaml", leader={"speed": [{"from_step": 0, "value": 0.0}]}), None),
        }
        options = dict(followers=4, steps=60, seed=3)
        for name, (model, below) in cases.items():
            with self.subTest(name):
                if below is None:  # 2.5 standard deviations below the mean of the last gap
                    found = tool("analyze", model=model, signals="gap", followers=4, steps=60, json=self.path(name + ".json"))
                    self.assertEqual(found.returncode, 0, found.stderr)
                    with open(self.path(name + ".json")) as file:
                        gap = json.load(file)["signals"]["gap"]
                    means, variances = gap["mean"], gap["variance"]
                    below = min(min(row) for row in means) - 0.5 * math.sqrt(max(max(row) for row in variances))
                rows = self.estimate(name, model, below=below, realizations=4000, **options)
                measured = self.measured(name, model, below, realizations=100000, **options)
                for i, (share, error) in enumerate(measured, 1):
                    row = rows[str(i)]
                    self.assert_agree(row["probability"], row["standard_error"], share, max(error, 1e-5))
                self.assertGreater(max(share for share, _ in measured), 1e-4)

    def test_the_same_bits_for_every_number_of_threads_and_from_shards(self):
        model = self.model(standstill_distance=3.0)
        for method, realizations in (("condition", 3000), ("split", 400)):
            options = dict(followers=3, steps=60, realizations=realizations, seed=9, method=method)
            self.estimate(method + "_1", model, threads=1, **options)
            self.estimate(method + "_3", model, threads=3, **options)
            self.assertEqual(self.content(method + "_1"), self.content(method + "_3"))
            shards = [self.path("{}_shard_{}".format(method, i)) for i in range(3)]
            for i, shard in enumerate(shards):
                found = tool("rare", model=model, output=shard, shard="{}/3".format(i), **options)
                self.assertEqual(found.returncode, 0, found.stderr)
            self.assertEqual(tool("rare", *shards, output=self.path(method + "_merged")).returncode, 0)
            self.assertEqual(self.content(method + "_merged"), self.content(method + "_1"))
            self.assertIn("rare DIR", tool("merge", *shards, output=self.path("other")).stderr)

    def test_ctrl_c_ends_it_and_the_same_command_continues_it(self):
        model = self.model(standstill_distance=3.0)
        for method in ("condition", "split"):
            options = dict(model=model, followers=20, steps=100, realizations=200000, threads=2, checkpoint_seconds=0.2, method=method)
            command = [live_platoon.executable("rare"), "--output", self.path(method)]
            for key, value in options.items():
                command += ["--" + key.replace("_", "-"), str(value)]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                                       start_new_session=True)
            if method == "condition":
                live_platoon.wait_for(lambda: os.path.exists(os.path.join(self.path(method), "checkpoint.cbor")), "a checkpoint")
            else:
                time.sleep(3.0)
            began = time.monotonic()
            os.killpg(process.pid, signal.SIGINT)
            output, errors = process.communicate(timeout=60)
            self.assertLess(time.monotonic() - began, 2.0 * live_platoon.PATIENCE)
            self.assertEqual(process.returncode, 130, errors)
            self.assertIn("stopped after", output)
        options.update(realizations=20000, method="condition", output=self.path("condition"))
        self.assertIn("holds a shard of another run: rare is", tool("rare", **options).stderr)

    def test_splitting_agrees_with_conditioning(self):
        for distance, follower in ((2.0, 5), (2.0, 1), (3.0, 1)):
            name = "split_{}_{}".format(distance, follower)
            model = self.model(name=name + ".yaml", standstill_distance=distance)
            options = dict(followers=follower, steps=100, seed=4)
            known = self.estimate(name + "_known", model, realizations=4000, **options)[str(follower)]
            rows = self.estimate(name, model, realizations=10000, method="split", **options)
            found = rows[str(follower)]
            self.assert_covered(found, known["probability"], known["standard_error"])
            self.assertLess(found["standard_error"], 0.35 * found["probability"], name)

    def test_splitting_agrees_with_plain_monte_carlo_behind_losses(self):
        loss = {"loss": {"probability": 0.1, "on_loss": "hold"}}
        for name, channel in (("lost", loss), ("bursts", {"loss": {"probability": 0.1, "mean_burst": 2.0, "on_loss": "hold"}}),
                              ("quantised", {"quantisation_step": 0.5})):
            model = self.model(name=name + ".yaml", standstill_distance=2.0, channel=channel)
            options = dict(followers=2, steps=100, seed=2)
            rows = self.estimate(name, model, realizations=6000, **options)
            self.assertEqual(self.document(name)["method"], "split")
            measured = self.measured(name, model, 0.0, realizations=1000000, **options)
            for i, (share, error) in enumerate(measured, 1):
                row = rows[str(i)]
                self.assertTrue(math.isnan(row["bound"]))
                self.assertGreater(share, 1e-5)
                self.assert_covered(row, share, error)

    def test_bad_input(self):
        model = self.model(standstill_distance=2.0)
        lossy = self.model(name="lossy.yaml", standstill_distance=2.0, channel={"loss": {"probability": 0.1, "on_loss": "hold"}})
        silent = self.model(name="silent.yaml", standstill_distance=2.0, noise_variance=0.0)
        for options, expected in (
                (dict(model=lossy, method="condition"), "the gaps are not normal, because a link loses or quantises"),
                (dict(model=model, method="guess"), "method: guess: must be auto, condition or split"),
                (dict(model=model, below=3), "below: 3 m: must be below the mean gap of vehicle_1 at step 0, 2 m"),
                (dict(model=lossy, below=3), "the gap of vehicle_1 is smaller in each of 50 realizations"),
                (dict(model=silent), "the event cannot happen"),
                (dict(model=silent, method="split"), "levels die out"),
                (dict(model=lossy, realizations=100), "realizations: 100: must be from 200 to"),
                (dict(model=model, burn_in=50), "burn_in: 50: must be below the 50 steps"),
                (dict(model=model, below="deep"), "below: deep"),
                (dict(model=model, speed=0), "speed: 0"),
        ):
            self.assertIn(expected, self.error(**options))
            self.assertFalse(os.path.exists(os.path.join(self.path("refused"), "rare.csv")))
        self.estimate("kept", model, followers=1, steps=20, realizations=100)
        self.assertIn("never overwritten", self.error(model=model, output=self.path("kept")))


if __name__ == "__main__":
    unittest.main()
