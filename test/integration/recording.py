"""Recordings of launches: the base of tests that record."""

import os

import rosbag

import live_platoon
from terminal import LaunchTest

DATA = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data")


class BagTest(LaunchTest):
    def setUp(self):
        super().setUp()
        self.bag = self.path("run.bag")

    def record(self, **arguments):
        return self.run_to_the_end(record=self.bag, **arguments)

    def csv_of(self, *bags):
        result = live_platoon.tool("bag_statistics", "--csv", *bags)
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
