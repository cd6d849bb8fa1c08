#!/usr/bin/python3
"""Replays that drive external followers end with a verdict, or with the reason why there is none.

replays_test.py --count 500 [--busy 4] [--lanes 3] [--minutes 60]: runs `count` replays of one recording, or as many as begin in
`minutes`, in `lanes` parallel lanes beside `busy` busy loops, each with a new follower that starts at the same time. Prints the
number of replays for each outcome; status 0 if all are right.
"""

import argparse
import collections
import concurrent.futures
import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import live_platoon
from folder import FolderTest, temporary_folder
from recording import rewritten
from terminal import Terminal, start_master

HERE = os.path.dirname(os.path.abspath(__file__))
RUN = dict(followers=2, steps=20, realizations=30, batch=10)
MESSAGES = 3 * 21
EQUAL = "vehicle_2: {} messages equal the recorded ones to the bit".format(MESSAGES)
# The example equals the built-in vehicle except for rounding.
APART = r"vehicle_2: {} messages as in the recording, positions at most (\S+) m apart".format(MESSAGES)
LONGEST = 300.0  # [s] limit for a replay: one that hangs never ends


def record(folder, **arguments):
    """Records RUN with built-in vehicles; returns the bag."""
    bag = os.path.join(folder, "run.bag")
    terminal = Terminal(folder, "platoon.launch", output=os.path.join(folder, "run"), record=bag, **dict(RUN, **arguments))
    try:
        terminal.wait()
    finally:
        terminal.end()
    if not os.path.exists(bag):
        raise AssertionError("nothing was recorded:\n" + terminal.text())
    return bag


def ended(text):
    """The outcome of a replay from its output: a verdict, a reason, or nothing."""
    apart = re.search(APART, text)
    if EQUAL in text or (apart and float(apart.group(1)) < 1e-11):
        return "right"
    if "differs from the recording" in text or apart:
        return "wrong"
    return "no verdict" if "no verdict: " in text else "nothing"


class Followers:
    """External vehicles on their own master, and the replays that drive them."""

    def __init__(self, folder, cleanup):
        self.folder, self.master = folder, start_master(folder, cleanup)

    def start(self, *command):
        return subprocess.Popen(command, env=live_platoon.ros_environment(self.master, ROS_HOME=self.folder), stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)

    def replay(self, bag, command, **arguments):
        """The output of a replay that drives the vehicle started by this command. Raises AssertionError if it does not end."""
        vehicle = self.start(*command) if command else None
        terminal = Terminal(self.folder, "replay.launch", master=self.master, bag=bag, drive="vehicle_2", external=2, output="", **arguments)
        try:
            terminal.wait(LONGEST)
        except subprocess.TimeoutExpired:
            raise AssertionError("the replay does not end; it printed:\n" + terminal.text())
        finally:
            terminal.end()
            if vehicle:
                vehicle.kill()
                vehicle.wait()
        return terminal.text()


def example():
    return [live_platoon.shared("launch", "examples", "rospy_follower.py"), "2"]


def run_lane(bag, numbers, deadline):
    """Runs the replays of one lane. Returns counts of the outcomes, and the output of the replays that were not right."""
    outcomes, texts = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        followers = Followers(folder, stack.callback)
        for number in numbers:
            if time.monotonic() > deadline:
                break
            try:
                text = followers.replay(bag, example())
                outcome = ended(text)
            except AssertionError as error:
                text, outcome = str(error), "hangs"
            outcomes[outcome] += 1
            if outcome != "right":
                texts.append("replay {}: {}\n{}".format(number, outcome, text[-3000:]))
    return outcomes, texts


