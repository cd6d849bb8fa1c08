#!/usr/bin/python3
"""Use from the terminal: roslaunch with invalid arguments, several launches at once, live.launch, a vehicle that blocks the run."""

import os
import subprocess
import unittest

import rosbag

import live_platoon
from terminal import LaunchTest


class BadInput(LaunchTest):
    def rejected(self, *said, **arguments):
        """Checks that the launch ends with all these words, before any node starts and without writing to the output."""
        terminal = self.launch(**arguments)
        self.assertNotEqual(terminal.wait(), 0)
        text = terminal.text()
        for words in said:
            self.assertIn(words, text)
        self.assertNotIn("process[", text)
        return text

    def test_arguments_out_of_range_are_named_all_at_once(self):
        self.rejected("followers: 0: must be a whole number from 1", "time_headway: -1: must be a finite number > 0",
                     "noise_variance: nan: must be a finite number >= 0", "steps: ten: must be a whole number from 0",
                     "hosting: cloud: must be processes or one_process", followers=0, headway=-1, noise_variance="nan",
                     steps="ten", hosting="cloud")
        self.assertFalse(os.path.exists(self.output))

    def test_a_model_file_that_is_missing_is_named(self):
        self.rejected("model: /nowhere/model.yaml: no such file: must be a model file, or one of the shipped acc.yaml", model="/nowhere/model.yaml")

    def test_an_argument_that_a_launch_file_needs_is_named(self):
        self.rejected("bag: missing: must be a recording to replay", file="replay.launch")
        self.rejected("bag: missing: must be a recording to replay", file="replay.launch", drive="leader")
        self.rejected("arg 'first' is not defined", file="followers.launch", output=None)

    def test_vehicles_that_a_launch_cannot_start_are_named_once(self):
        text = self.rejected("first: abc: must be a whole number from 1", "last: 0x10: must be a whole number from 1", file="followers.launch",
                             output=None, first="abc", last="0x10")
        self.assertEqual(text.count("abc: must be"), 1)
        self.assertNotIn("invalid literal", text)
        for external in ("2, 3", "2;3", "02"):
            self.rejected("external: {}: must be numbers of followers from 1 to 1000000, each once, separated by commas".format(external),
                          file="followers.launch", output=None, first=1, last=3, external=external)
        self.rejected("last: 3: must be a whole number from 4 to 1000000", file="followers.launch", output=None, first=4, last=3)
        self.rejected("first: 0: must be a whole number from 1 to 1000000", file="followers.launch", output=None, first=0, last=3)
        for hosting in ("processes", "one_process"):
            self.rejected("last: 1e1: must be written 10, in digits alone", followers="1e1", hosting=hosting)
        self.rejected("first: 02: must be written 2, in digits alone", "last: 3e0: must be written 3, in digits alone", file="followers.launch",
                      output=None, first="02", last="3e0")
        self.rejected("last: 3: must be a whole number from 4 to 20", first=5, last=3)
        self.rejected("first: abc: must be a whole number from 1 to 21", "last: 30: must be a whole number from 0 to 20", first="abc", last=30)

    def test_a_replay_of_a_vehicle_that_is_not_recorded_is_rejected(self):
        small = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data", "small.bag")
        for drive in ("vehicle_33", "vehicle_0", "vehicle_x", "follower"):
            self.rejected("drive: {}: must be leader, or one of vehicle_1 to vehicle_2, the recorded followers".format(drive),
                          file="replay.launch", bag=small, drive=drive, unverified=True)

    def test_a_replay_as_recorded_rejects_what_would_change_the_run(self):
        small = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data", "small.bag")
        for drive in ("", "vehicle_1"):
            self.rejected("followers: given: must be with drive:=leader", "headway: given: must be with drive:=leader",
                          "seed: given: must be with drive:=leader", file="replay.launch", bag=small, unverified=True, drive=drive,
                          headway=2.4, followers=5, seed=9)

    def test_an_argument_of_a_replay_without_effect_is_named(self):
        small = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data", "small.bag")
        self.rejected("rate: -1: must be a finite number >= 0", "patience: given: must be with drive:=vehicle_N", file="replay.launch", bag=small,
                      rate=-1, patience=5)
        self.rejected("start: given: must be without drive:=leader", "pause: given: must be without drive:=leader", file="replay.launch",
                      bag=small, drive="leader", start=5, pause=True)
        self.rejected(*("{}: given: must be without drive:=vehicle_1".format(name) for name in ("rate", "start", "dashboard", "stay", "output")),
                      "external: 2: must be 1, the replayed vehicle, or empty", file="replay.launch", bag=small, drive="vehicle_1", rate=2,
                      start=5, dashboard=True, stay=True, external=2)

    def test_a_port_that_a_page_cannot_have_is_rejected(self):
        for port in (99999, -1, "http"):
            self.rejected("dashboard_port: {}: must be a whole number from 0 to 65535".format(port), dashboard=True, dashboard_port=port)

    def test_a_part_of_the_string_in_one_process_is_rejected(self):
        self.rejected("first, last: 1, 2: must be 1 and 4 with hosting:=one_process, which runs all vehicles", hosting="one_process",
                      followers=4, last=2)

    def test_unknown_and_missing_keys_are_named(self):
        model = self.model_with(time_headwya=3.2, time_headway=None)
        self.rejected("time_headwya: unknown key", "time_headway: missing", model=model)

    def test_a_loop_that_cannot_track_a_ramp_is_rejected(self):
        model = self.model_with(plant="{numerator: [1.0], denominator: [1.0, -1.0]}")
        self.rejected("no double integral action", model=model)

    def test_a_closed_loop_that_is_not_strictly_proper_is_rejected(self):
        model = self.model_with(plant="{numerator: [1.0, 0, 0, 0], denominator: [1.0, -2.0, 1.0]}")
        self.rejected("T must be strictly proper", model=model)

    def test_an_unstable_loop_is_rejected_unless_allow_unstable_is_given(self):
        unstable = "{numerator: [9.0], denominator: [1.0, -2.0, 1.0]}"
        self.rejected("the closed loop is unstable: rho(A) =", "allow_unstable: true", model=self.model_with(plant=unstable))
        model = self.model_with(plant=unstable, allow_unstable="true")
        self.run_to_the_end(model=model, followers=2, steps=10, realizations=100)

    def test_a_folder_that_cannot_be_written_is_named(self):
        occupied = self.write("file", "")
        self.rejected("output: " + occupied + "/run", "must be a folder that can be written", output=occupied + "/run")

    def test_results_are_not_written_over(self):
        self.launch(followers=1, steps=5, realizations=100).wait()
        before = live_platoon.statistics(self.output)
        self.rejected("holds a run of 100 realizations: must be another folder (or resume:=true", followers=1, steps=5,
                     realizations=200)
        self.assertEqual(live_platoon.statistics(self.output), before)

    def test_a_folder_and_a_namespace_in_use_are_rejected_and_other_ones_run_side_by_side(self):
        master, second = self.roscore(), self.path("second")
        settings = dict(followers=2, steps=10, realizations=2000)
        first = self.launch(master=master, batch=10, rate=500, **settings)
        with live_platoon.held("/platoon/vehicle_2", master):  # the first run does not end before the others are checked
            self.assertRegex(self.rejected("output", master=master, ns="platoon2"),
                             r"output: {}: is in use by launch \S+; it is free .*when process \d+ ends".format(self.output))
            for file, arguments in (("platoon.launch", dict(hosting="one_process")), ("live.launch", dict(rviz="false"))):
                self.rejected("ns: platoon: a platoon runs in it already (node /platoon/", ", results in " + self.output + ")",
                             file=file, master=master, output=second, **arguments)
            beside = self.launch(master=master, ns="left/platoon2", output=second, headway=2.4, **settings)
        for terminal, output, headway in ((beside, second, 2.4), (first, self.output, 3.2)):
            self.assertEqual(terminal.wait(), 0)
            self.assertNotIn("has died", terminal.text())
            self.assert_bits(output, headway=headway, **settings)
        self.assertLessEqual(live_platoon.completed_summary(second)["attempts"], live_platoon.UNDISTURBED)

    def test_a_checkpoint_of_another_configuration_is_rejected_with_what_differs(self):
        self.launch(followers=1, steps=5, realizations=100).wait()
        before = live_platoon.statistics(self.output)
        self.rejected("holds a run of another configuration", "seed is 1 there and 2 here", followers=1, steps=5,
                     realizations=200, seed=2, resume="true")
        self.assertEqual(live_platoon.statistics(self.output), before)


