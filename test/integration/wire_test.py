#!/usr/bin/python3
"""What is wrong on the wire is dropped, counted and reported, and never used; what is right can be followed by anyone."""

import math
import re
import sys
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Log
from stochastic_platoon.msg import ErrorStatistics, Position, Progress

import live_platoon

STEPS = 20
BATCH = 10
REALIZATIONS = 1200


def message(run, attempt, first, step, position):
    return Position(run=run, attempt=attempt, first_realization=first, step=step, position=position)


class Wire(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.output = rospy.get_param("~output")
        cls.progress, cls.positions, cls.statistics, cls.said = [], [], [], []
        rospy.Subscriber("/rosout", Log, lambda message: cls.said.append(message.msg), queue_size=1000)
        rospy.Subscriber("/platoon/error_statistics", ErrorStatistics, cls.statistics.append, queue_size=10000)
        rospy.Subscriber("/platoon/vehicle_1/position", Position, cls.positions.append, queue_size=100000)
        rospy.Subscriber("/platoon/progress", Progress, cls.progress.append, queue_size=100000)
        cls.send_foreign_messages()
        cls.summary = live_platoon.wait_for(lambda: live_platoon.completed_summary(cls.output), "the run to complete")

    @classmethod
    def send_foreign_messages(cls):
        topics = ["/platoon/vehicle_2/position", "/platoon/vehicle_2/predecessor_position"]
        publishers = [rospy.Publisher(topic, Position, queue_size=100) for topic in topics]
        live_platoon.wait_for(lambda: all(publisher.get_num_connections() for publisher in publishers), "subscribers")
        # In the middle of a batch: then its step -1 and its present step are past for certain.
        now = live_platoon.wait_for(
            lambda: next((p for p in cls.progress[-1:] if p.first_realization >= 100 and p.step >= 2), None), "the first batches")
        cls.attempts = now.attempt
        for publisher in publishers:
            for step, size, value in [
                    (STEPS + 7, BATCH, 1.0),    # a step out of turn
                    (-1, BATCH, 1.0),           # a start that is not due
                    (now.step, BATCH, 1.0),     # a duplicate
                    (STEPS + 8, 3, 1.0),        # a wrong batch size and out of turn
            ]:
                publisher.publish(message(now.run, now.attempt, now.first_realization, step, [value] * size))
            # In turn by their names, as a new attempt at the first batch, but not to be used.
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, [1.0] * (BATCH + 1)))
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, []))
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, [math.nan] * BATCH))
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, [math.inf] * BATCH))
            # A new attempt by its name, but of another run.
            publisher.publish(message(now.run ^ 1, now.attempt + 1, 0, -1, [1.0] * BATCH))
            publisher.publish(message(0, now.attempt + 1, 0, -1, [1.0] * BATCH))

        def all_counted():
            # A report comes once a second at most, with the counts so far: one more foreign message brings the next.
            publishers[0].publish(message(now.run, now.attempt, now.first_realization, STEPS + 7, [1.0] * BATCH))
            counts = [re.search(r"vehicle_2/position: .*so far (\d+) out of turn, (\d+) of wrong size, (\d+) not finite, (\d+) of another run", text)
                      for text in cls.said]
            return [match.groups() for match in counts if match and "0" not in match.groups()]

        cls.counted = live_platoon.wait_for(all_counted, "a report that counts all kinds", 20)

    def test_foreign_messages_change_no_bit(self):
        self.assertEqual(live_platoon.statistics(self.output),
                         live_platoon.reference(self.output, followers=3, steps=STEPS, realizations=REALIZATIONS))
        self.assertEqual(self.summary["positions_lost"], 0)
        self.assertEqual(self.summary["attempts"], self.attempts, "a foreign message began an attempt")

    def test_they_are_reported(self):
        out_of_turn, wrong_size, not_finite, foreign_run = (int(count) for count in self.counted[-1])
        self.assertGreaterEqual(out_of_turn, 4)
        self.assertEqual((wrong_size, not_finite, foreign_run), (2, 2, 2))

    def test_the_stamps_are_platoon_time_and_never_go_back(self):
        period = 0.1
        stamps = [message.header.stamp.to_sec() for message in self.positions]
        self.assertGreater(len(stamps), 1000)
        self.assertEqual(stamps, sorted(stamps))
        for before, after in zip(self.positions, self.positions[1:]):
            if after.step == before.step + 1:
                self.assertAlmostEqual((after.header.stamp - before.header.stamp).to_sec(), period, 9)

    def test_the_last_statistics_on_the_topic_are_those_of_the_file(self):
        final = live_platoon.wait_for(
            lambda: {message.step: message for message in self.statistics if message.realizations == REALIZATIONS}, "statistics", 10)
        live_platoon.wait_for(lambda: len({m.step for m in self.statistics if m.realizations == REALIZATIONS}) == STEPS, "all steps", 10)
        final = {message.step: message for message in self.statistics if message.realizations == REALIZATIONS}
        for line in live_platoon.statistics(self.output).decode().splitlines()[1:]:
            vehicle, step, _, mean, variance, theoretical_mean, theoretical_variance = line.split(",")
            message = final[int(step)]
            self.assertFalse(message.time_average)
            self.assertEqual(message.mean[int(vehicle) - 1], float(mean))
            self.assertEqual(message.variance[int(vehicle) - 1], float(variance))
            self.assertEqual(message.theoretical_mean[int(vehicle) - 1], float(theoretical_mean))
            self.assertEqual(message.theoretical_variance[int(vehicle) - 1], float(theoretical_variance))


if __name__ == "__main__":
    rospy.init_node("wire_test")
    rostest.rosrun("stochastic_platoon", rospy.get_param("~name"), Wire, sys.argv)
