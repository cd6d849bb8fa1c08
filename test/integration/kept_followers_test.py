#!/usr/bin/python3
"""Followers that outlive launches serve runs of one model after another, with and without radios, losses, mixed vehicles and
recordings: every run completes with the bits of monte_carlo.

kept_followers_test.py --count 200 [--seed 1] [--lanes 3]: runs `count` launches on such followers in `lanes` parallel lanes, each
lane with its own master and followers. Prints the number of launches for each outcome; status 0 if all are right.
"""

import argparse
import collections
import concurrent.futures
import contextlib
import itertools
import json
import os
import random
import subprocess
import sys
import tempfile
import time
import unittest

import rosgraph
import yaml

import live_platoon
from folder import FolderTest
from terminal import Terminal, start_master

LONGEST = 60.0  # [s] limit for a launch: one that hangs never ends
SHIPPED = ("paper.yaml", "cacc.yaml", "lossy.yaml", "mixed.yaml", "by_distance.yaml", "path_cacc.yaml", "two_ahead.yaml")


def some_with_radios(folder):
    """A model file whose string mixes cars with a radio that loses with cars without; returns its path."""
    with open(live_platoon.shared("config", "cacc.yaml")) as file:
        model = yaml.safe_load(file)
    model["inputs"][1]["channel"].update(loss={"probability": 0.2, "on_loss": "zero"})
    model["vehicle_types"] = {"human": {"time_headway_seconds": 1.5, "inputs": [{"signal": "position"}]}}
    model["string"] = ["default", "human", "default"]
    path = os.path.join(folder, "radios.yaml")
    with open(path, "w") as file:
        json.dump(model, file)
    return path


class Kept:
    """A master with followers first .. `followers` that outlive launches."""

    def __init__(self, cleanup, folder, followers, first):
        os.makedirs(folder, exist_ok=True)
        self.folder, self.followers, self.first = folder, followers, first
        self.master = start_master(folder, cleanup)
        self.models = [live_platoon.shared("config", name) for name in SHIPPED] + [some_with_radios(folder)]
        kept = Terminal(folder, "followers.launch", master=self.master, first=first, last=followers)
        cleanup(kept.end)
        kept.wait_for_text("process[platoon/vehicle_{}".format(followers))
        self.runs = itertools.count()

    def run(self, model, recorded, **settings):
        """Launches a run and compares its bits. Raises AssertionError with the output of roslaunch. Returns (attempts, bag)."""
        output = os.path.join(self.folder, "run{}".format(next(self.runs)))
        settings = dict(dict(steps=20, realizations=120, seed=7), **settings, followers=self.followers, model=model)
        record = dict(record=output + ".bag") if recorded else {}
        launch = Terminal(self.folder, "platoon.launch", master=self.master, output=output, first=1, last=self.first - 1, batch=40, **record,
                          **settings)
        try:
            launch.wait(LONGEST)
        except subprocess.TimeoutExpired:
            raise AssertionError("{}: does not end; it printed:\n{}".format(model, launch.text()))
        finally:
            launch.end()
        summary = live_platoon.completed_summary(output)
        if not summary:
            raise AssertionError("{}: is not complete; it printed:\n{}".format(model, launch.text()))
        right = live_platoon.reference(output, **settings)
        if live_platoon.statistics(output) != right:
            raise AssertionError("{0}: {1}/statistics.csv differs from {1}/reference/statistics.csv".format(model, output))
        if recorded and live_platoon.tool("bag_statistics", output + ".bag", "--csv").stdout.encode() != right:
            raise AssertionError("{}: the bag {}.bag has other statistics".format(model, output))
        return summary["attempts"], output + ".bag"


