"""Recordings: the bases of tests that record a launch, and of tests that alter the bag in test/data."""

import os

import rosbag

from folder import FolderTest
from live_platoon import summary_of, tool
from terminal import LaunchTest

DATA = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data")


class BagTest(LaunchTest):
    def setUp(self):
        super().setUp()
        self.bag = self.path("run.bag")

    def record(self, **arguments):
        return self.run_to_the_end(record=self.bag, **arguments)

    def csv_of(self, *bags):
        result = tool("bag_statistics", "--csv", *bags)
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


def rewritten(source, target, change):
    """Writes the messages of a bag to another one, each as often as change(topic, message) returns; it may change the message."""
    with rosbag.Bag(source) as given, rosbag.Bag(target, "w") as written:
        for topic, message, time in given.read_messages():
            for _ in range(change(topic, message)):
                written.write(topic, message, time)
    return target


def forged_position(topic, step):
    """For rewritten(): the positions of a step are a picometre larger."""
    def change(of_topic, message):
        if of_topic == topic and message.step == step:
            message.position = tuple(value + 1e-12 for value in message.position)
        return 1

    return change


class SmallBagTest(FolderTest):
    SMALL = os.path.join(DATA, "small.bag")

    def altered(self, name, keep):
        return rewritten(self.SMALL, self.path(name), keep)

    def rejected(self, bag, *said, options=()):
        result = tool("bag_statistics", bag, *options)
        self.assertEqual(result.returncode, 1)
        for words in said:
            self.assertIn(words, result.stderr)
        self.assertNotIn("terminate", result.stderr)
        return result

    def partial(self, bag, *options):
        output = self.path("partial")
        result = tool("bag_statistics", bag, "--partial", *options, output=output)
        self.assertEqual(result.returncode, 0, result.stderr)
        return summary_of(output)

    def bent(self, name, change):
        def forge(topic, message):
            change(topic, message)
            return 1

        return self.altered(name, forge)
