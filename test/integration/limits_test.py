#!/usr/bin/python3
"""Cars with limits: trajectories and statistics against a direct simulation that shares no code with the package."""

import csv
import io
import json
import math
import os
import tempfile
import unittest

import numpy as np
import stochastic_platoon as sp

import limits_reference
import live_platoon
from folder import FolderTest

PERIOD = 0.05
# Cars that brake worse than their leader: collisions are counted, and the cars drive on without contact.
CAR = {
    "plant": {"actuator_lag": 0.2, "input_delay": 0.15},
    "controller": {"kp": 0.45, "kd": 1.0, "headway_filter": True},
    "limits": {"input": [-4.5, 1.6], "speed": [0.0, 23.5]},
    "time_headway_seconds": 1.4,
    "standstill_distance": 3.0,
}
FIRST = 22.0  # [m/s]: all vehicles start with it, so that it must be within their limits


def emergency_stop(first=FIRST):
    """Rows of a drive: from `first` to 24 m/s, beyond the followers' limit, and to rest with 8.5 m/s^2."""
    braking = 2.0 + (24.0 - first) / 1.2 + 2.0
    stopped = braking + 24.0 / 8.5
    corners = [(0.0, first), (2.0, first), (2.0 + (24.0 - first) / 1.2, 24.0), (braking, 24.0), (stopped, 0.0), (30.0, 0.0)]
    times = np.arange(0.0, 30.001, 0.01)
    return times, np.interp(times, *np.array(corners).T)


def drive_of(times, speeds):
    return "time,speed\n" + "".join("{!r},{!r}\n".format(float(t), float(v)) for t, v in zip(times, speeds))


def positions_of(times, speeds, steps):
    """y_0(-1), y_0(0), ...: by the trapezoidal rule, at its first speed before."""
    values = np.interp(PERIOD * np.arange(steps), times, speeds).astype(np.longdouble)
    moved = np.concatenate([[0.0], np.cumsum(PERIOD * (values[1:] + values[:-1]) / 2)])
    return np.concatenate([[-PERIOD * values[0]], moved])


class Model:
    """Writes model files of cars with limits behind an emergency stop."""

    def model(self, car=CAR, noise=0.0, **keys):
        times, speeds = emergency_stop()
        self.write("drive.csv", drive_of(times, speeds))
        document = {key: value for key, value in car.items() if key not in ("gain", "delay")}
        document.update({"sample_period": PERIOD, "noise_variance": noise, "leader": {"file": "drive.csv"},
                         "initial_position": {"mean": 0.0, "variance": 0.0}}, **keys)
        if "gain" in car:
            document["inputs"] = [{"signal": "position"},
                                  {"signal": "input", "gain": car["gain"], "noise_variance": 10.0 * noise, "channel": {"delay": 2}}]
        return self.write("model.yaml", json.dumps(document))


