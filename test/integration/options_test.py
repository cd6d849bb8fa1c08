#!/usr/bin/python3
"""Options that no other test gives: the pause and the fast start of a replay, and the namespace of watch."""

import os
import subprocess
import time
import unittest

import rosbag
import rospy
from std_srvs.srv import SetBool
from stochastic_platoon.msg import Position

import live_platoon
from orders import Orders, setUpModule  # noqa: F401: unittest calls setUpModule
from recording import DATA

SMALL = os.path.join(DATA, "small.bag")  # 2 followers, steps -1 .. 4, 6 realizations in batches of 4 and 2
VEHICLES = range(3)


def content(messages):
    return [(message.step, message.first_realization, tuple(message.position)) for message in messages]


class Replay(Orders):
    def paused(self, **arguments):
        """A replay that waits for its service, and the topics of its vehicles."""
        topics = [self.listen("vehicle_{}/position".format(i), Position) for i in VEHICLES]
        terminal = self.launch("replay.launch", bag=SMALL, pause="true", **arguments)
        live_platoon.wait_for(lambda: all(topic.connections() for topic in topics), "the player's topics")
        live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/monitor"), "the monitor")
        return terminal, topics

    def pause(self, data):
        rospy.wait_for_service("/platoon/player/pause_playback", 60)
        answer = rospy.ServiceProxy("/platoon/player/pause_playback", SetBool)(data)
        self.assertEqual((answer.success, answer.message), (True, "paused" if data else "playing"))

    def recorded(self):
        """Of each vehicle, what was recorded."""
        with rosbag.Bag(SMALL) as bag:
            return [content(message for _, message, _ in bag.read_messages("/platoon/vehicle_{}/position".format(i))) for i in VEHICLES]

    def test_that_is_paused_waits_and_then_gives_the_recorded_statistics(self):
        terminal, topics = self.paused(rate=0.2)  # 6 s for the 1.2 s of platoon time
        time.sleep(1.0)
        self.assertEqual([topic.messages for topic in topics], [[], [], []])
        self.pause(False)
        live_platoon.wait_for(lambda: topics[0].messages, "a message")
        self.pause(True)
        time.sleep(0.2)  # what is under way arrives
        played = len(topics[0].messages)
        time.sleep(1.0)
        self.assertEqual(len(topics[0].messages), played)
        self.assertLess(played, 12)
        self.pause(False)
        self.completed(terminal)
        self.assertEqual([content(topic.messages) for topic in topics], self.recorded())
        with open(os.path.join(DATA, "small_statistics.csv"), "rb") as file:
            self.assertEqual(live_platoon.statistics(self.output), file.read())

    def test_of_a_recording_named_from_the_working_folder_finds_it(self):
        for drive, arguments in (("", {}), ("vehicle_2", dict(output=""))):
            terminal = self.launch("replay.launch", inside=("env", "-C", DATA), bag="small.bag", drive=drive, **arguments)
            terminal.wait()
            self.assertNotIn("has died", terminal.text())
        self.assertIn("vehicle_2: 12 messages equal the recorded ones to the bit", terminal.text())
        self.assertTrue(live_platoon.completed_summary(self.output))

    def test_the_first_seconds_of_platoon_time_pass_as_fast_as_possible(self):
        terminal, topics = self.paused(rate=0.02, start=0.95)  # the last of the 1.1 s are due after 7.5 s, without `start` after 55 s
        began = time.monotonic()
        self.pause(False)
        live_platoon.wait_for(lambda: len(topics[0].messages) >= 10, "the first 0.9 s")
        self.assertEqual(len(topics[0].messages), 10)
        self.completed(terminal)
        self.assertTrue(7.5 < time.monotonic() - began < 50.0)
        self.assertEqual([content(topic.messages) for topic in topics], self.recorded())


class Watch(Orders):
    def test_shows_the_platoon_of_another_namespace(self):
        self.launch(ns="left/platoon2", followers=3, steps=0, rate=100, burn_in=10)
        printed = subprocess.run([live_platoon.shared("src", "tools", "watch"), "--once", "--namespace", "left/platoon2"], stdout=subprocess.PIPE,
                                 universal_newlines=True, timeout=live_platoon.DEADLINE, check=True).stdout
        lines = printed.splitlines()
        heading = next(row for row, line in enumerate(lines) if line.split()[:2] == ["follower", "mean"])
        self.assertEqual([line.split()[0] for line in lines[heading + 1:] if line.strip()], ["1", "2", "3"])


if __name__ == "__main__":
    unittest.main()
