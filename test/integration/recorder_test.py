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
    SETTINGS = dict(followers=3, steps=20, realizations=20000, batch=1000, rate=120, stall_timeout=0.5)

    def test_kill_9_of_the_recorder_costs_no_message(self):
        launches = {split: self.launch(own_master=True, output=self.path("run{}".format(split)), record=self.path("run{}.bag".format(split)),
                                       record_split_mb=split, **self.SETTINGS) for split in (0, 1)}
        for terminal in launches.values():
            terminal.wait_for_text("/20000 realizations")
            live_platoon.kill("/platoon/channel", terminal.master)
        for split, terminal in launches.items():
            with self.subTest(split_mb=split):
                output = self.path("run{}".format(split))
                self.assertGreater(self.completed(terminal, output)["attempts"], 1)
                names = [name for name in sorted(os.listdir(self.folder)) if name.startswith("run{}".format(split))]
                self.assertFalse([name for name in names if ".active" in name or ".recovered" in name], names)
                bags = [self.path(name) for name in names if name.endswith(".bag")]
                bags.sort(key=lambda name: (len(name), name))
                if split == 0:
                    self.assert_whole(output + ".bag", 3, 20, 20)
                self.assertEqual(self.csv_of(*bags), live_platoon.statistics(output))

    def test_kill_9_of_a_follower_leaves_nothing_of_the_attempt_it_ended(self):
        terminal = self.launch(record=self.bag, **self.SETTINGS)
        terminal.wait_for_text("/20000 realizations")
        live_platoon.kill("/platoon/vehicle_2", terminal.master)
        self.assertGreater(self.completed(terminal)["attempts"], 1)
        self.assert_whole(self.bag, 3, 20, 20)
        self.assertEqual(self.csv_of(self.bag), live_platoon.statistics(self.output))
        replayed = self.path("replayed")
        text = self.replayed(self.bag, output=replayed)  # of two attempts, of which the monitor takes the second one where the first ends
        self.assertNotIn("out of turn", text)
        self.assertEqual(live_platoon.statistics(replayed), live_platoon.statistics(self.output))

    def test_kill_9_of_recorder_and_monitor_at_once_costs_no_message(self):
        terminal = self.launch(record=self.bag, hosting="one_process", **self.SETTINGS)
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

    def test_a_later_part_of_another_recording_is_not_touched(self):
        for name in ("run_1.bag", "run_17.bag.active", "run_2.bag.active.3"):
            self.write(name, "precious")
            terminal = self.launch(record=self.bag, record_split_mb=1)
            self.assertNotEqual(terminal.wait(), 0)
            self.assertIn(name + ": exists: must be a new file", terminal.text())
            with open(self.path(name)) as file:
                self.assertEqual(file.read(), "precious")
            os.remove(self.path(name))


class FullDisk(BagTest):
    """A limit on the size of a node's files simulates a full disk, and can be lifted."""

    def limit(self, terminal, node, size):
        process = live_platoon.wait_for(lambda: live_platoon.process_of(node, terminal.master), node)
        resource.prlimit(process, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    def test_the_recorder_waits_for_room_and_goes_on(self):
        settings = dict(followers=3, steps=50, realizations=10000)
        reference = live_platoon.reference(self.folder, **settings)
        launches = {}
        for hosting, node in (("processes", "/platoon/channel"), ("one_process", "/platoon/platoon")):
            launches[hosting, node] = self.launch(own_master=True, output=self.path(hosting), record=self.path(hosting + ".bag"), hosting=hosting,
                                                  rate=400, batch=500, stall_timeout=0.5, **settings)
            self.limit(launches[hosting, node], node, 1000000)  # less than a batch, as each attempt begins a new file
        for (hosting, _), terminal in launches.items():
            terminal.wait_for_text("run stalled: recorder blocks the run: " + self.path(hosting + ".bag"))
        time.sleep(2.0)  # retries fail as well
        for (hosting, node), terminal in launches.items():
            with self.subTest(hosting=hosting):
                output, bag, from_bag = (self.path(hosting + suffix) for suffix in ("", ".bag", "-from-bag"))
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
