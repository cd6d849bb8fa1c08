#!/usr/bin/python3
"""kill -9 of any node during a run costs time but no sample: the statistics equal those of an undisturbed run to the bit."""

import sys
import unittest

import rospy
import rostest
from stochastic_platoon.msg import Progress

import live_platoon


class Kill(unittest.TestCase):
    def setUp(self):
        self.output = rospy.get_param("~output")
        self.victims = rospy.get_param("~victims").split("+")
        self.settings = {name: rospy.get_param("~" + name) for name in ("followers", "steps", "realizations")}
        self.committed = 0
        self.progress = rospy.Subscriber("/platoon/progress", Progress, self.receive, queue_size=1000)

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