def run_many(bag, count, busy, lanes, seconds=float("inf")):
    """Runs all lanes beside so many busy loops. Returns as run_lane."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy)]
    deadline = time.monotonic() + seconds
    try:
        outcomes, texts = collections.Counter(), []
        with concurrent.futures.ThreadPoolExecutor(lanes) as pool:
            for of_lane, texts_of_lane in pool.map(lambda lane: run_lane(bag, range(lane, count, lanes), deadline), range(min(lanes, count))):
                outcomes += of_lane
                texts += texts_of_lane
        return outcomes, texts
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


class Replays(FolderTest):
    @classmethod
    def setUpClass(cls):
        cls.bag = record(temporary_folder(cls.addClassCleanup))

    def setUp(self):
        super().setUp()
        self.followers = Followers(self.folder, self.addCleanup)

    def test_a_link_that_carries_answers_late_costs_an_attempt_and_the_verdict_comes(self):
        text = self.followers.replay(self.bag, [os.path.join(HERE, "slow_accept.py"), "2", "0.5"])
        self.assertEqual(ended(text), "right", text)
        self.assertNotIn("has died", text)

    def test_a_follower_that_is_killed_and_comes_back_costs_attempts_and_the_verdict_comes(self):
        # A vehicle with the same node name replaces the first one, as after a restart. The first answers too slowly to complete.
        slow = self.followers.start(os.path.join(HERE, "slow_accept.py"), "2", "3600")
        self.addCleanup(slow.wait)
        self.addCleanup(slow.kill)
        live_platoon.wait_for(lambda: live_platoon.process_of("/vehicle_2", self.followers.master), "the first vehicle")
        terminal = Terminal(self.folder, "replay.launch", master=self.followers.master, bag=self.bag, drive="vehicle_2", external=2, output="")
        self.addCleanup(terminal.end)
        live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/vehicle_replay", self.followers.master), "the replay")
        time.sleep(1.0)  # the replay sends and receives nothing
        slow.send_signal(signal.SIGKILL)
        slow.wait()
        again = self.followers.start(*example())
        self.addCleanup(again.wait)
        self.addCleanup(again.kill)
        terminal.wait(LONGEST)
        self.assertEqual(ended(terminal.text()), "right", terminal.text())

    def test_a_lost_answer_before_a_batch_of_a_later_recorded_attempt_costs_an_attempt_and_the_verdict_comes(self):
        def later_attempt(topic, message):
            if getattr(message, "first_realization", 0) >= RUN["batch"]:
                message.attempt += 1
            return 0 if topic.endswith("/checksum") else 1

        later = rewritten(self.bag, os.path.join(self.folder, "later.bag"), later_attempt)
        text = self.followers.replay(later, [os.path.join(HERE, "losing_follower.py"), "2"], unverified=True)
        self.assertEqual(ended(text), "right", text)

    def test_a_vehicle_that_does_not_answer_ends_the_replay_with_the_reason(self):
        for fault, dropped in (("answer", "out of turn; clause 6 of"), ("size", "of a wrong batch size; clause 3 of"), ("finite", "not finite; clause 4 of")):
            text = self.followers.replay(self.bag, [os.path.join(HERE, "broken_follower.py"), "2:" + fault], patience=4)
            self.assertRegex(text, r"no verdict: vehicle_2 has not answered step 5 of the realizations from 0 within 4 s, in \d+ attempts; its last "
                             "message was dropped, as " + dropped)
        text = self.followers.replay(self.bag, [os.path.join(HERE, "slow_accept.py"), "2", "3600"], patience=4)
        self.assertRegex(text, r"no verdict: vehicle_2 has not answered step -1 of the realizations from 0 within 4 s, in \d+ attempts; clause 2 of")

    def test_a_repeated_answer_is_dropped_and_the_replay_goes_on(self):
        text = self.followers.replay(self.bag, [os.path.join(HERE, "broken_follower.py"), "2:twice"], patience=4)
        self.assertIn("/platoon/vehicle_2/position: dropped a message that is out of turn: ", text)
        self.assertRegex(text, r"vehicle_2: \d+ messages as in the recording, positions at most \d\S* m apart")

    def test_a_vehicle_that_is_not_there_ends_the_replay_with_the_reason(self):
        text = self.followers.replay(self.bag, None, patience=3)
        self.assertIn("waiting for external vehicle_2: start its node (the replay ends after 3 s)", text)
        self.assertIn("no verdict: vehicle_2 is not running: no publisher of /platoon/vehicle_2/position; the vehicle is external: start its node", text)

    def test_a_kept_follower_that_has_taken_part_in_no_run_joins_the_replay_with_all_its_inputs(self):
        bag = record(self.folder, model="path_cacc.yaml", steps=20, hosting="one_process")
        kept = Terminal(self.folder, "followers.launch", master=self.followers.master, first=2, last=2)
        self.addCleanup(kept.end)
        live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/vehicle_2", self.followers.master), "the kept follower")
        text = self.followers.replay(bag, None, patience=20)
        self.assertIn(EQUAL, text)

    def test_some_replays_under_load_end_with_the_right_verdict(self):
        outcomes, texts = run_many(self.bag, 4, 2, 2)
        self.assertEqual(outcomes, {"right": 4}, "\n".join(texts))


def main(arguments):
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        outcomes, texts = run_many(record(folder), arguments.count, arguments.busy, arguments.lanes, 60.0 * arguments.minutes)
        print("\n".join(texts))
        print("{} replays beside {} busy loops in {:.0f} s: {}".format(sum(outcomes.values()), arguments.busy, time.monotonic() - began, ", ".join(
            "{} {}".format(number, outcome) for outcome, number in outcomes.most_common())))
        return 0 if set(outcomes) == {"right"} else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, help="so many replays instead of the tests")
    parser.add_argument("--busy", type=int, default=4, help="busy loops beside them (4)")
    parser.add_argument("--minutes", type=float, default=1000.0, help="no more begin after these (1000)")
    parser.add_argument("--lanes", type=int, default=3, help="at once (3)")
    parsed, others = parser.parse_known_args()
    if parsed.count:
        sys.exit(main(parsed))
    unittest.main(argv=sys.argv[:1] + others)
