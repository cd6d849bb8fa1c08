"""An external vehicle beside a launch, and its conformance test check_vehicle."""

import csv
import os
import re
import subprocess

import live_platoon
from terminal import LaunchTest, kept_master

HERE = os.path.dirname(os.path.abspath(__file__))
CLAUSES = ("one_publisher", "answer", "size", "finite", "stamp", "turn", "attempt", "start_anew", "causal", "queues", "run",
           "spacing")


def rows(output):
    """statistics.csv as {(vehicle, step): [mean, variance, theoretical mean, theoretical variance]}; empty cells are None."""
    with open(os.path.join(output, "statistics.csv")) as file:
        return {(int(row["vehicle"]), int(row["step"])):
                [float(row[name]) if row[name] else None
                 for name in ("mean", "variance", "theoretical_mean", "theoretical_variance")] for row in csv.DictReader(file)}


class ExternalTest(LaunchTest):
    def setUp(self):
        super().setUp()
        self.environment = live_platoon.ros_environment(kept_master(), ROS_HOME=self.folder)

    def start(self, *command):
        """Starts an external vehicle."""
        return self.background(*command, env=self.environment)

    def start_example(self, index):
        return self.start(live_platoon.shared("launch", "examples", "rospy_follower.py"), str(index))

    def check_vehicle(self, index, *options):
        return subprocess.run([live_platoon.executable("check_vehicle"), str(index)] + list(options), env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=live_platoon.DEADLINE)

    def assert_keeps_the_contract(self, index, *options):
        done = self.check_vehicle(index, *options)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(re.findall(r"^ ?(\d+) holds ", done.stdout, re.M), [str(n + 1) for n in range(len(CLAUSES))])
        self.assertIn("vehicle_{} keeps the vehicle contract".format(index), done.stdout)

    def assert_broken(self, clause, index, *options):
        number = CLAUSES.index(clause) + 1
        done = self.check_vehicle(index, "--patience", "1", *options)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertEqual(re.findall(r"^ ?(\d+) BROKEN ", done.stdout, re.M), [str(number)], done.stdout)
        self.assertIn("breaks clause {} of the vehicle contract: ".format(number), done.stdout)
        return done.stdout