class Limits(Model, FolderTest):
    def trajectories(self, **settings):
        settings = dict({"model": self.path("model.yaml"), "followers": 6, "steps": 600, "realizations": 5, "only": 3,
                         "output": tempfile.mkdtemp(dir=self.folder)}, **settings)
        done = live_platoon.tool("monte_carlo", "--trajectories", **settings)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        with open(os.path.join(settings["output"], "trajectories.csv")) as file:
            rows = list(csv.DictReader(file))
        return lambda key: np.array([float(row[key] or "nan") for row in rows]).reshape(settings["followers"] + 1, -1)

    def test_the_table_of_limits_has_the_shares_of_steps_at_them(self):
        car = dict(CAR, gain=1.0, limits={"input": [-4.5, 0.2], "speed": [0.0, 22.2]})
        self.model(car, noise=0.01)
        settings = dict(model=self.path("model.yaml"), followers=6, steps=600, realizations=3)
        done = live_platoon.tool("monte_carlo", output=self.path("all"), **settings)
        self.assertEqual(done.returncode, 0, done.stderr)
        tables = [self.trajectories(realizations=3, only=realization) for realization in range(3)]
        inputs, speeds = (np.concatenate([table(name)[1:, 1:] for table in tables], axis=1) for name in ("input", "speed"))
        (low, high), (slowest, fastest) = car["limits"]["input"], car["limits"]["speed"]
        shares = np.array([inputs == low, inputs == high, speeds <= slowest + 1e-6, speeds >= fastest - 1e-6]).mean(axis=2).T
        self.assertTrue((shares.max(axis=0) > 0.001).all(), shares)
        with open(os.path.join(self.path("all"), "limits.csv")) as file:
            rows = list(csv.DictReader(file))
        found = [[float(row[name]) for name in ("input_low", "input_high", "speed_low", "speed_high")] for row in rows]
        np.testing.assert_allclose(found, shares, rtol=1e-12)

    def compare(self, car, table, noisy):
        position = table("position")
        times, speeds = emergency_stop()
        leader = positions_of(times, speeds, 600)
        self.assertLess(np.abs(position[0] - leader).max(), 1e-9)
        places = limits_reference.places(car, PERIOD, leader[0], FIRST, 6)
        above, fed = list(leader), np.concatenate([[0.0], np.diff(np.diff(leader, prepend=leader[0] - PERIOD * FIRST)[1:], prepend=PERIOD * FIRST)]) / PERIOD ** 2
        used = []
        for i in range(1, 7):
            received = table("received_position")[i][:600] if noisy else above[:600]
            heard = None
            if "gain" in car:
                late = np.concatenate([[0.0], fed[:-1]])
                heard = table("received_input")[i][:600] if noisy else late[:600]
            above, u = limits_reference.follow(car, PERIOD, places[i - 1], FIRST, received, heard)
            self.assertLess(np.abs(position[i] - np.array(above)).max(), 1e-8, "vehicle {}".format(i))
            fed = np.concatenate([[0.0], u])
            used += u
        return np.array(used)

    def test_an_emergency_stop_is_that_of_an_independent_simulation(self):
        self.model()
        used = self.compare(CAR, self.trajectories(), noisy=False)
        self.assertEqual(used.min(), -4.5)

    def test_an_emergency_stop_with_noise_is_that_of_an_independent_simulation_of_the_same_noise(self):
        self.model(noise=0.02)
        self.compare(CAR, self.trajectories(), noisy=True)

    def test_cars_of_all_kinds_are_those_of_an_independent_simulation(self):
        kinds = {
            "without lag and delay": {"plant": {"actuator_lag": 0.0}},
            "a delay of 2.6 steps": {"plant": {"actuator_lag": 0.3, "input_delay": 0.13}},
            "a delay of 0.4 steps without lag": {"plant": {"actuator_lag": 0.0, "input_delay": 0.02}},
            "integral action": {"controller": {"kp": 0.45, "kd": 1.0, "ki": 0.05, "headway_filter": True}},
            "no filter": {"controller": {"kp": 0.4, "kd": 0.9}},
            "no filter and integral action": {"controller": {"kp": 0.4, "kd": 0.9, "ki": 0.03}},
            "a sampled controller": {"controller": {"numerator": [9.0, -8.9], "denominator": [1.0, -0.6]}},
            "limits of the input alone": {"limits": {"input": [-3.0, 1.0]}},
            "limits of the speed alone": {"limits": {"speed": [0.0, 23.0]}},
            "a radio": {"gain": 1.0, "time_headway_seconds": 0.6},
        }
        for name, changes in kinds.items():
            for noise in (0.0, 0.02):
                with self.subTest(name, noise=noise):
                    car = dict(CAR, **changes)
                    self.model(car, noise)
                    self.compare(car, self.trajectories(), noisy=noise > 0.0)

    def test_statistics_are_those_of_an_independent_simulation_with_its_own_noise(self):
        steps, count, noise = 260, 2000, 0.05
        self.model(noise=noise)
        rows = list(csv.DictReader(io.StringIO(live_platoon.reference(
            self.folder, model=self.path("model.yaml"), followers=3, steps=steps, realizations=count).decode())))
        self.assertEqual({row["theoretical_mean"] for row in rows}, {""})
        measured = lambda key: np.array([float(row[key]) for row in rows]).reshape(3, steps)
        random = np.random.default_rng(7)
        leader = positions_of(*emergency_stop(), steps)
        above = np.repeat(leader[:, None], count, axis=1)
        h = CAR["time_headway_seconds"] / PERIOD
        for i, place in enumerate(limits_reference.places(CAR, PERIOD, leader[0], FIRST, 3)):
            received = above[:-1] + np.sqrt(noise) * random.standard_normal(above[:-1].shape) * (np.arange(steps) > 0)[:, None]
            own = np.array(limits_reference.follow(CAR, PERIOD, place, FIRST, received)[0])
            errors = (above[1:] - own[1:] - CAR["standstill_distance"] - h * (own[1:] - own[:-1])).astype(float)
            mean, variance = errors.mean(axis=1), errors.var(axis=1, ddof=1)
            fourth = ((errors - mean[:, None]) ** 4).mean(axis=1)
            bound = 5.0 * np.sqrt(2.0 / count)  # two estimates; 2 N K scores exceed it with a probability of 1e-3
            self.assertLess(np.abs((measured("mean")[i] - mean) / (np.sqrt(variance) + 1e-9)).max(), bound)
            self.assertLess(np.abs((measured("variance")[i] - variance) / (np.sqrt(np.maximum(fourth - variance ** 2, 0)) + 1e-9)).max(), bound)
            above = own

    def test_a_steady_start_is_steady(self):
        for car in (CAR, dict(CAR, limits={}, gain=1.0)):
            self.model(car, start="steady", leader={"speed": [{"from_step": 0, "value": 20.0}]}, vehicle_length=4.5)
            table = self.trajectories(steps=300)
            self.assertLess(np.abs(table("acceleration")[1:, 1:]).max(), 1e-7)
            self.assertLess(np.abs(table("speed")[1:, 1:] - 20.0).max(), 1e-9)
            self.assertLess(np.abs(table("gap")[1:, 1:] - (3.0 + 1.4 * 20.0 - 4.5)).max(), 1e-9)
            self.assertLess(np.abs(table("position")[0, 1] - 0.0), 1e-12)


