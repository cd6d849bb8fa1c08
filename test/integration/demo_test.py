#!/usr/bin/python3
"""launch/demo as users run it: on a terminal, redirected to a file, and when it fails."""

import json
import os
import pty
import re
import signal
import subprocess
import unittest
import urllib.request

import live_platoon
from folder import FolderTest

DEMO = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "launch", "demo")


class Demo(FolderTest):
    def setUp(self):
        super().setUp()
        self.results = self.path("demo")

    def test_live_on_a_machine_without_a_screen_prints_the_pages_address_and_the_page_moves(self):
        environment = self.environment(0)
        for name in ("DISPLAY", "WAYLAND_DISPLAY"):
            environment.pop(name, None)
        log = self.path("printed")
        with open(log, "w") as written:
            process = subprocess.Popen([DEMO, "live", "followers:=3", "rate:=200"], env=environment, stdout=written,
                                       stderr=subprocess.STDOUT)

        def said(words):
            with open(log, errors="replace") as file:
                return re.search(words, file.read())

        def step():
            try:
                with urllib.request.urlopen(url + "/state.json", timeout=10) as answer:
                    return json.load(answer)["step"] or 0
            except OSError:
                return 0
        try:
            live_platoon.wait_for(lambda: said("Dashboard: http") or process.poll() is not None, "the page's address")
            if process.poll() is not None:
                self.fail(said("(?s).*").group(0))
            url = said("Dashboard: (http://localhost:[0-9]+)").group(1)
            first = live_platoon.wait_for(step, "the first figures")
            live_platoon.wait_for(lambda: step() > first, "the next figures")
        finally:
            process.send_signal(signal.SIGINT)
            process.wait()

    def environment(self, realizations):
        return dict(os.environ, HOME=self.folder, ROS_HOME=self.folder, REALIZATIONS=str(realizations))

    def run_demo(self, realizations):
        return subprocess.run([DEMO, self.results], env=self.environment(realizations), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, errors="replace")

    def run_demo_on_a_terminal(self, realizations):
        """Exit status and output on the terminal."""
        ours, theirs = pty.openpty()
        process = subprocess.Popen([DEMO, self.results], env=self.environment(realizations), stdout=theirs, stderr=theirs,
                                   stdin=theirs)
        os.close(theirs)
        printed = b""
        try:
            while True:
                printed += os.read(ours, 4096)
        except OSError:  # the terminal's other end is closed
            os.close(ours)
        return process.wait(), printed.decode(errors="replace")

    def check_screen(self, text):
        for headway in ("3.2", "2.4"):
            self.assertIn("roslaunch's own output: {}/headway-{}.log".format(self.results, headway), text)
            self.assertIn("Platoon of 20 followers, h = {:g} s ({} sample periods)".format(0.1 * float(headway), headway), text)
            self.assertTrue(os.path.exists("{}/headway-{}.log".format(self.results, headway)))
        self.assertEqual(len(re.findall(r"^ +20 ", text, re.MULTILINE)), 2)
        self.assertIn("h = 3.2: string stable", text)
        self.assertIn("h = 2.4: NOT string stable", text)
        self.assertIn("100 %", text)
        self.assertTrue(os.path.exists(self.results + "/errors.png"))
        self.assertIn(self.results + "/errors.png", text)
        for noise in ("process[", "SUMMARY", "REQUIRED", "killing on exit"):
            self.assertNotIn(noise, text)

    def test_prints_progress_a_table_per_headway_and_the_verdicts(self):
        done = self.run_demo(2000)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.check_screen(done.stdout)

    def test_keeps_the_progress_on_one_line_of_a_terminal(self):
        status, text = self.run_demo_on_a_terminal(50000)
        self.assertEqual(status, 0, text)
        self.check_screen(text)
        progress = [line for line in text.split("\n") if " realizations  " in line]
        self.assertEqual(len(progress), 2)
        self.assertGreater(progress[0].count("\r["), 2)

    def test_shows_the_whole_log_of_a_run_that_fails(self):
        done = self.run_demo(0)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("realizations: 0: must be", done.stdout)
        self.assertIn("run incomplete", done.stdout)
        self.assertNotIn("h = 2.4", done.stdout)


if __name__ == "__main__":
    unittest.main()
