#!/usr/bin/python3
"""The Python module against the programs: the same numbers, bits and messages; progress, Ctrl-C, threads; NumPy arrays."""

import json
import os
import pickle
import shutil
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import numpy as np
import rosbag
import stochastic_platoon as sp

import live_platoon

DATA = live_platoon.shared("test", "data")
SIGNALS = ["gap", "speed", "acceleration"]


def program(name, *arguments, fails=False, **options):
    command = [live_platoon.executable(name), *arguments]
    for option, value in options.items():
        command += ["--" + option.replace("_", "-"), str(value)]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    assert (result.returncode != 0) == fails, result.stderr
    return result.stderr if fails else result.stdout


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def assertRaisesText(self, kind, text, function, *arguments, **options):
        with self.assertRaises(kind) as caught:
            function(*arguments, **options)
        self.assertIn(text, caught.exception.args[0])

    def assertSameTables(self, one, other):
        for name in one.summary["crc32"]:
            if name != "summary":
                columns, others = one.table(name), other.table(name)
                self.assertEqual(list(columns), list(others))
                for column in columns:
                    np.testing.assert_array_equal(columns[column], others[column])
                self.assertEqual(one.summary["crc32"][name], other.summary["crc32"][name])


class Models(InFolder):
    def test_a_shipped_model_is_found_by_its_name_and_a_file_by_its_path(self):
        model = sp.Model.load("acc.yaml")
        self.assertEqual(model, sp.Model.load(live_platoon.shared("config", "acc.yaml")))
        self.assertEqual(sp.Model.load(), sp.Model.load("paper.yaml"))
        self.assertNotEqual(model, sp.Model.load())
        self.assertEqual(model.time_headway_seconds, 3.5)
        self.assertEqual(model.sample_period, 0.01)

    def test_what_is_written_is_read_again(self):
        model = sp.Model.load("mixed.yaml")
        self.assertEqual(sp.Model.from_dict(model.to_dict()), model)
        self.assertEqual(sp.Model.parse(json.dumps(model.to_dict())), model)
        self.assertEqual(pickle.loads(pickle.dumps(model)), model)
        self.assertFalse(model.is_homogeneous)

    def test_values_are_replaced_in_a_copy(self):
        model = sp.Model.load()
        other = model.replace(time_headway=np.float64(2.4), noise_variance=0.25)
        self.assertEqual((other.time_headway, other.noise_variance), (2.4, 0.25))
        self.assertEqual((model.time_headway, model.noise_variance), (3.2, 0.6))
        self.assertEqual(model.replace({"channel/delay": 2}).to_dict()["channel"]["delay"], 2)
        self.assertEqual(model.replace(loss=0.1).vehicle(1).loss_probability, 0.1)
        self.assertEqual(model.replace(headway_seconds=0.3).time_headway, 0.3 / 0.1)
        # Also in a model whose file gives seconds.
        self.assertEqual(sp.Model.load("acc.yaml").replace(time_headway=40.0).time_headway_seconds, 0.4)
        self.assertEqual(model.replace({"controller/numerator/0": 1.0}).to_dict()["controller"]["numerator"], [1.0, 0.0])

    def test_a_shipped_drive_leads_by_its_name(self):
        model = sp.Model.load().replace(leader="city.csv")
        self.assertGreater(len(model.to_dict()["leader"]["positions"]), 1000)
        self.assertEqual(sp.shipped_file("city.csv", "config/leaders"), live_platoon.shared("config", "leaders", "city.csv"))
        self.assertRaisesText(ValueError, "nowhere.csv", sp.Model.load().replace, leader="nowhere.csv")

    def test_a_vehicle_has_its_loop_and_its_place(self):
        model = sp.Model.load()
        vehicle = model.vehicle(3)
        self.assertEqual(vehicle.A.shape, (vehicle.B.size, vehicle.C.size))
        # T(z) = C (z I - A)^-1 B, with T(1) = 1.
        self.assertAlmostEqual(float(vehicle.C @ np.linalg.solve(np.eye(vehicle.B.size) - vehicle.A, vehicle.B)), 1.0, places=12)
        self.assertEqual(sp.Model.load("paper_at_rest.yaml").vehicle(3).place, -3 * sp.Model.load("paper_at_rest.yaml").vehicle(0).standstill_distance)
        self.assertRaises(IndexError, model.vehicle, -1)
        self.assertRaises(IndexError, model.vehicle_to_dict, -1)

    def test_the_keys_of_a_vehicle_are_those_of_its_type(self):
        model = sp.Model.load("mixed.yaml")
        for index in range(7):
            vehicle, keys = model.vehicle(index), model.vehicle_to_dict(index)
            self.assertEqual((keys["time_headway"], keys["standstill_distance"]), (vehicle.time_headway, vehicle.standstill_distance))
            self.assertEqual(keys["controller"], model.to_dict()["controller"])

    def test_bad_models_raise_with_the_texts_of_the_tools(self):
        model = sp.Model.load()
        self.assertRaisesText(FileNotFoundError, "nowhere.yaml", sp.Model.load, "nowhere.yaml")
        self.assertRaisesText(ValueError, "must be a file of at most 256 MB that can be read (Is a directory)", sp.Model.load, self.folder)
        self.assertRaisesText(ValueError, "time_headway: -1", model.replace, time_headway=-1)
        self.assertRaisesText(ValueError, "time_heedway: unknown key", model.replace, time_heedway=1)
        self.assertRaisesText(ValueError, "seed: belongs to a run", model.replace, seed=2)
        self.assertRaisesText(ValueError, "must be YAML", sp.Model.parse, "a: [1")
        for function in (sp.analyze, sp.monte_carlo, sp.stability_map):
            self.assertRaisesText(TypeError, "model: 'paper.yaml': must be a Model", function, "paper.yaml")
        document = model.to_dict()
        document["noise_variance"] = -0.5
        with open(self.path("bad.yaml"), "w") as file:
            json.dump(document, file)
        with self.assertRaises(ValueError) as caught:
            sp.Model.load(self.path("bad.yaml"))
        self.assertIn(str(caught.exception).split("model/")[-1], program("analyze", model=self.path("bad.yaml"), fails=True))