class LinearMap(unittest.TestCase):
    def test_the_map_of_cars_with_limits_is_that_of_the_same_cars_without(self):
        limited = sp.Model.load("acc_limits.yaml")
        document = dict(limited.to_dict(), start="steady")
        del document["limits"]
        axes = dict(headway=np.array([2.5, 3.5]) / limited.sample_period, loss=[0.0, 0.1])
        found, linear = sp.stability_map(limited, **axes), sp.stability_map(sp.Model.from_dict(document), **axes)
        np.testing.assert_array_equal(found.string_stable, linear.string_stable)
        np.testing.assert_array_equal(found.peak_gain, linear.peak_gain)
        self.assertEqual(set(found.string_stable.ravel()), {0.0, 1.0})


class LinearTheory(FolderTest):
    def test_a_warning_about_the_cars_with_and_without_limits_is_printed_once(self):
        drive = self.write("drive.csv", "time,speed\n" + "".join("{},{}\n".format(second, 25 + 5 * second) for second in range(20)))
        report = sp.analyze(sp.Model.load("acc_limits.yaml").replace(leader=drive), followers=2, steps=100).report
        self.assertEqual(report.count("leader: speed of "), 1, report)

    def test_analysis_and_summary_have_the_theory_of_the_same_cars_without_limits(self):
        acc = sp.Model.load("acc_limits.yaml").replace({"noise_variance": 0.04, "limits/input": [-0.12, 0.1]})
        heard = sp.Model.load("leader_and_predecessor.yaml").replace({"limits/input": [-12.0, 10.0], "start": "steady"})
        lossy = acc.replace({"channel/loss/probability": 0.1})
        for number, (limited, is_normal) in enumerate(((acc, True), (heard, True), (lossy, False))):
            document = dict(limited.to_dict(), start="steady")
            low, high = document.pop("limits")["input"]
            run = dict(followers=3, steps=60)
            found = dict(sp.analyze(limited, **run)["linear"])
            same = sp.analyze(sp.Model.from_dict(document), signals=["input"], **run)
            beyond = found.pop("probability_beyond_input_limits")
            for key, value in found.items():
                np.testing.assert_equal(value, same[key], key)
            summary = sp.monte_carlo(limited, realizations=10, output=self.path(str(number)), **run).summary["linear"]
            for key in ("string_stable", "limit_variance", "spectral_radius"):
                self.assertEqual(summary[key], same[key])
            np.testing.assert_array_equal(summary["stationary_variance"], same["stationary_variance"])
            if not is_normal:
                self.assertEqual((beyond, summary["probability_beyond_input_limits"]), (None, None))
                continue
            scale = np.sqrt(2.0 * same["signals"]["input"]["variance"])
            mean = same["signals"]["input"]["mean"]
            erfc = np.vectorize(math.erfc)
            with np.errstate(divide="ignore"):
                expected = 0.5 * (erfc((mean - low) / scale) + erfc((high - mean) / scale))
            self.assertGreater(expected.max(), 1e-4)
            np.testing.assert_allclose(beyond, expected, rtol=1e-9, atol=1e-300)
            np.testing.assert_allclose(summary["probability_beyond_input_limits"], beyond.max(axis=1), rtol=1e-15)


class ShippedExamples(unittest.TestCase):
    """Every shipped model drives like cars, or its file says that it is a textbook loop."""

    def closest(self, model, leader=None):
        """The least speed [m/s] and the least gap [m] of 20 followers in two minutes, or behind the drive."""
        model = model.replace(leader=leader) if leader else model
        steps = len(model.to_dict()["leader"]["positions"]) - 1 if leader else round(120.0 / model.sample_period)
        found = sp.trajectories(model, 0, followers=20, steps=steps)
        return np.nanmin(found["speed"][1:]), np.nanmin(found["gap"][1:])

    def test_no_car_reverses_or_overlaps_but_a_textbook_loop_that_says_so(self):
        folder = live_platoon.shared("config")
        names = sorted(name for name in os.listdir(folder) if name.endswith(".yaml"))
        textbook = []
        for name in names:
            with open(os.path.join(folder, name)) as file:
                text = " ".join(file.read().split())
            if "textbook loop, not " in text:
                textbook.append(name)
                continue
            model = sp.Model.load(name)
            leaders = ["emergency_stop.csv", "city.csv"] if "limits" in model.to_dict() else []
            for leader in [None] + leaders:
                with self.subTest(name=name, leader=leader):
                    speed, gap = self.closest(model, leader)
                    self.assertGreater(speed, sp.model.REVERSING)
                    self.assertGreater(gap, 0.0)
        self.assertEqual(textbook, ["closed_loop.yaml", "lossy.yaml", "mixed.yaml", "paper.yaml", "paper_at_rest.yaml", "paper_nonzero.yaml",
                                    "receiver_filter.yaml"])

    def test_a_textbook_loop_does_reverse(self):
        self.assertLess(self.closest(sp.Model.load())[0], sp.model.REVERSING)


if __name__ == "__main__":
    unittest.main()
