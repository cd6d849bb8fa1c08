#!/usr/bin/python3
"""The bag in test/data pins the format; altered copies of it are rejected with a clear error."""

import os
import shutil
import struct
import unittest

import rosbag
import rospy
from std_msgs.msg import String

import live_platoon
from live_platoon import tool
from recording import DATA, SmallBagTest
from xxh64 import xxh64


class SmallBag(SmallBagTest):
    """2 followers, steps -1 .. 4, 6 realizations in batches of 4 and 2."""

    def test_it_gives_the_statistics_it_was_recorded_with(self):
        output = self.path("run")
        result = tool("bag_statistics", self.SMALL, output=output)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(DATA, "small_statistics.csv"), "rb") as file:
            self.assertEqual(live_platoon.statistics(output), file.read())
        self.assertTrue(live_platoon.completed_summary(output))

    def test_a_bag_of_version_0_1_0_is_rejected_by_name(self):
        old = os.path.join(DATA, "small_0.1.0.bag")
        self.rejected(old, "small_0.1.0.bag: holds no checksums", "versions before 0.2.0")
        self.rejected(old, "small_0.1.0.bag: its configuration is not valid: version: 0.1.0: must be 0.2.0 or ", options=["--unverified"])

    def test_signals_that_the_recording_does_not_determine_are_rejected(self):
        self.rejected(self.SMALL, "run/signals: input: must be absent unless every vehicle has limits, a radio, or a plant by its actuator_lag",
                     options=["--signals", "input"])

    def test_messages_of_another_run_are_named_and_not_used(self):
        def forge(topic, message):
            if topic.endswith("vehicle_1/position") and message.first_realization == 4:
                message.run ^= 1
            return 1

        self.rejected(self.altered("foreign.bag", forge), "vehicle_1/position: step -1 of the realizations from 4 is of another run",
                     options=["--unverified"])
        self.assertEqual(self.partial(self.path("foreign.bag"), "--unverified")["realizations"], 4)

    def test_what_another_program_changed_is_rejected_even_in_part(self):
        bag = self.bent("bent.bag", lambda topic, message: setattr(message, "step", 4) if topic.endswith("vehicle_1/predecessor_position")
                        and message.step == 3 else None)
        for options in ([], ["--partial"]):
            self.rejected(bag, "bent.bag: is damaged, or was changed by another program", "messages are not as they were recorded",
                         options=options)

    def test_a_position_that_was_changed_is_recognized_by_the_figures_beside_it(self):
        def change(topic, message):
            if topic.endswith("vehicle_2/position") and message.step == 3 and message.first_realization == 4:
                bits = bytearray(struct.pack("<2d", *message.position))
                bits[1] ^= 1  # bit 8, counted from the lowest
                message.position = struct.unpack("<2d", bits)

        self.rejected(self.bent("bent.bag", change),
                     "error_statistics: the figures of step 3 are not those of the positions beside them: the recording is damaged",
                     options=["--unverified"])

    def test_a_leader_that_is_not_at_one_place_is_rejected(self):
        def change(topic, message):
            if topic.endswith("vehicle_0/position") and message.step == 2 and message.first_realization == 0:
                message.position = (message.position[0] + 1e-9,) + tuple(message.position[1:])

        bag = self.bent("leader.bag", change)
        for unverified, reason in (("false", "messages are not as they were recorded"),
                                   ("true", "is damaged: the leader is not at one place at step 2")):
            result = tool("configure", bag=bag, drive="leader", hosting="one_process", output=self.path("out"), unverified=unverified)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(reason, result.stderr)

    def test_a_bag_of_two_runs_is_rejected(self):
        path = self.path("two.bag")
        with rosbag.Bag(self.SMALL) as source, rosbag.Bag(path, "w") as target:
            for topic, message, time in source.read_messages():
                target.write(topic, message, time)
                if topic.endswith("configuration"):
                    target.write(topic, String(message.data.replace('"seed":1', '"seed":2')), time)
        self.rejected(path, "two.bag: holds more than one run of a platoon: must hold one", options=["--unverified"])

    def test_results_are_not_written_over(self):
        output = self.path("run")
        tool("bag_statistics", self.SMALL, output=output)
        result = tool("bag_statistics", self.SMALL, output=output)
        self.assertEqual(result.returncode, 1)
        self.assertIn("holds results already, which are never overwritten", result.stderr)

    def test_a_hole_is_named_by_topic_and_step(self):
        bag = self.altered("hole.bag", lambda topic, message: 0 if topic.endswith("vehicle_1/position") and message.step == 2
                           and message.first_realization == 4 else 1)
        self.rejected(bag, "vehicle_1/position: step 3 of the realizations from 4 follows step 1 of the realizations from 4: the "
                     "messages between are missing", "--partial", options=["--unverified"])
        self.assertEqual(self.partial(bag, "--unverified")["realizations"], 4)

    def test_a_duplicate_is_named_by_topic_and_step(self):
        bag = self.altered("twice.bag", lambda topic, message: 2 if topic.endswith("vehicle_2/position") and message.step == 3
                           and message.first_realization == 0 else 1)
        self.rejected(bag, "vehicle_2/position: step 3 of the realizations from 0 comes twice", options=["--unverified"])

    def test_what_rosbag_compressed_is_as_good(self):
        """As `rosbag compress` does: copies every message unchanged, ordered by time."""
        for compression in (rosbag.Compression.BZ2, rosbag.Compression.LZ4):
            path = self.path("compressed.bag")
            with rosbag.Bag(self.SMALL) as source, rosbag.Bag(path, "w", compression=compression) as target:
                for topic, message, time_ in source.read_messages(raw=True):
                    target.write(topic, message, time_, raw=True)
            with open(os.path.join(DATA, "small_statistics.csv")) as file:
                self.assertEqual(tool("bag_statistics", path, "--csv").stdout, file.read())

    def test_the_checksums_are_what_their_message_says(self):
        """An independent computation of the checksums: see msg/Checksum.msg."""
        messages = digest = checksums = since = 0
        with rosbag.Bag(self.SMALL) as bag:
            for topic, (_, content, _, _, kind), time_ in bag.read_messages(raw=True):
                if topic != "/platoon/checksum":
                    seed = xxh64(topic.encode(), 0) + time_.to_nsec()
                    digest = (digest + xxh64(content, seed % 2**64)) % 2**64
                    messages, since = messages + 1, since + 1
                    continue
                checksum = kind().deserialize(content)
                self.assertEqual((checksum.messages, checksum.digest), (messages, digest))
                digest = since = 0
                checksums += 1
        self.assertGreaterEqual(checksums, 2)
        self.assertEqual(since, 0, "messages behind the last checksum")

    def test_foreign_topics_are_named_and_skipped(self):
        path = self.path("foreign.bag")
        shutil.copy(self.SMALL, path)
        with rosbag.Bag(path, "a") as target:
            target.write("/chatter", String("hello"), rospy.Time(1))
        result = tool("bag_statistics", path)
        self.assertEqual(result.returncode, 0)
        self.assertIn("/chatter: foreign", result.stderr)


if __name__ == "__main__":
    unittest.main()
