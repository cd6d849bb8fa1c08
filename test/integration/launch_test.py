#!/usr/bin/python3
"""Use from the terminal: roslaunch with valid and invalid arguments, Ctrl-C, resume."""

import glob
import json
import os
import re
import signal
import subprocess
import time
import unittest

import live_platoon
from terminal import LaunchTest


class BadInput(LaunchTest):
    def refused(self, *said, **arguments):
        """Checks that the launch ends with all these words, before any node starts and without writing to the output."""
        terminal = self.launch(**arguments)
        self.assertNotEqual(terminal.wait(), 0)
        text = terminal.text()
        for words in said:
            self.assertIn(words, text)
        self.assertNotIn("process[", text)
        return text

    def test_arguments_out_of_range_are_named_all_at_once(self):
        self.refused("followers: 0: must be a whole number from 1", "time_headway: -1: must be a finite number > 0",
                     "noise_variance: nan: must be a finite number >= 0", "steps: ten: must be a whole number from 0",
                     "hosting: cloud: must be processes or one_process", followers=0, headway=-1, noise_variance="nan",
                     steps="ten", hosting="cloud")
        self.assertFalse(os.path.exists(self.output))

    def test_a_model_file_that_is_missing_is_named(self):
        self.refused("model: /nowhere/model.yaml: must be a file of at most 256 MB that can be read", model="/nowhere/model.yaml")

    def test_unknown_and_missing_keys_are_named(self):
        model = self.model_with(time_headwya=3.2, time_headway=None)
        self.refused("time_headwya: unknown key", "time_headway: missing", model=model)

    def test_a_loop_that_cannot_track_a_ramp_is_refused(self):
        model = self.model_with(plant="{numerator: [1.0], denominator: [1.0, -1.0]}")
        self.refused("no double integral action", model=model)

    def test_a_closed_loop_that_is_not_strictly_proper_is_refused(self):
        model = self.model_with(plant="{numerator: [1.0, 0, 0, 0], denominator: [1.0, -2.0, 1.0]}")
        self.refused("T must be strictly proper", model=model)

    def test_an_unstable_loop_is_refused_unless_it_is_asked_for(self):
        unstable = "{numerator: [9.0], denominator: [1.0, -2.0, 1.0]}"
        self.refused("the closed loop is unstable: rho(A) =", "allow_unstable: true", model=self.model_with(plant=unstable))
        model = self.model_with(plant=unstable, allow_unstable="true")
        terminal = self.launch(model=model, followers=2, steps=10, realizations=100)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(self.output), terminal.text())

    def test_a_folder_that_cannot_be_written_is_named(self):
        occupied = os.path.join(self.folder, "file")
        with open(occupied, "w"):
            pass
        self.refused("output: " + occupied + "/run", "must be a folder that can be written", output=occupied + "/run")

    def test_results_are_not_written_over(self):
        self.launch(followers=1, steps=5, realizations=100).wait()
        before = live_platoon.statistics(self.output)
        self.refused("holds a run of 100 realizations: must be another folder (or resume:=true", followers=1, steps=5,
                     realizations=200)
        self.assertEqual(live_platoon.statistics(self.output), before)

    def test_a_folder_and_a_namespace_in_use_are_refused_and_other_ones_run_side_by_side(self):
        master = self.roscore()
        settings = dict(followers=2, steps=10, realizations=2000)
        first = self.launch(master=master, batch=10, rate=500, **settings)
        live_platoon.wait_for(lambda: os.path.exists(self.output + "/.lock"), "the first launch to check its folder")
        self.assertRegex(self.refused("output", master=master, ns="platoon2"),
                         r"output: {}: is in use by launch \S+; it is free .*when process \d+ ends".format(self.output))
        held = live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/vehicle_2", master), "a node of the first launch")
        os.kill(held, signal.SIGSTOP)  # the first run must not end before the second launch has checked the folder
        self.addCleanup(live_platoon.let_go_on, held)
        second = os.path.join(self.folder, "second")
        for file, arguments in (("platoon.launch", dict(hosting="one_process")), ("live.launch", dict(rviz="false"))):
            self.refused("ns: platoon: a platoon runs in it already (node /platoon/", ", results in " + self.output + ")",
                         file=file, master=master, output=second, **arguments)
        beside = self.launch(master=master, ns="left/platoon2", output=second, headway=2.4, **settings)
        live_platoon.let_go_on(held)
        for terminal, output, headway in ((beside, second, 2.4), (first, self.output, 3.2)):
            self.assertEqual(terminal.wait(), 0)
            self.assertNotIn("has died", terminal.text())
            self.assertEqual(live_platoon.statistics(output), live_platoon.reference(output, headway=headway, **settings))
        self.assertLessEqual(live_platoon.completed_summary(second)["attempts"], live_platoon.UNDISTURBED)

    def test_a_checkpoint_of_another_configuration_is_refused_with_what_differs(self):
        self.launch(followers=1, steps=5, realizations=100).wait()
        before = live_platoon.statistics(self.output)
        self.refused("holds a run of another configuration", "seed is 1 there and 2 here", followers=1, steps=5,
                     realizations=200, seed=2, resume="true")
        self.assertEqual(live_platoon.statistics(self.output), before)


