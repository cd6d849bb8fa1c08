#!/usr/bin/python3
"""A car with an Odometry interface, and a vehicle of another package, as external vehicles."""

import json
import os
import subprocess
import time
import unittest

import rosbag

import live_platoon
from external import ExternalTest, HERE, rows

LISTENER = r"""
import json, rospy, sys
from diagnostic_msgs.msg import DiagnosticArray
def heard(message):
    for status in message.status:
        # One write: each publisher's messages come in a thread of their own.
        sys.stdout.write(json.dumps({pair.key: pair.value for pair in status.values}) + "\n")
        sys.stdout.flush()
rospy.init_node("listener")
rospy.Subscriber("/diagnostics", DiagnosticArray, heard)
rospy.spin()
"""


class Car(ExternalTest):
    """A simulated car, in 8 s of wall time; with PLATOON_MINUTE=1 in the environment in real time, one minute."""

    STEPS = 600 if "PLATOON_MINUTE" in os.environ else 400
    SPEED = 5.0   # [m/s]
    START = 123.0  # [m] of the car, in the frame of its odometry
    HEADWAY = 3.2

    def recorded(self, bag, topic, steps=STEPS):
        """The position at each step, in order (one realization)."""
        with rosbag.Bag(bag) as opened:
            found = {message.step: message.position for _, message, _ in opened.read_messages(["/platoon/" + topic])}
        self.assertEqual(sorted(found), list(range(-1, steps)))
        return [found[step][0] for step in sorted(found)]

    def test_a_car_that_has_never_heard_of_positions_drives_as_vehicle_2_of_4(self):
        """Checks values that pass through the adapter, to the bit. The car's position at a step depends on scheduling."""
        period = 0.1 if "PLATOON_MINUTE" in os.environ else 0.02
        model = self.model_with(sample_period=period, noise_variance=0.0001,
                                leader="{{speed: [{{from_step: 0, value: {}}}]}}".format(self.SPEED))
        diagnostics, log, bag = map(self.path, ("diagnostics", "car", "run.bag"))
        with open(diagnostics, "w") as file:
            self.background("/usr/bin/python3", "-c", LISTENER, env=self.environment, stdout=file)
        # The run ends if the car passes one of these on.
        self.start("rostopic", "pub", "-r", "5", "/car/odom", "nav_msgs/Odometry", "pose: {pose: {position: {x: .nan}}}")
        live_platoon.wait_for(lambda: live_platoon.process_of("/listener", self.environment["ROS_MASTER_URI"]), "the listener")

        def said():
            with open(diagnostics) as file:
                found = [json.loads(line) for line in file.read().split("\n")[:-1]]  # without a line of which a part is written
            return [values for values in found if "largest latency [s]" in values]

        terminal = self.launch(followers=4, external=2, realizations=1, steps=self.STEPS, model=model,
                               rate=round(1.0 / period), stall_timeout=0, record=bag)
        self.start(os.path.join(HERE, "car.py"), log, "__ns:=/car")
        self.start(live_platoon.shared("src", "tools", "odometry_vehicle"), "_index:=2", "~odometry:=/car/odom",
                   "~reference:=/car/reference")
        live_platoon.wait_for(lambda: any(int(values["steps"]) > 0 for values in said()), "the first steps")
        with live_platoon.held("/odometry_vehicle", terminal.master):
            time.sleep(10.0 * period)
        self.assertEqual(self.completed(terminal)["positions_lost"], 0)
        measured = rows(self.output)
        self.assertEqual({vehicle for vehicle, step in measured if measured[vehicle, step][2] is None}, {2, 3, 4})
        before, own, received = (self.recorded(bag, topic) for topic in
                                 ("vehicle_1/position", "vehicle_2/position", "vehicle_2/predecessor_position"))
        self.check_what_passes(log, own, received)
        for k in range(self.STEPS):  # lists begin with step -1
            error = before[k + 1] - own[k + 1] - self.HEADWAY * (own[k + 1] - own[k])
            self.assertAlmostEqual(measured[2, k][0], error, 9)
        # The car follows a second later, plus its lag.
        self.assertGreater(own[-1], 0.3 * before[-1])
        self.assertLess(own[-1], before[-1])
        self.assertAlmostEqual(measured[1, self.STEPS - 1][0], 0.0, delta=0.2)
        last = said()[-1]
        self.assertTrue(0 < int(last["steps"]) <= self.STEPS + 1)
        self.assertGreater(float(last["largest latency [s]"]), 0.0)
        self.assertGreaterEqual(int(last["missed ticks"]), 9, "it was held for 10 periods")
        self.assertGreater(int(last["ignored odometry"]), 0)

    def test_its_place_in_the_frame_of_its_odometry_may_be_given(self):
        origin, steps, log, bag = 125.0, 100, self.path("car"), self.path("run.bag")
        model = self.model_with(sample_period=0.02, noise_variance=0.0001, leader="{{speed: [{{from_step: 0, value: {}}}]}}".format(self.SPEED))
        terminal = self.launch(followers=2, external=2, realizations=1, steps=steps, model=model, rate=50, stall_timeout=0, record=bag)
        self.start(os.path.join(HERE, "car.py"), log, "__ns:=/car")
        self.start(live_platoon.shared("src", "tools", "odometry_vehicle"), "_index:=2", "_origin:={}".format(origin), "~odometry:=/car/odom",
                   "~reference:=/car/reference")
        self.completed(terminal)
        own, received = (self.recorded(bag, topic, steps) for topic in ("vehicle_2/position", "vehicle_2/predecessor_position"))
        self.assertEqual(own[0], self.START - origin, "the car stands until it gets a reference")
        self.check_what_passes(log, own, received, origin)

    def check_what_passes(self, log, own, received, origin=START):
        """Checks that the platoon received positions that the car reported, in order, and the car references from the platoon."""
        with open(log) as file:
            lines = [line.split() for line in file.read().splitlines()]
        places = [float(x) - origin for word, x in lines if word == "at"]
        at = 0
        for step, position in enumerate(own, -1):
            while at < len(places) and places[at] != position:
                at += 1
            self.assertLess(at, len(places), "at step {} the car was said to be at {} m, where it has not been since".format(step, position))
        references = [float(x) for word, x in lines if word == "to"]
        self.assertGreater(len(references), 0)
        self.assertEqual(set(references) - {position + origin for position in received}, set())

    def test_a_batch_of_many_is_rejected_with_an_explanation(self):
        self.start(os.path.join(HERE, "car.py"), "__ns:=/car")
        log = self.path("said")
        with open(log, "w") as file:
            self.background(live_platoon.shared("src", "tools", "odometry_vehicle"), "_index:=2", "~odometry:=/car/odom", env=self.environment, stderr=file)
        self.launch(followers=2, external=2, realizations=30, batch=10, stall_timeout=0)

        def rejected():
            with open(log) as file:
                return "a message of 10 positions: must be one, as there is one car" in file.read()

        live_platoon.wait_for(rejected, "its words")


