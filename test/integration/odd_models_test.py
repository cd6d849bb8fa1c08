#!/usr/bin/python3
"""Models at the edge of what the theory covers: it agrees with the measurement there, or does not answer."""

import math
import os
import re
import unittest

import numpy as np
import stochastic_platoon as sp

from python_module import ModuleTest, program

PAPER = sp.Model.load("paper.yaml")
CAR = {"plant": {"actuator_lag": 0.1}, "controller": {"kp": 0.2, "kd": 0.7, "headway_filter": True}, "time_headway_seconds": 3.5,
       "limits": {"input": [-6.0, 2.5]}}
ONE_INTEGRATOR = {"sample_period": 0.1, "time_headway": 10, "standstill_distance": 5.0, "noise_variance": 0.01,
                  "plant": {"numerator": [0.1], "denominator": [1.0, -1.0]}, "controller": {"kp": 0.5, "kd": 0.0, "ki": 0.05},
                  "initial_position": {"mean": 0.0, "variance": 0.0}, "leader": {"speed": [{"from_step": 0, "value": 20.0}]}}


class OddModels(ModuleTest):
    def saved(self, model):
        path = self.path("model.yaml")
        with open(path, "w") as file:
            file.write(repr(model.to_dict()))
        return path

    def test_far_followers_before_the_noise_arrives_agree_to_rounding(self):
        """Their variance is 0: only the rounding of their position is left, which is far from 0 before the first step."""
        trucks = {"truck": {"standstill_distance": 30.1}}
        for model, followers in ((PAPER.replace(start="steady"), 50),
                                 (PAPER.replace(noise_variance=0.01, vehicle_types=trucks, string=["default", "truck"]), 10)):
            results = sp.monte_carlo(model, followers=followers, steps=50, realizations=100)
            self.assertLess(results.max_abs_z, results.summary["agreement"]["plausible_z"])

    def test_a_default_vehicle_that_the_string_does_not_have_takes_no_part(self):
        model = PAPER.replace(vehicle_types={"car": CAR}, string=["car"])
        results = sp.monte_carlo(model, followers=2, steps=50, realizations=100)
        self.assertTrue(results.complete)
        self.assertIn("limits", results.summary["crc32"])
        free = PAPER.replace(vehicle_types={"car": {key: CAR[key] for key in CAR if key != "limits"}}, string=["car"])
        self.assertEqual(len(sp.analyze(free, followers=2, steps=50, signals=["input"])["signals"]["input"]["stationary_mean"]), 2)

    def test_the_input_of_a_plant_of_one_integrator_is_what_its_speed_needs(self):
        rest = sp.Model.from_dict(ONE_INTEGRATOR)
        for model in (rest, rest.replace(start="steady")):
            found = sp.analyze(model, followers=2, steps=2000, signals=["input"])["signals"]["input"]
            np.testing.assert_allclose(found["stationary_mean"], [20.0, 20.0], rtol=1e-12)
            np.testing.assert_allclose(np.array(found["mean"])[:, -1], [20.0, 20.0], rtol=1e-6)
        results = sp.monte_carlo(rest.replace(start="steady"), followers=2, steps=200, realizations=1000, signals=["input"])
        self.assertRegex(results.report, r"input of follower 2 at .*, agrees \(")
        limited = sp.analyze(rest.replace(start="steady", limits={"input": [-5.0, 20.1]}), followers=1, steps=50)
        measured = sp.monte_carlo(rest.replace(start="steady"), followers=1, steps=50, realizations=20000, signals=["input"])
        of = measured.signals["input"]
        expected = 0.5 * math.erfc((20.1 - of.mean[0, -1]) / math.sqrt(2.0 * of.variance[0, -1]))
        self.assertGreater(expected, 0.01)  # to about 3 % with 20000 realizations
        beyond = np.array(limited["linear"]["probability_beyond_input_limits"])[0, -1]
        self.assertAlmostEqual(beyond / float(expected), 1.0, delta=0.1)

    def test_a_lost_speed_acts_by_the_controller_that_the_loop_has(self):
        loss = {"probability": 0.2, "on_loss": "zero"}
        inputs = [{"signal": "position", "from": "predecessor", "noise_variance": 0.02},
                  {"signal": "speed", "from": "predecessor", "gain": 0.3, "noise_variance": 0.01, "channel": {"loss": loss}}]
        model = sp.Model.from_dict({"sample_period": 0.1, "time_headway": 8, "standstill_distance": 6.0, "plant": {"actuator_lag": 0.3},
                                    "controller": {"kp": 2.0, "kd": 3.0, "divide_by_one_plus_headway": True}, "inputs": inputs,
                                    "initial_position": {"mean": 0.0, "variance": 0.0}, "leader": {"speed": [{"from_step": 0, "value": 20.0}]}})
        found = sp.analyze(model, followers=1, steps=1000)
        self.assertAlmostEqual(found["stationary_mean"][0], 5.4, places=9)
        self.assertAlmostEqual(np.array(found["mean"])[0, -1], 5.4, places=6)

    def test_what_losses_leave_of_a_start_is_not_judged_by_its_variance(self):
        """Few realizations carry a variance that decays: the measured kurtosis does not show them."""
        model = PAPER.replace(noise_variance=0.0, initial_position={"mean": 0.0, "variance": 0.3}, standstill_distance=5.3, start="steady",
                              leader={"speed": [{"from_step": 0, "value": 0.0}]}, channel={"loss": {"probability": 0.1, "on_loss": "extrapolate"}})
        quiet = {"noise_variance": 0.0}
        drive = {"start": "rest", "leader": {"speed": [{"from_step": 0, "value": 20.0}]}}
        for change in (quiet, {"noise_variance": 1e-9}, {"noise_variance": 1e-6}, {"noise_variance": 1e-4},
                       {"vehicle_types": {"noisy": {"noise_variance": 0.5}}, "string": ["default", "default", "noisy"], **quiet},
                       {"channel/quantisation_step": 1e-4, **quiet}, {"noise_variance": 1e-4, **drive}, {"noise_variance": 1e-3, **drive}):
            for seed in (1, 2):
                results = sp.monte_carlo(model.replace(change), followers=3, steps=80, realizations=1500, seed=seed)
                self.assertNotIn("DISAGREE", results.report, change)
                self.assertRegex(results.report, r"what is left of the start .* variances are not judged")
                agreement = results.summary["agreement"]
                self.assertLess(agreement["max_abs_z_variance"], agreement["plausible_z"])
        settled = sp.monte_carlo(model.replace(noise_variance=0.1), followers=3, steps=80, realizations=1500, seed=1).report
        judged = re.search(r"(\d+) of 240 variances are not judged", settled)
        self.assertLess(int(judged[1]) if judged else 0, 60)

    def test_variances_far_behind_in_a_string_that_hears_two_ahead_tend_to_the_limit(self):
        """A gain above 1 to the predecessor, although the string is stable: rounding must not grow by it."""
        heard = [(signal, ahead, gain, noise) for signal, noise, gains in (("position", 0.02, (1.3, -0.3)), ("speed", 0.01, (1.0, -0.3)),
                                                                           ("acceleration", 0.01, (1.0, -0.3)))
                 for ahead, gain in zip(("predecessor", 2), gains)]
        inputs = [{"signal": signal, "from": ahead, "weight" if signal == "position" else "gain": gain, "noise_variance": noise}
                  for signal, ahead, gain, noise in heard]
        model = sp.Model.from_dict({"sample_period": 0.1, "plant": {"actuator_lag": 0.3}, "controller": {"kp": 0.2, "kd": 1.1},
                                    "time_headway": 10, "standstill_distance": 5.0, "inputs": inputs,
                                    "initial_position": {"mean": 0.0, "variance": 0.0}, "leader": {"speed": [{"from_step": 0, "value": 20.0}]}})
        found = sp.analyze(model, followers=300, steps=5)
        self.assertTrue(found.string_stable)
        missing = 1.0 - found["stationary_variance"] / found["limit_variance"]
        self.assertTrue(0.0 < missing[299] < 0.6 * missing[149], missing[[149, 299]])
        self.assertLess(missing[299], 1e-3)

    def test_cars_can_be_sampled_at_a_kilohertz(self):
        ploeg = sp.Model.load("ploeg_plexe.yaml").replace(sample_period=0.001)
        found = sp.analyze(ploeg, followers=2, steps=5)
        self.assertTrue(found.string_stable)
        self.assertAlmostEqual(found["critical_delay"], 0.0689, places=4)
        run = sp.monte_carlo(ploeg, followers=2, steps=300, realizations=2000)
        self.assertLess(run.max_abs_z, run.summary["agreement"]["plausible_z"])
        car = sp.Model.load("acc.yaml").replace({"sample_period": 0.002, "noise_variance": 0.1})
        run = sp.monte_carlo(car, followers=3, steps=2000, realizations=1000)
        self.assertLess(run.max_abs_z, run.summary["agreement"]["plausible_z"])

    def test_a_string_that_hears_several_has_a_gain_of_1_at_frequency_0(self):
        for name in ("path_cacc.yaml", "flatbed.yaml"):
            found = sp.analyze(sp.Model.load(name), followers=2, steps=5)
            self.assertEqual((found["peak_gain"], found["peak_frequency"]), (1.0, 0.0), name)
        self.assertAlmostEqual(sp.analyze(sp.Model.load("consensus.yaml"), followers=2, steps=5)["peak_gain"], 0.914893617, places=9)

    def test_a_type_is_judged_at_the_places_where_it_stands(self):
        inputs = [{"signal": "position", "noise_variance": 0.02}, {"signal": "speed", "gain": 0.1, "noise_variance": 0.01}]
        behind = {"controller": {"kp": 0.2, "kd": 0.0}, "time_headway": 3, "inputs": [{"signal": "position", "from": 2, "noise_variance": 0.02}]}
        keys = {"sample_period": 0.1, "plant": {"actuator_lag": 0.5}, "controller": {"kp": 0.2, "kd": 0.7}, "time_headway": 10,
                "standstill_distance": 5.0, "inputs": inputs, "initial_position": {"mean": 0.0, "variance": 0.0},
                "leader": {"speed": [{"from_step": 0, "value": 20.0}]}, "vehicle_types": {"B": behind}}
        self.assertLess(sp.analyze(sp.Model.from_dict(dict(keys, string=["default", "B"])), followers=2, steps=5)["spectral_radius"], 1.0)
        self.assertRaisesText(ValueError, "vehicle_types/B: the closed loop is unstable: rho(A) = 1.00237", sp.Model.from_dict, dict(keys, string=["B", "default"]))

    def test_a_map_over_headways_needs_vehicles_that_have_one(self):
        self.assertRaisesText(ValueError, "headway: given: must be absent beside spacing: constant", sp.stability_map,
                              sp.Model.load("path_cacc.yaml"), headway=[1.0, 20.0], loss=[0.0, 0.3])

    def test_a_path_with_dots_is_the_same_figure(self):
        limits = sp.Model.load("acc_limits.yaml")
        of = [sp.tune(limits, minimise="linear/limit_variance", over={"controller/kp": [0.05, 1.0]}, subject_to={path: 50}, realizations=0,
                      bound_seconds=0.0) for path in ("linear.phase_margin", "linear/phase_margin")]
        self.assertEqual(of[0].goal, of[1].goal)
        self.assertGreaterEqual(of[0].figures["linear/phase_margin"], 50.0 - 1e-6)

    def test_points_without_a_theory_are_infeasible_for_tune(self):
        """At 0.5 losses and arrivals alternate. Just below it the theory takes long, so that the goal leads away from there."""
        lossy = sp.Model.load("lossy.yaml").replace({"channel/loss": {"probability": 0.3, "mean_burst": 1.0, "on_loss": "hold"}})
        found = sp.tune(lossy, minimise="channel/loss/probability", over={"channel/loss/probability": [0.1, 0.5]},
                        subject_to={"string_stable": True, "limit_variance": [0.0, 100.0]}, realizations=0, bound_seconds=0.0)
        self.assertEqual(found.variables["channel/loss/probability"], 0.1)

    def test_a_report_has_no_number_that_is_none(self):
        one = sp.monte_carlo(PAPER, followers=2, steps=20, realizations=1, signals=["gap", "speed"]).report
        self.assertRegex(one, r"gap of follower 2 at 1.9 s \(step 19\): mean \S+ m \(theory")
        self.assertNotIn("nan", one)
        hidden = sp.monte_carlo(sp.Model.load("acc.yaml"), followers=1, steps=50, realizations=100, signals=["speed"]).report
        self.assertIn("Amplification of the speed (L2): none, as noise hides it\n", hidden)

    def test_a_gap_that_is_never_small_has_no_realization(self):
        quiet = PAPER.replace(standstill_distance=2.0, noise_variance=0.1, leader={"speed": [{"from_step": 0, "value": 0.0}]},
                              vehicle_types={"quiet": {"noise_variance": 0.0}}, string=["quiet", "default"])
        for only in ({}, {"only": 3}):
            printed = program("rare", "--trajectories", fails=True, model=self.saved(quiet), followers=2, steps=50, realizations=500,
                              vehicle=1, output=self.path("rare"), **only)
            self.assertIn("below: 0: of probability 0 here: must be larger, or another vehicle", printed)
        self.assertFalse(os.path.exists(self.path("rare", "trajectories.csv")))

    def test_losses_of_probability_0_are_none_whatever_their_mean_burst(self):
        options = {"followers": 3, "steps": 20, "signals": ["gap"]}
        bursts = PAPER.replace({"channel/loss": {"probability": 0.0, "mean_burst": 4.0, "on_loss": "hold"}})
        none = PAPER.replace({"channel/loss": {"probability": 0.0, "on_loss": "hold"}})
        runs = [sp.monte_carlo(model, realizations=200, **options) for model in (bursts, none)]
        np.testing.assert_array_equal(runs[0].theoretical_variance, runs[1].theoretical_variance)
        np.testing.assert_array_equal(runs[0].variance, runs[1].variance)
        found = [sp.analyze(model, collision_probability=1e-3, **options) for model in (bursts, none)]
        np.testing.assert_array_equal(found[0]["collision"]["required_standstill_distances"], found[1]["collision"]["required_standstill_distances"])
        self.assertIsNotNone(sp.monte_carlo(bursts, followers=3, steps=3000, realizations=2).string_stable)
        # The mean burst counts where the probability is varied.
        self.assertEqual([np.array(of["stable_loss_probabilities"]).tolist() for of in found], [[[0.0, 0.8]], [[0.0, 0.99]]])

    def test_a_leader_beyond_the_limits_of_its_vehicle_gives_a_warning(self):
        limited = sp.Model.load("acc_limits.yaml")  # speed from 0 to 40 m/s, input from -6 to 3 m/s^2
        beyond = "beyond the limits of the vehicle"
        for drive, expected in (([20.0, 20.0, 50.0, 50.0], "leader: speed from 20 to 50 m/s: {}, 0 to 40 m/s".format(beyond)),
                                ([5.0, 0.0, -10.0, -10.0], "leader: speed from -10 to 5 m/s: {}, 0 to 40 m/s".format(beyond)),
                                ([30.0, 22.0, 14.0], "leader: acceleration from -8 to 0 m/s^2: {}, -6 to 3 m/s^2".format(beyond))):
            drive = drive[:1] * 10 + drive
            table = self.write("drive.csv", "time,speed\n" + "".join("{},{}\n".format(second, speed) for second, speed in enumerate(drive)))
            warnings = sp.analyze(limited.replace(leader={"file": table}), followers=1, steps=5)["warnings"]
            self.assertIn(expected, warnings)
        self.assertNotIn(beyond, str(sp.analyze(limited, followers=1, steps=5)["warnings"]))
        back = sp.analyze(PAPER.replace(leader={"speed": [{"from_step": 0, "value": -5.0}]}), followers=1, steps=5)["warnings"]
        self.assertIn("leader: speed of -5 m/s: the car reverses", back)

    def test_the_shares_of_unlike_vehicles_are_all_printed(self):
        """A third of the variance of follower 2 comes from the radio of follower 1, though it has none itself."""
        radar = {"signal": "position", "noise_variance": 0.01}
        radio = {"inputs": [radar, {"signal": "input", "gain": 1.0, "noise_variance": 2.0, "channel": {"delay": 1}}]}
        model = sp.Model.load("cacc.yaml").replace(inputs=[radar], vehicle_types={"radio": radio}, string=["radio", "default"])
        report = sp.analyze(model, followers=2, steps=5).report
        whole = float(re.search(r"(\S+) m\^2 of follower 2", report)[1])
        shares = re.search(r"of which radar (\S+) m\^2, radio (\S+) m\^2 \(follower 2\)", report)
        self.assertAlmostEqual(sum(map(float, shares.groups())), whole, delta=1e-5 * whole)

    def test_a_short_drive_and_the_linear_cars_of_a_long_one_have_the_steps_they_can_have(self):
        table = self.write("half.csv", "time,speed\n0,20\n0.5,20\n")
        self.assertEqual(sp.monte_carlo(sp.Model.load("cacc.yaml").replace(leader={"file": table}), followers=1, realizations=2).summary["steps"], 51)
        printed = program("analyze", model="cacc_truck.yaml", loss=0.2, mean_burst=5, leader="city.csv", followers=2)
        self.assertIn("The same cars without limits (linear)", printed)
        self.assertIn("must be at most", program("analyze", fails=True, model="cacc_truck.yaml", loss=0.2, mean_burst=5, leader="city.csv",
                                                 followers=20, steps=4401))

    def test_analyze_replaces_an_earlier_analysis_and_no_other_file(self):
        model, analysis, table = self.saved(PAPER), self.path("analysis.json"), self.path("map.csv")
        sweep = {"sweep_headway": "3:4:2", "sweep_gain": "1:2:2"}
        for _ in range(2):
            program("analyze", model=model, json=analysis, csv=table, followers=2, steps=5, **sweep)
        for options in ({"json": model}, {"json": table}, {"csv": analysis}, {"csv": model}):
            printed = program("analyze", fails=True, followers=2, steps=5, **dict(sweep, **options))
            name, file = next(iter(options.items()))
            self.assertIn("{}: {}: exists and is no earlier {}: must be another file".format(name, file, "analysis" if name == "json" else "map"), printed)
        os.symlink("loop", self.path("loop"))
        for file, reason in (("", "(empty)"), (self.path("loop"), self.path("loop") + ": Too many levels of symbolic links"),
                             ("a" * 300, "a" * 300 + ": File name too long"), (self.folder, self.folder + ": exists and is no earlier analysis")):
            self.assertIn("json: {}: must be another file\n".format(reason), program("analyze", fails=True, json=file, followers=2, steps=5))
        sp.Model.load(model)

    def test_losses_next_to_a_half_have_a_critical_mean_burst(self):
        half = sp.analyze(PAPER.replace(loss=0.5), followers=2, steps=5)["critical_mean_burst"]
        for loss in (0.49999999999999994, 0.5000000001, 0.4999999999):
            found = sp.analyze(PAPER.replace(loss=loss), followers=2, steps=5)
            self.assertEqual(found["critical_mean_burst"] is None, half is None)
            self.assertIsNotNone(found.string_stable)

    def test_unlike_vehicles_that_hear_others_have_no_required_distance_of_one(self):
        inputs = [{"signal": "position", "from": "predecessor", "weight": 0.6, "noise_variance": 0.3},
                  {"signal": "position", "from": 2, "weight": 0.4, "noise_variance": 0.5}]
        one = sp.Model.load("two_ahead.yaml").replace(inputs=inputs, leader={"speed": [{"from_step": 0, "value": 0.0}]}, start="rest")
        two = one.replace(vehicle_types={"b": {"standstill_distance": 12.0}}, string=["default", "b"])
        required = [sp.analyze(model, followers=6, steps=50, signals=["gap"], collision_probability=1e-3)["collision"]
                    ["required_standstill_distance_of_platoon"] for model in (one, two)]
        self.assertAlmostEqual(required[0], 4.5763, places=3)
        self.assertIsNone(required[1])

    def test_losses_are_varied_in_the_types_that_a_given_loss_reaches(self):
        """A type with inputs of its own keeps their channels."""
        radio = [{"signal": "position", "noise_variance": 0.02}, {"signal": "input", "gain": 1.0, "noise_variance": 0.01, "channel": {"delay": 1}}]
        heard = sp.Model.load("two_ahead.yaml")
        own_loss = {"channel": {"loss": {"probability": 0.1, "on_loss": "hold"}}}  # of the first position, while the other's is varied
        strings = ((sp.Model.load("ploeg_plexe.yaml").replace(time_headway_seconds=0.6, inputs=radio), {}),
                   (heard, {"lossy": own_loss, "quiet": {"noise_variance": 0.001}}))
        for default, inheriting in strings:
            types = dict(inheriting, own={"inputs": default.to_dict()["inputs"]})
            model = default.replace(vehicle_types=types, string=["default"] + sorted(types))
            keys = ["critical_loss_types", "stable_loss_probabilities"]
            found, given = (sp.analyze(of, followers=2, steps=5, keys=keys) for of in (model, model.replace(loss=0.01)))
            for of in (found, given):
                self.assertEqual(of["critical_loss_types"], ["default"] + sorted(inheriting))
            ends = [end for interval in found["stable_loss_probabilities"] for end in interval if 0.0 < end < 0.99]
            self.assertEqual(len(ends), 1)
            sides = [end * factor for end in ends for factor in (1.0 - 1e-3, 1.0 + 1e-3)]
            stable = [sp.analyze(model.replace(loss=loss), followers=2, steps=5, keys=["string_stable"]).string_stable for loss in sides]
            self.assertEqual(sorted(stable), [False, True])
            headway = default.to_dict()["time_headway"]
            mapped = sp.stability_map(model, headway=[headway, 2.0 * headway], loss=sides)
            self.assertEqual((mapped.over, mapped.string_stable[:, 0].tolist()), ("headway", stable))

    def test_variances_of_slow_cars_sampled_fast_exist_without_losses_only_and_the_analysis_says_so(self):
        model = sp.Model.load("path_cacc.yaml").replace({
            "sample_period": 0.0005, "spacing": "headway", "time_headway_seconds": 3.5, "plant": {"actuator_lag": 0.1, "input_delay": 0.05},
            "controller": {"kp": 0.2, "kd": 0.7}, "inputs": [{"signal": "position", "noise_variance": 0.01},
                                                             {"signal": "speed", "from": "leader", "gain": 0.05, "noise_variance": 0.01}]})
        keys = ["stationary_variance", "string_stable", "warnings"]
        reason = "stationary variances: not computed: the spectra of the string are too narrow to integrate"
        for of, is_computed in ((model, True), (model.replace(loss=0.1), False)):
            found = sp.analyze(of, followers=1, steps=5, keys=keys)
            self.assertEqual((np.isfinite(found.stationary_variance).all(), reason in list(found["warnings"])), (is_computed, not is_computed))


if __name__ == "__main__":
    unittest.main()