class Theory(InFolder):
    def compare(self, found, expected):
        if isinstance(found, dict):
            self.assertEqual(list(found), list(expected))
            for key in found:
                self.compare(found[key], expected[key])
        elif isinstance(found, np.ndarray):
            np.testing.assert_array_equal(found, np.array(expected, dtype=float))
        elif isinstance(found, list):
            self.assertEqual(len(found), len(expected))
            for one, other in zip(found, expected):
                self.compare(one, other)
        else:
            self.assertEqual(found, expected)

    def test_an_analysis_is_that_of_the_tool(self):
        for name, more in (("paper.yaml", dict(signals=SIGNALS, collision_probability=1e-6)), ("lossy.yaml", {}), ("mixed.yaml", {})):
            options = dict(more, signals=",".join(more["signals"])) if more else {}
            report = program("analyze", model=name, followers=5, steps=40, json=self.path("a.json"), **options)
            with open(self.path("a.json")) as file:
                expected = json.load(file)
            analysis = sp.analyze(sp.Model.load(name), followers=5, steps=40, **more)
            self.compare(dict(analysis), expected)
            self.compare(dict(sp.Analysis.load(self.path("a.json"))), expected)
            self.assertIn(analysis.report, report)
            self.assertEqual(analysis.variance.shape, (5, 40))
            self.assertEqual(analysis.string_stable, expected["string_stable"])

    def test_keys_may_be_nested_and_are_named_if_missing(self):
        analysis = sp.analyze(sp.Model.load())
        self.assertEqual(analysis["norms.mean_l2"].shape, (20,))
        self.assertEqual(analysis["transfer"]["numerator"].dtype, float)
        self.assertRaisesText(KeyError, "norms.median is missing", lambda: analysis["norms.median"])
        self.assertAlmostEqual(analysis.critical_headway, 2.8, places=9)
        self.assertEqual((analysis.number("critical_headway"), analysis.numbers("norms.mean_l2").size), (analysis.critical_headway, 20))
        self.assertRaisesText(ValueError, "norms must be a number or null", analysis.number, "norms")
        self.assertRaisesText(ValueError, "reason must be a list of numbers", analysis.numbers, "reason")

    def test_an_analysis_over_the_headway_has_its_limits_in_seconds(self):
        program("analyze", sweep_headway="2:4:3", json=self.path("swept.json"))
        headways, limits = sp.Analysis.load(self.path("swept.json")).limits_over_headway
        np.testing.assert_allclose(headways, [0.2, 0.3, 0.4])
        self.assertTrue(np.isnan(limits[0]) and limits[1] > limits[2] > 0.0)
        self.assertIsNone(sp.analyze(sp.Model.load()).limits_over_headway)

    def test_bad_settings_raise_with_the_texts_of_the_tools(self):
        model = sp.Model.load()
        self.assertRaisesText(ValueError, "followers: 0: must be", sp.analyze, model, followers=0)
        self.assertRaisesText(ValueError, "steps: 0: must be at least 1 here", sp.analyze, model, steps=0)
        self.assertRaisesText(ValueError, "collision_probability: 0.7: must be a number above 0 and below 0.5", sp.analyze, model,
                              collision_probability=0.7)
        self.assertRaisesText(ValueError, "gap, speed, acceleration, jerk", sp.analyze, model, signals=["sped"])
        self.assertRaisesText(FileNotFoundError, "none.json", sp.Analysis.load, self.path("none.json"))

    def test_a_map_is_that_of_the_tool(self):
        program("analyze", sweep_headway="2:4:5", sweep_gain="1:1.5:3", csv=self.path("map.csv"))
        loaded = sp.StabilityMap.load(self.path("map.csv"))
        computed = sp.stability_map(sp.Model.load(), headway=np.linspace(2, 4, 5), gain=np.linspace(1, 1.5, 3))
        self.assertEqual((computed.over, computed.up, computed.string_stable.shape), ("headway", "gain", (3, 5)))
        for name in ("xs", "ys", "spectral_radius", "peak_gain", "string_stable", "loss_gain"):
            np.testing.assert_array_equal(getattr(computed, name), getattr(loaded, name))
        self.assertRaisesText(ValueError, "nothing varies", sp.stability_map, sp.Model.load())
        self.assertRaisesText(ValueError, "headway: -1: must be a finite number > 0", sp.stability_map, sp.Model.load(), headway=[-1.0, 2.0],
                              gain=[1.0, 1.2])


