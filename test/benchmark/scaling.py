#!/usr/bin/python3
"""Wall and CPU seconds of shards, their merge and a sweep, compared with one run of the same realizations.

scaling.py [REALIZATIONS [SHARDS]]; the sweep has 200 points of a 200th of the realizations each. Also a part of ratios.py.
"""

import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "integration"))
import live_platoon  # noqa: E402

POINTS = 200
SWEEP = "model: {}\nvary: {{headway: 2.4:4:{}}}\nrealizations: {}\n"


class Case:
    def __init__(self, folder, realizations, shards):
        self.folder, self.realizations, self.shards = folder, realizations, shards
        self.model = live_platoon.shared("config", "paper.yaml")

    def fresh(self, name):
        path = os.path.join(self.folder, name)
        shutil.rmtree(path, ignore_errors=True)
        return path

    def run(self, tool, *words):
        subprocess.run([live_platoon.executable(tool)] + list(words), check=True, stdout=subprocess.DEVNULL)

    def one_run(self):
        self.run("monte_carlo", "--model", self.model, "--realizations", str(self.realizations), "--output", self.fresh("one"))

    def shards_in_turn(self):
        folder = self.fresh("shards")
        for index in range(self.shards):
            self.run("monte_carlo", "--model", self.model, "--realizations", str(self.realizations), "--shard",
                     "{}/{}".format(index, self.shards), "--output", os.path.join(folder, str(index)))

    def merge(self):
        folder = os.path.join(self.folder, "shards")
        self.run("merge", *[os.path.join(folder, name) for name in os.listdir(folder)], "--output", self.fresh("merged"))

    def sweep(self):
        file = os.path.join(self.folder, "sweep.yaml")
        with open(file, "w") as text:
            text.write(SWEEP.format(self.model, POINTS, self.realizations // POINTS))
        self.run("sweep", file, "--output", self.fresh("sweep"))


def cost(job):
    """Wall and CPU seconds."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    job()
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def pairs(folder, in_turn, realizations=1000000, shards=64):
    """Yields speeds in the form of ratios.py."""
    case = Case(folder, realizations, shards)
    one, parts, sweep = in_turn(lambda: realizations / cost(case.one_run)[0], lambda: realizations / cost(case.shards_in_turn)[0],
                                lambda: realizations / cost(case.sweep)[0])
    yield "{} shards one after another, realizations per second".format(shards), "one run", parts, one
    yield "sweep of {} points, realizations per second".format(POINTS), "one run", sweep, one


def main():
    realizations = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1000000
    shards = int(sys.argv[2]) if len(sys.argv) > 2 else 64
    with tempfile.TemporaryDirectory() as folder:
        case = Case(folder, realizations, shards)
        for name, job in (("one run", case.one_run), ("{} shards in turn".format(shards), case.shards_in_turn), ("merge", case.merge),
                          ("sweep of {} points".format(POINTS), case.sweep), ("one run", case.one_run)):
            print("{:24s} wall {:8.2f} s  CPU {:8.2f} s".format(name, *cost(job)), flush=True)


if __name__ == "__main__":
    main()