class Arguments(LaunchTest):
    def test_a_misspelt_one_is_rejected_before_any_node_starts(self):
        for file, argument, words in (("platoon.launch", dict(headways=2.4), "headways: unknown argument of platoon.launch: did you mean headway?"),
                                      ("live.launch", dict(rates=20), "rates: unknown argument of live.launch: did you mean rate?"),
                                      ("followers.launch", dict(first=1, last=2, externl=2, output=None),
                                       "externl: unknown argument of followers.launch: did you mean external?")):
            terminal = self.launch(file, **argument)
            terminal.wait_for_text(words)
            terminal.wait()
            self.assertNotIn("process[", terminal.text())
            self.assertFalse(os.path.exists(self.output))


class Process(LaunchTest):
    """Process 1 of a container."""

    INSIDE = ("unshare", "--user", "--map-root-user", "--pid", "--fork", "--mount-proc", "--kill-child")

    def setUp(self):
        super().setUp()
        if subprocess.run(self.INSIDE + ("true",), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0:
            self.skipTest("namespaces are not allowed here")

    def test_a_program_that_launches_by_the_api_runs_to_its_end(self):
        program = self.write("program.py", "from roslaunch.parent import ROSLaunchParent\n"
                             "import sys\n"
                             "launch = ROSLaunchParent('of_a_test', [(sys.argv[2], sys.argv[3:])], port=int(sys.argv[1]))\n"
                             "launch.start()\n"
                             "launch.spin()\n")
        port = live_platoon.free_port()
        ended = subprocess.run(self.INSIDE + ("/usr/bin/python3", program, str(port), live_platoon.shared("launch", "platoon.launch"), "followers:=2", "steps:=5",
                                              "realizations:=10", "output:=" + self.output),
                               env=live_platoon.ros_environment("http://localhost:{}".format(port), ROS_HOME=self.folder),
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=live_platoon.DEADLINE)
        self.assertTrue(live_platoon.completed_summary(self.output), ended.stdout)

    def test_a_launch_that_is_process_1_runs_to_its_end(self):
        """As in a container whose entry point is roslaunch."""
        terminal = self.launch(own_master=True, inside=self.INSIDE, followers=2, steps=5, realizations=10)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(self.output), terminal.text())
        self.assertRegex(terminal.text(), "(?m)^{}: .*complete, undamaged".format(self.output))


