#!/usr/bin/python3
"""check: the program that judges the results of a run."""

import csv
import json
import os
import pathlib
import resource
import shutil
import subprocess
import unittest
import zlib

import stochastic_platoon as sp

import live_platoon
from folder import FolderTest, temporary_folder


def limit_files(size):
    """Writes beyond this size [bytes] fail like those to a full disk."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


def script(name, *arguments, largest=resource.RLIM_INFINITY):
    """The finished process of a program in Python, which can write no file above the size `largest` [bytes]."""
    return subprocess.run([live_platoon.shared("src", "tools", name), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=4 * live_platoon.DEADLINE, preexec_fn=lambda: limit_files(largest))


def sign(folder, summary=None):
    """Writes a summary whose checksums are those of the present tables, as a forger would."""
    file = pathlib.Path(folder, "summary.json")
    summary = summary or json.loads(file.read_text())
    for name in summary["crc32"]:
        if name != "summary":
            summary["crc32"][name] = "{:08x}".format(zlib.crc32(pathlib.Path(folder, name + ".csv").read_bytes()))
    summary["crc32"]["summary"] = "00000000"
    text = json.dumps(summary, indent=2, sort_keys=True) + "\n"
    own = "{:08x}".format(zlib.crc32(text.encode()))
    file.write_text(text.replace('"summary": "00000000"', '"summary": "{}"'.format(own)))


class RunTest(FolderTest):
    OPTIONS = dict(followers=3, steps=60, realizations=300, signals="gap,speed")

    @classmethod
    def setUpClass(cls):
        cls.whole = os.path.join(temporary_folder(cls.addClassCleanup), "whole")
        done = live_platoon.tool("monte_carlo", output=cls.whole, **cls.OPTIONS)
        assert done.returncode == 0, done.stderr

    def setUp(self):
        super().setUp()
        self.run_folder = self.path("run")
        shutil.copytree(self.whole, self.run_folder)

    def change(self, name, old, new):
        file = pathlib.Path(self.run_folder, name)
        text = file.read_text()
        self.assertIn(old, text)
        file.write_text(text.replace(old, new, 1))

    def summary(self):
        return json.loads(pathlib.Path(self.run_folder, "summary.json").read_text())


class Check(RunTest):
    def passes(self, *folders):
        done = live_platoon.tool("check", *folders or [self.run_folder])
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return done.stdout

    def fails(self, *reasons, folder=None):
        done = live_platoon.tool("check", folder or self.run_folder)
        self.assertEqual(done.returncode, 1, done.stdout)
        lines = done.stdout.splitlines()
        self.assertEqual(len(lines), len(reasons), done.stdout)
        for line, reason in zip(lines, reasons):
            self.assertIn(reason, line)

    def test_a_whole_run_passes_in_one_line(self):
        self.assertRegex(self.passes(), r"^\S+: string stable; complete, undamaged, in agreement \(largest \|z\| [\d.]+, at most [\d.]+\): "
                                        r"3 followers, 60 steps, 300 realizations, seed 1\n$")
        self.assertEqual(len(self.passes(self.run_folder, self.whole).splitlines()), 2)
        self.assertEqual(sp.check(self.run_folder), [])

    def test_a_summary_that_was_rewritten_with_its_checksum_passes_if_nothing_else_changed(self):
        sign(self.run_folder)
        self.passes()

    def test_every_damaged_file_is_named(self):
        self.change("statistics.csv", "\n1,5,300,", "\n1,5,301,")
        self.change("gaps.csv", "vehicle", "Vehicle")
        self.fails("gaps.csv: is not as it was written", "statistics.csv: is not as it was written")
        self.change("summary.json", '"seed": 1', '"seed": 2')
        self.fails("summary.json: is not as it was written")

    def test_a_table_that_is_missing_is_named(self):
        os.remove(os.path.join(self.run_folder, "signals.csv"))
        self.fails("signals.csv: must be a regular file")

    def test_a_forged_measurement_disagrees_with_the_theory(self):
        with open(os.path.join(self.run_folder, "statistics.csv")) as stream:
            rows = list(csv.reader(stream))
        rows[-1][4] = str(1.6 * float(rows[-1][4]))
        with open(os.path.join(self.run_folder, "statistics.csv"), "w") as stream:
            stream.write("".join(",".join(row) + "\n" for row in rows))
        sign(self.run_folder)
        self.fails("measurement and theory disagree by the table")

    def test_a_score_beyond_chance_and_a_contradiction_are_named(self):
        summary = self.summary()
        summary["agreement"]["max_abs_z_mean"] = 9.5
        summary["contradictions"] = ["one figure is not the other"]
        sign(self.run_folder, summary)
        self.fails("disagree by the scores of summary.json: largest |z| 9.50", "contradict each other: one figure is not the other")

    def test_a_forged_verdict_is_named(self):
        summary = self.summary()
        summary["theory"]["string_stable"] = False
        sign(self.run_folder, summary)
        self.fails("the verdict is not that of the recorded model")

    def forge(self, folder, name, column):
        """Increases the first number of a column by a thousandth, and signs; returns the line, None without a number, and the table as
        it was."""
        file = pathlib.Path(folder, name)
        before = file.read_text()
        rows = [line.split(",") for line in before.splitlines()]
        at = rows[0].index(column)
        line, row = next(((n, row) for n, row in enumerate(rows, 1) if n > 1 and row[at] not in ("", "0")), (None, None))
        if row is None:
            return None, before
        row[at] = repr(1.001 * float(row[at]))
        file.write_text("".join(",".join(row) + "\n" for row in rows))
        sign(folder)
        return line, before

    def test_every_forged_column_of_theory_places_and_counts_is_named(self):
        lossy = self.path("lossy")
        done = live_platoon.tool("monte_carlo", output=lossy, loss=0.1, **dict(self.OPTIONS, signals=""))
        self.assertEqual(done.returncode, 0, done.stderr)
        forged = set()
        for folder in (self.run_folder, lossy):
            for table in sorted(name for name in os.listdir(folder) if name.endswith(".csv")):
                names = pathlib.Path(folder, table).read_text().splitlines()[0].split(",")
                places = ["vehicle", "step", "count"] if table in ("statistics.csv", "signals.csv") else []
                for column in [name for name in names if name.startswith("theoretical_")] + places:
                    with self.subTest(table=table, column=column):
                        line, before = self.forge(folder, table, column)
                        if line is None:
                            continue
                        self.fails("{}: line {}: ".format(table, line), folder=folder)
                        pathlib.Path(folder, table).write_text(before)
                        sign(folder)
                        forged.add(table)
        self.assertEqual(forged, {"statistics.csv", "signals.csv", "gaps.csv", "amplification.csv", "ages.csv"})

    def test_every_forged_figure_of_a_summary_is_named(self):
        figures = {name: value for name, value in self.summary()["theory"].items() if isinstance(value, float) and value != 0.0}
        self.assertLess({"limit_variance", "peak_gain"}, set(figures))
        for name, value in figures.items():
            summary = self.summary()
            summary["theory"][name] = 1.001 * value
            sign(self.run_folder, summary)
            self.fails("summary.json: theory/{}: ".format(name))
            summary["theory"][name] = value
            sign(self.run_folder, summary)
        for name, value in (("followers", 4), ("steps", 61), ("seed", 2)):
            summary = self.summary()
            true, summary[name] = summary[name], value
            sign(self.run_folder, summary)
            self.fails("summary.json: {}: {}: must be {}, by the recorded model and run".format(name, value, true))
            summary[name] = true
            sign(self.run_folder, summary)
        summary["theory"]["stationary_variance"][1] *= 1.001
        sign(self.run_folder, summary)
        self.fails("summary.json: theory/stationary_variance/1: ")

    def test_an_incomplete_run_is_named(self):
        summary = self.summary()
        summary.update(complete=False, realizations=200)
        sign(self.run_folder, summary)
        self.fails("not complete: 200 of 300 realizations")

    def test_a_folder_without_results_and_another_version_are_named(self):
        self.fails("not complete: nothing was measured", folder=self.folder)
        self.fails("summary.json: must be a regular file", folder=self.path("nowhere"))
        summary = self.summary()
        summary["version"] = "0.1.0"
        sign(self.run_folder, summary)
        self.fails("summary.json: version: 0.1.0: must be ")

    def test_a_summary_of_0_2_0_can_be_repeated_but_not_checked(self):
        summary = self.summary()
        summary["version"] = summary["configuration"]["version"] = "0.2.0"
        sign(self.run_folder, summary)
        self.fails("summary.json: version: 0.2.0: must be ")
        again = self.path("again")
        done = live_platoon.tool("monte_carlo", repeat=os.path.join(self.run_folder, "summary.json"), output=again)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("bit for bit", done.stdout)
        self.passes(again)

    def test_a_lossy_run_passes_by_its_own_scores(self):
        lossy = self.path("lossy")
        done = live_platoon.tool("monte_carlo", output=lossy, loss=0.1, followers=2, steps=30, realizations=4000)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("complete, undamaged, ", self.passes(lossy))


if __name__ == "__main__":
    unittest.main()
