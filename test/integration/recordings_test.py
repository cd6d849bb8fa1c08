#!/usr/bin/python3
"""Recordings of several runs are rejected by all readers; those of a part of a run give whole realizations only."""

import csv
import os
import unittest

import numpy as np
import rosbag
import stochastic_platoon as sp

import live_platoon
from live_platoon import tool
from recording import BagTest, SmallBagTest
from user_tools_test import script


def exported(folder):
    """The realizations in the table of this folder."""
    with open(folder + "/trajectories.csv") as stream:
        rows = list(csv.DictReader(stream))
    assert all(row["position"] for row in rows), "cells are empty"
    return sorted({int(row["realization"]) for row in rows})


def of_another_run(topic, message):
    """For altered()."""
    if topic.endswith("/configuration"):
        message.data = message.data.replace('"seed":1', '"seed":2')
    if hasattr(message, "run"):
        message.run ^= 1
    return 1


class TwoRunsTest(SmallBagTest):
    MORE = "holds more than one run of a platoon: must hold one"

    def setUp(self):
        super().setUp()
        self.other, self.both = self.altered("other.bag", of_another_run), self.path("both.bag")
        with rosbag.Bag(self.both, "w") as target:
            for file in (self.SMALL, self.other):
                with rosbag.Bag(file) as source:
                    for topic, message, time in source.read_messages():
                        target.write(topic, message, time)


class TwoRuns(TwoRunsTest):
    def test_tables_and_statistics_of_two_runs_are_rejected(self):
        for bags in ([self.SMALL, self.other], [self.other, self.SMALL], [self.both]):
            done = script("export", *bags, "--output", self.path("out"), "--unverified")
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertIn("{}: {}".format(bags[0], self.MORE), done.stderr)
            with self.assertRaisesRegex(ValueError, self.MORE):
                sp.Recording(bags, unverified=True).positions(1)
            self.assertIn(self.MORE, tool("bag_statistics", *bags, "--unverified").stderr)

    def test_no_replay_of_bags_of_two_runs_begins(self):
        two = self.SMALL + " " + self.other
        for bag, drive in ((two, ""), (two, "leader"), (two, "vehicle_1"), (self.both, "leader")):
            done = tool("configure", bag=bag, drive=drive, unverified="true", output=self.path("out"))
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(self.MORE, done.stderr)


class ReplayOfTwoRuns(BagTest, TwoRunsTest):
    def test_a_replay_of_a_bag_of_two_runs_ends_with_the_reason(self):
        for drive in ("", "vehicle_1"):
            text = self.replayed(self.both, drive=drive, unverified=True, output="" if drive else self.path("out"))
            self.assertIn(self.MORE, text)
            self.assertNotIn("complete, undamaged", text)
            self.assertNotIn("equal the recorded ones", text)


class MissingMessages(SmallBagTest):
    """6 realizations in batches of 4 and 2, of which the first lacks a step of one stream."""

    def setUp(self):
        super().setUp()
        self.hole = self.altered("hole.bag", lambda topic, message: 0 if topic.endswith("vehicle_1/predecessor_position")
                                 and (message.step, message.first_realization) == (2, 0) else 1)

    def export(self, *options):
        return script("export", self.hole, "--unverified", "--output", self.path("out"), *options)

    def test_export_writes_whole_realizations_only(self):
        done = self.export()
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("{}: the recording is not complete: received_position of vehicle_1 lacks step 2 of realization 0; --partial".format(self.hole),
                      done.stderr)
        done = self.export("--partial", "--realizations", "0:4")
        self.assertIn("hole.bag: holds no whole realization", done.stderr)
        self.assertEqual(self.export("--partial").returncode, 0)
        self.assertEqual(exported(self.path("out")), [4, 5])

    def test_realizations_that_are_whole_need_no_partial(self):
        self.assertEqual(self.export("--realizations", "4:6").returncode, 0)
        self.assertEqual(exported(self.path("out")), [4, 5])

    def test_the_python_module_raises_or_marks_what_is_missing(self):
        recording, partial = (sp.Recording(self.hole, unverified=True, partial=partial) for partial in (False, True))
        self.assertTrue(np.isfinite(recording.positions(1)).all())
        for read in (lambda: recording.predecessor_positions(1), lambda: list(recording.trajectories(0, 6))):
            self.assertRaisesRegex(ValueError, "vehicle_1 lacks step 2 of realization 0", read)
        missing = np.isnan(partial.predecessor_positions(1))
        self.assertTrue(missing[:4, 3].all())
        self.assertEqual(missing.sum(), 4)
        self.assertEqual([of.name for of in partial.trajectories(0, 6)], ["realization 4", "realization 5"])


