#!/usr/bin/python3
"""The program of the simulated world prints what depends on its two numbers alone."""

import os
import subprocess
import unittest

import live_platoon

SIMULATE = os.path.join(os.environ.get("PLATOON_TEST_PROGRAMS", live_platoon.shared("build", "test", "programs")), "simulate")


class Output(unittest.TestCase):
    def printed(self, faults, seed, *inside):
        done = subprocess.run([*inside, SIMULATE, str(faults), str(seed)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                              timeout=live_platoon.DEADLINE * live_platoon.PATIENCE)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_is_the_same_on_one_core_and_depends_on_the_seed(self):
        one_core = ("taskset", "--cpu-list", str(min(os.sched_getaffinity(0))))
        text = self.printed(400, 7)
        self.assertEqual(self.printed(400, 7, *one_core), text)
        digest, counted = text.splitlines()
        self.assertRegex(digest, "^digest of the histories: [0-9a-f]{16}$")
        self.assertRegex(counted, r"^400 faults in \d+ runs: 0 wrong, 0 hung$")
        self.assertNotIn(digest, self.printed(400, 8))

    def test_rejects_what_is_no_number(self):
        for words, said in ((("ten", "1"), "FAULTS: ten: must be a whole number from 1 to"), (("0", "1"), "FAULTS: 0: must be"),
                            (("10", "-1", "x"), "2 errors:\n  SEED: -1: must be"), (("10",), "usage: simulate FAULTS SEED")):
            done = subprocess.run([SIMULATE, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("simulate: " + said, done.stderr)


if __name__ == "__main__":
    unittest.main()
