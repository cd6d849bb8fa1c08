#!/usr/bin/python3
"""Tuning against grids, its files and its messages."""

import json
import math
import os
import pty
import re
import signal
import subprocess
import time
import unittest

import numpy as np
import stochastic_platoon as sp

import live_platoon
from folder import FolderTest
from tune_bound_test import PAPER_BOX

TUNE = live_platoon.shared("src", "tools", "tune")
ACC = {"plant": {"actuator_lag": 0.1}, "controller": {"kp": 1.0, "kd": 1.0, "headway_filter": True}, "time_headway_seconds": 1.0,
       "sample_period": 0.01, "noise_variance": 0.01, "standstill_distance": 5.0, "initial_position": {"mean": 0.0, "variance": 0.0},
       "leader": {"speed": [{"from_step": 0, "value": 20.0}]}}


def tuned(model, **options):
    return sp.tune(model, **{"bound_seconds": 0.0, "realizations": 0, **options})


def limit_variance(gain, pole):
    """Of the paper's car at h = 3.2, by a sum over frequencies; None if it is not string stable."""
    d = np.convolve([1.0, -2.0, 1.0], [1.0, pole])
    n = gain / 4.2 * np.array([1.0, 0.0])
    v = np.polyadd(np.append(d, 0.0), np.convolve(n, [4.2, -3.2]))
    if (np.abs(np.roots(v)) >= 1.0).any():
        return None
    w = (np.arange(20000) + 0.5) * math.pi / 20000
    z = np.exp(1j * w)
    d, n, v = (np.abs(np.polyval(p, z)) ** 2 for p in (d, n, v))
    return 0.6 * (np.mean(d / (v - n)) - 1.0) if (v > n).all() else None


