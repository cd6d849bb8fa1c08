#!/usr/bin/python3
"""A run that is interrupted, finished or killed goes on with resume:=true; the averages of an endless run outlive kills."""

import glob
import itertools
import signal
import subprocess
import time
import unittest

from stochastic_platoon.msg import Overview

import live_platoon
from orders import Orders, setUpModule  # noqa: F401: unittest calls setUpModule
from terminal import LaunchTest


class StopAndResume(LaunchTest):
    SETTINGS = dict(followers=3, steps=10, batch=8)

    def test_a_stopped_run_goes_on_and_gives_the_same_bits(self):
        terminal = self.launch(realizations=2000, rate=500, **self.SETTINGS)
        live_platoon.wait_for(lambda: glob.glob(self.output + "/checkpoint.cbor"), "a checkpoint")
        terminal.interrupt()
        self.assertIn("To continue, launch again with output:={} resume:=true".format(self.output), terminal.text())
        stopped = live_platoon.summary_of(self.output)
        self.assertFalse(stopped["complete"])
        self.assertGreater(stopped["realizations"], 0)
        self.assertLess(stopped["realizations"], 2000)
        # With another batch size: the statistics depend on the realizations only.
        settings = dict(self.SETTINGS, batch=100)
        summary = self.completed(self.launch(realizations=2000, resume="true", **settings))
        self.assertEqual(summary["realizations"], 2000)
        self.assertEqual(summary["positions_lost"], 0)
        self.assert_bits(followers=3, steps=10, realizations=2000)

    def test_realizations_are_added_to_a_finished_run(self):
        self.run_to_the_end(realizations=100, **self.SETTINGS)
        self.run_to_the_end(realizations=300, resume="true", **self.SETTINGS)
        self.assert_bits(followers=3, steps=10, realizations=300)

    def test_resuming_a_finished_run_changes_nothing(self):
        self.run_to_the_end(realizations=100, **self.SETTINGS)
        before = live_platoon.statistics(self.output)
        self.run_to_the_end(realizations=100, resume="true", **self.SETTINGS)
        self.assertEqual(live_platoon.statistics(self.output), before)

    def test_a_monitor_that_is_started_after_the_end_and_stopped_at_once_leaves_the_run_complete(self):
        """As roslaunch does with one that was killed just after it had written its results."""
        self.run_to_the_end(realizations=100, **self.SETTINGS)
        before, ends = live_platoon.statistics(self.output), []
        for delay in itertools.chain(range(30, 120, 6), range(150, 3000, 150)):  # ms; the first tick follows the first answers of the master
            if delay >= 150 and any("Results: " in text for text in ends):
                break
            monitor = subprocess.Popen([live_platoon.executable("monitor"), "__ns:=platoon", "__name:=monitor"], stdout=subprocess.PIPE,
                                       stderr=subprocess.STDOUT, text=True)
            time.sleep(0.001 * delay)
            monitor.send_signal(signal.SIGINT)
            ends.append(monitor.communicate(timeout=30)[0])
            self.assertTrue(live_platoon.summary_of(self.output)["complete"], ends[-1])
            self.assertNotIn("To continue", ends[-1])
        self.assertTrue(any("Results: " in text for text in ends))
        self.assertEqual(live_platoon.statistics(self.output), before)


class Endless(Orders):
    def steps_of_another(self, steps, attempt=0):
        """The number of an attempt newer than `attempt`, after so many of its steps."""
        return self.overview.newest(lambda message: message.attempt > attempt and message.step[-1] > steps, "an attempt after {}".format(attempt)).attempt

    def setUp(self):
        super().setUp()
        self.overview = self.listen("overview", Overview)

    def test_averages_go_on_over_a_kill_and_a_resumed_run(self):
        terminal = self.launch(followers=3, steps=0, rate=1000, burn_in=50, stall_timeout=0.5)

        def counted():
            summary = live_platoon.summary_of(self.output)
            rows = [line.split(",") for line in live_platoon.statistics(self.output).decode().splitlines()[1:]]
            return summary["attempts"], [int(row[2]) for row in rows], [int(row[1]) for row in rows]

        attempt = self.steps_of_another(1000)
        for victim in ("vehicle_2", "monitor", "vehicle_0"):
            live_platoon.kill("/platoon/" + victim)
            attempt = self.steps_of_another(1000, attempt)
        terminal.interrupt()
        attempts, counts, last_steps = counted()
        self.assertGreater(attempts, 3)
        for count, last_step in zip(counts, last_steps):
            self.assertGreater(count, last_step + 1 - 50 + 1000, "nothing of what was before the last kill")
        terminal = self.launch(followers=3, steps=0, rate=1000, burn_in=50, resume="true")
        self.steps_of_another(1000, attempts)
        terminal.interrupt()
        attempts_after, counts_after, _ = counted()
        self.assertGreater(attempts_after, attempts, "the noise of an earlier attempt was used once more")
        for before, after in zip(counts, counts_after):
            self.assertGreater(after, before + 200)

    def test_time_averages_are_labelled_and_approach_the_stationary_variance(self):
        terminal = self.launch(followers=2, steps=0, burn_in=50)
        self.steps_of_another(30000)
        terminal.interrupt()
        summary = live_platoon.summary_of(self.output)
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


if __name__ == "__main__":
    unittest.main()
