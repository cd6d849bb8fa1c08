#!/usr/bin/python3
"""Invalid messages on the platoon's topics are dropped, counted and reported, and never used; any node can read valid ones."""

import math
import re
import sys
import unittest

import genpy
import rospy
import rostest
from rosgraph_msgs.msg import Log
from stochastic_platoon.msg import ErrorStatistics, Position, Progress

import live_platoon
from forged_publisher import ForgedPublisher

STEPS = 20
BATCH = 10
REALIZATIONS = 1200
LAST_ATTEMPT = 2**32 - 1
END_OF_TIME = genpy.Time()
END_OF_TIME.secs = END_OF_TIME.nsecs = 2**32 - 1  # an invalid number of nanoseconds


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
        rospy.Subscriber("/platoon/progress", Progress, cls.receive_progress, queue_size=100000)
        nodes = ["vehicle_{}".format(i) for i in range(4)] + ["channel", "monitor"]
        cls.processes = {node: live_platoon.wait_for(lambda: live_platoon.process_of(node), node) for node in {cls.node(name) for name in nodes}}
        cls.send_as_a_second_publisher()
        cls.send_under_the_publishers_own_name()
        cls.summary = live_platoon.wait_for(lambda: live_platoon.completed_summary(cls.output), "the run to complete")

    @classmethod
    def receive_progress(cls, message):
        if message._connection_header["callerid"] != rospy.get_name():
            cls.progress.append(message)

    @classmethod
    def node(cls, name):
        """The node that hosts the component of this name."""
        return "/platoon/platoon" if rospy.get_param("~hosting") == "one_process" else "/platoon/" + name

    @classmethod
    def now(cls):
        """A progress report from the middle of a batch: step -1 and the reported step are certainly past."""
        return live_platoon.wait_for(
            lambda: next((p for p in cls.progress[-1:] if p.first_realization >= 100 and p.step >= 2), None), "the first batches")

    @classmethod
    def send_as_a_second_publisher(cls):
        """Sends messages that would be in turn, from a node that is not the topic's publisher."""
        topics = ["/platoon/vehicle_2/position", "/platoon/vehicle_2/predecessor_position"]
        publishers = [rospy.Publisher(topic, Position, queue_size=100) for topic in topics]
        reporter = rospy.Publisher("/platoon/progress", Progress, queue_size=100)
        live_platoon.wait_for(lambda: all(publisher.get_num_connections() for publisher in publishers + [reporter]), "subscribers")
        now = cls.now()
        cls.attempts = now.attempt
        for attempt in (now.attempt + 1, now.attempt + 1000000, LAST_ATTEMPT):
            for publisher in publishers:
                publisher.publish(message(now.run, attempt, 0, -1, [1.0] * BATCH))
                publisher.publish(message(now.run, attempt, now.first_realization, -1, [1.0] * BATCH))
            reporter.publish(Progress(receiver="monitor", run=now.run, attempt=attempt, step=-2))
        reporter.publish(Progress(receiver="monitor", run=now.run, attempt=now.attempt, first_realization=REALIZATIONS, step=-2))
        reporter.publish(Progress(receiver="no\x1b[2J one", run=now.run, attempt=now.attempt, step=2**62))

        def all_said():
            # Data of another vehicle.
            for position in cls.positions[-3:]:
                publishers[0].publish(position)
            reporter.publish(Progress(receiver="monitor", run=now.run, attempt=LAST_ATTEMPT, step=-2))
            reporter.publish(Progress(receiver="no\x1b[2J one", run=now.run, attempt=now.attempt, step=2**62))
            for forged in ("vehicle_2", "vehicle_3", "channel", "no\x1b[2J one"):
                reporter.publish(Progress(receiver=forged, run=now.run, attempt=now.attempt, step=-2, notice=Progress.MISSED))
            wanted = ["/platoon/vehicle_2/position has two publishers: {}, which counts in this run, and {}, whose messages are dropped".format(
                          cls.node("vehicle_2"), rospy.get_name()),
                      "/platoon/progress of monitor has two publishers: {}, which counts in this run, and {}, whose messages are dropped".format(
                          cls.node("monitor"), rospy.get_name()),
                      'progress: ignored a report from "no\\x1b[2J one": it is no receiver of this run',
                      'progress: ignored a notice of "vehicle_2" from the node {}, which is not the publisher of /platoon/vehicle_2/position'.format(
                          rospy.get_name())]
            return all(words in cls.said for words in wanted)

        live_platoon.wait_for(all_said, "the second publishers to be named")
        # The publishers keep running: if they ended, the master would update the nodes' lists of publishers and thereby end the
        # forged links.
        cls.second_publishers = publishers + [reporter]

    @classmethod
    def send_under_the_publishers_own_name(cls):
        """Sends messages that are invalid by their content alone."""
        publishers = [ForgedPublisher("/platoon/vehicle_2/position", Position, cls.node("vehicle_2"), cls.node("monitor")),
                      ForgedPublisher("/platoon/vehicle_2/predecessor_position", Position, cls.node("channel"), cls.node("vehicle_2"))]
        if rospy.get_param("~hosting") != "one_process":
            publishers.append(ForgedPublisher("/platoon/vehicle_2/position", Position, cls.node("vehicle_2"), cls.node("channel")))
        reporter = ForgedPublisher("/platoon/progress", Progress, cls.node("monitor"), cls.node("vehicle_0"))
        now = cls.now()
        for publisher in publishers:
            for attempt, first, step, size in [
                    (0, 0, STEPS + 7, BATCH),                         # a step out of turn
                    (0, 0, -1, BATCH),                                # a start that is not due
                    (0, 0, now.step, BATCH),                          # a duplicate
                    (0, 0, STEPS + 8, 3),                             # a wrong batch size and out of turn
                    (0, 0, -2, BATCH), (0, 0, -2**63, BATCH),         # steps that do not exist
                    (0, 0, 2**63 - 1, BATCH), (0, 2**63, now.step + 1, BATCH),
                    (0, 2**64 - 1 - now.first_realization, -1, BATCH),
                    (-1, 0, now.step + 1, BATCH),                     # an old attempt
                    (1, 0, now.step + 1, BATCH),                      # a future attempt, not from its start
                    (LAST_ATTEMPT - now.attempt, 0, 2**62, BATCH),
            ]:
                forged = message(now.run, max(now.attempt + attempt, 0), now.first_realization + first, step, [1.0] * size)
                forged.header.stamp = END_OF_TIME
                publisher.publish(forged)
            # In turn, as a new attempt at the first batch, but with invalid positions.
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, [1.0] * (BATCH + 1)))
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, []))
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, [math.nan] * BATCH))
            publisher.publish(message(now.run, now.attempt + 1, 0, -1, [math.inf] * BATCH))
            # A new attempt, but of another run.
            publisher.publish(message(now.run ^ 1, now.attempt + 1, 0, -1, [1.0] * BATCH))
            publisher.publish(message(0, now.attempt + 1, 0, -1, [1.0] * BATCH))
        for first, step in [(0, STEPS), (0, 2**63 - 1), (0, -3), (0, -2**63), (REALIZATIONS + 1, -2), (2**64 - 1, -2)]:
            reporter.publish(Progress(receiver="monitor", run=now.run, attempt=now.attempt, first_realization=first, step=step))
        reporter.publish(Progress(receiver="monitor", run=now.run, attempt=LAST_ATTEMPT, step=-2))
        reporter.publish(Progress(receiver="monitor", run=now.run ^ 1, attempt=now.attempt, first_realization=REALIZATIONS, step=-2))

        def all_counted():
            # Reports with the counts so far come at most once a second: each further foreign message triggers the next.
            publishers[0].publish(message(now.run, now.attempt, now.first_realization, STEPS + 7, [1.0] * BATCH))
            reporter.publish(Progress(receiver="monitor", run=now.run, attempt=now.attempt, step=-3))
            counts = [re.search(r"vehicle_2/position: .*so far (\d+) out of turn, (\d+) of wrong size, (\d+) not finite, (\d+) of another run", text)
                      for text in cls.said]
            cls.counted = [match.groups() for match in counts if match and "0" not in match.groups()]
            return cls.counted and any("beyond this run: attempt" in text for text in cls.said)

        live_platoon.wait_for(all_counted, "a report that counts all kinds")

    def test_foreign_messages_change_no_bit(self):
        self.assertEqual(live_platoon.statistics(self.output),
                         live_platoon.reference(self.output, followers=3, steps=STEPS, realizations=REALIZATIONS))
        self.assertEqual(self.summary["positions_lost"], 0)
        self.assertEqual(self.summary["attempts"], self.attempts, "a foreign message began an attempt")

    def test_no_node_has_come_to_harm(self):
        self.assertFalse([text for text in self.said if "starting over" in text])
        self.assertEqual({node: live_platoon.process_of(node) for node in self.processes}, self.processes)

    def test_they_are_reported(self):
        out_of_turn, wrong_size, not_finite, foreign_run = (int(count) for count in self.counted[-1])
        self.assertGreaterEqual(out_of_turn, 9)
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
            lambda: {message.step: message for message in self.statistics if message.realizations == REALIZATIONS}, "statistics")
        live_platoon.wait_for(lambda: len({m.step for m in self.statistics if m.realizations == REALIZATIONS}) == STEPS, "all steps")
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