class Live(LaunchTest):
    def test_live_launch_shows_the_platoon(self):
        terminal = self.launch("live.launch", followers=3, rviz="false")
        live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/monitor", terminal.master), "the monitor")
        environment = live_platoon.ros_environment(terminal.master)
        self.background(live_platoon.executable("markers"), "__ns:=platoon", env=environment)
        bag = self.path("markers.bag")
        subprocess.run([live_platoon.system_executable("rosbag", "record"), "-O", bag, "-l", "20", "/platoon/markers"],
                       env=environment, check=True, stdout=subprocess.DEVNULL, timeout=live_platoon.DEADLINE)
        with rosbag.Bag(bag) as recorded:
            received = [message.markers for _, message, _ in recorded.read_messages()]
        last = received[-1]
        emptied = [markers for markers in received if [marker.action for marker in markers] == [3]]
        self.assertEqual(len(emptied), 1, "RViz deletes all markers of an earlier run")
        shown = {marker.ns: marker for marker in last}
        bodies = [point.x for point in shown["bodies"].points]
        self.assertEqual((len(bodies), bodies[0] + 0.5 * shown["bodies"].scale.x), (4, 0.0), "the front of the leader is at its position")
        self.assertEqual(bodies, sorted(bodies, reverse=True))
        self.assertEqual(len(shown["wheels"].points), 16)
        labels = [marker.text for marker in last if marker.ns == "labels"]
        self.assertEqual((len(labels), labels[0]), (4, "leader"))
        bands = [marker.points for marker in last if marker.ns == "two_sigma"]
        self.assertEqual(len(bands), 3)
        # Four standard deviations: stationary_variance of the paper's first follower at h = 3.2.
        self.assertAlmostEqual(bands[0][1].x - bands[0][0].x, 4.0 * 1.361445058056042 ** 0.5, 6)


class Culprit(LaunchTest):
    def test_the_vehicle_that_holds_the_platoon_up_is_named(self):
        settings = dict(followers=3, steps=10, realizations=200)
        terminal = self.launch(batch=1, rate=500, stall_timeout=0.4, **settings)
        terminal.wait_for_text("/200")
        with live_platoon.held("/platoon/vehicle_2", terminal.master):
            terminal.wait_for_text("run stalled: vehicle_2 has sent nothing")
        self.completed(terminal)
        self.assert_bits(**settings)


if __name__ == "__main__":
    unittest.main()
