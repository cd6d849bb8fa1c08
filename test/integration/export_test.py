#!/usr/bin/python3
"""export, and the files that it and others write: all of them, or none."""

import csv
import os
import pathlib
import resource
import unittest
import unittest.mock

import numpy as np
import stochastic_platoon as sp
from stochastic_platoon.files import write_all

import live_platoon
from folder import FolderTest
from recording import DATA, BagTest
from user_tools_test import limit_files, script

SMALL = os.path.join(DATA, "small.bag")


class ExportedRun(BagTest):
    def assert_values_are_those_of_the_realizations_in_process(self, model):
        settings = dict(followers=3, steps=20, realizations=5)
        terminal = self.record(batch=2, hosting="one_process", model=model, **settings)
        live_platoon.wait_for(lambda: "complete, undamaged" in terminal.text(), "the result behind the end of roslaunch")
        self.assertRegex(terminal.text().splitlines()[-1], "^{}: .*complete, undamaged".format(self.output))
        done = script("export", self.bag, "--output", self.path("out"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with open(self.path("out", "trajectories.csv")) as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual(done.stdout, "{}: {} rows\n".format(self.path("out", "trajectories.csv"), 5 * 4 * 21))
        self.assertEqual(list(rows[0]), ["realization", "vehicle", "step", "seconds", "position", "received_position", "gap", "tracking_error",
                                         "speed", "acceleration", "jerk", "relative_speed"])
        self.assertEqual(len(rows), 5 * 4 * 21)
        period = sp.Model.load(model).sample_period
        self.assertEqual([float(row["seconds"]) for row in rows[:3]], [-period, 0.0, period])
        for realization in range(5):
            of = sp.trajectories(sp.Recording(self.bag).model, realization, **settings)
            own = [row for row in rows if row["realization"] == str(realization)]
            for name, order in (("position", 0), ("received_position", 0), ("gap", 0), ("tracking_error", 0), ("speed", 1), ("acceleration", 2),
                                ("jerk", 3), ("relative_speed", 1)):
                found = np.array([float(row[name] or "nan") for row in own]).reshape(4, 21)
                exact = name in ("position", "received_position")
                known = slice(0, 20) if name == "received_position" else slice(0, 21)  # no car acts on what it receives at the last step
                rounding = 0.0 if exact else 1e-12 / period ** order
                np.testing.assert_allclose(found[:, known], of[name][:, known], rtol=0.0, atol=rounding, err_msg=name)
        return np.array([float(row["acceleration"]) for row in rows if row["step"] == "0"])

    def test_every_value_is_that_of_the_same_realization_in_process(self):
        self.assert_values_are_those_of_the_realizations_in_process("paper.yaml")

    def test_a_steady_start_has_no_acceleration(self):
        first = self.assert_values_are_those_of_the_realizations_in_process("acc_limits.yaml")
        self.assertLess(np.abs(first).max(), 1.0)


class Export(FolderTest):
    def export(self, *arguments, output="out", **limits):
        return script("export", SMALL, "--output", self.path(output), *arguments, **limits)

    def rows(self, output="out"):
        with open(self.path(output, "trajectories.csv")) as stream:
            return list(csv.DictReader(stream))

    def test_some_realizations_only(self):
        self.assertEqual(self.export("--realizations", "2:4").returncode, 0)
        self.assertEqual({row["realization"] for row in self.rows()}, {"2", "3"})
        for bad in ("4:2", "0:7", "x"):
            done = self.export("--realizations", bad, output="bad")
            self.assertEqual(done.returncode, 1)
            self.assertIn("--realizations: {}: must be A:B with 0 <= A < B <= 6".format(bad), done.stderr)
        self.assertFalse(os.path.exists(self.path("bad")))

    def test_nothing_is_overwritten(self):
        self.assertEqual(self.export().returncode, 0)
        done = self.export("--realizations", "0:1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("trajectories.csv: exists and is never overwritten", done.stderr)
        self.assertEqual(len(self.rows()), 6 * 3 * 6)
        self.assertEqual(os.listdir(self.path("out")), ["trajectories.csv"])

    def test_a_full_disk_leaves_no_file(self):
        done = self.export(largest=5000)
        self.assertEqual(done.returncode, 1)
        self.assertIn("trajectories.csv: cannot be written: File too large", done.stderr)
        self.assertEqual(os.listdir(self.path("out")), [])

    def test_a_damaged_bag_is_rejected_and_leaves_no_file(self):
        content = bytearray(pathlib.Path(SMALL).read_bytes())
        content[len(content) // 2] ^= 1
        pathlib.Path(self.path("damaged.bag")).write_bytes(content)
        done = script("export", self.path("damaged.bag"), "--output", self.path("out"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("damaged.bag", done.stderr)
        self.assertFalse(os.path.exists(self.path("out", "trajectories.csv")))


class WriteAll(FolderTest):
    def test_a_full_disk_leaves_none_of_the_files(self):
        self.addCleanup(limit_files, resource.getrlimit(resource.RLIMIT_FSIZE)[0])
        limit_files(5000)
        for content in (bytes(5001), [bytes(2501)] * 2):
            with self.assertRaisesRegex(OSError, "^{}: cannot be written: File too large$".format(self.path("large"))):
                write_all({self.path("small"): b"1", self.path("large"): content, self.path("last"): b"2"})
            self.assertEqual(os.listdir(self.folder), [])

    def test_no_file_is_written_if_one_exists(self):
        os.symlink("nowhere", self.path("link"))
        self.write("file", "before")
        for name in ("link", "file"):
            with self.assertRaisesRegex(FileExistsError, "^{}: cannot be written: File exists$".format(self.path(name))):
                write_all({self.path("new"): b"1", self.path(name): b"2"})
        self.assertEqual(sorted(os.listdir(self.folder)), ["file", "link"])
        self.assertEqual(pathlib.Path(self.path("file")).read_text(), "before")

    def test_a_file_system_may_have_no_links(self):
        with unittest.mock.patch("os.link", side_effect=PermissionError(1, "Operation not permitted")):
            write_all({self.path("file"): b"1"})
            self.assertRaises(FileExistsError, write_all, {self.path("file"): b"2"})
        self.assertEqual(os.listdir(self.folder), ["file"])
        self.assertEqual(pathlib.Path(self.path("file")).read_bytes(), b"1")


if __name__ == "__main__":
    unittest.main()
