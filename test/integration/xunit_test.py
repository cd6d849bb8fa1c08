#!/usr/bin/python3
"""test/xunit.py, which runs each program test: its JUnit file; and test/contained.py: no process outlives a test, whatever its end."""

import os
import signal
import subprocess
import sys
import unittest
import xml.etree.ElementTree

import live_platoon
from folder import FolderTest
from processes import processes_with, words_of

HERE = os.path.dirname(os.path.abspath(__file__))
TEST = os.path.dirname(HERE)
XUNIT = os.path.join(TEST, "xunit.py")
# A test that starts a master, and a process in a session of its own.
LAUNCHING = """
import subprocess, sys, tempfile, time
sys.path.insert(0, sys.argv[1])
import terminal
other = subprocess.Popen(["sleep", "1000"], start_new_session=True)
terminal.start_master(tempfile.gettempdir(), lambda end: None)
print("both run", flush=True)
time.sleep(1000)
"""


class Xunit(FolderTest):
    def setUp(self):
        super().setUp()
        self.result = self.path("result.xml")

    def start(self, *program):
        """Starts xunit.py with a mark in the environment, as a shell starts a command in the foreground."""
        process = self.background(XUNIT, self.result, "name", *program, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                                  env=dict(os.environ, MARK=self.folder, TMPDIR=self.folder), start_new_session=True)
        self.addCleanup(process.stdout.close)
        return process

    def ended(self, *program):
        """Exit status, output and JUnit file of a program."""
        process = self.start(*program)
        printed, _ = process.communicate(timeout=live_platoon.DEADLINE)
        return process.returncode, printed, xml.etree.ElementTree.parse(self.result).getroot()

    def test_status_and_output_are_those_of_the_program(self):
        self.assertEqual(self.ended("sh", "-c", "echo said")[:2], (0, "said\n"))
        status, printed, suite = self.ended("sh", "-c", "echo wrong; exit 3")
        self.assertEqual((status, printed, suite.get("failures"), suite.find("testcase/failure").text), (3, "wrong\n", "1", "wrong\n"))
        status, _, suite = self.ended("sh", "-c", "exit 77")
        self.assertEqual((status, suite.get("skipped"), suite.get("failures")), (0, "1", "0"))

    def test_an_orphan_that_ends_leaves_no_zombie_while_the_test_runs(self):
        status, printed, _ = self.ended("sh", "-c", "orphan=$(sh -c 'sleep 0.2 > /dev/null & echo $!'); while [ -e /proc/$orphan ]; do sleep 0.05; done")
        self.assertEqual((status, printed), (0, ""))

    def test_no_process_outlives_an_interrupted_test(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                process = self.start(sys.executable, "-c", LAUNCHING, HERE)
                self.assertEqual(process.stdout.readline(), "both run\n")
                self.assertGreater(len(processes_with("MARK=" + self.folder)), 4)  # xunit.py, the test, sleep, roscore, rosmaster, rosout
                os.killpg(process.pid, number)
                self.assertEqual(process.wait(timeout=live_platoon.DEADLINE), 130)
                self.assertEqual(processes_with("MARK=" + self.folder), [])


class Contained(FolderTest):
    def start(self, *command):
        environment = {name: value for name, value in os.environ.items() if name != "PLATOON_CONTAINED"}
        return self.background(*command, env=dict(environment, MARK=self.folder, TMPDIR=self.folder), start_new_session=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def running(self):
        return processes_with("MARK=" + self.folder)

    def test_no_process_outlives_a_program_that_ends_or_fails(self):
        for status in (0, 3):
            program = self.start(os.path.join(TEST, "contained.py"), "bash", "-c", "sleep 1000 & setsid sleep 1000 & exit {}".format(status))
            self.assertEqual(program.wait(timeout=live_platoon.DEADLINE), status)
            self.assertEqual(self.running(), [])

    def test_no_node_outlives_a_test_that_is_started_by_hand_and_interrupted(self):
        for number, *command in ((signal.SIGTERM, os.path.join(HERE, "kept_followers_test.py"), "ChangingModels"),
                                 (signal.SIGINT, os.path.join(TEST, "soak"), "1", "3"), (signal.SIGHUP, os.path.join(TEST, "flips"), "10")):
            with self.subTest(signal=number):
                program = self.start(*command)
                live_platoon.wait_for(lambda: any("/roslaunch" in word for process in self.running() for word in words_of(process)), "a launch")
                os.kill(program.pid, number)
                self.assertEqual(program.wait(timeout=live_platoon.DEADLINE), 130)
                self.assertEqual(self.running(), [])

    def test_no_process_outlives_an_interrupted_bash_script(self):
        for script in ("architectures", "benchmark/run", "compilers", "fuzz/run", "run", "sanitize", "tidy"):
            with open(os.path.join(TEST, script)) as file:
                self.assertIn('|| exec "$source_folder/test/contained.py" "$0" "$@"\n', "".join(file.readlines()[:20]), script)


if __name__ == "__main__":
    unittest.main()