class Simulation(InFolder):
    SETTINGS = dict(followers=4, steps=30, realizations=3000, seed=3)

    def test_a_run_has_the_bits_of_the_tool(self):
        for name in ("paper_at_rest.yaml", "lossy.yaml"):
            output = self.path(name)
            report = program("monte_carlo", model=name, output=output, signals=",".join(SIGNALS), **self.SETTINGS)
            results = sp.monte_carlo(sp.Model.load(name), signals=SIGNALS, **self.SETTINGS)
            loaded = sp.Results.load(output)
            self.assertSameTables(loaded, results)
            self.assertEqual(results.report.splitlines()[1:3], report.splitlines()[1:3])
            self.assertEqual(results.variance.shape, (4, 30))
            self.assertEqual(loaded.model, sp.Model.load(name))
            np.testing.assert_array_equal(results.signals["gap"].variance, loaded.signals["gap"].variance)
            np.testing.assert_array_equal(results.gaps.histogram, loaded.gaps.histogram)
            self.assertEqual(results.gaps.histogram.sum(), 4 * 3000)
            self.assertEqual(results.amplification.measured["l2_ratio"].shape, (5,))
            self.assertEqual("ages" in results.summary["crc32"], name == "lossy.yaml")
        self.assertEqual(set(results.ages.signal), {"position"})

    def test_the_variance_agrees_with_the_theory(self):
        results = sp.monte_carlo(sp.Model.load(), followers=3, steps=20, realizations=20000, seed=11)
        self.assertLess(results.max_abs_z, 5.0)
        np.testing.assert_allclose(results.theoretical_variance, sp.analyze(sp.Model.load(), followers=3, steps=20).variance, rtol=1e-12)

    def test_threads_and_folders_change_no_bit(self):
        model = sp.Model.load()
        results = sp.monte_carlo(model, threads=1, **self.SETTINGS)
        written = sp.monte_carlo(model, threads=3, output=self.path("run"), **self.SETTINGS)
        self.assertSameTables(results, written)
        self.assertSameTables(results, sp.Results.load(self.path("run")))
        self.assertRaisesText(ValueError, "holds results", sp.monte_carlo, model, output=self.path("run"), **self.SETTINGS)

    def test_progress_is_told_and_may_stop_a_run_which_continues_in_its_folder(self):
        settings = dict(followers=20, steps=100, realizations=400000, seed=5, threads=1, output=self.path("run"))
        calls = []

        class Enough(Exception):
            pass

        def progress(done, of):
            calls.append(done)
            self.assertEqual(of, 400000)
            if 0 < done < of:
                raise Enough(done)

        self.assertRaises(Enough, sp.monte_carlo, sp.Model.load(), progress=progress, **settings)
        stopped = sp.Results.load(self.path("run"))
        self.assertFalse(stopped.complete)
        self.assertTrue(0 < stopped.realizations < 400000)
        calls.clear()
        results = sp.monte_carlo(sp.Model.load(), progress=lambda done, of: calls.append(done), **settings)
        self.assertGreaterEqual(calls[0], stopped.realizations)
        self.assertEqual(calls[-1], 400000)
        whole = program("monte_carlo", output=self.path("whole"), realizations=400000, seed=5, followers=20, steps=100)
        self.assertIn("Results", whole)
        self.assertSameTables(results, sp.Results.load(self.path("whole")))

    def test_ctrl_c_ends_a_run(self):
        threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
        began = time.monotonic()
        self.assertRaises(KeyboardInterrupt, sp.monte_carlo, sp.Model.load(), realizations=10**8)
        self.assertLess(time.monotonic() - began, 60.0)

    def test_other_threads_go_on_during_a_computation(self):
        counted = [0]
        ended = threading.Event()

        def count():
            while not ended.wait(0.001):
                counted[0] += 1

        thread = threading.Thread(target=count)
        thread.start()
        before = counted[0]
        sp.monte_carlo(sp.Model.load(), realizations=300000, threads=1)
        during = counted[0] - before
        ended.set()
        thread.join()
        self.assertGreater(during, 10)

    def test_a_realization_is_that_of_the_tool(self):
        program("monte_carlo", "--trajectories", only=17, output=self.path("one"), **self.SETTINGS)
        loaded = sp.Trajectories.load(self.path("one"))
        computed = sp.trajectories(sp.Model.load(), 17, **self.SETTINGS)
        self.assertEqual(computed.steps[0], -1.0)
        self.assertEqual(computed["position"].shape, (5, 31))
        for quantity in sp.Trajectories.QUANTITIES:
            np.testing.assert_array_equal(computed[quantity], loaded[quantity])
        part = computed.between(5, 8)
        np.testing.assert_array_equal(part["gap"], computed["gap"][:, 6:10])
        self.assertEqual((list(part.steps), part.name), ([5.0, 6.0, 7.0, 8.0], "realization 17"))
        self.assertRaisesText(ValueError, "rows are missing", computed.between, 40, 50)
        self.assertRaisesText(KeyError, "colour: must be one of position", lambda: computed["colour"])
        self.assertRaisesText(ValueError, "only: 3000: must be below", sp.trajectories, sp.Model.load(), 3000, **self.SETTINGS)

    def test_bad_settings_raise_with_the_texts_of_the_tools(self):
        model = sp.Model.load()
        self.assertRaisesText(ValueError, "realizations: 0: must be", sp.monte_carlo, model, realizations=0)
        self.assertRaisesText(ValueError, "steps: 0: must be at least 1 for a Monte Carlo", sp.monte_carlo, model, steps=0)
        self.assertRaisesText(ValueError, "threads: 0: must be 1 or more", sp.monte_carlo, model, threads=0)


