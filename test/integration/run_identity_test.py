#!/usr/bin/python3
"""Followers that outlive a launch take part in the next one under its configuration, or not at all."""

import json
import subprocess
import unittest
import xmlrpc.client

import live_platoon
from terminal import LaunchTest

FIRST = dict(headway=3.2, seed=1, steps=20, realizations=600, batch=50)


class KeptFollowers(LaunchTest):
    def begin(self, master, number, **settings):
        """Starts a launch on a kept master with vehicles 0 to 2."""
        return self.launch(master=master, output=self.path("run{}".format(number)), followers=4, first=1, last=2, **settings)

    def end(self, terminal, number, **settings):
        output = self.path("run{}".format(number))
        summary = self.completed(terminal, output)
        self.assertEqual(summary["positions_lost"], 0)
        self.assert_bits(output, followers=4, **{name: value for name, value in settings.items() if name != "batch"})
        return summary

    def test_started_before_any_launch_they_serve_launches_in_a_row_each_to_the_bit(self):
        kept = self.launch("followers.launch", own_master=True, output=None, first=3, last=4)
        kept.wait_for_text("process[platoon/vehicle_4")
        for number, change in enumerate([{}, {"headway": 3.3}, {"seed": 2}, {"steps": 31, "batch": 7}]):
            settings = dict(FIRST, **change)
            summary = self.end(self.begin(kept.master, number, **settings), number, **settings)
            # Attempts start from the beginning and the first ones succeed: the attempts of an earlier run have no effect.
            self.assertLessEqual(summary["attempts"], 3)

    def test_started_behind_the_first_launch_they_serve_the_next(self):
        master = self.roscore()
        first = self.begin(master, 0, **FIRST)
        first.wait_for_text("process[platoon/monitor")
        self.launch("followers.launch", output=None, master=master, first=3, last=4)
        self.end(first, 0, **FIRST)
        changed = dict(FIRST, headway=2.4, seed=5)
        summary = self.end(self.begin(master, 1, **changed), 1, **changed)
        self.assertLessEqual(summary["attempts"], 3)

    def test_vehicles_that_start_over_within_a_standing_launch(self):
        """All nodes stay up and only the configuration changes: all of them restart with it."""
        output, again = self.path("run0"), self.path("run1")
        terminal = self.launch(output=output, followers=3, stay=True, **FIRST)
        live_platoon.wait_for(lambda: live_platoon.completed_summary(output), "the first run to complete")
        changed = dict(FIRST, headway=2.4, seed=7)
        text = live_platoon.tool("configure", model=live_platoon.shared("config", "paper.yaml"), output=again, followers=3, **changed).stdout
        with xmlrpc.client.ServerProxy(terminal.master) as master:
            master.setParam("/test", "/platoon/configuration", text)
        # One restarted node reads the new configuration; its messages spread the new run to all others.
        live_platoon.kill("/platoon/monitor", terminal.master)
        live_platoon.wait_for(lambda: live_platoon.completed_summary(again), "the second run to complete")
        self.assert_bits(again, followers=3, **{name: value for name, value in changed.items() if name != "batch"})


class Rejected(LaunchTest):
    def follower(self, master, index, *arguments):
        process = self.background(live_platoon.executable("follower"), "__name:=vehicle_3", "__ns:=platoon", "_index:={}".format(index),
                                  *arguments, env=live_platoon.ros_environment(master), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                  universal_newlines=True)
        self.addCleanup(process.stderr.close)
        return process

    def launch_two_of_three(self):
        terminal = self.launch(followers=3, first=1, last=2, stall_timeout=0.5, **FIRST)
        terminal.wait_for_text("process[platoon/monitor")
        return terminal

    def test_a_vehicle_of_another_version_is_named_with_its_reason(self):
        terminal = self.launch_two_of_three()
        with xmlrpc.client.ServerProxy(terminal.master) as master:
            configuration = json.loads(master.getParam("/test", "/platoon/configuration")[2])
            configuration["version"] = "9.9.9"
            master.setParam("/test", "/platoon/of_another_version", json.dumps(configuration))
        self.follower(terminal.master, 3, "configuration:=of_another_version")
        terminal.wait_for_text("run stalled: vehicle_3 has sent nothing at all; it reports: version: 9.9.9: must be ")

    def test_a_vehicle_beyond_the_string_says_so_and_waits(self):
        terminal = self.launch_two_of_three()
        process = self.follower(terminal.master, 30)
        self.assertIn("~index: 30: must be a whole number from 1 to 3, the number of followers of the present run: waiting",
                      process.stderr.readline())
        terminal.wait_for_text("run stalled: vehicle_3 is not running: no publisher of /platoon/vehicle_3/position")
        self.assertIsNone(process.poll())


if __name__ == "__main__":
    unittest.main()
