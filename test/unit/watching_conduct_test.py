#!/usr/bin/python3
"""Tests of what the page says about the cars, without ROS."""

import sys
import unittest

import stochastic_platoon as sp

sys.dont_write_bytecode = True
from watching_messages import configuration, message, overview, snapshot  # noqa: E402
from watching import conduct, state, table  # noqa: E402


class Conduct(unittest.TestCase):
    def taken(self, *snapshots, lengths=(4.0, 4.0, 4.0)):
        of = conduct.Conduct(lengths, 0.1)
        for realization, step, position, speed in snapshots:
            of.take(message(realization=realization, step=step, position=position, speed=speed))
        return of.document()

    def test_collisions_are_gaps_below_0_and_are_remembered(self):
        apart, touching = [20.0, 10.0, 0.0], [20.0, 16.1, 12.1]
        self.assertEqual(self.taken((0, 1, apart, [5.0] * 3))["colliding"], [])
        now = self.taken((0, 1, touching, [5.0] * 3))
        self.assertEqual((now["colliding"], now["collided"], now["possible"]), ([1], 1, False))
        later = self.taken((0, 1, touching, [5.0] * 3), (0, 2, apart, [5.0] * 3))
        self.assertEqual((later["colliding"], later["collided"], later["possible"]), ([], 1, False))
        self.assertEqual(later["words"][:28], "1 follower overlapped earlie")
        self.assertEqual(self.taken((0, 1, touching, [5.0] * 3), lengths=(0.0,) * 3)["colliding"], [])

    def test_the_first_snapshot_is_news_whatever_the_cars_do(self):
        seen = conduct.Conduct([0.0, 0.0, 0.0, 0.0], 0.1)
        self.assertEqual([seen.take(snapshot(step)) for step in (0, 50, 100)], [True, False, False])

    def test_what_was_not_seen_is_not_denied(self):
        apart = [20.0, 10.0, 0.0]
        self.assertEqual(self.taken((0, 1, apart, [5.0] * 3))["words"], "no collision or reversing seen")

    def test_collisions_that_the_run_counts_are_known_though_no_snapshot_has_them(self):
        known = state.PlatoonState()
        changed = []
        known.changed = changed.append
        known.take_configuration(configuration())

        def conduct_with(collisions):
            changed.clear()
            known.take_overview(overview(realizations=9000, collisions=collisions), 0.0)
            self.assertIn("conduct", changed)
            return known.document()["conduct"]
        self.assertEqual(conduct_with([0, 0, 0])["words"], "no collision in 9000 realizations")
        known.take_snapshot(snapshot(3))
        self.assertEqual(conduct_with([0, 0, 0])["words"], "no collision in 9000 realizations; no reversing seen")
        now = conduct_with([45, 0, 0])
        self.assertEqual((now["words"], now["collided"], now["possible"]), ("a collision in 45 of 9000 realizations (follower 1)", 1, False))
        now = conduct_with([4, 5, 0])
        self.assertEqual((now["words"], now["collided"]), ("a collision in 5 of 9000 realizations (follower 2, the most)", 2))
        self.assertIn("Now: a collision in 5 of 9000", " ".join(table.table(known.document(), 24)))

    def test_a_follower_that_drives_backwards_reverses(self):
        apart = [20.0, 10.0, 0.0]
        self.assertEqual(self.taken((0, 1, apart, [0.0, -0.05, -0.2]))["reversing"], [2])
        self.assertIn("followers 1, 2 reverse", self.taken((0, 1, apart, [0.0, -1.0, -2.0]))["words"])

    def test_the_strongest_acceleration_is_over_the_time_between_two_snapshots(self):
        apart = [20.0, 10.0, 0.0]
        of = self.taken((0, 1, apart, [5.0] * 3), (0, 3, apart, [0.0, 4.5, 5.2]))  # the leader is no follower
        self.assertEqual(of["strongest"], {"acceleration": -2.5, "follower": 1, "step": 3})
        self.assertTrue(of["possible"])
        self.assertFalse(self.taken((0, 1, apart, [5.0] * 3), (0, 2, apart, [5.0, 5.0, 3.9]))["possible"])
        for other in ((1, 2), (0, 0), (0, 9)):  # another realization, an earlier step, a snapshot too late
            self.assertIsNone(self.taken((0, 1, apart, [5.0] * 3), (*other, apart, [0.0] * 3))["strongest"])

    def test_the_bounds_of_what_is_possible_are_those_of_the_warnings(self):
        apart = [20.0, 10.0, 0.0]
        for share, possible in ((0.99, True), (1.01, False)):
            braked = 5.0 - share * sp.model.HARDEST * 0.1
            self.assertEqual(self.taken((0, 1, apart, [5.0] * 3), (0, 2, apart, [5.0, 5.0, braked]))["possible"], possible)
            self.assertEqual(self.taken((0, 1, apart, [0.0, 0.0, share * sp.model.REVERSING]))["reversing"] == [], possible)
        self.assertEqual((sp.model.HARDEST, sp.model.REVERSING, sp.model.FASTEST_CAR), (10.0, -0.1, 60.0))

    def test_a_snapshot_has_accelerations_over_the_time_since_the_one_before(self):
        known = state.PlatoonState()
        known.take_configuration(configuration())
        for step, speed in ((3, [20.0] * 4), (5, [20.0, 20.5, 19.0, 20.0]), (11, [20.0] * 4)):
            now = snapshot(step)
            now.speed = speed
            known.take_snapshot(now)
            self.assertEqual(known.give("snapshot")["acceleration"], [0.0, 2.5, -5.0, 0.0] if step == 5 else [])

    def test_the_table_and_the_document_have_it(self):
        known = state.PlatoonState()
        known.take_configuration(configuration(vehicle_length=7.0))
        self.assertIsNone(known.document()["conduct"])
        known.take_overview(overview(), 0.0)
        known.take_snapshot(snapshot(3))
        self.assertEqual(known.document()["conduct"]["colliding"], [1, 2, 3])
        self.assertIn("Now: followers 1, 2, 3 overlap the vehicles ahead", table.table(known.document(), 24))
        known.take_configuration(configuration(vehicle_length=5.0))
        self.assertIsNone(known.document()["conduct"])


if __name__ == "__main__":
    unittest.main()