class ChangingModels(FolderTest):
    def test_a_vehicle_is_not_started_twice(self):
        kept = Kept(self.addCleanup, self.folder, 4, 3)
        state = rosgraph.Master("/kept_followers_test", kept.master).getSystemState
        live_platoon.wait_for(lambda: "/platoon/vehicle_3/position" in dict(state()[0]), "vehicle_3")
        twice = Terminal(self.folder, "followers.launch", master=kept.master, first=2, last=3)
        self.addCleanup(twice.end)
        self.assertNotEqual(twice.wait(LONGEST), 0)
        self.assertIn("/platoon/vehicle_3/position: node /platoon/vehicle_3 publishes it already: must be outside first:= .. last:=, or in "
                      "external:=", twice.text())
        self.assertNotIn("process[", twice.text())
        beside = Terminal(self.folder, "followers.launch", master=kept.master, first=2, last=3, external=3)
        self.addCleanup(beside.end)
        beside.wait_for_text("process[platoon/vehicle_2")
        kept.first = 2
        kept.run(kept.models[0], False)

    def test_radios_come_and_go_recorded_or_not_and_every_run_has_its_bits(self):
        kept = Kept(self.addCleanup, self.folder, 6, 3)
        paper, cacc, lossy, _, _, path, two_ahead, radios = kept.models
        for model, recorded in ((paper, False), (cacc, True), (path, True), (lossy, True), (two_ahead, False), (radios, False), (path, False),
                                (paper, True), (radios, True), (cacc, False)):
            kept.run(model, recorded)

    def test_the_links_of_a_radio_are_up_before_the_run_that_needs_them(self):
        kept = Kept(self.addCleanup, self.folder, 4, 3)
        kept.run(kept.models[0], False)
        master = rosgraph.Master("/kept_followers_test", kept.master)
        published, subscribed = (dict(listed) for listed in master.getSystemState()[:2])
        for i in (3, 4):
            node = "/platoon/vehicle_{}".format(i)
            self.assertEqual((published.get(node + "/input"), subscribed.get(node + "/predecessor_input")), ([node], [node]))

    def test_a_vehicle_that_advertises_its_input_with_the_first_message_is_recorded(self):
        kept = Kept(self.addCleanup, self.folder, 4, 4)
        self.background(live_platoon.executable("follower"), "__ns:=platoon", "__name:=vehicle_3", "_index:=3", "_kept:=false",
                        env=live_platoon.ros_environment(kept.master, ROS_HOME=self.folder))
        live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/vehicle_3", kept.master), "vehicle_3")
        kept.first = 3
        paper, cacc = kept.models[:2]
        kept.run(paper, False)
        kept.run(cacc, True)

    def test_a_replay_drives_a_kept_follower_that_had_no_radio_before(self):
        kept = Kept(self.addCleanup, self.folder, 4, 4)
        paper, cacc = kept.models[:2]
        bag = kept.run(cacc, True)[1]
        again = Kept(self.addCleanup, self.path("again"), 4, 4)
        again.run(paper, False)
        replay = Terminal(self.folder, "replay.launch", master=again.master, bag=bag, drive="vehicle_4", external=4, patience=20)
        self.addCleanup(replay.end)
        replay.wait(LONGEST)
        self.assertIn("vehicle_4: {} messages equal the recorded ones to the bit".format(3 * 21), replay.text())


def run_lane(seed, lane, numbers):
    """Returns counts of the outcomes, the attempts, and the messages of the launches that were not right."""
    outcomes, attempts, texts = collections.Counter(), [], []
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        rng = random.Random("{}/{}".format(seed, lane))
        kept = Kept(stack.callback, folder, rng.randint(3, 6), 2)
        before = None
        for number in numbers:
            model = rng.choice([other for other in kept.models if other != before])
            before, recorded = model, rng.random() < 0.5
            try:
                attempts.append(kept.run(model, recorded, seed=rng.randrange(1, 2**31), steps=rng.randint(5, 60),
                                         realizations=rng.randint(1, 400))[0])
                outcomes["{}{}".format(os.path.basename(model), ", recorded" * recorded)] += 1
            except AssertionError as error:
                outcomes["WRONG"] += 1
                texts.append("launch {}: {}".format(number, error))
    return outcomes, attempts, texts


def main(arguments):
    began, outcomes, attempts = time.monotonic(), collections.Counter(), []
    with concurrent.futures.ThreadPoolExecutor(arguments.lanes) as pool:
        for lane in pool.map(lambda lane: run_lane(arguments.seed, lane, range(lane, arguments.count, arguments.lanes)), range(arguments.lanes)):
            outcomes += lane[0]
            attempts += lane[1]
            print("\n".join(lane[2]))
    for outcome, number in sorted(outcomes.items()):
        print("{:6d} {}".format(number, outcome))
    print("{} launches on kept followers in {:.0f} s: {} wrong; attempts: at most {}, {:.1f} on average".format(
        sum(outcomes.values()), time.monotonic() - began, outcomes["WRONG"], max(attempts), sum(attempts) / len(attempts)))
    return 1 if outcomes["WRONG"] else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, help="so many launches instead of the tests")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lanes", type=int, default=3, help="at once (3)")
    parsed, others = parser.parse_known_args()
    if parsed.count:
        sys.exit(main(parsed))
    unittest.main(argv=sys.argv[:1] + others)
