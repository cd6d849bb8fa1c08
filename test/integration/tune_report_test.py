#!/usr/bin/python3
"""What tune reports and saves: fronts, binding constraints, sensitivities and kinks, and faults of its input."""

import math
import os
import resource
import subprocess
import tempfile
import unittest
from unittest import mock

import numpy as np
import stochastic_platoon as sp
from stochastic_platoon import tuning

from folder import FolderTest
from tune_test import TUNE, tuned
from user_tools_test import limit_files

ACC = sp.Model.load("acc.yaml")
BOX = {"controller/kp": [0.05, 3.0], "controller/kd": [0.1, 4.0]}


class Fronts(unittest.TestCase):
    def front(self, over, against, points, box=BOX):
        return tuned(ACC, minimise="limit_variance", over=box, pareto={"over": over, "against": against, "points": points})

    def test_no_point_is_worse_in_both_figures_than_another(self):
        for over, against, signs in (("limit_variance", "phase_margin", (1, -1)), ("phase_margin", "limit_variance", (-1, 1))):
            with self.subTest(over=over):
                result = self.front(over, against, 4)
                self.assertEqual((len(result.front), result.without_point), (4, []))
                costs = [(signs[0] * point["over"], signs[1] * point["against"]) for point in result.front]
                for one in costs:
                    self.assertFalse([other for other in costs if other != one and other[0] <= one[0] and other[1] <= one[1]], costs)
                for point in result.front:  # the figures themselves, not their negatives
                    self.assertGreater(min(point["over"], point["against"]), 0.0)

    def test_the_report_shows_every_point_and_the_bounds_without_one(self):
        whole, search = 5, tuning.search

        def search_that_fails_once(problem, starts=()):
            found = search(problem, starts)
            bounds = [constraint.low for constraint in problem.constraints if constraint.figure == "delay_margin"]
            return found._replace(violation=1.0) if starts and 1.46 < max(bounds) < 1.49 else found

        with mock.patch.object(tuning, "search", search_that_fails_once):
            result = self.front("limit_variance", "delay_margin", whole)
        self.assertEqual(len(result.front) + len(result.without_point), whole)
        self.assertEqual(len(result.without_point), 1)
        self.assertEqual(result.to_dict()["pareto"]["without_point"], result.without_point)
        self.assertIn("Front: the least limit_variance for lower bounds of delay_margin\n", result.report)
        self.assertIn("no point found for delay_margin of at least {:.6g}\n".format(result.without_point[0]), result.report)
        rows = [line.split() for line in result.report.split("Front:")[1].splitlines()[1:]]
        self.assertEqual(rows[0], ["delay_margin", "limit_variance", *BOX])
        for row, point in zip(rows[1:], result.front):
            self.assertEqual(row, ["{:.6g}".format(value) for value in (point["against"], point["over"], *point["variables"].values())])


class Saved(FolderTest):
    def test_a_full_disk_leaves_neither_file_so_that_the_folder_can_be_used_again(self):
        result = sp.Tuning(ACC, "limit_variance", {}, 1.0, {}, [], {}, {}, None, "its time is 0 s", 1)
        result.front = [{"over": 1.0, "against": 2.0, "variables": {}}] * 1000  # the second file is the larger one
        self.addCleanup(limit_files, resource.getrlimit(resource.RLIMIT_FSIZE)[0])
        limit_files(20000)
        with self.assertRaisesRegex(OSError, "tune.json: cannot be written: File too large"):
            result.save(self.folder)
        self.assertEqual(os.listdir(self.folder), [])
        result.front = []
        result.save(self.folder)
        self.assertEqual(sorted(os.listdir(self.folder)), ["model.yaml", "tune.json"])


