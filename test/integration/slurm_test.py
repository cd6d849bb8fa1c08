#!/usr/bin/python3
"""launch/shards.sbatch on a real Slurm that the test starts: the same bits after tasks are killed and a node is lost."""

import glob
import os
import sys
import unittest

import cluster
import live_platoon
from folder import FolderTest

SCRIPT = live_platoon.shared("launch", "shards.sbatch")
SHARDS = 4
REALIZATIONS = "2e5" if live_platoon.SANITIZED else "1e6"  # a task takes seconds, so that it can be killed before it ends
OPTIONS = ["--realizations", REALIZATIONS, "--batch", "128", "--checkpoint-seconds", "0.2"]
SWEEP = "vary: {headway: [2.4, 3.2]}\nfollowers: 3\nsteps: 20\nrealizations: 2000\nshards: 2\n"


class OnACluster(FolderTest):
    @classmethod
    def setUpClass(cls):
        cls.cluster = cluster.Cluster()
        cls.addClassCleanup(cls.cluster.end)
        try:
            cls.cluster.start()
        except AssertionError as error:
            raise AssertionError("{}\n{}".format(error, cls.cluster.logs()))

    def setUp(self):
        super().setUp()
        self.output = self.path("run")

    def submit(self, *words, **environment):
        """Submits; returns the job numbers of the array and of the merge."""
        said = self.cluster.run(SCRIPT, *words, environment=environment)
        self.assertRegex(said, r"^tasks: job \d+, merge: job \d+, ")
        return said.split()[2].rstrip(","), said.split()[5].rstrip(",")

    def wait_for(self, condition, what):
        try:
            return live_platoon.wait_for(condition, what)
        except AssertionError as error:
            raise AssertionError("{}\n{}\n{}\n{}".format(error, self.cluster.jobs(), self.said(), self.cluster.logs()))

    def said(self):
        text = ""
        for name in sorted(glob.glob(os.path.join(self.output, "logs", "*"))):
            with open(name) as file:
                text += "== {}\n{}".format(os.path.basename(name), file.read())
        return text

    def on_both_nodes(self, array):
        """For each node its running task that has a checkpoint; None unless both nodes have one."""
        on = {node: task.split("_")[1] for task, state, node in self.cluster.jobs()
              if task.startswith(array + "_") and state == "RUNNING"
              and os.path.exists(os.path.join(self.output, "shards", task.split("_")[1], "checkpoint.cbor"))}
        return on if sorted(on) == ["n0", "n1"] else None

    def wait_for_end(self, *jobs):
        self.wait_for(lambda: not any(task.split("_")[0] in jobs for task, _, _ in self.cluster.jobs()), "the jobs to end")

    def test_1_an_array_whose_tasks_and_node_are_killed_gives_the_bits_of_one_run(self):
        array, merge = self.submit(self.output, str(SHARDS), *OPTIONS)
        on = self.wait_for(lambda: self.on_both_nodes(array), "a task in the middle on each node")
        self.assertEqual(self.cluster.run("scontrol", "requeue", "{}_{}".format(array, on["n0"])), "")
        self.cluster.power_off("n1")
        self.wait_for_end(array, merge)
        with open(glob.glob(os.path.join(self.output, "logs", "{}_merge.txt".format(merge)))[0]) as file:
            self.assertIn("Measurement agrees with Lemma 1", file.read())
        self.assertEqual(live_platoon.statistics(self.output), live_platoon.reference(self.folder, realizations=REALIZATIONS))
        for node in ("n0", "n1"):
            self.check_went_on(array, on[node])

    def check_went_on(self, array, task):
        """Checks that a task that was started twice computed only part of its shard the second time."""
        with open(os.path.join(self.output, "logs", "{}_{}.txt".format(array, task))) as file:
            text = file.read()
        ends = [line for line in text.splitlines() if "computed now" in line]
        self.assertEqual(len(ends), 1, text)
        words = ends[0].replace(",", "").split()
        computed, size = int(words[words.index("them") - 2]), int(words[words.index("to") + 1]) - int(words[words.index("to") - 1]) + 1
        self.assertGreater(computed, 0, text)
        self.assertLess(computed, size, text)

    def test_2_what_is_missing_is_named_and_can_be_submitted_again(self):
        os.makedirs(os.path.join(self.output, "shards"))
        options = ["--realizations", "1000", "--followers", "2", "--steps", "5"]
        jobs = self.submit(self.output, "5", *options, TASKS="0,2")
        self.wait_for_end(*jobs)
        self.assertIn("shards 1,3-4 of 5: missing: must be computed (sbatch --array=1,3-4)", self.said())
        jobs = self.submit(self.output, "5", *options, TASKS="1,3-4")
        self.wait_for_end(*jobs)
        self.assertEqual(live_platoon.statistics(self.output),
                         live_platoon.reference(self.folder, realizations=1000, followers=2, steps=5))

    def test_3_a_sweep_as_an_array_gives_the_table_of_a_sweep_here(self):
        file = self.write("sweep.yaml", SWEEP)
        self.wait_for_end(*self.submit(self.output, file))
        here = self.path("here")
        self.cluster.run(live_platoon.executable("sweep"), file, "--output", here)
        tables = []
        for folder in (self.output, here):
            with open(os.path.join(folder, "sweep.csv"), "rb") as table:
                tables.append(table.read())
        self.assertEqual(tables[0], tables[1])


if __name__ == "__main__":
    reason = cluster.why_not()
    if reason:
        print("skipped: " + reason)
        sys.exit(77)
    unittest.main()
