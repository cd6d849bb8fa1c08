#!/usr/bin/python3
"""Models and theory of the Python module against the programs: the same numbers and messages; NumPy arrays."""

import json
import math
import os
import pickle
import unittest

import numpy as np
import stochastic_platoon as sp

import live_platoon
from python_module import SIGNALS, ModuleTest, program


class Models(ModuleTest):
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

    def test_a_model_keeps_the_tables_that_it_was_made_with(self):
        self.addCleanup(os.chdir, os.getcwd())
        for folder, speeds, received in (("here", "5 6 7", "1 1 0"), ("there", "9 9 9", "0 0 1")):
            os.mkdir(self.path(folder))
            with open(self.path(folder + "/drive.csv"), "w") as file:
                file.write("time,speed\n" + "".join("{}.0,{}\n".format(t, v) for t, v in enumerate(speeds.split())))
            with open(self.path(folder + "/received.csv"), "w") as file:
                file.write("received\n" + "\n".join(received.split()) + "\n")
        os.chdir(self.path("here"))
        paper, trace = sp.Model.load(), {"trace": "received.csv", "column": "received", "on_loss": "hold"}
        made = [paper.replace(leader="drive.csv"), paper.replace({"leader": {"file": "drive.csv"}}), paper.replace({"channel": {"loss": trace}}),
                sp.Model.parse(json.dumps(dict(paper.to_dict(), leader={"file": "drive.csv"})))]
        found = [sp.monte_carlo(model, followers=2, steps=15, realizations=5).mean for model in made]
        os.chdir(self.path("there"))
        for model, before in zip(made, found):
            self.assertEqual(model.replace(noise_variance=0.5).to_dict()["leader"], model.to_dict()["leader"])
            self.assertEqual(model.replace(time_headway=3.2), model)
        for name in ("drive.csv", "received.csv"):
            os.remove(self.path("here/" + name))
        for model, before in zip(made, found):
            np.testing.assert_array_equal(sp.monte_carlo(model, followers=2, steps=15, realizations=5).mean, before)

    def test_a_vehicle_has_its_loop_and_its_place(self):
        model = sp.Model.load()
        vehicle = model.vehicle(3)
        self.assertEqual(vehicle.A.shape, (vehicle.B.size, vehicle.C.size))
        # T(z) = C (z I - A)^-1 B, with T(1) = 1.
        self.assertAlmostEqual(float(vehicle.C @ np.linalg.solve(np.eye(vehicle.B.size) - vehicle.A, vehicle.B)), 1.0, places=12)
        self.assertEqual(sp.Model.load("paper_at_rest.yaml").vehicle(3).place, -3 * sp.Model.load("paper_at_rest.yaml").vehicle(0).standstill_distance)
        self.assertRaises(IndexError, model.vehicle, -1)
        self.assertRaises(IndexError, model.vehicle_to_dict, -1)
        self.assertEqual(model.vehicle(np.int64(3)).place, vehicle.place)
        for bad in (1.5, 10**30, "1"):
            for function in (model.vehicle, model.vehicle_to_dict):
                self.assertRaisesText(ValueError, "vehicle: {!r}: must be a whole number from 0 to 18446744073709551615".format(bad), function, bad)

    def test_the_keys_of_a_vehicle_are_those_of_its_type(self):
        model = sp.Model.load("mixed.yaml")
        for index in range(7):
            vehicle, keys = model.vehicle(index), model.vehicle_to_dict(index)
            self.assertEqual((keys["time_headway"], keys["standstill_distance"]), (vehicle.time_headway, vehicle.standstill_distance))
            self.assertEqual(keys["controller"], model.to_dict()["controller"])

    def test_the_keys_of_a_vehicle_are_a_model(self):
        """The keys of its type come without those of the default vehicle that they exclude."""
        loop = sp.Model.load("closed_loop.yaml")
        paper = sp.Model.load().to_dict()
        given = {"closed_loop": loop.to_dict()["closed_loop"], "time_headway": loop.time_headway}
        for base, own in ((sp.Model.load("acc_limits.yaml"), given), (loop, {key: paper[key] for key in ("plant", "controller", "time_headway")}),
                          (sp.Model.load("acc.yaml"), {"spacing": "constant"}), (sp.Model.load("path_cacc.yaml"), {"spacing": "headway", "time_headway": 12})):
            model = base.replace({"allow_unstable": True, "vehicle_types": {"other": own}, "string": ["other", "default"]})
            for index in (1, 2):
                keys = model.vehicle_to_dict(index)
                self.assertEqual(sp.Model.from_dict(keys).vehicle(0).time_headway, model.vehicle(index).time_headway)
                self.assertEqual("closed_loop" in keys, "plant" not in keys)

    def test_bad_models_raise_with_the_texts_of_the_tools(self):
        model = sp.Model.load()
        self.assertRaisesText(FileNotFoundError, "nowhere.yaml", sp.Model.load, "nowhere.yaml")
        self.assertRaisesText(ValueError, "must be a regular file of at most 256 MB that can be read (a folder)", sp.Model.load, self.folder)
        self.assertRaisesText(ValueError, "time_headway: -1", model.replace, time_headway=-1)
        for one, other in (("time_headway", "time_headway_seconds"), ("headway", "headway_seconds"), ("headway", "time_headway"),
                           ("headway_seconds", "time_headway_seconds"), ("headway", "time_headway_seconds"), ("channel/delay", "delay"),
                           ("channel/loss/probability", "loss"), ("channel/loss/mean_burst", "mean_burst"), ("leader", "leader/file")):
            for changes in ({one: 3.0, other: 2.0}, {other: 2.0, one: 3.0}):
                self.assertRaisesText(ValueError, "{}: given: must be absent beside {}, which sets it too".format(other, one), model.replace, changes)
        loss = {"probability": 0.1}
        for section, value, key in (("channel", {}, "delay"), ("channel", {"delay": 2}, "channel/delay"), ("channel", {"loss": loss}, "loss"),
                                    ("channel/loss", loss, "loss"), ("leader", {"file": "city.csv"}, "leader/unit"),
                                    ("controller/numerator", [1.0, 0.0], "controller/numerator/0")):
            self.assertRaisesText(ValueError, "{}: given: must be absent beside {}, which it replaces".format(section, key), model.replace,
                                  {section: value, key: 1})
        self.assertRaisesText(ValueError, "channel: given: must be absent beside channel/loss, which it replaces", model.replace,
                              {"channel": {}, "channel/loss": loss})
        self.assertEqual(model.replace({"leader": "city.csv", "leader/unit": "km/h"}), model.replace(leader={"file": "city.csv", "unit": "km/h"}))
        inputs = [{"signal": "position", "channel": {"delay": 1}}]
        self.assertEqual(model.replace(inputs=inputs).replace(delay=2), model.replace(inputs=inputs).replace(inputs=inputs, delay=2))
        self.assertRaisesText(ValueError, "time_heedway: unknown key", model.replace, time_heedway=1)
        self.assertRaisesText(ValueError, "seed: belongs to a run", model.replace, seed=2)
        self.assertRaisesText(ValueError, "must be YAML", sp.Model.parse, "a: [1")
        for function in (sp.analyze, sp.monte_carlo, sp.stability_map):
            self.assertRaisesText(TypeError, "model: 'paper.yaml': must be a Model", function, "paper.yaml")
        self.assertRaisesText(TypeError, "model: {}: use Model.load()", sp.Model, {})
        self.assertRaisesText(FileNotFoundError, "cac.yaml: no such file: must be a model file, or one of the shipped acc.yaml", sp.Model.load, "cac.yaml")
        for bad in (object(), [object()], {(1, 2): 3}, b"3"):
            self.assertRaisesText(ValueError, "headway: ", model.replace, headway=bad)
        self.assertRaisesText(ValueError, "signals: 5: must be names", sp.analyze, model, signals=5)
        self.assertRaisesText(ValueError, "keys: [1]: must be names", sp.analyze, model, keys=[1])
        self.assertEqual(sp.analyze(model, keys="peak_gain")["peak_gain"], sp.analyze(model)["peak_gain"])
        for text in ("2 errors:\n  run/followers: 0: must be", "\n  signals: distance: must be some of"):
            self.assertRaisesText(ValueError, text, sp.analyze, model, followers=0, signals="distance")
        for text in ("2 errors:\n  run/followers: 0: must be", "\n  method: guess: must be"):
            self.assertRaisesText(ValueError, text, sp.rare, model, followers=0, method="guess")
        self.assertRaisesText(ValueError, "keys: linear/norms, peak_gian: not in the theory of this model: must be of age_of_information, bounds, ",
                              sp.analyze, model, keys=["peak_gain", "peak_gian", "linear/norms/mean_l2"])
        limited = sp.Model.load("acc_limits.yaml")
        self.assertIsNone(sp.analyze(limited, keys=["peak_gain", "linear/norms/mean_l2"]).string_stable)
        self.assertRaisesText(ValueError, "keys: linear/nroms, peak_gian: not in the theory of this model: must be of age_of_information, ",
                              sp.analyze, limited, keys=["peak_gain", "peak_gian", "linear/nroms/mean_l2"])
        self.assertRaisesText(ValueError, "document: 'paper.yaml': must be a dictionary", sp.Model.from_dict, "paper.yaml")
        self.assertRaisesText(ValueError, "1: unknown key", model.replace, {1: 2})
        self.assertRaisesText(ValueError, "collision_probability: <object", sp.analyze, model, collision_probability=object())
        self.assertRaisesText(ValueError, "loss: [None]: must be a list of numbers", sp.stability_map, model, loss=[None])
        document = model.to_dict()
        document["noise_variance"] = -0.5
        with open(self.path("bad.yaml"), "w") as file:
            json.dump(document, file)
        with self.assertRaises(ValueError) as caught:
            sp.Model.load(self.path("bad.yaml"))
        self.assertIn(str(caught.exception).split("model/")[-1], program("analyze", model=self.path("bad.yaml"), fails=True))


