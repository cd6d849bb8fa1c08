#!/usr/bin/python3
"""The shipped models of links and mixed strings: theory and measurement of the package against a plain numpy simulation with its
own random numbers and without code of the package."""

import csv
import io
import json
import unittest

import numpy as np
import yaml

import link_reference
import live_platoon
from folder import FolderTest

FOLLOWERS, STEPS, REALIZATIONS = 7, 40, 40000

# The largest of 2 N K normal scores exceeds this with probability 1e-3 (Bonferroni). For two independent estimates the squared
# standard errors add.
BOUND = 5.0


def simulated(model, seed):
    """zeta, shape (followers, steps, realizations)."""
    random = np.random.default_rng(seed)
    vehicles = link_reference.vehicles_of(model, FOLLOWERS)
    leader = link_reference.vehicles_of(dict(model, string=["default"]), 1)[0]
    speed = 0.1 * 20.0  # [m/step] from step 0 on, in every shipped model
    r0 = np.concatenate([[0.0], speed * np.arange(STEPS + 1)])  # steps -1, 0, ...
    place = 0.0
    above = np.repeat(follow(leader, r0[:, None], 0.0, None), REALIZATIONS, axis=1)
    errors = []
    for vehicle in vehicles:
        delta, h = vehicle["standstill_distance"], vehicle["time_headway"]
        place -= delta
        own = follow(vehicle, received(vehicle, above, random), place, delta)
        errors.append(above[1:] - own[1:] - delta - h * (own[1:] - own[:-1]))
        above = own
    return np.array(errors)[:, :STEPS]


def follow(vehicle, heard, place, delta):
    """y(-1), y(0), ... for the inputs received at steps -1, 0, ...; from A, B, C or from plant and controller."""
    if "closed_loop" in vehicle:
        loop = vehicle["closed_loop"]
        a, b, c = np.array(loop["A"]), np.array(loop["B"]), np.array(loop["C"])
    else:
        a, b, c, _ = link_reference.state_space(*link_reference.polynomials_of(vehicle))
    rest = np.linalg.solve(np.eye(len(b)) - a, b)
    state = np.outer(rest / (c @ rest), np.full(heard.shape[1], place))
    positions = []
    for step in heard:
        positions.append(c @ state)
        state = a @ state + np.outer(b, step - (delta or 0.0))
    return np.array(positions)


def received(vehicle, sent, random):
    link = vehicle.get("channel", {})
    loss = link.get("loss", {"probability": 0.0, "on_loss": "hold"})
    predictor = link_reference.predictor_of(loss)
    noisy = sent.copy()
    noisy[1:] += np.sqrt(vehicle["noise_variance"]) * random.standard_normal(sent[1:].shape)
    used = [noisy[0]]
    q = chance = loss["probability"]  # stationary Markov chain; mean burst length 1 / (1 - stay)
    stay, enter = q, q
    if "mean_burst" in loss:
        stay, enter = 1.0 - 1.0 / loss["mean_burst"], q / (1.0 - q) / loss["mean_burst"]
    for k in range(1, len(sent)):
        arriving = noisy[max(k - link.get("delay", 0), 0)]
        predicted = sum(c * used[max(k - 1 - j, 0)] for j, c in enumerate(predictor))
        lost = random.random(arriving.shape) < chance
        chance = np.where(lost, stay, enter)
        used.append(np.where(lost, predicted, arriving))
    return np.array(used)


class ShippedModels(FolderTest):
    def measured(self, file):
        text = live_platoon.reference(self.folder, model=file, followers=FOLLOWERS, steps=STEPS, realizations=REALIZATIONS)
        rows = list(csv.DictReader(io.StringIO(text.decode())))
        table = lambda key: np.array([float(row[key] or "nan") for row in rows]).reshape(FOLLOWERS, STEPS)
        return table("mean"), table("variance"), table("theoretical_mean"), table("theoretical_variance")

    def check(self, name):
        file = live_platoon.shared("config", name)
        with open(file) as stream:
            self.compare(file, yaml.safe_load(stream))

    def compare(self, file, model):
        errors = simulated(model, 1)
        mean, variance = errors.mean(axis=2), errors.var(axis=2, ddof=1)
        fourth = ((errors - mean[:, :, None]) ** 4).mean(axis=2)
        of_mean = np.sqrt(variance / REALIZATIONS) + 1e-12
        of_variance = np.sqrt(np.maximum(fourth - variance ** 2, 0.0) / REALIZATIONS) + 1e-12
        own_mean, own_variance, theoretical_mean, theoretical_variance = self.measured(file)
        self.assertLess(np.abs((mean - theoretical_mean) / of_mean).max(), BOUND)
        self.assertLess(np.abs((variance - theoretical_variance) / of_variance).max(), BOUND)
        self.assertLess(np.abs((mean - own_mean) / of_mean).max(), BOUND * np.sqrt(2.0))
        self.assertLess(np.abs((variance - own_variance) / of_variance).max(), BOUND * np.sqrt(2.0))
        self.assertGreater(np.abs((variance - own_variance) / of_variance).max(), 0.5)  # the two measurements are independent

    def test_lossy(self):
        self.check("lossy.yaml")

    def test_losses_in_bursts_have_means_and_variances_and_a_verdict_of_the_means(self):
        with open(live_platoon.shared("config", "lossy.yaml")) as stream:
            model = yaml.safe_load(stream)
        model["channel"]["loss"] = {"probability": 0.2, "mean_burst": 2.5, "on_loss": "hold"}
        self.compare(self.write("bursts.yaml", json.dumps(model)), model)
        summary = live_platoon.summary_of(self.path("reference"))
        self.assertTrue(summary["theory"]["string_stable"])
        self.assertIn("the means alone are judged", summary["warning"])
        agreement = summary["agreement"]
        self.assertIsNone(agreement["max_abs_z_variance"])
        self.assertTrue(0.5 < agreement["max_abs_z_mean"] < agreement["plausible_z"], agreement)
        self.assertIn("means in agreement", live_platoon.tool("check", self.path("reference")).stdout)

    def test_mixed(self):
        self.check("mixed.yaml")

    def test_receiver_filter(self):
        self.check("receiver_filter.yaml")


if __name__ == "__main__":
    unittest.main()