class OtherPackage(ExternalTest):
    def test_a_package_of_its_own_builds_against_the_devel_space_and_saturates(self):
        build = self.path("build")
        subprocess.run(["cmake", "-S", live_platoon.shared("launch", "examples", "saturated_follower"), "-B", build,
                        "-DPYTHON_EXECUTABLE=/usr/bin/python3"], env=self.environment, check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["make", "-C", build], env=self.environment, check=True, stdout=subprocess.DEVNULL)
        program = os.path.join(build, "devel", "lib", "saturated_follower", "saturated_follower")
        # Headway and standstill distance of the run, other than the constants of a follower.
        settings = dict(followers=3, steps=40, realizations=1000, headway=2.4, model=self.model_with(standstill_distance=5.0))
        means, variances = [], []
        for limit in ("1e9", "0.02"):
            node = self.start(program, "_index:=3", "_limit:=" + limit)
            if not variances:
                self.assert_keeps_the_contract(3, "--model", live_platoon.shared("config", "mixed.yaml"))  # it is a truck
            self.output = self.path(limit)
            self.run_to_the_end(external=3, output=self.output, **settings)
            means.append(rows(self.output)[3, 39][0])
            variances.append([rows(self.output)[vehicle, 39][1] for vehicle in (1, 2, 3)])
            node.terminate()
            node.wait()
        live_platoon.reference(self.folder, **settings)
        built_in = rows(self.path("reference"))
        for vehicle, own in enumerate(variances[0], 1):  # an actuator that never saturates
            self.assertAlmostEqual(own, built_in[vehicle, 39][1], 9)
        self.assertEqual(variances[1][:2], [built_in[vehicle, 39][1] for vehicle in (1, 2)])
        self.assertAlmostEqual(means[0], built_in[3, 39][0], 9)
        self.assertGreater(means[1], 10.0)    # it cannot keep up with an accelerating leader


if __name__ == "__main__":
    unittest.main()