class Resumed(BagTest):
    def setUp(self):
        super().setUp()
        settings = dict(followers=2, steps=5, hosting="one_process")
        self.run_to_the_end(realizations=4, **settings)
        self.record(realizations=6, resume="true", **settings)

    def test_a_recording_has_the_realizations_of_the_resumed_run(self):
        recording = sp.Recording(self.bag)
        self.assertEqual(recording.realizations, range(4, 6))
        self.assertEqual(recording.positions(1).shape, (2, 6))
        self.assertTrue(np.isfinite(recording.positions(1)).all())
        self.assertEqual([of.name for of in recording.trajectories(4, 2)], ["realization 4", "realization 5"])
        self.assertRaisesRegex(IndexError, "first: 0: must be from 4 to 5", next, recording.trajectories(0, 1))
        done = script("export", self.bag, "--output", self.path("out"), "--realizations", "0:1")
        self.assertIn("--realizations: 0:1: must be A:B with 4 <= A < B <= 6", done.stderr)
        self.assertEqual(script("export", self.bag, "--output", self.path("out")).returncode, 0)
        self.assertEqual(exported(self.path("out")), [4, 5])

    def test_its_statistics_are_those_of_a_part_of_the_run(self):
        part, summary = "realizations 4 to 5 of 6", self.path("part", "summary.json")
        self.assertEqual(tool("bag_statistics", self.bag, output=self.path("part")).returncode, 0)
        self.assertIn("(a part of the run, {})".format(part), tool("check", self.path("part")).stdout)
        self.assertNotIn("a part of", tool("check", self.output).stdout)
        done = tool("monte_carlo", repeat=summary, output=self.path("again"))
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("{}: is of {}: cannot be repeated".format(summary, part), done.stderr)


class Leading(BagTest):
    """Recordings that lead other followers."""

    def configured(self, **options):
        output = self.path("out{}".format(len(os.listdir(self.folder))))  # each claims its folder
        return tool("configure", bag=self.bag, drive="leader", hosting="one_process", output=output, **options)

    def test_another_model_must_have_the_recorded_sample_period(self):
        self.record(followers=1, steps=10, realizations=2, hosting="one_process")
        done = self.configured(model=self.model_with(sample_period=0.05))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("model/sample_period: 0.05: must be 0.1 [s], that of the recording", done.stderr)
        self.assertEqual(self.configured(model=self.model_with(sample_period=0.1)).returncode, 0)

    def test_a_model_that_has_no_input_leaves_this_signal_out(self):
        self.record(followers=1, steps=10, realizations=2, hosting="one_process", model="acc.yaml", signals="gap,input")
        period = sp.Recording(self.bag).model.sample_period
        for model, signals in ((self.model_with(sample_period=period), "gap"), ("acc.yaml", "gap,input"), ("", "gap,input")):
            done = self.configured(model=model)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(sp.Configuration.parse(done.stdout).run["signals"], signals)

    def test_an_endless_recording_cannot_lead_and_is_found_by_its_name(self):
        active = self.bag + ".active"
        terminal = self.launch(followers=2, steps=0, rate=200, record=self.bag)
        live_platoon.wait_for(lambda: os.path.exists(active) and os.path.getsize(active) > 50000, "a recording", 60)
        terminal.interrupt()
        for reading in (tool("bag_statistics", self.bag), script("export", self.bag, "--output", self.path("out"))):
            self.assertEqual(reading.returncode, 1)
            self.assertIn("There is {}".format(active), reading.stderr)
        self.bag = active
        done = self.configured()
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("drive: leader: the recording is of an endless run: must be of a run with steps above 0", done.stderr)
        self.assertNotIn("positions", done.stderr)


if __name__ == "__main__":
    unittest.main()
