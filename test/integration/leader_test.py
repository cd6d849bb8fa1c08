#!/usr/bin/python3
"""Recorded drives as the leader: vehicle 0 follows the table, in every hosting to the bit, and the means are exact."""

import csv
import json
import math
import os
import subprocess
import unittest

import numpy as np
import yaml

import live_platoon
from terminal import LaunchTest

FOLLOWERS, STEPS, REALIZATIONS = 3, 400, 500
SETTINGS = dict(followers=FOLLOWERS, steps=STEPS, realizations=REALIZATIONS)


class Leader(LaunchTest):
    def monte_carlo(self, name, *flags, **options):
        folder = os.path.join(self.folder, name)
        command = [live_platoon.executable("monte_carlo"), "--output", folder, *flags]
        for option, value in options.items():
            command += ["--" + option.replace("_", "-"), str(value)]
        return folder, subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

    def finished(self, *arguments, **options):
        folder, done = self.monte_carlo(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return folder

    def model_behind(self, **leader):
        with open(live_platoon.shared("config", "paper.yaml")) as file:
            model = yaml.safe_load(file)
        model["leader"] = leader
        path = os.path.join(self.folder, "model.yaml")
        with open(path, "w") as file:
            json.dump(model, file)
        return path

    def leader_of(self, folder):
        """y_0(0), y_0(1), ... of a realization."""
        trajectory = self.finished("trajectory", "--trajectories", repeat=os.path.join(folder, "summary.json"), only=0)
        with open(os.path.join(trajectory, "trajectories.csv")) as file:
            return np.array([float(row["position"]) for row in csv.DictReader(file) if row["vehicle"] == "0" and int(row["step"]) >= 0])

    def test_vehicle_0_drives_like_a_shipped_table_in_the_graph_and_in_process(self):
        folder = self.finished("monte_carlo", leader="city.csv", **SETTINGS)
        table = np.genfromtxt(live_platoon.shared("config", "leaders", "city.csv"), delimiter=",", names=True)
        speed = np.interp(0.1 * np.arange(STEPS), table["time"], table["speed"])
        driven = np.concatenate([[0.0], np.cumsum(0.05 * (speed[1:] + speed[:-1]))])
        np.testing.assert_allclose(self.leader_of(folder), driven, atol=1e-9)
        with open(os.path.join(folder, "summary.json")) as file:
            agreement = json.load(file)["agreement"]
        self.assertTrue(1 < agreement["max_abs_z_mean"] < 5.5, agreement)
        self.launch(leader="city.csv", output=self.output, **SETTINGS).wait()
        self.assertTrue(live_platoon.completed_summary(self.output))
        self.assertEqual(live_platoon.statistics(self.output), live_platoon.statistics(folder))

    def test_a_table_lasts_as_long_as_the_run_and_may_have_any_columns_and_units(self):
        with open(os.path.join(self.folder, "lap.csv"), "w") as file:
            file.write("recorded by hand\nTime;Speed1\n" + "".join("%.12g;%.12g\n" % (100 + 0.5 * k, 36 + 3.6 * math.sin(k)) for k in range(61)))
        model = self.model_behind(file="lap.csv", time="Time", speed="Speed1", unit="km/h", skip_rows=1, from_second=5.0)
        folder = self.finished("run", model=model, followers=2, realizations=10)
        with open(os.path.join(folder, "summary.json")) as file:
            self.assertEqual(json.load(file)["steps"], 251, "25 s of the table are left")
        rows = 0.5 * np.arange(61)
        speed = np.interp(5.0 + 0.1 * np.arange(251), rows, [10 + math.sin(k) for k in range(61)])
        np.testing.assert_allclose(np.diff(self.leader_of(folder)), 0.05 * (speed[1:] + speed[:-1]), atol=1e-9)

    def test_bad_tables_are_named(self):
        for text, reason in (("time,velocity\n0,1\n1,1\n", "no column speed: must be one of time, velocity"),
                             ("time,speed\n0,1\n3,1\n", "row 3: 3 s after the row before: must be at most 1 s")):
            with open(os.path.join(self.folder, "bad.csv"), "w") as file:
                file.write(text)
            _, done = self.monte_carlo("none", leader=os.path.join(self.folder, "bad.csv"))
            self.assertEqual(done.returncode, 1)
            self.assertIn("leader/file: {}: {}".format(os.path.join(self.folder, "bad.csv"), reason), done.stderr)
        for leader, reason in ((dict(file="bad.csv", unit="knots"), "leader/unit: knots: must be km/h or m/s or mph"),
                               (dict(file="bad.csv", speed="v", position="x"), "leader/speed: given: must be absent beside position")):
            _, done = self.monte_carlo("none", model=self.model_behind(**leader))
            self.assertIn(reason, done.stderr)


if __name__ == "__main__":
    unittest.main()
