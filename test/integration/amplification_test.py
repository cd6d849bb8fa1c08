#!/usr/bin/python3
"""amplification.csv against its definition, the frequency response of a vehicle, and the theory."""

import math
import os
import unittest

import numpy as np

from terminal import LaunchTest

FOLLOWERS, STEPS = 3, 400
SIGNALS = "speed,acceleration,jerk"
PERIOD = 0.1  # [s] sample period of the paper's example


def mean_positions(leader, followers, headway):
    """Positions of the paper's platoon without noise for the leader y_0(-1), y_0(0), ...: an array (followers + 1, steps + 1)."""
    y = np.zeros((followers + 1, leader.size))
    y[0] = leader
    before, moved, filtered = np.zeros(followers), np.zeros(followers), np.zeros(followers)
    for k in range(leader.size - 1):
        error = y[:-1, k] - y[1:, k] - headway * (y[1:, k] - before)
        filtered = -0.89 * filtered + 1.35 / (1 + headway) * error
        before = y[1:, k].copy()
        y[1:, k + 1] = y[1:, k] + moved
        moved = moved + filtered
    return y


def amplification_of(positions, from_step):
    """The columns of amplification.csv for the mean motion, from its definition."""
    before = np.repeat(positions[:, :1], 2, axis=1)  # at rest before step -1
    padded = np.concatenate([before, positions], axis=1)
    speed, acceleration, jerk = (np.diff(padded, n)[:, 3 - n:][:, from_step:] / PERIOD ** n for n in (1, 2, 3))
    apart = speed - speed.mean(axis=1, keepdims=True)
    l2, linf = np.linalg.norm(apart, axis=1), abs(apart).max(axis=1)
    return {"l2_ratio": l2[1:] / l2[:-1], "linf_ratio": linf[1:] / linf[:-1], "l2_head_to_tail": l2[1:] / l2[0],
            "linf_head_to_tail": linf[1:] / linf[0], "rms_mean_speed": apart.std(axis=1),
            "rms_mean_acceleration": np.sqrt(np.mean(acceleration ** 2, axis=1)),
            "rms_mean_jerk": np.sqrt(np.mean(jerk ** 2, axis=1))}


def amplification_in(folder):
    """The columns of amplification.csv as arrays over vehicles 0..N, NaN for an empty cell."""
    return np.genfromtxt(os.path.join(folder, "amplification.csv"), delimiter=",", names=True)


class Amplification(LaunchTest):
    def test_a_sinusoid_is_amplified_by_the_frequency_response(self):
        followers, steps, from_step = 20, 400, 200
        rows = ["time,speed"] + ["%.1f,%.17g" % (0.1 * k, 20 + math.sin(0.2 * math.pi * k)) for k in range(steps + 2)]
        drive = self.write("sinusoid.csv", "\n".join(rows) + "\n")
        for headway, gain, of_twenty in ((2.4, 1.15823, 18.8753), (3.2, 0.799494, 0.0113841)):
            folder = self.monte_carlo("at-%g" % headway, leader=drive, headway=headway, noise_variance=0,
                                   followers=followers, steps=steps, realizations=2, signals=SIGNALS, burn_in=from_step)
            speed = 20 + np.sin(0.2 * np.pi * np.arange(steps + 1))
            leader = np.concatenate([[0.0], np.cumsum(0.05 * (speed[1:] + speed[:-1]))])
            leader = np.concatenate([[0.0], leader])[:steps + 1]
            found, expected = amplification_in(folder), amplification_of(mean_positions(leader, followers, headway), from_step)
            for name, values in expected.items():
                for column in (name, "theoretical_" + name):
                    own = found[column][-values.size:]
                    np.testing.assert_allclose(own, values, rtol=1e-6, err_msg=column)
            for prefix in ("", "theoretical_"):
                np.testing.assert_allclose(found[prefix + "l2_ratio"][1:], gain, rtol=2e-5)
                np.testing.assert_allclose(found[prefix + "l2_head_to_tail"][-1], of_twenty, rtol=2e-5)

    def test_measured_amplification_agrees_with_the_theory_within_the_standard_error(self):
        runs, realizations = 12, 2000
        found = [amplification_in(self.monte_carlo("seed-%d" % seed, leader="city.csv", signals=SIGNALS, seed=seed, followers=FOLLOWERS,
                                                steps=STEPS, realizations=realizations)) for seed in range(runs)]
        for name in ("l2_ratio", "l2_head_to_tail", "rms_mean_speed", "rms_acceleration", "rms_jerk"):
            values = np.array([one[name][1:] for one in found])
            error = values.std(axis=0, ddof=1) / math.sqrt(runs)
            score = (values.mean(axis=0) - found[0]["theoretical_" + name][1:]) / error
            self.assertTrue(np.all(abs(score) < 5.5), (name, score))  # a t-value of 11 degrees of freedom: 2e-4
        # The noise of the means is part of the measured accelerations, but not of the ratios.
        self.assertTrue(np.all(found[0]["rms_acceleration"][1:] > 2 * found[0]["theoretical_rms_mean_acceleration"][1:]))

    def test_a_leader_at_constant_speed_has_no_amplification(self):
        folder = self.monte_carlo("constant", signals="speed", burn_in=90, followers=2, steps=120, realizations=10)
        found = amplification_in(folder)
        for name in ("l2_ratio", "linf_ratio", "l2_head_to_tail", "linf_head_to_tail"):
            self.assertTrue(np.all(np.isnan(found[name])) and np.all(np.isnan(found["theoretical_" + name])), name)
        self.assertEqual(found["rms_mean_speed"][0], 0.0)
        with open(os.path.join(folder, "amplification.csv")) as file:
            self.assertNotIn("nan", file.read())


if __name__ == "__main__":
    unittest.main()