class Binding(unittest.TestCase):
    def test_a_verdict_binds_at_its_border(self):
        on_border = tuned(ACC, minimise="stationary_variance/19", over={"controller/kp": [0.05, 1.0]}, subject_to={"string_stable": True})
        self.assertAlmostEqual(on_border.variables["controller/kp"], 0.1628002, places=6)
        self.assertIn("string_stable", on_border.binding)
        self.assertIn("string_stable: true (binding)", on_border.report)
        inside = tuned(ACC, minimise="limit_variance", over={"controller/kp": [0.05, 1.0]}, subject_to={"string_stable": True})
        self.assertEqual(inside.binding, [])

    def test_a_bound_with_slack_does_not_bind(self):
        """At a tenth of a percent from a bound, and for a bound of 0."""
        result = tuned(ACC, minimise="time_headway_seconds", over={"time_headway_seconds": [1, 4]},
                       subject_to={"string_stable": True, "time_headway_seconds": [3.154, 40], "limit_variance": [0, 1]})
        self.assertAlmostEqual(result.goal, 3.15728161, places=6)
        self.assertIn("string_stable", result.binding)
        self.assertNotIn("time_headway_seconds", result.binding)
        self.assertNotIn("limit_variance", result.binding)

    def test_two_bounds_of_a_figure_cost_as_much_as_one(self):
        slopes = [tuned(ACC, minimise="critical_headway_seconds", over=BOX, subject_to={"phase_margin": ends}) for ends in ([50, 50.002], [50, 180])]
        self.assertEqual([result.binding for result in slopes], [["phase_margin"]] * 2)
        self.assertAlmostEqual(slopes[0].sensitivity["phase_margin"] / slopes[1].sensitivity["phase_margin"], 1.0, delta=1e-3)

    def test_a_minimum_with_a_kink_has_its_slopes_on_both_sides(self):
        model = ACC.replace({"controller/ki": 0.01})
        result = tuned(model, minimise="sensitivity_peak", over={"controller/kp": [0.05, 1.0], "controller/kd": [0.1, 1.0]})
        self.assertEqual((result.sensitivity, result.binding, set(result.kinks)), ({}, [], set(BOX)))
        self.assertNotIn("changes by -", result.report)
        for key, (behind, ahead) in result.kinks.items():
            self.assertIn("Kink of the goal at {}: it changes by {:.6g} per unit more, and by {:.6g} per unit less".format(key, ahead, -behind),
                          result.report)
            for slope, step in ((behind, -1e-4), (ahead, 1e-4)):
                moved = sp.analyze(result.model.replace({key: result.variables[key] + step}))["sensitivity_peak"]
                self.assertGreater(slope * step, 0.0)
                self.assertAlmostEqual((moved - result.goal) / (slope * step), 1.0, delta=0.1)


