"""Recordings of launches: the base of tests that record, and the tool that reads a bag."""

import os
import subprocess

import rosbag

import live_platoon
from terminal import LaunchTest

DATA = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data")


def bag_statistics(*arguments):
    return subprocess.run([live_platoon.executable("bag_statistics")] + list(arguments), stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, errors="replace")


class BagTest(LaunchTest):
    def setUp(self):
        super().setUp()
        self.bag = os.path.join(self.folder, "run.bag")

    def record(self, **arguments):
        terminal = self.launch(record=self.bag, **arguments)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(self.output), terminal.text())
        return terminal

    def csv_of(self, *bags):
        result = bag_statistics(*bags, "--csv")
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout.encode()

    def assert_whole(self, bag, followers, steps, batches):
        with rosbag.Bag(bag) as opened:
            counts = {topic: info.message_count for topic, info in opened.get_type_and_topic_info().topics.items()}
        for i in range(followers + 1):
            self.assertEqual(counts["/platoon/vehicle_{}/position".format(i)], batches * (steps + 1))
        for i in range(1, followers + 1):
            self.assertEqual(counts["/platoon/vehicle_{}/predecessor_position".format(i)], batches * (steps + 1))
        self.assertEqual(counts["/platoon/configuration"], 1)
        self.assertGreaterEqual(counts["/platoon/error_statistics"], steps)
