#!/usr/bin/python3
"""Tests of what the page and the table say about averages over time, when they pause, begin and go on, without ROS."""

import sys
import unittest

sys.dont_write_bytecode = True
from watching_messages import NAN, burning_in, configuration, endless  # noqa: E402
from watching import state, table  # noqa: E402


class Averages(unittest.TestCase):
    def setUp(self):
        self.state = state.PlatoonState()
        self.state.take_configuration(configuration(3, 0))

    def texts(self):
        return [event["text"] for event in self.state.document()["events"]]

    def heading(self):
        return table.table(self.state.document(), 24)[2]

    def test_averages_are_paused_during_a_manoeuvre_and_a_burn_in_behind_it(self):
        known = []
        for step, manoeuvre, counted_from in ((290, False, 200), (300, True, 501), (310, True, 511), (320, False, 520), (519, False, 520), (520, False, 520)):
            self.state.take_overview(endless(3, step, manoeuvre=manoeuvre, counted_from=counted_from), 0.0)
            known.append((self.state.document()["manoeuvre"], self.state.document()["paused_until"]))
        self.assertEqual(known, [(False, None), (True, 501), (True, 511), (False, 520), (False, 520), (False, None)])
        self.assertEqual(self.texts()[-3:], ["the leader manoeuvres: averages are paused", "the manoeuvre is over: averages go on at step 520",
                                             "averages go on"])
        self.state.take_overview(endless(3, 600, counted_from=800), 0.0)  # it began and ended between two overviews
        self.assertEqual(self.texts()[-2:], ["the leader manoeuvres: averages are paused", "the manoeuvre is over: averages go on at step 800"])
        self.assertIn("averages over time, burn-in: paused until 80 s (step 800)", table.table(self.state.document(), 24)[2])

    def test_averages_begin_where_some_followers_have_theirs_before_the_others(self):
        self.state.take_overview(burning_in(3, 190), 0.0)
        self.state.take_overview(burning_in(3, 199, mean=[0.1, 0.1, NAN], provisional_mean=[NAN, NAN, 0.1]), 0.0)
        self.state.take_overview(endless(3, 200, counted_from=200), 0.0)
        self.assertEqual(self.texts()[-1], "averages begin")

    def test_averages_begin_behind_a_manoeuvre_within_the_first_burn_in(self):
        for step, manoeuvre, counted_from in ((90, False, 200), (100, True, 301), (110, False, 310)):
            self.state.take_overview(burning_in(3, step, manoeuvre=manoeuvre, counted_from=counted_from), 0.0)
        self.assertEqual(self.texts()[-1], "the manoeuvre is over: averages begin at step 310")

    def test_averages_reach_no_step_of_their_pause(self):
        self.state.take_overview(endless(3, 300, counted_from=200), 0.0)
        self.assertIn("averages over time up to 30 s (step 300)", self.heading())
        self.state.take_overview(endless(3, 350, manoeuvre=True, counted_from=551), 0.0)
        self.assertTrue(self.heading().startswith("averages over time, manoeuvre: paused until 55.1 s (step 551)"), self.heading())

    def test_provisional_averages_reach_no_step_of_a_manoeuvre_that_travels_along_the_string(self):
        self.state.take_overview(burning_in(3, 101, counted_from=302), 0.0)
        self.assertIsNone(self.state.document()["provisional"]["step"])
        self.assertIn("~ provisional averages, replaced", self.heading())
        self.state.take_overview(burning_in(3, 102, counted_from=302), 0.0)
        self.assertIn("~ provisional averages up to 10.2 s (step 102), replaced", self.heading())


if __name__ == "__main__":
    unittest.main()