class StopAndResume(LaunchTest):
    SETTINGS = dict(followers=3, steps=10, batch=8)

    def test_a_stopped_run_goes_on_and_gives_the_same_bits(self):
        terminal = self.launch(realizations=2000, rate=500, **self.SETTINGS)
        live_platoon.wait_for(lambda: glob.glob(self.output + "/checkpoint.cbor"), "a checkpoint")
        terminal.interrupt()
        self.assertIn("resume:=true goes on from there", terminal.text())
        with open(self.output + "/summary.json") as file:
            stopped = json.load(file)
        self.assertFalse(stopped["complete"])
        self.assertGreater(stopped["realizations"], 0)
        self.assertLess(stopped["realizations"], 2000)
        # With another batch size: the statistics depend on the realizations only.
        settings = dict(self.SETTINGS, batch=100)
        self.launch(realizations=2000, resume="true", **settings).wait()
        summary = live_platoon.completed_summary(self.output)
        self.assertEqual(summary["realizations"], 2000)
        self.assertEqual(summary["positions_lost"], 0)
        self.assertEqual(live_platoon.statistics(self.output),
                         live_platoon.reference(self.folder, followers=3, steps=10, realizations=2000))

    def test_realizations_are_added_to_a_finished_run(self):
        self.launch(realizations=100, **self.SETTINGS).wait()
        self.launch(realizations=300, resume="true", **self.SETTINGS).wait()
        self.assertEqual(live_platoon.statistics(self.output),
                         live_platoon.reference(self.folder, followers=3, steps=10, realizations=300))

    def test_resuming_a_finished_run_changes_nothing(self):
        self.launch(realizations=100, **self.SETTINGS).wait()
        before = live_platoon.statistics(self.output)
        self.launch(realizations=100, resume="true", **self.SETTINGS).wait()
        self.assertEqual(live_platoon.statistics(self.output), before)


