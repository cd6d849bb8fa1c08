#!/usr/bin/python3
"""analyze for platoons over links, against independent computations: second moments of the whole string's state
(link_reference.py) and, for verdicts and limits, sums over a fine frequency grid."""

import itertools
import unittest

import numpy as np

import link_reference
from link_models import COLOUR, LOOPS, AnalyzeTest, model_of

# Orders 2 to 5, every predictor, delays 0 to 3, losses 0.01 to 0.9, colour, dither, patterns of 1 to 4 types.
CASES = {
    "order 2, hold, 0.01": model_of(2, {"loss": {"probability": 0.01, "on_loss": "hold"}}),
    "order 3, hold, 0.9, delay 1": model_of(3, {"delay": 1, "loss": {"probability": 0.9, "on_loss": "hold"}}),
    "order 3, extrapolate, 0.1": model_of(3, {"loss": {"probability": 0.1, "on_loss": "extrapolate"}}),
    "order 4, three coefficients, 0.3, delay 2": model_of(
        4, {"delay": 2, "loss": {"probability": 0.3, "on_loss": [1.5, -0.8, 0.3]}}),
    "order 5, coloured, dither, delay 3": model_of(
        5, {"noise_filter": COLOUR, "quantisation_step": 0.5, "delay": 3}),
    "order 5, all stages": model_of(5, {"noise_filter": COLOUR, "quantisation_step": 0.5, "delay": 1,
                                        "loss": {"probability": 0.2, "on_loss": [1.2, -0.3, 0.1]}}),
    "no noise, extrapolate": model_of(3, {"loss": {"probability": 0.1, "on_loss": "extrapolate"}}, noise_variance=0.0,
                                      initial_position={"mean": 0.0, "variance": 0.0}),
    "two types": model_of(3, {"loss": {"probability": 0.1, "on_loss": "hold"}},
                          vehicle_types={"truck": {"time_headway": 4.0, "channel": {"delay": 1}}}, string=["default", "truck"]),
    "three types": model_of(
        3, {"loss": {"probability": 0.05, "on_loss": "extrapolate"}},
        vehicle_types={"truck": dict(LOOPS[4], time_headway=4.0, noise_variance=0.2, channel={"delay": 2}),
                       "bus": dict(LOOPS[2], channel={"noise_filter": COLOUR, "loss": {"probability": 0.3, "on_loss": "hold"}},
                                   initial_position={"mean": -1.0, "variance": 2.0})},
        string=["truck", "default", "bus"]),
    "four types": model_of(
        3, {"quantisation_step": 0.2},
        vehicle_types={"a": {"time_headway": 3.6, "channel": {"loss": {"probability": 0.4, "on_loss": "hold"}}},
                       "b": dict(LOOPS[5], channel={"noise_filter": COLOUR}),
                       "c": {"channel": {"delay": 3, "loss": {"probability": 0.1, "on_loss": [1.5, -0.8, 0.3]}}}},
        string=["a", "default", "b", "c"]),
}


def grid(model, points=1 << 16):
    """For each vehicle of a pattern |T^|^2, |T F|^2, |(1 - L) F|^2, kappa, N_d, |1 - H T^|^2, |H|^2 and ebar, on a grid of the
    unit circle without z = 1 (w = 2 pi (j + 1/2) / points)."""
    w = 2.0 * np.pi * (np.arange(points) + 0.5) / points
    z = np.exp(1j * w)
    found = []
    for vehicle in link_reference.vehicles_of(model, len(model.get("string", ["default"]))):
        link = vehicle.get("channel", {})
        loss = link.get("loss", {"probability": 0.0, "on_loss": [1.0]})
        q, c = loss["probability"], link_reference.predictor_of(loss)
        numerator, denominator = link_reference.polynomials_of(vehicle)
        t = np.polyval(numerator, z) / np.polyval(denominator, z)
        l = sum(cj * z ** -(j + 1.0) for j, cj in enumerate(c))
        f = 1.0 / (1.0 - q * l)
        mean = (1.0 - q) * z ** -float(link.get("delay", 0)) * f * t
        h = vehicle["time_headway"]
        policy = (1.0 + h) - h / z
        colour = link.get("noise_filter", {"numerator": [1.0], "denominator": [1.0]})
        # W, numerator and denominator in powers of z
        noise = np.abs(np.polyval(colour["numerator"], z) / np.polyval(colour["denominator"], z)) ** 2
        square = lambda x: np.abs(x) ** 2
        found.append({
            "gain": square(mean), "loss_gain": square(t * f), "innovation": square((1.0 - l) * f),
            "kappa": q * (1.0 - q) / (1.0 - q * (1.0 - q) * np.mean(square(l * f))),
            "noise": noise * vehicle["noise_variance"] + link.get("quantisation_step", 0.0) ** 2 / 12.0,
            "complement": square(1.0 - policy * mean), "headway": square(policy),
            "ebar": 2.0 * sum((j + 1) * cj for j, cj in enumerate(c)) / (1.0 - q) if q else 0.0})
    return found