class Theory(ModuleTest):
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
            del expected["crc32"]
            analysis = sp.analyze(sp.Model.load(name), followers=5, steps=40, **more)
            self.compare(dict(analysis), expected)
            self.compare(dict(sp.Analysis.load(self.path("a.json"))), expected)
            self.assertIn(analysis.report, report)
            self.assertEqual(analysis.variance.shape, (5, 40))
            self.assertEqual(analysis.string_stable, expected["string_stable"])

    def test_the_theory_of_some_keys_is_that_of_all(self):
        model = sp.Model.load("two_ahead.yaml")
        some = sp.analyze(model, keys=["peak_gain", "gain_along_string"])
        self.assertAlmostEqual(max(some.numbers("gain_along_string.gain")), some.number("peak_gain"), places=12)
        self.assertEqual(some.number("peak_gain"), sp.analyze(model).number("peak_gain"))
        self.assertTrue(math.isnan(some.critical_headway))
        self.assertTrue(sp.analyze(model.replace(time_headway=22.0)).string_stable)
        self.assertIsNone(sp.analyze(model.replace(time_headway=22.0), keys=["critical_headway"]).string_stable)

    def test_keys_may_be_nested_and_are_named_if_missing(self):
        analysis = sp.analyze(sp.Model.load())
        self.assertEqual(analysis["norms.mean_l2"].shape, (20,))
        self.assertEqual(analysis["norms/mean_l2/3"], analysis["norms.mean_l2"][3])
        self.assertEqual(sp.analyze(sp.Model.load(), keys=["norms/mean_l2"])["norms/mean_l2/3"], analysis["norms/mean_l2/3"])
        self.assertRaisesText(KeyError, "norms/mean_l2/20 is missing", lambda: analysis["norms/mean_l2/20"])
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

    def test_other_files_than_analyses_are_rejected(self):
        sp.monte_carlo(sp.Model.load(), followers=1, steps=2, realizations=2, output=self.path("run"))
        self.write("tune.json", '{"minimise": "limit_variance", "goal": 1.0}')
        for name in ("run/summary.json", "tune.json"):
            self.assertRaisesText(ValueError, name + ": spectral_radius is missing: must be a file that analyze --json wrote", sp.Analysis.load,
                                  self.path(name))
        program("analyze", model="acc_limits.yaml", json=self.path("limits.json"))
        self.assertIn("limits", sp.Analysis.load(self.path("limits.json")).reason)

    def test_a_flipped_bit_is_found_in_analyses_and_tables(self):
        small = dict(followers=1, steps=2, realizations=2)
        program("analyze", followers=1, steps=2, json=self.path("a.json"))
        program("monte_carlo", "--trajectories", only=1, output=self.folder, **small)
        program("rare", "--trajectories", model="paper_at_rest.yaml", followers=1, steps=20, realizations=200, output=self.path("rare"))
        program("sweep", self.write("sweep.yaml", "{vary: {headway: [2.4, 3.2]}, followers: 1, steps: 2, realizations: 2}"), output=self.folder)
        for load, name, *files in ((sp.Analysis.load, "a.json", "a.json"), (sp.Sweep.load, "sweep.csv", "sweep.csv", "sweep.json"),
                                   *((sp.Trajectories.load, folder + "trajectories.csv", folder + "trajectories.csv", folder + "trajectories.json")
                                     for folder in ("", "rare/"))):
            load(self.path(name))
            for file in files:
                with open(self.path(file), "rb") as stream:
                    written = stream.read()
                checksums = max(written.find(b'"crc32"'), 0)
                for at in (*range(0, len(written), 1 + len(written) // 200), *range(checksums, min(checksums + 60, len(written)))):
                    with open(self.path(file), "wb") as stream:
                        stream.write(written[:at] + bytes([written[at] ^ 1 << at % 8]) + written[at + 1:])
                    with self.assertRaisesRegex(ValueError, file, msg="byte {}".format(at)):
                        load(self.path(name))
                with open(self.path(file), "wb") as stream:
                    stream.write(written)

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


if __name__ == "__main__":
    unittest.main()