class Endless(LaunchTest):
    def test_averages_go_on_over_a_kill_and_a_resumed_run(self):
        terminal = self.launch(followers=3, steps=0, rate=1000, burn_in=50, stall_timeout=0.5)
        terminal.wait_for_text("process[platoon/monitor")

        def counted():
            with open(self.output + "/summary.json") as file:
                summary = json.load(file)
            rows = [line.split(",") for line in live_platoon.statistics(self.output).decode().splitlines()[1:]]
            return summary["attempts"], [int(row[2]) for row in rows], [int(row[1]) for row in rows]

        def thousand_steps_of_another(attempt):
            """The number of an attempt newer than `attempt`, after a thousand of its steps."""
            def found():
                # Attempt and step of one message: an old step beside a new attempt would be too early.
                done = subprocess.run(["rostopic", "echo", "-n", "1", "/platoon/overview"], stdout=subprocess.PIPE, timeout=60,
                                      universal_newlines=True, env=dict(os.environ, ROS_MASTER_URI=terminal.master))
                overview = dict(re.findall(r"^(attempt|step): (.*)$", done.stdout, re.M))
                return json.loads(overview["step"])[-1] > 1000 and int(overview["attempt"]) > attempt and int(overview["attempt"])
            return live_platoon.wait_for(found, "a thousand steps of an attempt after {}".format(attempt), 60)

        attempt = thousand_steps_of_another(0)
        for victim in ("vehicle_2", "monitor", "vehicle_0"):
            live_platoon.kill("/platoon/" + victim, terminal.master)
            attempt = thousand_steps_of_another(attempt)
        terminal.interrupt()
        attempts, counts, last_steps = counted()
        self.assertGreater(attempts, 3)
        for count, last_step in zip(counts, last_steps):
            self.assertGreater(count, last_step + 1 - 50 + 1000, "nothing of what was before the last kill")
        terminal = self.launch(followers=3, steps=0, rate=1000, burn_in=50, resume="true")
        terminal.wait_for_text("process[platoon/monitor")
        thousand_steps_of_another(attempts)
        terminal.interrupt()
        attempts_after, counts_after, _ = counted()
        self.assertGreater(attempts_after, attempts, "the noise of an earlier attempt was used once more")
        for before, after in zip(counts, counts_after):
            self.assertGreater(after, before + 200)

    def test_time_averages_are_labelled_and_approach_the_stationary_variance(self):
        terminal = self.launch(followers=2, steps=0, burn_in=50)
        terminal.wait_for_text("process[platoon/monitor")
        time.sleep(4.0)  # the averaging time of this endless run
        terminal.interrupt()
        with open(self.output + "/summary.json") as file:
            summary = json.load(file)
        self.assertTrue(summary["time_average"])
        self.assertLess(summary["agreement"]["max_abs_z_variance"], 5.0)
        self.assertLess(summary["agreement"]["max_abs_z_mean"], 5.0)
        rows = [line.split(",") for line in live_platoon.statistics(self.output).decode().splitlines()[1:]]
        self.assertEqual([row[0] for row in rows], ["1", "2"])
        errors = summary["standard_error_of_variance"]
        for row, stationary, error in zip(rows, summary["theory"]["stationary_variance"], errors):
            step, count, variance, theory = int(row[1]), int(row[2]), float(row[4]), float(row[6])
            self.assertEqual(count, step + 1 - 50)
            self.assertEqual(theory, stationary)
            # The errors' correlation dies out within tens of steps (rho(A) = 0.53).
            self.assertTrue(variance * (2.0 / count) ** 0.5 < error < variance * (2.0 / (count / 50.0)) ** 0.5)
            self.assertLess(abs(variance - theory), 5.0 * error)


class Arguments(LaunchTest):
    def test_a_misspelt_one_is_rejected_before_any_node_starts(self):
        for file, argument, words in (("platoon.launch", dict(headways=2.4), "headways: unknown argument of platoon.launch: did you mean headway?"),
                                      ("live.launch", dict(rates=20), "rates: unknown argument of live.launch: did you mean rate?")):
            terminal = self.launch(file, **argument)
            terminal.wait_for_text(words)
            terminal.wait()
            self.assertNotIn("process[", terminal.text())
            self.assertFalse(os.path.exists(self.output))


class Live(LaunchTest):
    def test_live_launch_shows_the_platoon(self):
        import rosbag
        terminal = self.launch("live.launch", followers=3, rviz="false")
        live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/monitor", terminal.master), "the monitor")
        markers = subprocess.Popen([live_platoon.executable("markers"), "__ns:=platoon"],
                                   env=dict(os.environ, ROS_MASTER_URI=terminal.master, ROS_HOSTNAME="localhost"))
        self.addCleanup(markers.wait)
        self.addCleanup(markers.terminate)
        bag = os.path.join(self.folder, "markers.bag")
        subprocess.run([live_platoon.system_executable("rosbag", "record"), "-O", bag, "-l", "20", "/platoon/markers"],
                       env=dict(os.environ, ROS_MASTER_URI=terminal.master, ROS_HOSTNAME="localhost"), check=True,
                       stdout=subprocess.DEVNULL, timeout=live_platoon.DEADLINE)
        with rosbag.Bag(bag) as recorded:
            last = [message for _, message, _ in recorded.read_messages()][-1].markers
        shown = {marker.ns: marker for marker in last}
        bodies = [point.x for point in shown["bodies"].points]
        self.assertEqual((len(bodies), bodies[0]), (4, 0.0))
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
        terminal = self.launch(followers=3, steps=10, realizations=400, batch=1, rate=500, stall_timeout=0.4)
        terminal.wait_for_text("/400")
        process = live_platoon.process_of("/platoon/vehicle_2", terminal.master)
        os.kill(process, signal.SIGSTOP)
        try:
            terminal.wait_for_text("run stalled: vehicle_2 has sent nothing", 20)
        finally:
            os.kill(process, signal.SIGCONT)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(self.output))
        self.assertEqual(live_platoon.statistics(self.output),
                         live_platoon.reference(self.folder, followers=3, steps=10, realizations=400))


if __name__ == "__main__":
    unittest.main()
