"""Estimations of `rare` for tests: models, rows of rare.csv, and comparisons with known and measured probabilities."""

import csv
import json
import math
import os

import numpy as np
import scipy.stats
import yaml

import live_platoon
from folder import FolderTest
from live_platoon import tool

REST = {"speed": [{"from_step": 0, "value": 0.0}]}
COLUMNS = ["vehicle", "probability", "standard_error", "lower", "upper", "bound", "per_hour"]


class RareTest(FolderTest):
    def model(self, base="paper.yaml", name="model.yaml", **changes):
        with open(live_platoon.shared("config", base)) as file:
            model = yaml.safe_load(file)
        model.update(dict(dict(leader=REST), **changes))
        return self.write(name, json.dumps(model))

    def bursty(self, name, **changes):
        """A car whose gap of 44 m few bursts close."""
        loss = dict({"probability": 1e-6, "mean_burst": 25, "on_loss": "extrapolate"}, **changes)
        loss = {key: value for key, value in loss.items() if value is not None}
        return self.write(name + ".yaml", json.dumps({
            "plant": {"actuator_lag": 0.2}, "controller": {"kp": 0.2, "kd": 0.7, "headway_filter": True}, "time_headway_seconds": 2.0,
            "standstill_distance": 4.0, "sample_period": 0.2, "start": "steady", "leader": {"speed": [{"from_step": 0, "value": 20.0}]},
            "inputs": [{"signal": "position", "from": "predecessor", "noise_variance": 0.3, "channel": {"loss": loss}}],
            "initial_position": {"mean": 0.0, "variance": 0.0}, "allow_unstable": True}))

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

    def trajectory(self, name, model, vehicle, **options):
        """Gaps of a follower in the replayed realization, per step from 0 on."""
        found = tool("rare", "--trajectories", model=model, output=self.path(name), vehicle=vehicle, **options)
        self.assertEqual(found.returncode, 0, found.stderr)
        with open(os.path.join(self.path(name), "trajectories.csv")) as file:
            return np.array([float(row["gap"]) for row in csv.DictReader(file)
                             if row["vehicle"] == str(vehicle) and int(row["step"]) >= 0])

    def error(self, **options):
        found = tool("rare", **dict(dict(output=self.path("refused"), followers=2, steps=50, realizations=1000), **options))
        self.assertEqual(found.returncode, 1, found.stdout)
        return found.stderr

    def assert_agree(self, one, error_of_one, other, error_of_other, scores=4.5):
        self.assertLess(abs(one - other), scores * math.hypot(error_of_one, error_of_other), (one, other))

    def assert_covered(self, row, known, error):
        """The interval of a splitting, of 95 %, reaches as far as Student's t of 20 repetitions, with one and a half of them unseen. Twice the
        interval contains a known probability: Student's t with 19 degrees of freedom is beyond it in 5 of 10,000 cases."""
        reach = scipy.stats.t.ppf(0.975, 19) * math.hypot(row["standard_error"] / row["probability"], 1.5 / 20.0)
        self.assertAlmostEqual(math.log(row["probability"] / row["lower"]), reach, places=9, msg=row)
        self.assertLess(abs(math.log(row["probability"] / known)), math.hypot(2.0 * reach, 4.0 * error / known), (row, known))

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
