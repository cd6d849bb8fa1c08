#!/usr/bin/python3
"""Shards, their merge and sweeps as programs: killed during the run, on a full disk, and with invalid input."""

import functools
import glob
import json
import os
import signal
import subprocess
import tempfile
import time
import unittest

import live_platoon
from folder import FolderTest

# A shard takes seconds on one thread and writes its first checkpoint early, so that it can be killed before it ends.
REALIZATIONS = 100000 if live_platoon.SANITIZED else 400000
LONG = ["--realizations", str(REALIZATIONS), "--checkpoint-seconds", "0.1", "--batch", "128"]
SWEEP = "vary: {headway: 2.4:4:20}\nfollowers: 10\nsteps: 100\nrealizations: 20000\n"


@functools.lru_cache(maxsize=None)
def reference():
    """statistics.csv of the whole run."""
    with tempfile.TemporaryDirectory() as folder:
        return live_platoon.reference(folder, realizations=str(REALIZATIONS))


class ShardsTest(FolderTest):
    def start(self, tool, *words, before=""):
        process = subprocess.Popen(["bash", "-c", before + 'exec "$@"', "bash", live_platoon.executable(tool)] + list(words),
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        return process

    def run_tool(self, tool, *words, status=0, before=""):
        process = self.start(tool, *words, before=before)
        said, complained = process.communicate(timeout=live_platoon.DEADLINE * live_platoon.PATIENCE)
        self.assertEqual(process.returncode, status, said + complained)
        return said if status == 0 else complained

    def kill_once(self, process, condition, what):
        live_platoon.wait_for(lambda: condition() or process.poll() is not None, what)
        self.assertIsNone(process.poll(), "it was over before it could be killed")
        process.send_signal(signal.SIGKILL)
        process.wait()


class Shards(ShardsTest):
    def shard(self, part, *words, **options):
        return self.run_tool("monte_carlo", "--shard", part, "--output", self.path(part.replace("/", "_of_")), *words, **options)

    def test_shards_of_rare_are_joined_with_their_own_settings_and_any_speed(self):
        settings = ["--model", "paper_at_rest.yaml", "--followers", "2", "--steps", "20", "--realizations", "2000"]
        parts = [self.path("part%d" % i) for i in range(2)]
        for i, part in enumerate(parts):
            self.run_tool("rare", *settings, "--shard", "%d/2" % i, "--output", part)
        joined, whole = self.path("joined"), self.path("whole")
        complained = self.run_tool("rare", *parts, "--output", joined, "--below", "3", "--seed", "2", status=1)
        for name in ("below", "seed"):
            self.assertIn(name + ": given: must be absent beside shards, whose own it is", complained)
        self.assertFalse(os.path.exists(os.path.join(joined, "rare.csv")))
        self.run_tool("rare", *parts, "--output", joined, "--speed", "25")
        self.run_tool("rare", *settings, "--output", whole, "--speed", "25")
        with open(os.path.join(joined, "rare.csv")) as one, open(os.path.join(whole, "rare.csv")) as other:
            self.assertEqual(one.read(), other.read())
        with open(os.path.join(joined, "rare.json")) as one, open(os.path.join(whole, "rare.json")) as other:
            rows = json.load(one)["rows"]
            self.assertEqual(rows, json.load(other)["rows"])
        self.assertGreater(rows[0]["per_kilometre"], 0.0)
        self.assertIn("shard: given: must be absent beside only",
                      self.run_tool("monte_carlo", "--only", "1", "--trajectories", "--shard", "0/2", "--output", whole, status=1))

    def test_an_estimation_whose_results_were_written_in_part_is_completed_by_the_same_command(self):
        words = ["--model", "paper_at_rest.yaml", "--followers", "2", "--steps", "20", "--realizations", "2000", "--output", self.path("rare")]
        obstacle = self.path("rare", "rare.csv.part")
        os.makedirs(obstacle)
        self.run_tool("rare", *words, status=1)
        os.rmdir(obstacle)
        self.assertFalse(os.path.exists(self.path("rare", "rare.csv")))
        self.run_tool("rare", *words)
        self.assertEqual(sorted(os.listdir(self.path("rare"))), [".lock", "rare.csv", "rare.json"])

    def test_a_shard_that_is_killed_again_and_again_goes_on_and_is_merged_to_the_same_bits(self):
        folder, file = self.path("1_of_3"), self.path("1_of_3", "checkpoint.cbor")
        before = None
        for _ in range(2):
            process = self.start("monte_carlo", "--shard", "1/3", "--output", folder, "--threads", "1", *LONG)
            self.kill_once(process, lambda: live_platoon.written_at(file) not in (None, before), "a checkpoint")
            before = live_platoon.written_at(file)
        said = self.shard("1/3", *LONG)
        words = said.splitlines()[-1].replace(",", "").split()
        computed, first, last = (int(words[words.index(word) + step]) for word, step in (("them", -2), ("to", -1), ("to", 1)))
        self.assertTrue(0 < computed < last - first + 1, said)
        for part in ("0/3", "2/3"):
            self.shard(part, *LONG)
        self.assertIn(" 0 of them computed now", self.shard("1/3", *LONG))
        self.run_tool("merge", *[self.path("{}_of_3".format(i)) for i in (2, 0, 1)], "--output", self.path("merged"))
        self.assertEqual(live_platoon.statistics(self.path("merged")), reference())
        summary = live_platoon.summary_of(self.path("merged"))
        self.assertEqual((summary["complete"], summary["realizations"], summary["positions_lost"], summary["hosting"]),
                         (True, REALIZATIONS, 0, "monte_carlo"))

    def test_a_part_of_a_billion_realizations_is_taken(self):
        self.assertIn("realizations 12344992 to 12345999 of 1000000000, 1008 of them computed now",
                      self.shard("12345/1000000", "--realizations", "1e9"))

    def test_on_a_full_disk_it_fails_and_is_not_complete(self):
        # A limit on the file size makes a write fail like a full disk.
        self.assertIn("checkpoint.cbor.part: cannot be written: File too large",
                      self.shard("0/2", "--realizations", "2000", before="ulimit -f 8; ", status=1))
        self.assertEqual(glob.glob(self.path("0_of_2", "*.cbor*")), [])
        self.shard("1/2", "--realizations", "2000")
        self.assertIn("shards 0 of 2: missing", self.run_tool("merge", self.path("0_of_2"), self.path("1_of_2"),
                                                              "--output", self.path("merged"), status=1))
        self.assertFalse(os.path.exists(self.path("merged")))
        self.assertIn("1024 of them computed now", self.shard("0/2", "--realizations", "2048"))

    def test_a_shard_has_its_folder_for_itself(self):
        process = self.start("monte_carlo", "--shard", "0/2", "--output", self.path("0_of_2"), "--threads", "1", *LONG)
        live_platoon.wait_for(lambda: os.path.exists(self.path("0_of_2", "checkpoint.cbor")), "a checkpoint")
        self.assertIn("is in use by launch shard 0/2", self.shard("0/2", *LONG, status=1))
        process.kill()
        process.wait()

    def test_what_is_wrong_is_said(self):
        for part in ("3/3", "-1/3", "1", "x/3", "0/10001"):
            self.assertIn("shard: {}: must be I/N, I from 0 to N - 1, N at most the 10000 realizations".format(part),
                          self.shard(part, status=1))
        self.assertIn("checkpoint-seconds: 0: must be a finite number > 0", self.shard("0/3", "--checkpoint-seconds", "0", status=1))
        self.assertIn("must be given the folders of the shards", self.run_tool("merge", "--output", self.path("x"), status=1))
        self.assertIn("/nowhere: holds no shard", self.run_tool("merge", "/nowhere", "--output", self.path("x"), status=1))
        self.shard("0/1", "--realizations", "100")
        self.run_tool("merge", self.path("0_of_1"), "--output", self.path("merged"))
        self.assertIn("holds results already, which are never overwritten",
                      self.run_tool("merge", self.path("0_of_1"), "--output", self.path("merged"), status=1))


KILL = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdlib.h>
int rename(const char* from, const char* to) {
  static int count;
  if (++count == atoi(getenv("KILL_AT"))) raise(SIGKILL);
  return ((int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename"))(from, to);
}
"""


class Interrupted(ShardsTest):
    def interrupted(self, signals, *words):
        """Runs a command once per signal and sends the signal after a checkpoint; returns status and output of the last run."""
        file = self.path("run", "checkpoint.cbor")
        for number in signals:
            before = live_platoon.written_at(file)
            process = self.start("monte_carlo", "--output", self.path("run"), "--threads", "1", *LONG, *words)
            live_platoon.wait_for(lambda: process.poll() is not None or live_platoon.written_at(file) not in (None, before), "a checkpoint")
            self.assertIsNone(process.poll(), "it was over before it could be stopped")
            process.send_signal(number)
            said, _ = process.communicate(timeout=live_platoon.DEADLINE)
        return process.returncode, said

    def test_ctrl_c_writes_the_results_so_far_and_the_same_command_continues_to_the_same_bits(self):
        status, said = self.interrupted([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
        self.assertEqual(status, 130, said)
        summary = live_platoon.summary_of(self.path("run"))
        done = summary["realizations"]
        self.assertTrue(0 < done < REALIZATIONS and not summary["complete"])
        self.assertIn("stopped after {} of {} realizations: the same command continues".format(done, REALIZATIONS), said)
        self.assertIn("holds a shard of another run: seed is 1 there and 2 here",
                      self.run_tool("monte_carlo", "--output", self.path("run"), "--seed", "2", *LONG, status=1))
        self.run_tool("monte_carlo", "--output", self.path("run"), *LONG)
        self.assertTrue(live_platoon.completed_summary(self.path("run")))
        self.assertEqual(live_platoon.statistics(self.path("run")), reference())
        self.assertEqual(sorted(os.listdir(self.path("run"))), [".lock", "statistics.csv", "summary.json"])
        self.assertIn("holds results already", self.run_tool("monte_carlo", "--output", self.path("run"), *LONG, status=1))

    def test_ctrl_c_ends_what_is_no_batch_at_once(self):
        """Computations of minutes; a loaded machine may be ten times slower than a second."""
        for name, words in {
                "the trajectories of a realization": ("--only", "0", "--trajectories", "--followers", "2000", "--steps", "9999"),
                "theory": ("--loss", "0.1", "--followers", "400", "--steps", "10000", "--realizations", "10"),
                "a batch": ("--followers", "2000", "--steps", "9000", "--batch", "1000", "--realizations", "1e6")}.items():
            with self.subTest(name):
                output = self.path(words[0])
                process = self.start("monte_carlo", "--output", output, *words)
                live_platoon.wait_for(lambda: os.path.exists(os.path.join(output, ".lock")), "the locked folder")
                time.sleep(0.5)
                self.assertIsNone(process.poll(), "it was over before it could be stopped")
                process.send_signal(signal.SIGINT)
                began = time.monotonic()
                said = process.communicate(timeout=live_platoon.DEADLINE)[0]
                self.assertLess(time.monotonic() - began, 10.0)
                self.assertEqual(process.returncode, 130, said)
                self.assertIn("monte_carlo: stopped", said)
                self.assertEqual([file for file in os.listdir(output) if not file.startswith(".")], [])

    @unittest.skipIf(live_platoon.SANITIZED, "a sanitizer comes first in the list of preloaded libraries")
    def test_nothing_that_a_kill_leaves_must_be_removed_by_hand(self):
        shim = self.path("kill.so")
        subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-o", shim, "-", "-ldl"], input=KILL, universal_newlines=True, check=True)
        expected = live_platoon.reference(self.folder, realizations="2000")
        self.run_tool("monte_carlo", "--shard", "0/1", "--realizations", "2000", "--output", self.path("shard"))
        for command in (["merge", self.path("shard")], ["monte_carlo", "--realizations", "2000"]):
            for kill in range(1, 10):
                output = self.path("{}_{}".format(command[0], kill))
                process = self.start(*command, "--output", output, before="export LD_PRELOAD={} KILL_AT={}; ".format(shim, kill))
                process.communicate(timeout=live_platoon.DEADLINE)
                if process.returncode == 0:
                    break
                self.assertEqual(process.returncode, -signal.SIGKILL)
                self.run_tool(*command, "--output", output)
                self.assertEqual(live_platoon.statistics(output), expected)
            self.assertTrue(1 < kill < 9, "killed {} times".format(kill - 1))


class Sweeps(ShardsTest):
    def setUp(self):
        super().setUp()
        self.file = self.sweep(SWEEP)

    def sweep(self, text):
        return self.write("sweep.yaml", text)

    def test_a_sweep_that_is_killed_goes_on_point_by_point_to_the_same_table(self):
        points = self.path("killed", "points")
        process = self.start("sweep", self.file, "--output", self.path("killed"), "--threads", "1")
        self.kill_once(process, lambda: len(glob.glob(points + "/*.csv")) > 2, "some points")
        there = len(glob.glob(points + "/*.csv"))
        self.assertLess(there, 20)
        said = self.run_tool("sweep", self.file, "--output", self.path("killed"))
        self.assertIn("20 points, {} of them to compute\n".format(20 - there), said)
        self.run_tool("sweep", self.file, "--output", self.path("whole"), "--threads", "1")
        tables = []
        for name in ("killed", "whole"):
            with open(self.path(name, "sweep.csv"), "rb") as table:
                tables.append(table.read())
        self.assertEqual(tables[0], tables[1])
        self.assertEqual(tables[0].count(b"\n"), 201)

    def test_on_a_full_disk_it_fails_and_goes_on_when_there_is_room(self):
        complaint = self.run_tool("sweep", self.file, "--output", self.path("run"), before="ulimit -f 1; ", status=1)
        self.assertIn("cannot be written: File too large", complaint)
        self.assertFalse(os.path.exists(self.path("run", "sweep.csv")))
        self.assertIn("20 points, 20 of them to compute", self.run_tool("sweep", self.file, "--output", self.path("run")))

    def rejected(self, said, *words):
        self.assertIn(said, self.run_tool("sweep", *words, status=1))
        self.assertFalse(os.path.exists(self.path("run")), "the folder for the results was made")

    def test_what_is_wrong_is_said_before_anything_is_computed(self):
        output = ["--output", self.path("run")]
        self.rejected("sweep FILE --output DIR: must be given one file", *output)
        self.rejected("output: (empty): must be a folder", self.file)
        self.rejected("sweep: /nowhere: must be a regular file of at most 256 MB that can be read (No such file or directory)", "/nowhere", *output)
        self.rejected("task: 20: must be a whole number from 0 to 19", self.file, "--task", "20", *output)
        self.rejected("task: all: must be a whole number", self.file, "--task", "all", *output)
        self.rejected("1000000 x 1000000 = 1e+12 points: must be at most 100000",
                     self.sweep("vary: {headway: 2:4:1000000, loss: 0:0.5:1000000}\n"), *output)
        self.rejected("(hedway = 3): model/hedway: unknown key: allowed are", self.sweep("vary: {hedway: [3]}\n"), *output)
        self.rejected("steps_: unknown key: allowed are", self.sweep("vary: {headway: [3]}\nsteps_: 3\n"), *output)
        self.rejected("must be YAML", self.sweep("vary: {headway: [3}\n"), *output)


if __name__ == "__main__":
    unittest.main()
