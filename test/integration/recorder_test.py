#!/usr/bin/python3
"""A recorder that is killed, or whose disk is full, loses no message."""

import os
import resource
import subprocess
import time
import unittest

import live_platoon
from recording import BagTest


class Killed(BagTest):
    def test_kill_9_of_the_recorder_costs_no_message(self):
        for split in (0, 1):
            with self.subTest(split_mb=split):
                self.output = self.path("run{}".format(split))
                self.bag = self.output + ".bag"
                terminal = self.launch(record=self.bag, followers=3, steps=20, realizations=20000, batch=1000, rate=120,
                                       stall_timeout=0.5, record_split_mb=split)
                terminal.wait_for_text("/20000 realizations")
                live_platoon.kill("/platoon/channel", terminal.master)
                terminal.wait()
                self.assertGreater(live_platoon.completed_summary(self.output)["attempts"], 1)
                names = [name for name in sorted(os.listdir(self.folder)) if name.startswith("run{}".format(split))]
                self.assertFalse([name for name in names if ".active" in name or ".recovered" in name], names)
                bags = [self.path(name) for name in names if name.endswith(".bag")]
                bags.sort(key=lambda name: (len(name), name))
                if split == 0:
                    self.assert_whole(self.bag, 3, 20, 20)
                self.assertEqual(self.csv_of(*bags), live_platoon.statistics(self.output))

    def test_kill_9_of_a_follower_leaves_nothing_of_the_attempt_it_ended(self):
        terminal = self.launch(record=self.bag, followers=3, steps=20, realizations=20000, batch=1000, rate=120, stall_timeout=0.5)
        terminal.wait_for_text("/20000 realizations")
        live_platoon.kill("/platoon/vehicle_2", terminal.master)
        terminal.wait()
        self.assertGreater(live_platoon.completed_summary(self.output)["attempts"], 1)
        self.assert_whole(self.bag, 3, 20, 20)
        self.assertEqual(self.csv_of(self.bag), live_platoon.statistics(self.output))

    def test_kill_9_of_recorder_and_monitor_at_once_costs_no_message(self):
        terminal = self.launch(record=self.bag, followers=3, steps=20, realizations=20000, batch=1000, rate=120, stall_timeout=0.5,
                               hosting="one_process")
        terminal.wait_for_text("/20000 realizations")
        live_platoon.kill("/platoon/platoon", terminal.master)
        self.completed(terminal)
        self.assert_whole(self.bag, 3, 20, 20)
        self.assertEqual(self.csv_of(self.bag), live_platoon.statistics(self.output))

    def test_a_recorder_that_is_killed_once_its_bag_is_complete_says_so_again(self):
        for hosting, node in (("processes", "channel"), ("one_process", "platoon")):
            with self.subTest(hosting=hosting):
                self.output = self.path(hosting)
                self.bag = self.output + ".bag"
                terminal = self.launch(record=self.bag, followers=2, steps=10, realizations=100, hosting=hosting, stay="true")
                live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output) and os.path.exists(self.bag), "the bag")
                live_platoon.kill("/platoon/" + node, terminal.master)
                # A program that starts after the end of the run.
                subprocess.run([live_platoon.executable("until_complete")], check=True, stdout=subprocess.DEVNULL, timeout=live_platoon.DEADLINE,
                               env=live_platoon.ros_environment(terminal.master, ROS_NAMESPACE="platoon"))
                terminal.end()
                self.assertEqual(self.csv_of(self.bag), live_platoon.statistics(self.output))

    def test_an_unfinished_recording_of_another_run_is_not_touched(self):
        self.write("run.bag.active", "precious")
        terminal = self.launch(record=self.bag)
        self.assertNotEqual(terminal.wait(), 0)
        self.assertIn("run.bag.active: exists: must be a new file", terminal.text())
        with open(self.bag + ".active") as file:
            self.assertEqual(file.read(), "precious")


class FullDisk(BagTest):
    """A limit on the size of a node's files simulates a full disk, and can be lifted."""

    def limit(self, terminal, node, size):
        process = live_platoon.wait_for(lambda: live_platoon.process_of(node, terminal.master), node)
        resource.prlimit(process, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    def test_the_recorder_waits_for_room_and_goes_on(self):
        settings = dict(followers=3, steps=50, realizations=10000)
        reference = live_platoon.reference(self.folder, **settings)
        for hosting, node in (("processes", "/platoon/channel"), ("one_process", "/platoon/platoon")):
            with self.subTest(hosting=hosting):
                output, bag, from_bag = (self.path(hosting + suffix) for suffix in ("", ".bag", "-from-bag"))
                terminal = self.launch(record=bag, hosting=hosting, rate=400, batch=500, output=output, **settings)
                self.limit(terminal, node, 1000000)  # less than a batch, as each attempt begins a new file
                terminal.wait_for_text("run stalled: recorder blocks the run: " + bag)
                time.sleep(4.0)  # retries fail as well
                self.limit(terminal, node, resource.RLIM_INFINITY)
                self.completed(terminal, output)
                text = terminal.text()
                self.assertEqual(text.count("The platoon waits, and continues when there is space"), 1, text)
                self.assertIn("MB are free there", text)
                self.assertIn(bag + ": is recorded again", text)
                self.assertEqual(live_platoon.statistics(output), reference)
                self.assertEqual(live_platoon.tool("bag_statistics", bag, output=from_bag).returncode, 0)
                self.assertEqual(live_platoon.statistics(from_bag), reference)


if __name__ == "__main__":
    unittest.main()
