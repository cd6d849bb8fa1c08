#!/usr/bin/python3
"""Control of an endless platoon from outside, in both hostings: snapshots, manoeuvres, change of headway."""

import csv
import json
import math
import os
import re
import signal
import subprocess
import unittest

import rosbag
import rospy
import rosservice
import stochastic_platoon as sp
from rosgraph_msgs.msg import Log
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from stochastic_platoon.msg import ErrorStatistics, Position, Progress, Snapshot

import live_platoon
from orders import FOLLOWERS, HEADWAY, NOISE_VARIANCE, Orders, setUpModule  # noqa: F401: unittest calls setUpModule


class Watched(Orders):
    def test_snapshots_are_what_the_topics_of_all_vehicles_carry(self):
        self.in_both(self.check_snapshots)

    def check_snapshots(self, hosting):
        snapshots = self.listen("snapshot", Snapshot)
        received_snapshots = self.listen("predecessor_snapshot", Snapshot)
        vehicle, link = self.listen("vehicle_7/position", Position), self.listen("vehicle_8/predecessor_position", Position)
        terminal = self.endless(hosting, rate=15)
        topics = (snapshots, received_snapshots, vehicle, link)
        live_platoon.wait_for(lambda: all(len(topic.messages) >= 70 for topic in topics), "seventy of each", 60)
        terminal.end()
        # By the platoon's time in steps, which goes on when a machine under load repeats the run.
        own, theirs, sent, received = ({round(message.header.stamp.to_sec() / 0.1): message for message in list(topic.messages)} for topic in topics)
        run = vehicle.messages[0].run
        both = sorted(set(own) & set(sent))
        self.assertGreater(len(both), 50)
        for step in both:
            message = own[step]
            self.assertEqual((message.run, message.realization), (run, 0))
            self.assertEqual((len(message.position), len(message.tracking_error)), (FOLLOWERS + 1, FOLLOWERS))
            self.assertEqual((message.position[7], message.step), (sent[step].position[0], sent[step].step))
            self.assertEqual(message.header.stamp, sent[step].header.stamp)
        for step in set(theirs) & set(received):
            self.assertEqual((theirs[step].position[7], theirs[step].step), (received[step].position[0], received[step].step))
            self.assertEqual((len(theirs[step].position), len(theirs[step].tracking_error)), (FOLLOWERS, 0))
        for step in [step for step in own if step - 1 in own and own[step - 1].step == own[step].step - 1]:
            now, before = own[step], own[step - 1].position
            for i in range(1, FOLLOWERS + 1):
                error = now.position[i - 1] - now.position[i] - HEADWAY * (now.position[i] - before[i])
                self.assertAlmostEqual(now.tracking_error[i - 1], error, 9)
                self.assertAlmostEqual(now.speed[i], (now.position[i] - before[i]) / 0.1, 9)
        noise = [theirs[step].position[i] - own[step].position[i] for step in set(own) & set(theirs) for i in range(FOLLOWERS)]
        variance = sum(value ** 2 for value in noise) / len(noise)
        self.assertLess(abs(variance / NOISE_VARIANCE - 1.0), 4.0 * (2.0 / len(noise)) ** 0.5)


