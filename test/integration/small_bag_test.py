#!/usr/bin/python3
"""The bag in test/data pins the format; damaged and altered copies of it are rejected with a clear error."""

import json
import os
import shutil
import struct
import subprocess
import tempfile
import time
import unittest

import rosbag

import live_platoon
from recording import DATA, bag_statistics
from xxh64 import xxh64


class SmallBag(unittest.TestCase):
    """The bag in test/data pins the format: 2 followers, steps -1 .. 4, 6 realizations in batches of 4 and 2."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.small = os.path.join(DATA, "small.bag")

    def altered(self, name, keep):
        path = os.path.join(self.folder, name)
        with rosbag.Bag(self.small) as source, rosbag.Bag(path, "w") as target:
            for topic, message, time in source.read_messages():
                for _ in range(keep(topic, message)):
                    target.write(topic, message, time)
        return path

    def refused(self, bag, *said, options=()):
        result = bag_statistics(bag, *options)
        self.assertEqual(result.returncode, 1)
        for words in said:
            self.assertIn(words, result.stderr)
        self.assertNotIn("terminate", result.stderr)
        return result

    def partial(self, bag, *options):
        output = os.path.join(self.folder, "partial")
        result = bag_statistics(bag, "--partial", "--output", output, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(output, "summary.json")) as file:
            return json.load(file)

    def test_it_gives_the_statistics_it_was_recorded_with(self):
        output = os.path.join(self.folder, "run")
        result = bag_statistics(self.small, "--output", output)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(DATA, "small_statistics.csv"), "rb") as file:
            self.assertEqual(live_platoon.statistics(output), file.read())
        self.assertTrue(live_platoon.completed_summary(output))

    def test_a_bag_of_version_0_1_0_is_refused_by_name(self):
        old = os.path.join(DATA, "small_0.1.0.bag")
        self.refused(old, "small_0.1.0.bag: holds no checksums", "versions before 0.2.0")
        self.refused(old, "small_0.1.0.bag: was recorded by stochastic_platoon 0.1.0: must be of", options=["--unverified"])

    def test_messages_of_another_run_are_named_and_not_used(self):
        def forge(topic, message):
            if topic.endswith("vehicle_1/position") and message.first_realization == 4:
                message.run ^= 1
            return 1

        self.refused(self.altered("foreign.bag", forge), "vehicle_1/position: step -1 of the realizations from 4 is of another run",
                     options=["--unverified"])
        self.assertEqual(self.partial(os.path.join(self.folder, "foreign.bag"), "--unverified")["realizations"], 4)

    def bent(self, name, change):
        def forge(topic, message):
            change(topic, message)
            return 1

        return self.altered(name, forge)

    def test_what_another_program_changed_is_refused_even_in_part(self):
        bag = self.bent("bent.bag", lambda topic, message: setattr(message, "step", 4) if topic.endswith("vehicle_1/predecessor_position")
                        and message.step == 3 else None)
        for options in ([], ["--partial"]):
            self.refused(bag, "bent.bag: is damaged, or was changed by another program", "messages are not as they were recorded",
                         options=options)

    def test_a_position_that_was_changed_is_recognized_by_the_figures_beside_it(self):
        def change(topic, message):
            if topic.endswith("vehicle_2/position") and message.step == 3 and message.first_realization == 4:
                bits = bytearray(struct.pack("<2d", *message.position))
                bits[1] ^= 1  # bit 8, counted from the lowest
                message.position = struct.unpack("<2d", bits)

        self.refused(self.bent("bent.bag", change),
                     "error_statistics: the figures of step 3 are not those of the positions beside them: the recording is damaged",
                     options=["--unverified"])

    def test_every_value_that_was_changed_is_recognized(self):
        """Flips one bit of one position at a time, also of positions that do not enter the statistics."""
        with open(self.small, "rb") as file:
            content = file.read()
        values = set()
        with rosbag.Bag(self.small) as bag:
            for topic, message, _ in bag.read_messages():
                if topic.endswith("/position"):
                    values.update(message.position)
        places = sorted({content.find(struct.pack("<d", value)) for value in values if value != 0.0} - {-1})
        self.assertGreater(len(places), 20)
        path = os.path.join(self.folder, "bent.bag")
        for count, at in enumerate(places):
            bent = bytearray(content)
            bent[at + count % 7] ^= 1 << count % 8
            with open(path, "wb") as file:
                file.write(bent)
            self.refused(path, "messages are not as they were recorded", options=[["--partial"], []][count % 2])

    def test_a_leader_that_is_not_at_one_place_is_refused(self):
        def change(topic, message):
            if topic.endswith("vehicle_0/position") and message.step == 2 and message.first_realization == 0:
                message.position = (message.position[0] + 1e-9,) + tuple(message.position[1:])

        bag = self.bent("leader.bag", change)
        for unverified, reason in (("false", "messages are not as they were recorded"),
                                   ("true", "is damaged: the leader is not at one place at step 2")):
            result = subprocess.run([live_platoon.executable("configure"), "--bag", bag, "--recorded-leader", "true", "--hosting",
                                     "one_process", "--output", self.folder + "/out", "--unverified", unverified],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(reason, result.stderr)

    def test_a_bag_of_two_runs_is_refused(self):
        from std_msgs.msg import String
        path = os.path.join(self.folder, "two.bag")
        with rosbag.Bag(self.small) as source, rosbag.Bag(path, "w") as target:
            for topic, message, time in source.read_messages():
                target.write(topic, message, time)
                if topic.endswith("configuration"):
                    target.write(topic, String(message.data.replace('"seed":1', '"seed":2')), time)
        self.refused(path, "two.bag: holds more than one run of a platoon: must hold one", options=["--unverified"])

    def test_results_are_not_written_over(self):
        output = os.path.join(self.folder, "run")
        bag_statistics(self.small, "--output", output)
        result = bag_statistics(self.small, "--output", output)
        self.assertEqual(result.returncode, 1)
        self.assertIn("holds results already, which are never overwritten", result.stderr)

    def test_a_hole_is_named_by_topic_and_step(self):
        bag = self.altered("hole.bag", lambda topic, message: 0 if topic.endswith("vehicle_1/position") and message.step == 2
                           and message.first_realization == 4 else 1)
        self.refused(bag, "vehicle_1/position: step 3 of the realizations from 4 follows step 1 of the realizations from 4: the "
                     "messages between are missing", "--partial", options=["--unverified"])
        self.assertEqual(self.partial(bag, "--unverified")["realizations"], 4)

    def test_a_duplicate_is_named_by_topic_and_step(self):
        bag = self.altered("twice.bag", lambda topic, message: 2 if topic.endswith("vehicle_2/position") and message.step == 3
                           and message.first_realization == 0 else 1)
        self.refused(bag, "vehicle_2/position: step 3 of the realizations from 0 comes twice", options=["--unverified"])

    def test_what_rosbag_compressed_is_as_good(self):
        """As `rosbag compress` does: copies every message unchanged, ordered by time."""
        for compression in (rosbag.Compression.BZ2, rosbag.Compression.LZ4):
            path = os.path.join(self.folder, "compressed.bag")
            with rosbag.Bag(self.small) as source, rosbag.Bag(path, "w", compression=compression) as target:
                for topic, message, time_ in source.read_messages(raw=True):
                    target.write(topic, message, time_, raw=True)
            with open(os.path.join(DATA, "small_statistics.csv")) as file:
                self.assertEqual(bag_statistics(path, "--csv").stdout, file.read())

    def test_the_checksums_are_what_their_message_says(self):
        """An independent computation of the checksums: see msg/Checksum.msg."""
        messages = digest = checksums = since = 0
        with rosbag.Bag(self.small) as bag:
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

    def test_foreign_topics_are_named_and_passed_over(self):
        from std_msgs.msg import String
        path = os.path.join(self.folder, "foreign.bag")
        shutil.copy(self.small, path)
        with rosbag.Bag(path, "a") as target:
            import rospy
            target.write("/chatter", String("hello"), rospy.Time(1))
        result = bag_statistics(path)
        self.assertEqual(result.returncode, 0)
        self.assertIn("/chatter: foreign", result.stderr)

    def test_a_truncated_bag_is_refused_and_its_readable_part_used_when_asked(self):
        with open(self.small, "rb") as file:
            content = file.read()
        for share in (0.95, 0.55):
            path = os.path.join(self.folder, "cut.bag")
            with open(path, "wb") as file:
                file.write(content[:int(share * len(content))])
            self.refused(path, "cut.bag: ")
            result = bag_statistics(path, "--partial")
            self.assertIn("the file ends early, before byte {} of".format(int(share * len(content))), result.stderr)
            # The first batch, of four realizations, ends before the middle of the file and the second before its last tenth.
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("4 realizations" if share < 0.9 else "6 realizations", result.stdout)

    def test_any_cut_and_any_flipped_byte_is_survived(self):
        """A truncated file gives whole batches; a changed byte is rejected unless nothing relevant follows it."""
        with open(os.path.join(DATA, "small_statistics.csv")) as file:
            right = file.read()
        with open(self.small, "rb") as file:
            content = file.read()
        path = os.path.join(self.folder, "hostile.bag")
        for i in range(120):
            at = (i * 7919) % len(content)
            bent = bytearray(content[:at] if i % 2 else content)
            if i % 2 == 0:
                bent[at] ^= 0xff
            with open(path, "wb") as file:
                file.write(bent)
            result = bag_statistics(path, "--partial", "--csv")
            self.assertIn(result.returncode, (0, 1), "cut or bent at byte {}: {}".format(at, result.stderr))
            if i % 2 == 0 and result.returncode == 0:
                self.assertEqual(result.stdout, right, "bent at byte {}: {}".format(at, result.stderr))

    def test_an_empty_bag_a_missing_one_and_something_else_are_refused(self):
        empty = os.path.join(self.folder, "empty.bag")
        rosbag.Bag(empty, "w").close()
        self.refused(empty, "empty.bag: holds no topic \"configuration\": it is no recording of a platoon")
        nothing = os.path.join(self.folder, "nothing.bag")
        with open(nothing, "w"):
            pass
        self.refused(nothing, "nothing.bag: is damaged or no bag")
        self.refused(os.path.join(self.folder, "missing.bag"), "missing.bag: must be a bag file that can be read")
        self.refused(__file__, "small_bag_test.py: is damaged or no bag")

    def test_the_file_of_a_killed_recorder_is_refused_and_used_when_asked(self):
        from terminal import Terminal
        output, bag = os.path.join(self.folder, "run"), os.path.join(self.folder, "killed.bag")
        terminal = Terminal(self.folder, "platoon.launch", output=output, record=bag, followers=2, steps=10, realizations=400,
                            batch=10, rate=200)
        try:
            terminal.wait_for_text("/400 realizations")
            left = os.path.join(self.folder, "left.bag.active")
            shutil.copy(bag + ".active", left)
        finally:
            terminal.end()
        self.refused(left, "was not closed")
        self.assertIn(self.partial(left)["realizations"] % 10, (0,))


if __name__ == "__main__":
    unittest.main()
