#!/usr/bin/python3
"""Copies of the bag in test/data with flipped bits or without an end are rejected, or give what is left of them."""

import csv
import os
import shutil
import struct
import unittest

import rosbag

from live_platoon import tool
from recording import DATA, SmallBagTest
from terminal import Terminal


class Damaged(SmallBagTest):
    def test_every_value_that_was_changed_is_recognized(self):
        """Flips one bit of one position at a time, also of positions that do not enter the statistics."""
        with open(self.SMALL, "rb") as file:
            content = file.read()
        values = set()
        with rosbag.Bag(self.SMALL) as bag:
            for topic, message, _ in bag.read_messages():
                if topic.endswith("/position"):
                    values.update(message.position)
        places = sorted({content.find(struct.pack("<d", value)) for value in values if value != 0.0} - {-1})
        self.assertGreater(len(places), 20)
        path = self.path("bent.bag")
        for count, at in enumerate(places):
            bent = bytearray(content)
            bent[at + count % 7] ^= 1 << count % 8
            with open(path, "wb") as file:
                file.write(bent)
            self.rejected(path, "messages are not as they were recorded", options=[["--partial"], []][count % 2])

    def test_a_truncated_bag_is_rejected_and_its_readable_part_used_with_partial(self):
        with open(self.SMALL, "rb") as file:
            content = file.read()
        for share in (0.95, 0.55):
            path = self.path("cut.bag")
            with open(path, "wb") as file:
                file.write(content[:int(share * len(content))])
            self.rejected(path, "cut.bag: ")
            result = tool("bag_statistics", path, "--partial")
            self.assertIn("the file ends early, before byte {} of".format(int(share * len(content))), result.stderr)
            # The first batch, of four realizations, ends before the middle of the file and the second before its last tenth.
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("4 realizations" if share < 0.9 else "6 realizations", result.stdout)

    def test_any_cut_and_any_flipped_byte_is_survived(self):
        """A truncated file gives whole batches, of 4 and 2 realizations; a changed byte is rejected unless nothing relevant follows it."""
        with open(os.path.join(DATA, "small_statistics.csv")) as file:
            right = file.read()
        first = self.altered("first.bag", lambda topic, message: 0 if getattr(message, "first_realization", 0) == 4 else 1)
        whole = [tool("bag_statistics", first, "--partial", "--unverified", "--csv").stdout, right]
        for text, count in zip(whole, (4, 6)):
            self.assertEqual({row["count"] for row in csv.DictReader(text.splitlines())}, {str(count)})
        accepted = []
        with open(self.SMALL, "rb") as file:
            content = file.read()
        path = self.path("hostile.bag")
        for i in range(120):
            at = (i * 7919) % len(content)
            bent = bytearray(content[:at] if i % 2 else content)
            if i % 2 == 0:
                bent[at] ^= 0xff
            with open(path, "wb") as file:
                file.write(bent)
            result = tool("bag_statistics", path, "--partial", "--csv")
            self.assertIn(result.returncode, (0, 1), "cut or bent at byte {}: {}".format(at, result.stderr))
            if result.returncode == 0:
                self.assertIn(result.stdout, whole if i % 2 else [right], "cut or bent at byte {}: {}".format(at, result.stderr))
                accepted += [whole.index(result.stdout)] if i % 2 else []
        self.assertGreater(len(accepted), 10)
        self.assertEqual(set(accepted), {0, 1})

    def test_an_empty_bag_a_missing_one_and_something_else_are_rejected(self):
        empty = self.path("empty.bag")
        rosbag.Bag(empty, "w").close()
        self.rejected(empty, "empty.bag: holds no topic \"configuration\": it is no recording of a platoon")
        self.rejected(self.write("nothing.bag", ""), "nothing.bag: is damaged or no bag")
        self.rejected(self.path("missing.bag"), "missing.bag: must be a bag, a regular file that can be read")
        os.mkfifo(self.path("fifo"))
        self.rejected(self.path("fifo"), "fifo: must be a bag, a regular file that can be read")
        self.rejected("/dev/zero", "/dev/zero: must be a bag, a regular file that can be read")
        self.rejected(__file__, "damaged_bag_test.py: is damaged or no bag")

    def test_the_file_of_a_killed_recorder_is_rejected_and_used_with_partial(self):
        output, bag = self.path("run"), self.path("killed.bag")
        terminal = Terminal(self.folder, "platoon.launch", output=output, record=bag, followers=2, steps=10, realizations=400,
                            batch=10, rate=100)
        self.addCleanup(terminal.end)
        terminal.wait_for_text("/400 realizations")
        left = self.path("left.bag.active")
        shutil.copy(bag + ".active", left)
        self.rejected(left, "was not closed")
        self.assertIn(self.partial(left)["realizations"] % 10, (0,))


if __name__ == "__main__":
    unittest.main()