class ResultFiles(InFolder):
    def setUp(self):
        super().setUp()
        self.run_folder = self.path("run")
        sp.monte_carlo(sp.Model.load(), followers=2, steps=5, realizations=50, output=self.run_folder)

    def test_damage_is_found(self):
        table = os.path.join(self.run_folder, "statistics.csv")
        with open(table) as file:
            text = file.read()
        with open(table, "w") as file:
            file.write(text.replace("1,0,50", "1,0,51", 1))
        self.assertRaisesText(ValueError, "statistics.csv: is not as it was written", sp.Results.load, self.run_folder)
        os.remove(table)
        self.assertRaisesText(FileNotFoundError, "statistics.csv", sp.Results.load, self.run_folder)

    def test_folders_that_hold_no_run_are_refused(self):
        self.assertRaisesText(FileNotFoundError, "no such folder", sp.Results.load, self.path("none"))
        self.assertRaisesText(FileNotFoundError, "summary.json", sp.Results.load, self.folder)
        self.assertRaisesText(ValueError, "must be a run's folder", sp.Results.load, os.path.join(self.run_folder, "summary.json"))
        results = sp.Results.load(self.run_folder)
        self.assertRaisesText(KeyError, "gaps.csv: no such file: run with signals:=gap", lambda: results.gaps)
        self.assertRaisesText(KeyError, "has no table gaps: must be one of statistics", results.table, "gaps")
        self.assertEqual(results.signals, {})

    def test_tables_with_quotes_and_texts_are_read(self):
        with open(self.path("sweep.csv"), "w") as file:
            file.write('point,"the, ""leader""",' + ",".join(sp.Sweep.MEASURED[1:]) + "\n" + '0,"a,b"' + ",1" * 11 + "\r\n1,c" + "," * 11 + "\n")
        sweep = sp.Sweep.load(self.path("sweep.csv"))
        self.assertEqual(sweep.varied, ['the, "leader"'])
        self.assertEqual(sweep.columns['the, "leader"'], ["a,b", "c"])
        np.testing.assert_array_equal(sweep.columns["mean"], [1.0, np.nan])
        with open(self.path("sweep.csv"), "a") as file:
            file.write("2,d,1\n")
        self.assertRaisesText(ValueError, "line 4 has 3 values instead of 13", sp.Sweep.load, self.path("sweep.csv"))


