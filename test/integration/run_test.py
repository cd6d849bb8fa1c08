#!/usr/bin/python3
"""A run of the shipped launch file completes without loss, agrees with the theory and equals monte_carlo to the bit."""

import sys
import unittest

import rospy
import rostest

import live_platoon


class Run(unittest.TestCase):
    def setUp(self):
        self.output = rospy.get_param("~output")
        self.followers = rospy.get_param("~followers")
        self.steps = rospy.get_param("~steps")
        self.realizations = rospy.get_param("~realizations")
        self.headway = rospy.get_param("~headway")
        self.link = {name: rospy.get_param("~" + name) for name in ("loss", "delay") if rospy.get_param("~" + name)}
        self.model = rospy.get_param("~model")
        self.summary = live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output), "the run to complete")

    def test_every_position_is_received_and_none_is_lost(self):
        expected = (self.followers + 1) * (self.steps + 1) * self.realizations
        self.assertEqual(self.summary["positions_received"], expected)
        self.assertEqual(self.summary["positions_lost"], 0)
        self.assertEqual(self.summary["realizations"], self.realizations)

    def test_it_agrees_with_the_theory_within_the_error_of_the_estimators(self):
        # The largest of 2 N K normal scores exceeds this with probability 1e-3 (Bonferroni), 5.5 for N K = 10^4. The scores are
        # exact for every number of realizations.
        agreement = self.summary["agreement"]
        plausible = min(agreement["plausible_z"], 5.5)
        self.assertLess(agreement["max_abs_z_mean"], plausible)
        self.assertLess(agreement["max_abs_z_variance"], plausible)
        self.assertGreater(agreement["max_abs_z_variance"], 0.5)  # a measurement, not a copy of the theory

    def test_it_equals_monte_carlo_to_the_bit(self):
        reference = live_platoon.reference(self.output, followers=self.followers, steps=self.steps, headway=self.headway,
                                           realizations=self.realizations, model=live_platoon.shared("config", self.model),
                                           **self.link)
        self.assertEqual(live_platoon.statistics(self.output), reference)

    def test_its_settings_are_parameters_with_the_names_of_the_launch_arguments(self):
        settings = rospy.get_param("/platoon")
        shared = dict(headway=self.headway, loss=float(self.link.get("loss", 0.0)), delay=int(self.link.get("delay", 0)), mean_burst="")
        if self.model == "lossy.yaml":
            shared.update(loss=0.1)
        if self.model == "mixed.yaml":  # whose trucks have values of their own
            shared = dict.fromkeys(shared, "")
        expected = dict(followers=self.followers, steps=self.steps, realizations=self.realizations, noise_variance=0.6,
                        output=self.output, resume=False, external="", **shared)
        self.assertEqual({name: settings.get(name) for name in expected}, expected)

    def test_the_verdict_on_string_stability_is_the_papers(self):
        # The verdict is the same for the links and mixed strings in this test.
        self.assertTrue(self.summary["theory"]["mean_square_stable"])
        self.assertEqual(self.summary["theory"]["string_stable"], self.headway == 3.2)


if __name__ == "__main__":
    rospy.init_node("run_test")
    rostest.rosrun("stochastic_platoon", rospy.get_param("~name"), Run, sys.argv)