class Manoeuvres(Orders):
    def test_the_leader_obeys_and_goes_back_to_its_profile(self):
        self.in_both(self.check_manoeuvres)

    def check_manoeuvres(self, hosting):
        snapshots = self.listen("snapshot", Snapshot)
        speed = rospy.Publisher("/platoon/leader/speed", Float64, queue_size=10)
        # Of 20 snapshots a second each is 2 steps after the one before: 5 steps, half a period of the sinusoid, may show no swing.
        terminal = self.endless(hosting, rate=40)

        def speeds():
            """Speeds of the leader [m/s] between the latest snapshots."""
            last = list(snapshots.messages)[-20:]
            return [(b.position[0] - a.position[0]) / (0.1 * (b.step - a.step)) for a, b in zip(last, last[1:]) if b.step > a.step]

        def speed_is(wanted):
            live_platoon.wait_for(lambda: speeds() and abs(speeds()[-1] - wanted) < 1e-3, "a speed of {} m/s".format(wanted), 60)

        speed_is(20.0)
        live_platoon.wait_for(lambda: speed.get_num_connections() > 0, "the leader to listen")
        for bad in (math.nan, math.inf, -1e6):
            speed.publish(bad)
        terminal.wait_for_text("leader/speed: leader speed: ", 60)
        terminal.wait_for_text("must be a finite number of magnitude 1000 at most [m/s]", 60)
        speed_is(20.0)
        speed.publish(25.0)
        speed_is(25.0)
        terminal.wait_for_text("averages are paused until its effect has decayed", 60)
        self.assertTrue(self.trigger("brake").success)
        speed_is(0.0)
        self.assertTrue(self.trigger("accelerate").success)
        speed_is(10.0)
        self.assertTrue(self.trigger("sinusoid").success)
        live_platoon.wait_for(lambda: len(speeds()) > 9 and min(speeds()) < 9.0 and max(speeds()) > 11.0, "the leader to swing about 10 m/s", 60)
        self.assertTrue(self.trigger("cruise").success)
        speed_is(20.0)
        terminal.wait_for_text("the leader drives by the model file again: averages go on in 10 s (100 steps)", 60)
        # A new attempt starts with the leader of the model file.
        self.assertTrue(self.trigger("brake").success)
        live_platoon.kill("/platoon/platoon" if hosting == "one_process" else "/platoon/vehicle_3")
        speed_is(20.0)

    def test_a_report_of_another_node_does_not_end_the_launch(self):
        settings = dict(followers=2, steps=20, realizations=300, seed=4)
        reports = self.listen("progress", Progress)
        reporter = rospy.Publisher("/platoon/progress", Progress, queue_size=10)
        self.addCleanup(reporter.unregister)
        terminal = self.launch(batch=10, rate=150, stall_timeout=0, **settings)
        now = reports.newest(lambda message: message.receiver == "monitor" and message.step >= 0, "the first steps")
        with live_platoon.held("/platoon/vehicle_2"):
            end = "/platoon/until_complete"
            live_platoon.wait_for(lambda: live_platoon.process_of(end), end)
            live_platoon.wait_for(lambda: reporter.get_num_connections() >= 4, "leader, monitor, until_complete and this node to listen")
            for _ in range(5):
                reporter.publish(Progress(receiver="monitor", run=now.run, attempt=now.attempt, first_realization=300, step=-2, finished=True))
        self.completed(terminal)
        self.assert_bits(**settings)

    def test_a_notice_of_the_channel_counts_where_vehicle_1_does_not_hear_its_predecessor(self):
        with open(live_platoon.shared("config", "two_ahead.yaml")) as file:
            model = re.sub("  - {signal: position, from: predecessor.*\n  - .*weight: 0.4, noise_variance: 0.05}",
                           "  - {signal: position, from: 2, weight: 1.0, noise_variance: 0.05, "
                           "channel: {loss: {probability: 0.1, on_loss: hold}}}", file.read())
        self.assertIn("weight: 1.0", model)
        reports, said = self.listen("progress", Progress), self.listen("/rosout", Log)
        # Paced, so that the leader still sends when the channel is back; the timeout would come later.
        self.endless("processes", model=self.write("behind.yaml", model), followers=3, rate=5, window=200, stall_timeout=60)
        reports.newest(lambda message: message.receiver == "monitor" and message.step >= 3, "the first steps")
        live_platoon.kill("/platoon/channel")
        live_platoon.wait_for(lambda: any(re.search(r"channel has missed messages of attempt \d+: attempt \d+ begins", message.msg)
                                          for message in list(said.messages)), "a new attempt", 30)

    def test_a_run_over_realizations_rejects_orders_with_an_explanation_and_keeps_its_bits(self):
        settings = dict(followers=3, steps=20, realizations=500, headway=3.2, seed=4)
        speed = rospy.Publisher("/platoon/leader/speed", Float64, queue_size=10)
        terminal = self.launch(batch=50, rate=100, stall_timeout=0, **settings)
        with live_platoon.held("/platoon/vehicle_3"):  # the run does not end meanwhile
            for service in ("brake", "accelerate", "sinusoid", "cruise"):
                answer = self.trigger(service)
                self.assertFalse(answer.success)
                self.assertIn("in a run of many realizations the leader drives by the model file", answer.message)
            live_platoon.wait_for(lambda: speed.get_num_connections() > 0, "the leader to listen")
            speed.publish(3.0)
            terminal.wait_for_text("leader/speed: rejected: in a run of many realizations", 60)
            answer = self.change(headway=2.4)
            self.assertFalse(answer.success)
            self.assertIn("steps: 20: must be 0 (an endless run", answer.message)
        self.completed(terminal)
        self.assert_bits(**settings)


