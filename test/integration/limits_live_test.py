#!/usr/bin/python3
"""An emergency stop of cars with limits: every hosting, a recording and its replays, shards and kills give the same bits."""

import os
import subprocess
import unittest

import rosbag

import live_platoon
from limits_test import Model
from terminal import LaunchTest, kept_master

FOLLOWERS, STEPS, REALIZATIONS, BATCHES = 4, 360, 600, 6
SETTINGS = dict(followers=FOLLOWERS, steps=STEPS, realizations=REALIZATIONS, signals="gap,speed,input")
TABLES = ("statistics", "signals", "gaps", "limits")


class LimitsLive(Model, LaunchTest):
    def tables(self, folder):
        contents = {}
        for name in TABLES:
            with open(os.path.join(folder, name + ".csv"), "rb") as file:
                contents[name] = file.read()
        return contents

    def setUp(self):
        super().setUp()
        self.file = self.model(noise=0.02)

    def reference(self):
        return self.tables(self.monte_carlo("reference", model=self.file, **SETTINGS))

    def test_processes_a_recording_and_its_replays(self):
        bag = self.path("run.bag")
        self.run_to_the_end(model=self.file, batch=REALIZATIONS // BATCHES, record=bag, **SETTINGS)
        self.assertEqual(live_platoon.summary_of(self.output)["positions_lost"], 0)
        expected = self.reference()
        self.assertEqual(self.tables(self.output), expected)
        with rosbag.Bag(bag) as opened:
            counts = {topic: info.message_count for topic, info in opened.get_type_and_topic_info().topics.items()}
        self.assertEqual([counts.get("/platoon/vehicle_{}/input".format(i)) for i in range(FOLLOWERS + 1)],
                         [None] + FOLLOWERS * [BATCHES * (STEPS + 1)])
        found = live_platoon.tool("bag_statistics", bag, "--csv")
        self.assertEqual((found.returncode, found.stdout.encode()), (0, expected["statistics"]), found.stderr)
        again = self.path("again")
        self.run_to_the_end("replay.launch", bag=bag, output=again)
        self.assertEqual(self.tables(again), expected)
        terminal = self.launch("replay.launch", bag=bag, drive="vehicle_3", output="")
        terminal.wait()
        self.assertIn("vehicle_3: {} messages equal the recorded ones to the bit".format(BATCHES * (STEPS + 1)), terminal.text())
        behind = self.path("behind")
        self.run_to_the_end("replay.launch", bag=bag, drive="leader", output=behind)
        self.assertEqual(live_platoon.statistics(behind), expected["statistics"])

    def test_one_process_with_a_kill(self):
        terminal = self.launch(model=self.file, hosting="one_process", batch=10, rate=10000, **SETTINGS)
        live_platoon.wait_for(lambda: os.path.exists(os.path.join(self.output, "checkpoint.cbor")), "a checkpoint")
        live_platoon.kill("/platoon/platoon", terminal.master)
        self.completed(terminal)
        self.assertEqual(self.tables(self.output), self.reference())

    def test_shards(self):
        folders = [self.monte_carlo("shard{}".format(part), model=self.file, shard="{}/3".format(part), **SETTINGS) for part in range(3)]
        done = live_platoon.tool("merge", *folders, output=self.path("merged"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.tables(self.path("merged")), self.reference())

    def test_external_vehicles_start_steadily(self):
        # The vehicles of the example are linear and of another kind; they keep the distance of a steady start.
        self.background(live_platoon.shared("launch", "examples", "rospy_follower.py"), "2", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                        env=live_platoon.ros_environment(kept_master(), ROS_HOME=self.folder))
        calm = self.model(noise=0.0, leader={"speed": [{"from_step": 0, "value": 20.0}]})
        self.run_to_the_end(model=calm, external=2, **dict(SETTINGS, realizations=2, steps=60, signals="gap,speed"))
        with open(os.path.join(self.output, "signals.csv")) as file:
            speeds = [float(line.split(",")[4]) for line in file if line.startswith("speed,")]
        self.assertEqual(len(speeds), FOLLOWERS * 60)
        self.assertLess(max(abs(speed - 20.0) for speed in speeds), 1e-6)
        with open(os.path.join(self.output, "limits.csv")) as file:
            rows = file.read().splitlines()
        self.assertEqual(rows[2], "2,,,0,0")


if __name__ == "__main__":
    unittest.main()
