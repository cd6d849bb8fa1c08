#!/usr/bin/python3
"""Recorded drives that vehicle 0 follows, with exact means, and recorded losses of a link: equal to the bit in every
hosting."""

import collections
import csv
import json
import math
import os
import pathlib
import unittest

import numpy as np
import rosbag
import rospy
import yaml
from geometry_msgs.msg import PointStamped, TwistStamped
from nav_msgs.msg import Odometry

import link_reference
import live_platoon
from terminal import LaunchTest
from user_tools_test import script

FOLLOWERS, STEPS, REALIZATIONS = 3, 400, 500
SETTINGS = dict(followers=FOLLOWERS, steps=STEPS, realizations=REALIZATIONS)
SIGNALS = "speed,acceleration,jerk"


class Recorded(LaunchTest):
    def leader_of(self, folder):
        """y_0(0), y_0(1), ... of a realization."""
        trajectory = self.monte_carlo("trajectory", "--trajectories", repeat=os.path.join(folder, "summary.json"), only=0)
        with open(os.path.join(trajectory, "trajectories.csv")) as file:
            return np.array([float(row["position"]) for row in csv.DictReader(file) if row["vehicle"] == "0" and int(row["step"]) >= 0])

    def test_vehicle_0_drives_like_a_shipped_table_in_the_graph_and_in_process(self):
        settings = dict(SETTINGS, signals=SIGNALS, burn_in=50)
        folder = self.monte_carlo("monte_carlo", leader="city.csv", **settings)
        table = np.genfromtxt(live_platoon.shared("config", "leaders", "city.csv"), delimiter=",", names=True)
        speed = np.interp(0.1 * np.arange(STEPS), table["time"], table["speed"])
        driven = np.concatenate([[0.0], np.cumsum(0.05 * (speed[1:] + speed[:-1]))])
        np.testing.assert_allclose(self.leader_of(folder), driven, atol=1e-9)
        agreement = live_platoon.summary_of(folder)["agreement"]
        self.assertTrue(1 < agreement["max_abs_z_mean"] < 5.5, agreement)
        self.run_to_the_end(leader="city.csv", **settings)
        self.assertEqual(live_platoon.statistics(self.output), live_platoon.statistics(folder))
        for name in ("signals.csv", "amplification.csv"):
            with open(os.path.join(self.output, name)) as live, open(os.path.join(folder, name)) as own:
                self.assertEqual(live.read(), own.read(), name)

    def test_a_table_lasts_as_long_as_the_run_and_may_have_any_columns_and_units(self):
        self.write("lap.csv", "recorded by hand\nTime;Speed1\n" + "".join("%.12g;%.12g\n" % (100 + 0.5 * k, 36 + 3.6 * math.sin(k)) for k in range(61)))
        model = self.model_with(leader=dict(file="lap.csv", time="Time", speed="Speed1", unit="km/h", skip_rows=1, from_second=5.0))
        folder = self.monte_carlo("run", model=model, followers=2, realizations=10)
        self.assertEqual(live_platoon.summary_of(folder)["steps"], 251, "25 s of the table are left")
        rows = 0.5 * np.arange(61)
        speed = np.interp(5.0 + 0.1 * np.arange(251), rows, [10 + math.sin(k) for k in range(61)])
        np.testing.assert_allclose(np.diff(self.leader_of(folder)), 0.05 * (speed[1:] + speed[:-1]), atol=1e-9)

    def test_the_speed_of_a_car_in_a_bag_becomes_a_table(self):
        bag_file, table = self.path("car.bag"), self.path("drive.csv")
        with rosbag.Bag(bag_file, "w") as bag:
            for k in range(241):
                odometry = Odometry()
                odometry.header.stamp = rospy.Time(1700000000) + rospy.Duration(0.05 * k)
                odometry.twist.twist.linear.x, odometry.twist.twist.linear.y = 0.03 * k, -0.04 * k
                bag.write("/odom", odometry, odometry.header.stamp)
                bag.write("/gps", TwistStamped(header=odometry.header), odometry.header.stamp)
        self.assertIn("--topic: missing: must name one of the bag's: /gps, /odom", self.recorded_drive(bag_file, table).stderr)
        self.assertIn("/nowhere: must be a bag, a regular file that can be read", self.recorded_drive("/nowhere", table).stderr)
        self.assertIn("--topic: /x: must be one of the bag's: /gps, /odom", self.recorded_drive(bag_file, table, "--topic", "/x").stderr)
        self.assertEqual(self.recorded_drive(bag_file, table, "--topic", "/odom").returncode, 0)
        again = self.recorded_drive(bag_file, table, "--topic", "/gps")
        self.assertNotEqual(again.returncode, 0, "the table is not overwritten")
        self.assertIn("File exists", again.stderr)
        self.assertIn("recorded_drive: --output: {}: ".format(table), again.stderr)
        folder = self.monte_carlo("car", leader=table, followers=2, realizations=10)
        np.testing.assert_allclose(self.leader_of(folder), 0.5 * (0.1 * np.arange(121)) ** 2, atol=1e-6)

    def test_the_only_topic_of_a_bag_is_read_by_default(self):
        with rosbag.Bag(self.path("gps.bag"), "w") as bag:
            for k in range(3):
                message = TwistStamped()
                message.header.stamp = rospy.Time(1700000000) + rospy.Duration(0.5 * k)
                message.twist.linear.x, message.twist.linear.y, message.twist.linear.z = 3.0 * k, -4.0 * k, 100.0
                bag.write("/gps", message, message.header.stamp)
                bag.write("/point", PointStamped(header=message.header), message.header.stamp)
        done = self.recorded_drive(self.path("gps.bag"), self.path("drive.csv"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, "{}: 3 rows, 1.0 s, up to 10.0 m/s\n".format(self.path("drive.csv")))
        with open(self.path("drive.csv")) as file:
            self.assertEqual(file.read(), "time,speed\n0,0\n0.5,5\n1,10\n")

    def test_a_full_disk_leaves_no_table(self):
        bag, table = self.gps_bag([0.1 * k for k in range(8000)]), self.path("drive.csv")
        done = self.recorded_drive(bag, table, largest=50000)  # the messages' own classes need files, too
        self.assertEqual((done.returncode, done.stderr), (1, "recorded_drive: --output: {}: cannot be written: File too large\n".format(table)))
        self.assertEqual(os.listdir(self.folder), ["gps.bag"])
        self.assertEqual(self.recorded_drive(bag, table).returncode, 0)

    def test_a_gap_that_a_leader_cannot_drive_over_is_rejected(self):
        table = self.path("drive.csv")
        done = self.recorded_drive(self.gps_bag([0.0, 0.5, 3.5, 4.0]), table)
        self.assertEqual(done.returncode, 1)
        self.assertIn("/gps, message 3: stamp: 1700000003.5 s, 3 s after that of the message before, at 0.5 s of the drive: must be at most "
                      "1 s after it", done.stderr)
        self.assertFalse(os.path.exists(table))
        self.assertEqual(self.recorded_drive(self.gps_bag([0.0, 1.0, 1.5, 2.5]), table).returncode, 0)
        self.monte_carlo("driven", leader=table, followers=1, realizations=1)

    def test_a_damaged_definition_of_a_message_is_named_with_its_bag(self):
        bag = self.path("car.bag")
        with rosbag.Bag(bag, "w") as opened:
            for k in range(3):
                opened.write("/odom", Odometry(), rospy.Time(1700000000 + k))
        content = pathlib.Path(bag).read_bytes()
        for right, wrong in ((b"\nHeader header", b"\nHeader hdader"), (b"\nHeader header", b"\nHeadev header")):
            self.assertIn(right, content)
            pathlib.Path(bag).write_bytes(content.replace(right, wrong))
            done = self.recorded_drive(bag, self.path("drive.csv"))
            self.assertEqual(done.returncode, 1)
            self.assertNotIn("Traceback", done.stderr)
            self.assertIn("recorded_drive: {}: is damaged, or ".format(bag), done.stderr.splitlines()[-1])

    def gps_bag(self, seconds):
        """A bag of 0.5 m/s at these seconds after its first message."""
        with rosbag.Bag(self.path("gps.bag"), "w") as bag:
            for second in seconds:
                message = TwistStamped()
                message.header.stamp = rospy.Time(1700000000) + rospy.Duration(second)
                message.twist.linear.x = 0.5
                bag.write("/gps", message, message.header.stamp)
        return self.path("gps.bag")

    def recorded_drive(self, bag, table, *options, **limits):
        return script("recorded_drive", bag, "--output", table, *options, **limits)

    def test_bad_tables_are_named(self):
        for text, reason in (("time,velocity\n0,1\n1,1\n", "no column speed: must be one of time, velocity"),
                             ("time,speed\n0,1\n3,1\n", "row 3: 3 s after the row before: must be at most 1 s")):
            done = live_platoon.tool("monte_carlo", output=self.path("none"), leader=self.write("bad.csv", text))
            self.assertEqual(done.returncode, 1)
            self.assertIn("leader/file: {}: {}".format(self.path("bad.csv"), reason), done.stderr)
        for leader, reason in ((dict(file="bad.csv", unit="knots"), "leader/unit: knots: must be km/h or m/s or mph"),
                               (dict(file="bad.csv", speed="v", position="x"), "leader/speed: given: must be absent beside position")):
            done = live_platoon.tool("monte_carlo", output=self.path("none"), model=self.model_with(leader=leader))
            self.assertIn(reason, done.stderr)

    TRACE = [1, 1, 0, 1, 0, 0, 1, 1, 1, 0, 1, 1, 0, 0, 0, 1, 1]

    def trace(self, name, entries):
        self.write(name, "second,received\n" + "".join("%.1f,%d\n" % (0.1 * k, entry) for k, entry in enumerate(entries)))

    def measured(self, folder):
        with open(os.path.join(folder, "statistics.csv")) as file:
            return [row[:5] for row in csv.reader(file)]

    def positions_of(self, trajectory):
        """y_i(-1), y_i(0), ... by vehicle."""
        with open(os.path.join(trajectory, "trajectories.csv")) as file:
            rows = list(csv.DictReader(file))
        return [np.array([float(row["position"]) for row in rows if row["vehicle"] == str(i)]) for i in range(3)]

    def test_every_link_and_realization_loses_what_the_trace_has_from_an_offset_of_its_own(self):
        self.trace("log.csv", self.TRACE)
        loss = {"trace": "log.csv", "on_loss": "hold"}
        leader = {"speed": [{"from_step": k, "value": 10.0 + 7.0 * math.sin(k)} for k in range(60)]}
        model = self.model_with(channel={"loss": loss}, noise_variance=0.0, leader=leader)
        with open(model) as file:
            vehicle = link_reference.vehicles_of(dict(yaml.safe_load(file), string=["default"]), 1)[0]
        a, b, c, _ = link_reference.state_space(*link_reference.polynomials_of(vehicle))
        offsets = set()
        for realization in range(4):
            folder = self.monte_carlo("only-%d" % realization, "--trajectories", model=model, followers=2, steps=60, realizations=4, only=realization)
            positions = self.positions_of(folder)
            for i in (1, 2):
                sent, fitting = positions[i - 1], []
                for offset in range(len(self.TRACE)):
                    state, held, own = np.zeros(len(b)), sent[0], []
                    for k, position in enumerate(sent):
                        own.append(c @ state)
                        # The first entry, k = 0, is step -1, at which nothing is lost.
                        held = position if k == 0 or self.TRACE[(offset + k - 1) % len(self.TRACE)] else held
                        state = a @ state + b * held
                    fitting += [offset] if np.abs(own - positions[i]).max() < 1e-9 else []
                self.assertEqual(len(fitting), 1, "vehicle {}, realization {}".format(i, realization))
                offsets.update(fitting)
        self.assertGreater(len(offsets), 3)

    def test_recorded_losses_have_the_same_bits_in_the_graph_and_none_has_those_of_no_loss(self):
        self.trace("log.csv", self.TRACE)
        self.trace("ones.csv", [1] * 17)
        settings = dict(followers=3, steps=60, realizations=3000)
        plain = self.monte_carlo("plain", **settings)
        ones = self.monte_carlo("ones", model=self.model_with(channel={"loss": {"trace": "ones.csv"}}), **settings)
        self.assertEqual(live_platoon.statistics(ones), live_platoon.statistics(plain))
        model = self.model_with(channel={"loss": {"trace": "log.csv"}})
        lossy = self.monte_carlo("lossy", model=model, **settings)
        self.assertNotEqual(live_platoon.statistics(lossy), live_platoon.statistics(plain))
        self.run_to_the_end(model=model, **settings)
        self.assertEqual(live_platoon.statistics(self.output), live_platoon.statistics(lossy))
        with open(os.path.join(self.output, "ages.csv")) as live, open(os.path.join(lossy, "ages.csv")) as own:
            self.assertEqual(live.read(), own.read())

    def test_ages_are_counted_as_the_links_of_the_run_lose(self):
        model = self.model_with(channel={"loss": {"probability": 0.4, "mean_burst": 2.5}})
        settings = dict(model=model, followers=2, steps=60, realizations=6)
        with open(os.path.join(self.monte_carlo("all", **settings), "ages.csv")) as file:
            rows = [(int(row["vehicle"]), int(row["age"]), int(row["count"])) for row in csv.DictReader(file)]
        counted = collections.Counter()
        for realization in range(6):
            folder = self.monte_carlo("of-%d" % realization, "--trajectories", only=realization, **settings)
            with open(os.path.join(folder, "trajectories.csv")) as file:
                of = {(int(row["vehicle"]), int(row["step"])): row for row in csv.DictReader(file)}
            for i in (1, 2):
                age = 0
                for k in range(59):  # noise makes every arrival another value
                    age = age + 1 if of[i, k]["received_position"] == of[i, k - 1]["received_position"] else 0
                    counted[i, age] += 1
        self.assertEqual({(i, age): count for i, age, count in rows if count > 0}, dict(counted))

    def test_shares_of_ages_are_counts_over_their_sum_and_have_a_theory_unless_losses_are_recorded(self):
        self.trace("log.csv", self.TRACE)
        p, steps, realizations = 0.3, 59, 600  # the messages of the last step move no vehicle
        for name, loss in (("independent", {"probability": p}), ("trace", {"trace": "log.csv"})):
            folder = self.monte_carlo(name, model=self.model_with(channel={"loss": loss}), followers=2, steps=60, realizations=realizations)
            with open(os.path.join(folder, "ages.csv")) as file:
                rows = list(csv.DictReader(file))
            self.assertEqual({row["vehicle"] for row in rows}, {"1", "2"})
            for vehicle in ("1", "2"):
                self.assertEqual(sum(int(row["count"]) for row in rows if row["vehicle"] == vehicle), steps * realizations)
            for row in rows:
                self.assertAlmostEqual(float(row["share"]), int(row["count"]) / (steps * realizations), places=15)
                if name == "trace":
                    self.assertEqual(row["theoretical_share"], "")
                    continue
                age = int(row["age"])
                # An arrival `age` steps ago and losses since, or at the step number age - 1 losses from the first step on.
                theory = ((1 - p) * p ** age * (steps - age) + (p ** age if age > 0 else 0.0)) / steps
                self.assertAlmostEqual(float(row["theoretical_share"]) / theory, 1.0, places=12)
                if age == 0:
                    self.assertAlmostEqual(float(row["theoretical_share"]), 1 - p, places=15)
                    self.assertLess(abs(float(row["share"]) - (1 - p)), 5.0 * math.sqrt(p * (1 - p) / (steps * realizations)))

    # Below a gap of 2.5 m every position is lost (but for a probability of 1e-12), beyond it none: the gap one step earlier decides.
    def test_losses_follow_from_the_gap_of_the_step_before(self):
        leader = {"speed": [{"from_step": k, "value": 8.0 + 8.0 * math.sin(0.1 * k)} for k in range(120)]}
        table = [[2.5, 1.0 - 1e-12], [2.5 + 1e-9, 0.0]]
        model = self.model_with(channel={"loss": {"by_distance": table, "on_loss": "hold"}}, noise_variance=0.0, leader=leader,
                                standstill_distance=1.0, vehicle_length=1.7)
        with open(model) as file:
            vehicle = link_reference.vehicles_of(dict(yaml.safe_load(file), string=["default"], channel={}), 1)[0]
        a, b, c, _ = link_reference.state_space(*link_reference.polynomials_of(vehicle))
        folder = self.monte_carlo("gap", "--trajectories", model=model, followers=2, steps=120, realizations=4, only=2)
        positions = self.positions_of(folder)
        for i in (1, 2):
            place, state, held, losses = -1.0 * i, np.zeros(len(b)), 0.0, 0  # held: relative to its place
            for k, position in enumerate(positions[i - 1]):
                self.assertAlmostEqual(c @ state, positions[i][k] - place, delta=1e-9)
                lost = k > 0 and positions[i - 1][k - 1] - positions[i][k - 1] - 1.7 < 2.5
                held = held if lost else position - (place + 1.0)
                losses += lost
                state = a @ state + b * held
            self.assertTrue(10 < losses < 110, losses)

    def test_losses_by_distance_have_the_same_bits_in_the_graph_and_those_of_one_probability_where_it_is_constant(self):
        settings = dict(followers=3, steps=60, realizations=3000)
        for name, loss in (("one", {"probability": 0.1}), ("constant", {"by_distance": [[20.0, 0.1]]})):
            self.monte_carlo(name, model=self.model_with(channel={"loss": loss}), **settings)
        one, constant = (self.measured(self.path(name)) for name in ("one", "constant"))
        self.assertEqual(constant, one)
        loss = {"by_distance": [[2.0, 0.02], [8.0, 0.6]]}
        model = self.model_with(channel={"loss": loss})
        reference = self.monte_carlo("by_distance", model=model, **settings)
        self.assertNotEqual(self.measured(reference), one)
        for hosting in ("processes", "one_process"):
            self.run_to_the_end(model=model, output=self.path(hosting), hosting=hosting, **settings)
            self.assertEqual(live_platoon.statistics(self.path(hosting)), live_platoon.statistics(reference))

    def test_a_radio_loses_by_distance_with_the_same_bits_in_the_graph(self):
        loss = {"by_distance": [[0.2, 0.02], [0.6, 0.6]]}
        radio = {"signal": "input", "from": "predecessor", "noise_variance": 0.01, "channel": {"delay": 2, "loss": loss}}
        radar = {"signal": "position", "from": "predecessor", "noise_variance": 0.01, "channel": {"loss": loss}}
        with open(live_platoon.shared("config", "cacc.yaml")) as file:
            model = self.write("radio.yaml", json.dumps(dict(yaml.safe_load(file), inputs=[radar, radio])))
        settings = dict(followers=3, steps=60, realizations=1000)
        reference = self.monte_carlo("radio", model=model, **settings)
        self.run_to_the_end(model=model, **settings)
        self.assertEqual(live_platoon.statistics(self.output), live_platoon.statistics(reference))


if __name__ == "__main__":
    unittest.main()