class Changes(Orders):
    def test_a_shorter_headway_in_mid_run_lets_the_tail_swing(self):
        self.in_both(self.check_change)

    def check_change(self, hosting):
        snapshots, statistics = self.listen("snapshot", Snapshot), self.listen("error_statistics", ErrorStatistics)
        bag = self.path(hosting)
        terminal = self.endless(hosting, rate=0, burn_in="", seed=3, record=bag + ".bag", output=self.output + "/")
        enough = 4000 if live_platoon.SANITIZED else 8000

        def averaged(headway_is, run):
            live_platoon.wait_for(lambda: list(statistics.messages)[-1:] and statistics.messages[-1].step > enough,
                                  "averages over many steps", 300)
            configuration = json.loads(rospy.get_param("/platoon/configuration"))
            self.assertEqual(configuration["model"]["time_headway"], headway_is)
            self.assertEqual(rospy.get_param("/platoon/headway"), headway_is)
            return statistics.messages[-1], snapshots.newest(lambda message: message.run != run).run

        stable, first_run = averaged(3.2, None)
        for bad, words in ((dict(headway=0), "time_headway: 0: must be a finite number > 0"),
                           (dict(headway="inf"), "time_headway: inf: must be a finite number > 0"),
                           (dict(headway="fast"), "time_headway: fast: must be a finite number > 0"),
                           (dict(headway=float("nan")), "time_headway: nan: must be a finite number > 0"),
                           (dict(loss=float("-inf")), "channel/loss/probability: -inf: must be a number from 0 to below 1"),
                           (dict(headway=[2.4]), "headway: must be a number"),
                           (dict(headway=2.4, loss=""), "loss: empty: must be a number"),
                           (dict(hedway=2.4), "hedway: unknown key: allowed are headway, noise_variance, loss"),
                           (dict(noise_variance=-1), "noise_variance: -1: must be a finite number >= 0"),
                           (dict(loss=1.0), "channel/loss/probability: 1.0: must be a number from 0 to below 1")):
            answer = self.change(**bad)
            self.assertFalse(answer.success)
            self.assertIn(words, answer.message)
        connections = [topic.connections() for topic in (snapshots, statistics)]
        answer = self.change(headway=2.4)
        self.assertTrue(answer.success, answer.message)
        self.assertIn("run 2 begins, headway 2.4: its statistics start anew", answer.message)
        live_platoon.wait_for(lambda: snapshots.messages[-1].run != first_run, "the new run", 60)
        del statistics.messages[:]
        live_platoon.wait_for(lambda: statistics.messages, "its statistics")
        self.assertLess(statistics.messages[0].step, stable.step, "the statistics do not start anew")
        unstable, _ = averaged(2.4, first_run)
        # rospy would lose a topic that is withdrawn and advertised again.
        self.assertEqual([topic.connections() for topic in (snapshots, statistics)], connections)
        terminal.interrupt()
        live_platoon.wait_for(lambda: "not complete: the run is endless and was stopped" in terminal.text(), "the result")
        self.assertIn(self.output + "-run2: not complete: the run is endless and was stopped", terminal.text())
        self.assertGreater(unstable.variance[-1], 3.0 * stable.variance[-1])
        # Each run has its own folder.
        for folder, headway in ((self.output, 3.2), (self.output + "-run2", 2.4)):
            summary, loaded = live_platoon.summary_of(folder), sp.Results.load(folder)
            self.assertTrue(summary["time_average"])
            self.assertEqual((loaded.variance.shape, loaded.steps.shape), ((FOLLOWERS, 1), (1,)))
            self.assertEqual(summary["theory"]["string_stable"], headway == 3.2)
            # 2 FOLLOWERS scores; each average is worth thousands of independent errors.
            for score in summary["agreement"].values():
                if not live_platoon.SANITIZED:
                    self.assertLess(score, 5.0)
            with open(os.path.join(folder, "statistics.csv")) as file:
                self.assertEqual(len(list(csv.DictReader(file))), FOLLOWERS)
        # Each run has its own bag, recorded up to the end of the run.
        for suffix, headway, latest in (("", 3.2, stable), ("-run2", 2.4, unstable)):
            with rosbag.Bag(bag + suffix + ".bag.active") as recorded:
                first = next(recorded.read_messages("/platoon/error_statistics")).message
            self.assertEqual(first.theoretical_variance, latest.theoretical_variance, "statistics of another run")
            read = self.path(hosting + suffix + "-read")
            self.assertEqual(live_platoon.tool("bag_statistics", bag + suffix + ".bag.active", output=read).returncode, 0)
            summary = live_platoon.summary_of(read)
            self.assertEqual(summary["theory"]["string_stable"], headway == 3.2)
            if not live_platoon.SANITIZED:
                self.assertLess(summary["agreement"]["max_abs_z_variance"], 5.0)


    def test_a_confirmed_order_is_carried_out_even_if_the_node_that_accepted_it_is_killed(self):
        self.in_both(self.check_order_and_kill)

    def check_order_and_kill(self, hosting):
        reports = self.listen("progress", Progress)
        self.endless(hosting, followers=3, rate=200)
        nodes = ["platoon"] if hosting == "one_process" else ["monitor", "vehicle_0"]
        for number, victims in enumerate((nodes[:1], nodes, nodes[:1], nodes, nodes[:1])):
            before = reports.newest(lambda message: message.receiver == "monitor" and message.step >= 0, "steps").run
            processes = [live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/" + victim), victim) for victim in victims]
            headway = round(3.0 + 0.1 * number, 1)
            answer = self.change(headway=headway)
            for process in processes:
                os.kill(process, signal.SIGKILL)
            self.assertTrue(answer.success, answer.message)
            live_platoon.wait_for(lambda: any(message.receiver == "monitor" and message.run != before and message.step >= 0
                                              for message in list(reports.messages)[-20:]), "steps of the run with headway {}".format(headway), 60)
            document = json.loads(rospy.get_param("/platoon/configuration"))
            self.assertEqual((document["model"]["time_headway"], document["run"]["run_number"]), (headway, number + 2))
            del reports.messages[:-20]

    def test_an_order_before_the_one_before_has_begun_keeps_that_one(self):
        self.endless("processes", followers=3, rate=200)
        rospy.wait_for_service("/platoon/change_run", 60)
        subprocess.run(["rossrv", "show", rosservice.get_service_type("/platoon/change_run")], check=True, stdout=subprocess.DEVNULL)
        proxy = rospy.ServiceProxy("/platoon/change_run", Trigger, persistent=True)
        answers = []
        for values in ({"headway": 2.8}, {"noise_variance": 0.3}):
            rospy.set_param("/platoon/change_run", values)
            answers.append(proxy())
        self.assertEqual([answer.success for answer in answers], [True, True])

        def both():
            model = json.loads(rospy.get_param("/platoon/configuration"))["model"]
            return (model["time_headway"], model["noise_variance"]) == (2.8, 0.3)
        live_platoon.wait_for(both, "a run of both orders", 30)
        self.terminal.end()


if __name__ == "__main__":
    unittest.main()