class Optima(unittest.TestCase):
    def test_the_papers_gain_and_pole_are_as_good_as_the_best_of_a_grid(self):
        result = tuned(sp.Model.load(), minimise="limit_variance", over=PAPER_BOX, subject_to={"string_stable": True})
        gain, pole = result.variables.values()
        self.assertAlmostEqual(result.goal / limit_variance(gain, pole), 1.0, places=6)
        grid = [limit_variance(g, p) for g in np.linspace(0.9, 1.1, 21) * gain for p in pole + np.linspace(-0.1, 0.1, 21) if abs(p) < 0.95]
        coarse = [limit_variance(g, p) for g in np.linspace(0.1, 4.0, 40) for p in np.linspace(-0.95, 0.95, 39)]
        self.assertLessEqual(result.goal, min(value for value in grid + coarse if value is not None) * (1.0 + 1e-6))

    def test_the_least_headway_on_the_border_of_a_verdict_is_that_of_a_grid(self):
        car = sp.Model.from_dict(dict(ACC, plant={"actuator_lag": 0.1}, sample_period=0.1))
        result = tuned(car, minimise="time_headway", subject_to={"string_stable": True, "phase_margin": [35, 180]},
                       over={"controller/kp": [0.05, 1.0], "controller/kd": [0.3, 2.0], "time_headway": [1.0, 30.0]})
        grid = [analysis["critical_headway"] for kp in (0.5, 0.8, 1.0) for kd in (1.0, 1.3, 1.6, 2.0) for analysis in
                [sp.analyze(car.replace({"controller/kp": kp, "controller/kd": kd, "time_headway": 20.0}), keys={"critical_headway", "phase_margin"})]
                if analysis["phase_margin"] >= 35.0]
        self.assertLess(result.goal, min(grid) * (1.0 + 1e-4))
        # It is no less than what is feasible: the verdict changes at the goal itself.
        analysis = sp.analyze(result.model.replace({"time_headway": result.goal * (1.0 + 1e-6)}))
        self.assertIs(analysis["string_stable"], True)
        self.assertGreaterEqual(analysis["phase_margin"], 35.0 - 1e-6)
        self.assertAlmostEqual(analysis["critical_headway"] / result.goal, 1.0, delta=1e-4)

    def test_the_car_of_cacc_keeps_its_phase_margin_at_half_the_headway(self):
        result = tuned(sp.Model.load("cacc.yaml"), minimise="critical_headway_seconds", subject_to={"phase_margin": [56, 180]},
                       over={"controller/kp": [0.01, 2.0], "controller/kd": [0.1, 3.0]})
        self.assertLessEqual(result.goal, 0.141)
        self.assertGreaterEqual(result.figures["phase_margin"], 56.0)
        self.assertIn("phase_margin", result.binding)
        analysis = sp.analyze(result.model)
        self.assertAlmostEqual(analysis["critical_headway_seconds"], result.goal, places=9)
        self.assertAlmostEqual(analysis["phase_margin"], result.figures["phase_margin"], places=9)

    def test_the_sensitivity_to_a_bound_is_the_change_of_the_optimum(self):
        goals = []
        for bound in (2.49, 2.5, 2.51):
            result = tuned(sp.Model.load(), minimise="limit_variance", over=PAPER_BOX, subject_to={"string_stable": True, "sensitivity_peak": bound})
            self.assertIn("sensitivity_peak", result.binding)
            goals.append(result.goal)
            if bound == 2.5:
                slope = result.sensitivity["sensitivity_peak"]
        self.assertAlmostEqual((goals[2] - goals[0]) / 0.02 / slope, 1.0, delta=0.02)

    def test_the_box_binds_where_more_gain_is_always_better(self):
        result = tuned(sp.Model.from_dict(ACC), minimise="critical_headway_seconds",
                       over={"controller/kp": [0.1, 40.0], "controller/kd": [0.1, 15.0]})
        self.assertLessEqual(result.goal, 0.22)
        self.assertIn("controller/kp", result.binding)
        self.assertIn("The box binds", result.report)

    def test_a_goal_that_exists_in_a_small_part_of_the_box_is_found_without_constraints(self):
        whole = tuned(sp.Model.load(), minimise="limit_variance", over=PAPER_BOX)
        stable = tuned(sp.Model.load(), minimise="limit_variance", over=PAPER_BOX, subject_to={"string_stable": True})
        self.assertAlmostEqual(whole.goal / stable.goal, 1.0, places=6)
        self.assertEqual(whole.binding, ["controller/denominator/1"])

    def test_a_figure_of_the_same_cars_without_limits_is_a_goal(self):
        limits = sp.Model.load("acc_limits.yaml")
        linear = sp.Model.from_dict({key: value for key, value in limits.to_dict().items() if key not in ("limits", "start")})
        goals = [tuned(model, minimise=figure, over={"controller/kp": [0.05, 3.0]}).goal
                 for model, figure in ((limits, "linear/limit_variance"), (linear, "limit_variance"))]
        self.assertAlmostEqual(goals[0] / goals[1], 1.0, places=9)

    def test_a_key_of_the_model_is_a_goal(self):
        result = tuned(sp.Model.load("acc.yaml"), minimise="time_headway_seconds", over={"time_headway_seconds": [0.5, 5.0]},
                       subject_to={"string_stable": True})
        self.assertAlmostEqual(result.goal, sp.analyze(sp.Model.load("acc.yaml"))["critical_headway_seconds"], delta=1e-5)

    def test_each_kind_of_figure_is_a_goal(self):
        gain, lossy = "controller/numerator/0", sp.Model.load("lossy.yaml")
        bursts = lossy.replace({"channel/loss/mean_burst": 2.0})
        for model, goal, key, ends, options in (
                (lossy, "limit_variance", gain, [0.8, 1.6], {}),
                (bursts, "stationary_variance/4", gain, [0.8, 1.6], {}),
                (sp.Model.load("cacc.yaml"), "limit_variance", "controller/kd", [0.4, 1.5], {}),
                (sp.Model.load(), "signals/gap/limit_variance", gain, [0.8, 1.6], {}),
                (sp.Model.load("acc.yaml"), "signals/input/stationary_variance/4", "controller/kp", [0.3, 1.5], {}),
                (sp.Model.load("paper_at_rest.yaml"), "collision/probability/4", gain, [0.8, 1.6], {"collision_probability": 1e-6}),
                (sp.Model.load("paper_at_rest.yaml"), "collision/required_standstill_distance", gain, [0.8, 1.6],
                 {"collision_probability": 1e-6})):
            with self.subTest(goal=goal):
                options = dict(options, followers=5, steps=20)
                result = tuned(model, minimise=goal, over={key: ends}, **options)

                def at(value):
                    signals = ["gap"] if "collision" in goal else [name for name in sp.SIGNALS if "signals/" + name in goal]
                    document = sp.analyze(model.replace({key: value}), signals=signals, **options)
                    *path, last = goal.split("/")
                    return document[".".join(path)][int(last)] if last.isdigit() else document[goal.replace("/", ".")]
                self.assertEqual(at(result.variables[key]), result.goal)
                others = [value for value in map(at, np.linspace(*ends, 7)) if value is not None]
                self.assertGreater(len(others), 2)
                self.assertLessEqual(result.goal, min(others) * (1.0 + 1e-9))

    def test_losses_and_required_distances_are_constraints(self):
        for subject_to, model, options in (
                ({"critical_loss_probability": 0.15}, "lossy.yaml", {}),
                ({"collision/required_standstill_distance": 4.3}, "paper_at_rest.yaml", {"collision_probability": 1e-6})):
            result = tuned(sp.Model.load(model), minimise="time_headway", over={"time_headway": [2.6, 8.0]}, subject_to=subject_to,
                           followers=5, steps=20, **options)
            (figure, bound), = subject_to.items()
            self.assertEqual(result.binding, [figure])
            self.assertAlmostEqual(result.figures[figure] / bound, 1.0, delta=1e-3)

    def test_a_front_falls_from_point_to_point(self):
        result = tuned(sp.Model.load(), minimise="limit_variance", over={"time_headway": [2.9, 6.0], "controller/numerator/0": [0.5, 2.0]},
                       subject_to={"string_stable": True}, pareto={"over": "limit_variance", "against": "time_headway", "points": 4})
        self.assertEqual(len(result.front), 4)
        pairs = [(point["against"], point["over"]) for point in result.front]
        for before, after in zip(pairs, pairs[1:]):
            self.assertTrue(before[0] > after[0] and before[1] < after[1], pairs)
        against, over = pairs[2]
        alone = tuned(sp.Model.load().replace({"time_headway": against}), minimise="limit_variance", over={"controller/numerator/0": [0.5, 2.0]},
                      subject_to={"string_stable": True})
        self.assertAlmostEqual(over / alone.goal, 1.0, delta=1e-4)


