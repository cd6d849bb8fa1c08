#!/usr/bin/python3
"""The program `rare` and its module: bits, interruptions, replays, plots, required distances, and bad input."""

import json
import math
import os
import signal
import subprocess
import time
import unittest

import numpy as np
import stochastic_platoon as sp

import live_platoon
from live_platoon import tool
from rare_case import COLUMNS, RareTest

PLOT = live_platoon.shared("src", "tools", "plot")
LOSS = {"loss": {"probability": 0.1, "on_loss": "hold"}}


def seconds_of(process):
    """Time that a process has computed."""
    with open("/proc/{}/stat".format(process.pid)) as file:
        user, system = file.read().rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


class Estimations(RareTest):
    def started(self, name, **options):
        """An estimation that runs, with its output in the folder of this name."""
        command = [live_platoon.executable("rare"), "--output", self.path(name)]
        for key, value in options.items():
            command += ["--" + key.replace("_", "-"), str(value)]
        return self.background(*command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

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
            self.assertIn("holds a shard of a run", tool("rare", *shards, output=shards[0]).stderr)
            self.assertIn("holds results already", tool("rare", model=model, output=self.path(method + "_1"), shard="0/3", **options).stderr)
            again = tool("monte_carlo", repeat=self.path(method + "_1", "rare.json"), output=self.path("again"))
            self.assertIn("must be the summary.json of a run", again.stderr)
            self.assertIn("holds rare.csv: must be the results of a run", tool("check", self.path(method + "_1")).stdout)

    def test_ctrl_c_ends_it_also_in_the_pilot_run_and_its_folder_is_only_for_the_same_command(self):
        model = self.model(standstill_distance=3.0)
        for method in ("condition", "split"):
            options = dict(model=model, followers=20, steps=100, realizations=200000, threads=2, checkpoint_seconds=0.2, method=method)
            process = self.started(method, **options)
            if method == "condition":
                live_platoon.wait_for(lambda: os.path.exists(os.path.join(self.path(method), "checkpoint.cbor")), "a checkpoint")
            else:
                live_platoon.wait_for(lambda: seconds_of(process) > 1.0, "the pilot run of a splitting")
                self.assertFalse(os.path.exists(os.path.join(self.path(method), ".lock")))
            self.assertIsNone(process.poll(), "it was over before it could be stopped")
            began = time.monotonic()
            process.send_signal(signal.SIGINT)
            output, errors = process.communicate(timeout=60)
            self.assertLess(time.monotonic() - began, 10.0)  # a loaded machine may be ten times slower than a second
            self.assertEqual(process.returncode, 130, errors)
            self.assertIn("stopped after", output)
        options.update(realizations=20000, method="condition", output=self.path("condition"))
        self.assertIn("holds a shard of another run: rare/realizations is 200000 there and 20000 here", tool("rare", **options).stderr)

    def test_a_follower_whose_event_is_out_of_reach_leaves_the_others_their_estimates(self):
        model = self.model(standstill_distance=3.0, vehicle_types={"far": {"standstill_distance": 80.0}}, string=["far", "default"])
        rows = self.estimate("far", model, followers=2, steps=20, realizations=2000, method="split")
        self.assertIn("below: 0 m: levels die out: no path of vehicle_1", self.document("far")["problems"]["1"])
        self.assertTrue(np.isnan(rows["1"]["probability"]) and rows["2"]["probability"] > 0.0, rows)
        self.assertLess(rows["1"]["upper"], 0.1)  # of a gap below one of the levels that the paths have reached

    def test_losses_that_no_realization_sees_are_in_the_estimate(self):
        """40 realizations of 4000 paths in all; 23 of 20,000,000 have the event. The noise alone gives 5e-8."""
        row = self.estimate("bursts", self.bursty("bursts"), followers=1, steps=60, below=43.3, realizations=4000)["1"]
        self.assert_covered(row, 23 / 2e7, math.sqrt(23) / 2e7)
        self.assertLess(row["standard_error"], 0.1 * row["probability"])
        self.assertNotIn("problems", self.document("bursts"))
        gaps = self.trajectory("bursts_replayed", self.bursty("bursts"), 1, followers=1, steps=60, below=43.3, realizations=4000)
        self.assertLess(gaps.min(), 43.3)

    def test_two_rare_losses_in_one_realization_are_in_the_upper_limit(self):
        model, options = self.bursty("pairs", probability=1e-3), dict(followers=1, steps=60, below=-10.0)
        row = self.estimate("pairs", model, realizations=5000, **options)["1"]
        begins = 1e-3 + 59 * 1e-3 / 25
        self.assertLess(row["standard_error"], 0.2 * row["probability"])
        self.assertAlmostEqual(row["upper"] / (row["probability"] ** 2 / row["lower"] + 0.5 * begins ** 2), 1.0, places=9)
        self.assertRegex(self.document("pairs")["problems"]["1"], r"row 1: the estimate is without realizations of probability 5\.6e-06 at most, .* or two of them in one realization: realizations must be more than 6e\+03")

    def test_losses_by_the_distance_that_no_path_sees_are_in_the_upper_limit(self):
        loss = {"probability": None, "mean_burst": None, "by_distance": [[40.0, 1e-5], [100.0, 1e-5]]}
        row = self.estimate("distance", self.bursty("distance", **loss), followers=1, steps=60, below=43.3, realizations=4000)["1"]
        self.assertTrue(6e-4 < row["upper"] < 6.1e-4, row)
        self.assertIn("row 1: the estimate is without realizations of probability 0.0006 at most", self.document("distance")["problems"]["1"])

    def test_a_follower_whose_event_is_certain_leaves_the_others_their_estimates(self):
        model = self.model(standstill_distance=3.0, vehicle_types={"near": {"standstill_distance": 0.5}}, string=["near", "default"])
        rows = self.estimate("near", model, followers=2, steps=20, below=1.0, realizations=2000, method="split")
        for vehicle in ("1", "any"):
            self.assertEqual((rows[vehicle]["probability"], rows[vehicle]["standard_error"], rows[vehicle]["upper"]), (1.0, 0.0, 1.0))
        (_, _), (share, error) = self.measured("near", model, 1.0, followers=2, steps=20, realizations=300000)
        self.assert_covered(rows["2"], share, error)

    def test_an_estimate_beyond_its_bound_is_the_bound_and_has_an_interval_below(self):
        row = self.estimate("bound", self.model(standstill_distance=3.9375), followers=3, steps=50, realizations=2000)["3"]
        self.assertEqual((row["probability"], row["upper"]), (row["bound"], row["bound"]))
        self.assertTrue(1.0 < (row["probability"] - row["lower"]) / row["standard_error"] < 3.0, row)

    def test_one_follower_out_of_reach_has_an_upper_limit(self):
        row = self.estimate("alone", self.model(standstill_distance=80.0), followers=1, steps=20, realizations=2000, method="split")["1"]
        self.assertTrue(np.isnan(row["probability"]) and row["upper"] < 0.1, row)
        taken = tool("rare", model=self.model(standstill_distance=80.0), followers=1, steps=20, realizations=2000, required=1e-3, output=self.path("alone"))
        self.assertEqual((taken.returncode, taken.stdout), (1, ""))
        self.assertIn("holds a rare.csv already", taken.stderr)

    def test_bad_input(self):
        model = self.model(standstill_distance=2.0)
        lossy = self.model(name="lossy.yaml", standstill_distance=2.0, channel=LOSS)
        silent = self.model(name="silent.yaml", standstill_distance=2.0, noise_variance=0.0)
        quiet = self.model(name="quiet.yaml", standstill_distance=2.0, noise_variance=1e-7)
        for options, expected in (
                (dict(model=lossy, method="condition"), "the gaps are not normal, because a link loses or quantises"),
                (dict(model="acc_limits.yaml", method="condition"), "the gaps are not normal, because a vehicle has limits"),
                (dict(model=model, method="guess"), "method: guess: must be auto, condition or split"),
                (dict(model=model, below=3), "below: 3 m: must be below the mean gap of vehicle_1 at step 0, 2 m"),
                (dict(model=lossy, below=3), "the gap of vehicle_1 is smaller in each of 50 realizations"),
                (dict(model=silent), "the event cannot happen"),
                (dict(model=silent, method="split"), "levels die out: no path of vehicle_1 falls below 2 m: must be larger, or realizations more than 1000"),
                (dict(model=lossy, realizations=100), "realizations: 100: must be from 200 to"),
                (dict(model=model, burn_in=50), "burn_in: 50: must be below the 50 steps"),
                (dict(model=model, below="deep"), "below: deep"),
                (dict(model=model, speed=0), "speed: 0"),
                (dict(model=model, required=1), "required: 1: must be above 0 and below 1"),
                (dict(model=model, required=1e-6, per="day", over="mass"), "per: day: must be run or hour"),
                (dict(model=model, required=1e-6, over="mass"), "over: mass: must be standstill_distance or time_headway"),
                (dict(model=model, per="hour"), "per: given: must be with required"),
                (dict(model=silent, required=1e-6), "required: 1e-06: not reached by standstill_distance from 2 to 259.493: must be another value; there: below: 0 m: the event cannot"),
                (dict(model=quiet, required=1e-6), "required: 1e-06: satisfied by every standstill_distance from 0.0154147 to 2: must be smaller"),
                (dict(model=model, only=3), "only: given: must be with --trajectories"),
                (dict(model=model, burn_in=-1), "burn_in: -1"),
        ):
            self.assertIn(expected, self.error(**options))
            self.assertFalse(os.path.exists(os.path.join(self.path("refused"), "rare.csv")))
        self.estimate("kept", model, followers=1, steps=20, realizations=100)
        self.assertIn("never overwritten", self.error(model=model, output=self.path("kept")))
        for options, expected in ((dict(vehicle=3), "vehicle: 3: must be"), (dict(only=1000), "only: 1000: must be"), (dict(vehicle="last"), "vehicle: last")):
            found = tool("rare", "--trajectories", model=model, output=self.path("refused"), followers=2, steps=50, realizations=1000, **options)
            self.assertEqual(found.returncode, 1)
            self.assertIn(expected, found.stderr)

    def test_a_killed_or_interrupted_estimation_continues_to_the_same_bits(self):
        for method, options in (("condition", dict(followers=5, realizations=60000)), ("split", dict(followers=2, realizations=10000))):
            options = dict(options, model=self.model(standstill_distance=3.0), steps=100, method=method, checkpoint_seconds=0.1)
            self.estimate(method + "_whole", **options)
            for number, status in ((signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, 130)):
                name = "{}_{}".format(method, status)
                checkpoint = os.path.join(self.path(name), "checkpoint.cbor")
                process = self.started(name, threads=1, **options)  # on many threads it may be over before it can be stopped
                live_platoon.wait_for(lambda: os.path.exists(checkpoint), "a checkpoint")
                process.send_signal(number)
                output, errors = process.communicate(timeout=60)
                self.assertEqual(process.returncode, status, output + errors)
                if status == 130:
                    self.assertIn("of 20 repetitions: the same" if method == "split" else "of 60000 realizations: the same", output)
                self.assertFalse(os.path.exists(os.path.join(self.path(name), "rare.csv")))
                self.estimate(name, **options)
                self.assertEqual(self.content(name), self.content(method + "_whole"))
                self.assertFalse(os.path.exists(checkpoint))

    def test_of_the_module_are_those_of_the_program(self):
        file = self.model(standstill_distance=3.0)
        options = dict(followers=3, steps=60, realizations=2000, seed=9, below=0.2, speed=20.0)
        rows = self.estimate("program", file, **options)
        seen = []
        found = sp.rare(sp.Model.load(file), output=self.path("module"), progress=lambda done, of: seen.append((done, of)), **options)
        self.assertEqual(self.content("module"), self.content("program"))
        self.assertEqual(seen[-1], (2000, 2000))
        for result in (found, sp.Rare.load(self.path("module"))):
            self.assertEqual((result.method, result.below, result.samples, result.followers), ("condition", 0.2, 2000, 3))
            for name in COLUMNS[1:]:
                np.testing.assert_allclose(getattr(result, name), [rows[str(i)][name] for i in (1, 2, 3)], rtol=1e-12)
                self.assertAlmostEqual(result.any[name] / rows["any"][name], 1.0, places=12)
        row = found.document["rows"][0]  # 60 steps of 0.1 s at 20 m/s are 0.12 km
        self.assertAlmostEqual(row["per_kilometre"] / (row["per_hour"] / 72.0), 1.0, places=12)
        with self.assertRaisesRegex(ValueError, "method: guess: must be auto"):
            sp.rare(sp.Model.load(file), method="guess")
        with self.assertRaisesRegex(ValueError, "below: 9 m: must be below the mean gap"):
            sp.rare(sp.Model.load(file), below=9.0)

    def test_with_a_flipped_bit_are_rejected(self):
        self.estimate("flipped", self.model(standstill_distance=3.0), followers=3, steps=60, realizations=500)
        self.assertEqual(sp.Rare.load(self.path("flipped")).followers, 3)
        believed = []
        for name in ("rare.csv", "rare.json"):
            with open(self.path("flipped", name), "rb") as file:
                whole = file.read()
            for at in range(0, len(whole), 7):
                with open(self.path("flipped", name), "wb") as file:
                    file.write(whole[:at] + bytes([whole[at] ^ 1 << at % 8]) + whole[at + 1:])
                try:
                    sp.Rare.load(self.path("flipped"))
                    believed.append("bit {} of byte {} of {}: {}".format(at % 8, at, name, whole[max(at - 20, 0):at + 20]))
                except ValueError:
                    pass
            with open(self.path("flipped", name), "wb") as file:
                file.write(whole)
        self.assertEqual(believed, [])
        sp.Rare.load(self.path("flipped"))

    def test_are_drawn(self):
        folders = []
        for distance in (2.0, 3.0):
            name = "at_{}".format(distance)
            self.estimate(name, self.model(standstill_distance=distance), followers=3, steps=60, realizations=500)
            folders.append(self.path(name))
        self.estimate("longer", self.model(standstill_distance=3.0), followers=3, steps=80, realizations=500)
        for shown, panels in ((folders[:1], 1), (folders[:1] + [self.path("longer")], 1), (folders, 2)):
            done = subprocess.run([PLOT, "rare", *shown, "--output", self.path("plot_{}.svg".format(panels))], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, universal_newlines=True, env=dict(os.environ, MPLBACKEND="Agg"))
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(self.path("plot_{}.svg".format(panels))) as file:
                text = file.read()
            self.assertEqual(text.count('id="axes_'), panels)
            for words in ["upper bound by theory", "any follower"] + ["standstill distance"] * (panels - 1):
                self.assertIn(words, text)
        damaged = subprocess.run([PLOT, "rare", self.folder, "--output", self.path("none.svg")], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(damaged.returncode, 1)
        self.assertIn("rare.json", damaged.stderr)

    def replayed(self, name, model, vehicle, **options):
        """The smallest gap of each follower in a replayed sample."""
        found = tool("rare", "--trajectories", model=model, output=self.path(name), vehicle=vehicle, **options)
        self.assertEqual(found.returncode, 0, found.stderr)
        return np.nanmin(sp.Trajectories.load(self.path(name))["gap"][1:], axis=1)

    def test_each_sample_replays_as_a_small_gap(self):
        model = self.model(standstill_distance=4.0)
        options = dict(followers=3, steps=60)
        for vehicle in (1, 3):
            for sample in (0, 7, 9999):
                least = self.replayed("sample_{}_{}".format(vehicle, sample), model, vehicle, only=sample, **options)
                self.assertTrue(-2.0 < least[vehicle - 1] < 0.0, least)
            likely = self.replayed("likely_{}".format(vehicle), model, vehicle, **options)
            self.assertAlmostEqual(likely[vehicle - 1], 0.0, places=9)
        self.assertLess(self.replayed("any", model, "any", only=5, **options).min(), 0.0)
        lossy = self.model(name="lossy.yaml", standstill_distance=4.0, channel=LOSS)
        limits = self.model("acc_limits.yaml", name="limits.yaml", leader={"file": "emergency_stop.csv"}, standstill_distance=6.0)
        for name, file, below, steps in (("lossy", lossy, 0.0, 60), ("limits", limits, 0.25, 320)):
            for repetition in (0, 3):
                least = self.replayed("{}_{}".format(name, repetition), file, 1, followers=1, steps=steps, realizations=2000, below=below,
                                      only=repetition)
                self.assertTrue(below - 2.0 < least[0] < below, (name, least))

    def test_the_required_distance_is_the_smallest_that_satisfies_the_probability(self):
        options = dict(followers=2, steps=40, realizations=500)
        for name, per, key, figure in (("run", "run", "standstill_distance", "probability"), ("hour", "hour", "standstill_distance", "per_hour"),
                                       ("headway", "run", "time_headway", "probability")):
            start = dict(standstill_distance=2.0) if key == "standstill_distance" else dict(standstill_distance=2.0, time_headway=4.0)
            rows = self.estimate(name, self.model(name=name + "_start.yaml", **start), required=1e-6, per=per, over=key, **options)
            self.assertLessEqual(rows["any"][figure], 1e-6)
            value = self.document(name)["configuration"]["model"][key]
            nearer = self.model(name=name + ".yaml", **dict(start, **{key: 0.998 * value}))
            self.assertGreater(self.estimate(name + "_nearer", nearer, **options)["any"][figure], 1e-6)


if __name__ == "__main__":
    unittest.main()