class Faults(unittest.TestCase):
    KNOWN = {"minimise": "limit_variance", "over": {"controller/kp": [0.1, 1.0]}}

    def faults(self, **arguments):
        """The lines of the error that ends tune before its search; none if it begins to search."""
        class Searched(Exception):
            pass

        with mock.patch.object(tuning, "search", side_effect=Searched):
            try:
                sp.tune(ACC, **{**self.KNOWN, **arguments})
            except Searched:
                return []
            except ValueError as error:
                return str(error).split("\n")

    def test_each_is_found_before_the_search(self):
        front = {"over": "limit_variance", "against": "phase_margin"}
        for arguments, fault in (
                ({"over": [1]}, "over: [1]: must be a mapping"),
                ({"subject_to": ["string_stable"]}, "subject_to: ['string_stable']: must be a mapping"),
                ({"pareto": [1]}, "pareto: [1]: must be over"),
                ({"pareto": dict(front, points=True)}, "'points': True}: must be over"),
                ({"pareto": dict(front, points=2.5)}, "'points': 2.5}: must be over"),
                ({"minimise": None}, "minimise: None: must be the path of a figure"),
                ({"minimise": "reason"}, "reason: must be a single number, and is 'string stable"),
                ({"subject_to": {"string_stable": 1}}, "string_stable: is true or false: must be in subject_to, with true or false, not 1"),
                ({"over": {"controller/kp": ["１", "２"]}}, "over: controller/kp: ['１', '２']: must be [low, high]"),
                ({"over": {"controller/kp": ["0.1", "1_0"]}}, "over: controller/kp: ['0.1', '1_0']: must be [low, high]"),
                ({"over": {"controller/kp": "12"}}, "over: controller/kp: '12': must be [low, high]"),
                ({"subject_to": {"phase_margin": "５0"}}, "subject_to: phase_margin: '５0': must be true, false, a number"),
                ({"subject_to": {"phase_margin": [None, "1_0"]}}, "subject_to: phase_margin: [None, '1_0']: must be true, false, a number"),
                ({"realizations": -1}, "run/realizations: -1: must be a whole number >= 0; 0: no confirmation"),
                *(({"bound_seconds": bad}, "bound_seconds: {}: must be a finite number >= 0 [s]".format(bad))
                  for bad in (math.nan, math.inf, -1, "x", "1_0", None))):
            with self.subTest(**arguments):
                found = self.faults(**arguments)
                self.assertEqual(len(found), 1, found)
                self.assertIn(fault, found[0])

    def test_numbers_of_numpy_and_texts_of_numbers_are_none(self):
        front = {"over": "limit_variance", "against": "phase_margin", "points": np.int64(3)}
        self.assertEqual(self.faults(subject_to={"string_stable": np.bool_(True), "phase_margin": "50"}, pareto=front, bound_seconds="0",
                                     over={"controller/kp": np.array([0.1, 1.0])}, realizations=np.int64(5)), [])

    def test_all_are_named_at_once(self):
        found = self.faults(minimise="limit_varianc", over={"controller/kq": [1, 2], "controller/kp": [2, 1]}, pareto=[1], bound_seconds=-1,
                            subject_to={"phase_margin": [60, 50], "string_stable": 1, "phase": 3}, realizations=-1, followers=0,
                            collision_probability=0.7)
        said = ["over: controller/kq: ", "over: controller/kp: [2, 1]: ", "subject_to: phase_margin: [60, 50]: ", "pareto: [1]: ",
                "run/realizations: -1: ", "bound_seconds: -1: ", "run/followers: 0: ", "collision_probability: 0.7: ", "limit_varianc: no figure",
                "string_stable: is true or false", "phase: no figure"]
        self.assertEqual(len(found), len(said), found)
        for fault in said:
            self.assertEqual(sum(line.startswith(fault) for line in found), 1, (fault, found))

    def test_the_reason_for_which_no_point_can_be_computed_is_named(self):
        with self.assertRaisesRegex(ValueError, "^over: the goal exists at no point found; nearest at .*:\nlimit_variance: does not exist there: .*which sets it too"):
            tuned(ACC, minimise="limit_variance", over={"time_headway_seconds": [3.0, 4.0], "time_headway": [30.0, 40.0]})

    def test_the_nearest_point_has_its_figures(self):
        with self.assertRaises(ValueError) as caught:
            tuned(ACC, minimise="limit_variance", over={"controller/kp": [0.05, 1.0]}, subject_to={"limit_variance": 1.4e-5})
        self.assertRegex(str(caught.exception), r"nearest at controller/kp [\d.]+:\nlimit_variance: [\d.e-]+: must be at most 1.4e-05 \(nearest")

    def test_the_program_names_its_option(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("minimise: limit_variance\nover: {controller/numerator/0: [1, 1_0]}\n")
            file.flush()
            for bad in ("nan", "-1", "1_0", "x"):
                done = subprocess.run([TUNE, file.name, "--bound=" + bad], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
                self.assertEqual((done.returncode, done.stdout), (1, ""))
                self.assertIn("--bound: {}: must be a finite number >= 0 [s]\n".format(bad), done.stderr)
                self.assertIn("over: controller/numerator/0: [1, '1_0']: must be [low, high]", done.stderr)


if __name__ == "__main__":
    unittest.main()
