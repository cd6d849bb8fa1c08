#!/usr/bin/python3
"""kill -9 of any node during a run costs time but no sample: the statistics equal those of an undisturbed run to the bit."""

import os
import sys
import unittest

import rospy
import rostest
from stochastic_platoon.msg import Progress

import live_platoon
from folder import temporary_folder
from terminal import Terminal


class Kill(unittest.TestCase):
    def setUp(self):
        folder = temporary_folder(self.addCleanup)
        self.output = os.path.join(folder, "run")
        self.victims = rospy.get_param("~victims").split("+")
        self.settings = {"followers": 4, "steps": 20, "realizations": 800}
        self.committed = 0
        self.progress = rospy.Subscriber("/platoon/progress", Progress, self.receive, queue_size=1000)
        # Paced, so that the run lasts long enough to be disturbed on any machine, and not begun before this test listens.
        platoon = Terminal(folder, "platoon.launch", os.environ["ROS_MASTER_URI"], model=rospy.get_param("~model"), output=self.output, batch=10,
                           rate=400, stall_timeout=0.5, hosting=rospy.get_param("~hosting"), **self.settings)
        self.addCleanup(platoon.end)

    def receive(self, message):
        self.committed = message.first_realization

    def test_the_statistics_are_those_of_an_undisturbed_run(self):
        for count, victim in enumerate(self.victims, start=1):
            share = count / (len(self.victims) + 1.0)
            live_platoon.wait_for(lambda: self.committed >= share * self.settings["realizations"],
                                  "{:.0f} % of the run".format(100 * share))
            self.assertLess(self.committed, self.settings["realizations"], "the run was over before " + victim + " was killed")
            live_platoon.kill("/platoon/" + victim)
        summary = live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output), "the run to complete")
        self.assertGreater(summary["attempts"], len(self.victims), "no batch was repeated: the kill had no effect")
        self.assertEqual(summary["positions_lost"], 0)
        self.assertEqual(summary["positions_received"],
                         (self.settings["followers"] + 1) * (self.settings["steps"] + 1) * self.settings["realizations"])
        self.assertEqual(live_platoon.statistics(self.output), live_platoon.reference(self.output, model=live_platoon.shared("config", rospy.get_param("~model")),
                                                **self.settings))


if __name__ == "__main__":
    rospy.init_node("kill_test")
    rostest.rosrun("stochastic_platoon", rospy.get_param("~name"), Kill, sys.argv)