class Program(FolderTest):
    def tune(self, text, *options):
        file = self.write("tuning.yaml", text)
        return subprocess.run([TUNE, file, "--bound", "0", *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True)

    def test_a_plot_of_no_front_says_what_it_needs(self):
        plot = [live_platoon.shared("src", "tools", "plot"), "pareto", "--output", self.path("front")]
        self.tune(self.SMALL, "--output", self.path("alone"))
        for front, reason in ((self.path("nowhere"), "must be a regular file"),
                              (self.path("alone"), "must be a tune.json with a front, as tune writes it for a file with the key pareto")):
            done = subprocess.run(plot + [front], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn(reason, done.stderr)

    SMALL = "minimise: limit_variance\nover: {controller/numerator/0: [1.0, 2.0]}\nrealizations: 200\n"

    def test_the_same_file_gives_the_same_bytes_and_a_model_for_every_program(self):
        for folder in ("one", "other"):
            done = self.tune(self.SMALL, "--output", self.path(folder))
            self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("tune.json", "model.yaml"):
            with open(self.path("one", name), "rb") as one, open(self.path("other", name), "rb") as other:
                self.assertEqual(one.read(), other.read())
        with open(self.path("one", "tune.json")) as file:
            found = json.load(file)
        self.assertLessEqual({"variables", "goal", "binding", "sensitivity", "bound"}, set(found))
        self.assertIs(found["confirmation"]["agrees"], True)
        document = self.path("analysis.json")
        subprocess.run([live_platoon.executable("analyze"), "--model", self.path("one", "model.yaml"), "--json", document], check=True,
                       stdout=subprocess.DEVNULL)
        with open(document) as file:
            self.assertEqual(json.load(file)["limit_variance"], found["goal"])
        self.assertIn("has results already", self.tune(self.SMALL, "--output", self.path("one")).stderr)
        done = self.tune(self.SMALL, "--output", self.path("one/model.yaml/x"))  # before the search, which would print its result
        self.assertEqual(done.stdout, "")
        self.assertRegex(done.stderr, "^tune: --output: .*/x: must be a folder that can be written: .*/model.yaml: Not a directory\n$")

    def test_bad_input_is_named(self):
        for text, message in (
                ("minimise: limit_varianc\nover: {controller/numerator/0: [1, 2]}", "limit_varianc: no figure of the analysis and no key of the model: must be one of"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [2, 1]}", "over: controller/numerator/0: [2, 1]: must be [low, high]"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 1]}", "over: controller/numerator/0: [1, 1]: must be [low, high]"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, .inf]}", "must be [low, high], two finite numbers"),
                ("minimise: limit_variance\nover: {controller/numerator/0: 1}", "over: controller/numerator/0: 1: must be [low, high]"),
                ("minimise: limit_variance\nover: {}", "over: empty"),
                ("minimise: limit_variance\nover: {controller/kq: [1, 2]}", "over: controller/kq: "),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\nsubject: {}", "subject: unknown: must be one of model"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\nsubject_to: {phase_margin: [60, 50]}", "phase_margin: [60, 50]: must be true"),
                ("minimise: variance\nover: {controller/numerator/0: [1, 2]}", "variance: must be a single number"),
                ("minimise: spectral_radius\nover: {noise_variance: [1, 2]}", "over: noise_variance: neither spectral_radius nor a constraint depends on it"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\nsubject_to: {phase_margi: 50}", "phase_margi: no figure of the analysis"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\npareto: {over: limit_variance}", "pareto: {'over': 'limit_variance'}: must be over"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\npareto: {over: limit_variance, against: critical_headwa}", "critical_headwa: no figure of the analysis"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, true]}", "over: controller/numerator/0: [1, True]: must be [low, high]"),
                ("minimise: string_stable\nover: {controller/numerator/0: [1, 2]}", "string_stable: is true or false: must be in subject_to, with true or false"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\nsubject_to: {phase_margin: true}", "phase_margin: is a number: must be a number or [low, high] in subject_to"),
                ("minimise: leader\nover: {controller/numerator/0: [1, 2]}", "leader: must be a single number: name one of its entries, as leader/speed/0/"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\nrealizations: many", "run/realizations: many: must be a whole number"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\ncollision_probability: rare", "collision_probability: 'rare': must be a finite number > 0"),
                ("minimise: collision/per_step\nover: {controller/numerator/0: [1, 2]}", "collision_probability: missing"),
                ("minimise: limit_variance\nover: [controller/kp]", "over: ['controller/kp']: must be a mapping"),
                ("model: none.yaml\nminimise: limit_variance\nover: {controller/numerator/0: [1, 2]}", "none.yaml"),
                ("over: {controller/numerator/0: [1, 2]}", "minimise: missing"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2], controller/numerator/0: [1, 3]}", ": over: controller/numerator/0: given twice: must be given once"),
                ("{minimise: limit_variance, over: {controller/numerator/0: [1, 2]}}\nsubject_to: {phase_margin: 50}", "several documents, one from line 2 on: must be one"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, 2]}\nsubject_to: {phase_margin: [099, 050]}", "subject_to: phase_margin: [99, 50]: must be true, false, a number"),
                ("minimise: limit_variance\nover: {controller/numerator/0: [1, '2 m']}\nsubject_to: {1: {2: no}}", "over: controller/numerator/0: [1, '2 m']: must be [low, high]"),
                ("minimise: limit_variance\nover: {? [1, 2] : [1, 2]}", "over: [1, 2]: [1, 2]: unknown key: allowed are allow_unstable, "),
                ("minimise: [", "must be YAML")):
            done = self.tune(text)
            self.assertEqual(done.returncode, 1, text)
            self.assertIn(message, done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_constraints_that_exclude_everything_are_named_with_the_nearest_point(self):
        done = self.tune(self.SMALL + "subject_to: {phase_margin: 89, string_stable: true}")
        self.assertEqual(done.returncode, 1)
        self.assertIn("subject_to: no point found satisfies all constraints; nearest at controller/numerator/0", done.stderr)
        self.assertRegex(done.stderr, r"phase_margin: [\d.]+: must be at least 89")

    def test_constraints_that_no_point_satisfies_name_the_nearest_point_of_each(self):
        text = "minimise: limit_variance\nover: {controller/numerator/0: [1.0, 2.0]}\n"
        done = self.tune("model: paper.yaml\n" + text + "subject_to: {time_headway: [1, 2], sensitivity_peak: 1.5}")
        self.assertEqual(done.returncode, 1)
        self.assertIn("time_headway: 3.2: must be from 1 to 2 (nearest of all points: 3.2)", done.stderr)
        nearest = float(re.search(r"sensitivity_peak: [\d.]+: must be at most 1.5 \(nearest of all points: ([\d.]+)\)", done.stderr)[1])
        grid = [sp.analyze(sp.Model.load().replace({"controller/numerator/0": gain}))["sensitivity_peak"] for gain in np.linspace(1.0, 2.0, 101)]
        self.assertAlmostEqual(nearest / min(grid), 1.0, delta=1e-3)
        done = self.tune("minimise: limit_variance\nover: {controller/numerator/0: [100, 200]}")
        self.assertIn("over: the goal exists at no point found; nearest at controller/numerator/0", done.stderr)

    def test_a_goal_of_0_has_a_report(self):
        silent = sp.Model.load().replace(noise_variance=0.0)
        found = sp.tune(silent, minimise="limit_variance", over={"controller/numerator/0": [0.5, 2.5]},
                        subject_to={"string_stable": True}, realizations=0)
        self.assertEqual(found.goal, 0.0)
        self.assertIn("Least limit_variance: 0\n", found.report)

    def test_a_folder_with_one_of_the_files_takes_none(self):
        found = sp.tune(sp.Model.load(), minimise="limit_variance", over={"time_headway": [2.6, 3.2]}, realizations=0, bound_seconds=0.0)
        open(self.path("tune.json"), "w").close()
        with self.assertRaisesRegex(FileExistsError, "has a tune.json already"):
            found.save(self.folder)
        self.assertEqual(os.listdir(self.folder), ["tune.json"])

    def test_the_report_says_why_there_is_no_bound(self):
        for text, reason in ((self.SMALL.replace("limit_variance", "spectral_radius"), "it exists for limit_variance, peak_gain, sensitivity_peak only, not for spectral_radius"),
                             (self.SMALL.replace("controller/numerator/0: [1.0, 2.0]", "time_headway: [3.0, 4.0]"),
                              "it exists for gains of the controller and numbers of its numerator and denominator, not for time_headway")):
            done = self.tune(text, "--bound", "20", "--output", self.path(reason[:13] + reason[-4:]))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("No lower bound: " + reason, done.stdout)
        self.assertIn("No lower bound: its time is 0 s", self.tune(self.SMALL).stdout)

    def test_ctrl_c_ends_it_at_each_stage_with_one_line_and_without_files(self):
        paper = "minimise: limit_variance\nover: {}\nsteps: 500\nrealizations: 1000000\n".format(json.dumps(PAPER_BOX))
        cacc = "model: cacc.yaml\nminimise: critical_headway_seconds\nover: {controller/kp: [0.01, 2.0], controller/kd: [0.1, 3.0]}\n"
        for stage, text, bound in (("search", cacc, "0"), ("bound", paper, "600"), ("monte_carlo", paper, "0")):
            with self.subTest(stage):
                shown, terminal = pty.openpty()
                self.addCleanup(os.close, shown)
                output = self.path(stage)
                process = self.background(TUNE, self.write(stage + ".yaml", text), "--bound", bound, "--output", output,
                                          stdout=subprocess.PIPE, stderr=terminal, universal_newlines=True)
                os.close(terminal)
                seen = ""
                while stage + ":" not in seen:
                    seen += os.read(shown, 1000).decode()
                began = time.monotonic()
                process.send_signal(signal.SIGINT)
                printed, _ = process.communicate(timeout=60)
                self.assertLess(time.monotonic() - began, 10.0)  # a loaded machine may be ten times slower than a second
                self.assertEqual(process.returncode, 130)
                self.assertEqual(printed, "tune: interrupted: nothing is written, the same command begins again\n")
                self.assertFalse(os.path.exists(output))


if __name__ == "__main__":
    unittest.main()