class Analyze(AnalyzeTest):
    def test_means_and_variances_of_every_step_are_those_of_the_whole_state(self):
        for name, model in CASES.items():
            with self.subTest(name):
                theory = self.analyze(model, 6, 50)
                means, variances = link_reference.moments(model, 6, 50)
                np.testing.assert_allclose(np.array(theory["mean"]), means, rtol=1e-10, atol=1e-10)
                # Cells with zero variance hold the rounding errors of the reference.
                np.testing.assert_allclose(np.array(theory["variance"]), variances, rtol=1e-10, atol=1e-13 * variances.max())
                self.assertEqual(theory["theory"], "exact")

    def test_stationary_values_are_those_of_a_long_recursion(self):
        for name, model in CASES.items():
            with self.subTest(name):
                means, variances = link_reference.moments(model, 4, 600)
                theory = self.analyze(model, 4, 5)
                np.testing.assert_allclose(theory["stationary_variance"], variances[:, -1], rtol=1e-9, atol=1e-20)
                np.testing.assert_allclose(theory["stationary_mean"], means[:, -1], rtol=1e-9, atol=1e-9)

    def test_loss_gain_and_limit_are_those_of_a_grid_of_frequencies(self):
        for name, model in CASES.items():
            with self.subTest(name):
                theory = self.analyze(model, 1, 2)
                vehicles = grid(model)
                count = len(vehicles)
                divisor = 1.0 - np.prod([v["gain"] for v in vehicles], axis=0)
                self.assertEqual(theory["string_stable"], bool(divisor.min() > 0.0 and (theory["loss_gain"] or 0.0) < 1.0))
                between = {}
                for l, j in itertools.product(range(count), repeat=2):
                    way = np.ones_like(divisor)
                    i = (l + 1) % count
                    while i != j:
                        way = way * vehicles[i]["gain"]
                        i = (i + 1) % count
                    between[l, j] = way / divisor
                gains = np.array([[vehicles[j]["kappa"] * np.mean(vehicles[j]["innovation"] * between[l, j] *
                                                                  vehicles[l]["loss_gain"]) if vehicles[l]["kappa"] else 0.0
                                   for l in range(count)] for j in range(count)])
                radius = np.abs(np.linalg.eigvals(gains)).max()
                # The grid resolves the singular frequencies: its error is far below the tolerance.
                self.assertAlmostEqual((theory["loss_gain"] or 0.0) / (radius or 1.0), 1.0 if radius else 0.0, delta=1e-9)
                if not theory["string_stable"]:
                    self.assertIsNone(theory["limit_variance"])
                    continue
                before = lambda j, added: sum(between[l, j] * added[l] for l in range(count))
                added = [v["gain"] * v["noise"] for v in vehicles]
                given = np.array([v["kappa"] * (np.mean(v["innovation"] * (v["noise"] + before(j, added))) + v["ebar"] ** 2)
                                  for j, v in enumerate(vehicles)])
                sigma = np.linalg.solve(np.eye(count) - gains, given)
                added = [a + v["loss_gain"] * s for a, v, s in zip(added, vehicles, sigma)]
                limits = [np.mean(v["complement"] * before(j, added) + v["headway"] * added[j]) for j, v in enumerate(vehicles)]
                np.testing.assert_allclose(theory["limit_variance"], max(limits), rtol=1e-9)

    def test_the_string_settles_at_its_limit(self):
        def rest(followers):
            theory = self.analyze(CASES["order 3, extrapolate, 0.1"], followers, 2)
            self.assertTrue(theory["string_stable"])
            return 1.0 - theory["stationary_variance"][-1] / theory["limit_variance"]

        # The remainder of the sum after N vehicles decays like N^(-3/2), as 1 - |T^|^2 begins with w^2 and |S|^2 with w^4.
        self.assertLess(rest(4000), 2e-6)
        self.assertAlmostEqual(rest(1000) / rest(4000), 8.0, delta=0.1)

    def stable(self, model):
        return self.analyze(model, 1, 2)["string_stable"]

    def test_decides_right_on_both_sides_of_the_critical_loss_probability(self):
        model = model_of(3, {"loss": {"probability": 0.05, "on_loss": "extrapolate"}})
        critical = self.analyze(model, 1, 2)["critical_loss_probability"]
        at = lambda q: model_of(3, {"loss": {"probability": q, "on_loss": "extrapolate"}})
        # At the critical probability the loss gain is 1, also on the grid.
        for q, stable in ((critical - 1e-7, True), (critical + 1e-7, False)):
            vehicle = grid(at(q))[0]
            gain = vehicle["kappa"] * np.mean(vehicle["innovation"] * vehicle["loss_gain"] / (1.0 - vehicle["gain"]))
            self.assertEqual(gain < 1.0, stable)
            self.assertEqual(self.stable(at(q)), stable)

    def test_decides_right_on_both_sides_of_a_gain_of_one(self):
        # Delay does not change |T|: the border is the paper's critical headway, with |T| = 1.
        border = self.analyze(model_of(3), 1, 2)["critical_headway"]
        for h, stable in ((border * (1.0 + 1e-7), True), (border * (1.0 - 1e-7), False)):
            self.assertEqual(self.stable(model_of(3, {"delay": 2}, time_headway=h)), stable)

    def test_holding_makes_an_unstable_string_stable_over_an_interval_of_losses(self):
        # Without losses |T| exceeds 1 at h = 2.7; holding is a low-pass filter.
        theory = self.analyze(model_of(3, {"loss": {"probability": 0.0, "on_loss": "hold"}}, time_headway=2.7), 1, 2)
        self.assertFalse(theory["string_stable"])
        self.assertIsNone(theory["critical_loss_probability"])
        (low, high), = theory["stable_loss_probabilities"]
        self.assertTrue(0.0 < low < high, (low, high))
        self.assertEqual(high, 0.99)  # the largest probability that is searched
        at = lambda q: model_of(3, {"loss": {"probability": q, "on_loss": "hold"}}, time_headway=2.7)
        for q, stable in ((low - 1e-5, False), (low + 1e-5, True), (0.5 * (low + high), True), (high, True)):
            self.assertEqual(self.stable(at(q)), stable, q)
            vehicle = grid(at(q))[0]
            gain = vehicle["kappa"] * np.mean(vehicle["innovation"] * vehicle["loss_gain"] / (1.0 - vehicle["gain"]))
            self.assertEqual(vehicle["gain"].max() < 1.0 and gain < 1.0, stable, q)

    def test_a_mean_burst_that_independent_losses_have_changes_nothing(self):
        independent = self.analyze(model_of(3, {"loss": {"probability": 0.5, "mean_burst": 2.0, "on_loss": "hold"}}))
        self.assertEqual(independent["variance"],
                         self.analyze(model_of(3, {"loss": {"probability": 0.5, "on_loss": "hold"}}))["variance"])

    def test_a_link_that_does_nothing_is_the_papers(self):
        plain = self.analyze(model_of(3))
        for channel in ({"delay": 0}, {"loss": {"probability": 0.0, "on_loss": "hold"}}, {"quantisation_step": 0.0}):
            theory = self.analyze(model_of(3, channel))
            for key in ("mean", "variance", "stationary_variance", "limit_variance", "reason"):
                self.assertEqual(theory[key], plain[key])


if __name__ == "__main__":
    unittest.main()