class Recordings(InFolder):
    SMALL = os.path.join(DATA, "small.bag")

    def test_positions_are_those_of_the_messages(self):
        recording = sp.Recording(self.SMALL)
        run = recording.configuration.run
        with rosbag.Bag(self.SMALL) as bag:
            for vehicle in (0, 1):
                positions = recording.positions(vehicle=vehicle)
                self.assertEqual(positions.shape, (run["realizations"], run["steps"] + 1))
                self.assertTrue(np.isfinite(positions).all())
                for _, message, _ in bag.read_messages(["/platoon/vehicle_{}/position".format(vehicle)]):
                    rows = slice(message.first_realization, message.first_realization + len(message.position))
                    np.testing.assert_array_equal(positions[rows, message.step + 1], message.position)

    def test_results_have_the_bits_of_the_run(self):
        program("bag_statistics", self.SMALL, output=self.path("results"))
        self.assertSameTables(sp.Results.load(self.path("results")), sp.Recording([self.SMALL]).results())
        self.assertIn("gap", sp.Recording(self.SMALL).results(signals=["gap"]).signals)

    def test_bad_recordings_and_names_raise(self):
        recording = sp.Recording(self.SMALL)
        self.assertRaisesText(FileNotFoundError, "none.bag: no such file", sp.Recording, self.path("none.bag"))
        self.assertRaises(IndexError, recording.positions, 1000)
        self.assertRaises(IndexError, recording.inputs, 1)
        with open(self.SMALL, "rb") as file:
            content = file.read()
        with open(self.path("cut.bag"), "wb") as file:
            file.write(content[:len(content) // 2])
        self.assertRaises(ValueError, sp.Recording(self.path("cut.bag"), partial=True).results)
        self.assertRaises(ValueError, lambda: sp.Recording(self.path("cut.bag")).results())


if __name__ == "__main__":
    unittest.main()
