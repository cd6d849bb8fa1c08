#!/usr/bin/python3
"""Tests of the smallest gaps in /state.json and in `watch`, without ROS."""

import json
import math
import sys
import unittest

sys.dont_write_bytecode = True
from watching_messages import configuration, overview, table_of  # noqa: E402
from watching import state, table  # noqa: E402

NAMES = ("smallest_gap", "smallest_gap_realization", "smallest_gap_step", "collisions", "collision_bound")


def gaps(smallest, realization, step, collisions, bound):
    return dict(zip(NAMES, (smallest, realization, step, collisions, bound)))


class Gaps(unittest.TestCase):
    def setUp(self):
        self.state = state.PlatoonState()

    def document(self, **fields):
        self.state.take_configuration(configuration())
        self.state.take_overview(overview(**fields), 0.0)
        return json.loads(json.dumps(self.state.document(), allow_nan=False))

    def test_without_a_run_and_without_gaps_the_lists_are_empty(self):
        for document in (self.state.document(), self.document()):
            self.assertEqual([document[name] for name in NAMES], [[]] * 5)
            self.assertNotIn("smallest gap", " ".join(table.table(document, 24)))

    def test_each_follower_has_its_smallest_gap_and_where_it_occurred(self):
        given = gaps([1.5, -0.83, 0.25], [8, 804213, 2 ** 45], [61, 7, 0], [0, 12, 0], [0.001, 0.3, 0.2])
        document = self.document(**given)
        self.assertEqual({name: document[name] for name in NAMES}, given)

    def test_missing_figures_are_null(self):
        document = self.document(**gaps([math.inf] * 3, [0] * 3, [0] * 3, [0] * 3, [math.nan] * 3))
        self.assertEqual((document["smallest_gap"], document["collision_bound"]), ([None] * 3, [None] * 3))
        self.assertNotIn("smallest gap", " ".join(table.table(document, 24)))
        self.assertEqual(self.document(**gaps([1.0] * 3, [0] * 3, [0] * 3, [0] * 3, []))["collision_bound"], [])

    def test_another_run_begins_without_gaps(self):
        self.document(**gaps([1.0] * 3, [0] * 3, [0] * 3, [0] * 3, [0.1] * 3))
        self.state.take_configuration(configuration(time_headway=2.4))
        self.assertEqual([self.state.document()[name] for name in NAMES], [[]] * 5)


class Watched(unittest.TestCase):
    def lines(self, followers, smallest, lines=24):
        return table_of(followers, lines, **gaps(smallest, [804213] * followers, [61] * followers, [3] * followers, []))

    def test_the_table_has_the_smallest_gap_of_all_followers_in_one_line(self):
        smallest = [2.0 - 0.1 * i for i in range(17)]
        smallest[16] = -0.8312
        self.assertIn("smallest gap -0.831 m: follower 17, realization 804213, 6.1 s (step 61)", self.lines(17, smallest))

    def test_the_table_has_the_first_of_equal_gaps(self):
        self.assertIn("smallest gap 0.5 m: follower 2, realization 804213, 6.1 s (step 61)", self.lines(3, [1.0, 0.5, 0.5]))

    def test_the_table_fits_the_screen(self):
        for lines in range(20, 50):
            self.assertLessEqual(len(self.lines(500, [1.0] * 500, lines)), lines)


if __name__ == "__main__":
    unittest.main()
