#!/usr/bin/python3
"""Tests of a Ctrl-C or a SIGTERM in the first seconds of `watch`, without a ROS master."""

import os
import signal
import subprocess
import sys
import tempfile
import unittest

WATCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "src", "tools", "watch")

SIGNALLED = "import os, signal\nos.kill(os.getpid(), signal.{})\n"

# Runs watch beside a master that is said to be there, and the signal comes while it registers.
REGISTERING = """
import os, runpy, signal, sys
import rosgraph, rospy.impl.init
start = rospy.impl.init.start_node
def start_node(*given, **named):
    os.kill(os.getpid(), signal.{})
    return start(*given, **named)
rospy.impl.init.start_node = start_node
rosgraph.is_master_online = lambda: True
sys.argv = ["watch"]
runpy.run_path({!r}, run_name="__main__")
"""


class Signals(unittest.TestCase):
    def ends_silently(self, command, number, **more):
        with tempfile.TemporaryDirectory() as home:
            environment = dict(os.environ, ROS_HOME=home, ROS_MASTER_URI="http://localhost:1", ROS_HOSTNAME="localhost", **more)
            run = subprocess.run([sys.executable, *command], stderr=subprocess.PIPE, universal_newlines=True, timeout=60, env=environment)
        self.assertEqual((run.returncode, run.stderr), (-number, ""))

    def test_a_ctrl_c_among_the_imports_prints_no_traceback(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "rosgraph.py"), "w") as file:
                file.write(SIGNALLED.format("SIGINT"))
            self.ends_silently([WATCH], signal.SIGINT, PYTHONPATH=folder + os.pathsep + os.environ.get("PYTHONPATH", ""))

    def test_a_signal_during_the_registration_prints_no_traceback(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number):
                self.ends_silently(["-c", REGISTERING.format(number.name, WATCH)], number)


if __name__ == "__main__":
    unittest.main()
