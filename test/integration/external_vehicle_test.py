#!/usr/bin/python3
"""External vehicles in the string: the examples, the conformance test check_vehicle, and violations of the vehicle contract."""

import csv
import json
import math
import os
import re
import shutil
import signal
import subprocess
import tempfile
import unittest

import rosbag

import live_platoon
from terminal import LaunchTest, start_master

HERE = os.path.dirname(os.path.abspath(__file__))
CLAUSES = ("one_publisher", "answer", "size", "finite", "stamp", "turn", "attempt", "start_anew", "causal", "queues", "run",
           "spacing")


def rows(output):
    """statistics.csv as {(vehicle, step): [mean, variance, theoretical mean, theoretical variance]}; empty cells are None."""
    with open(os.path.join(output, "statistics.csv")) as file:
        return {(int(row["vehicle"]), int(row["step"])):
                [float(row[name]) if row[name] else None
                 for name in ("mean", "variance", "theoretical_mean", "theoretical_variance")] for row in csv.DictReader(file)}


class ExternalTest(LaunchTest):
    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.home, ignore_errors=True)
        core, cls.master = start_master(cls.home)
        cls.addClassCleanup(core.wait)
        cls.addClassCleanup(core.terminate)

    def setUp(self):
        super().setUp()
        self.environment = dict(os.environ, ROS_MASTER_URI=self.master, ROS_HOSTNAME="localhost", ROS_HOME=self.folder)

    def start(self, *command):
        """Starts an external vehicle."""
        process = subprocess.Popen(command, env=self.environment)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        return process

    def start_example(self, index):
        return self.start(live_platoon.shared("launch", "examples", "rospy_follower.py"), str(index))

    def check_vehicle(self, index, *options):
        return subprocess.run([live_platoon.executable("check_vehicle"), str(index)] + list(options), env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=100)

    def assert_keeps_the_contract(self, index, *options):
        done = self.check_vehicle(index, *options)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(re.findall(r"^ ?(\d+) holds ", done.stdout, re.M), [str(n + 1) for n in range(len(CLAUSES))])
        self.assertIn("vehicle_{} keeps the vehicle contract".format(index), done.stdout)

    def assert_broken(self, clause, index, *options):
        number = CLAUSES.index(clause) + 1
        done = self.check_vehicle(index, "--patience", "1", *options)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertEqual(re.findall(r"^ ?(\d+) BROKEN ", done.stdout, re.M), [str(number)], done.stdout)
        self.assertIn("breaks clause {} of the vehicle contract: ".format(number), done.stdout)
        return done.stdout

    def run_to_the_end(self, **arguments):
        terminal = self.launch(master=self.master, **arguments)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(self.output), terminal.text())
        return terminal


class Example(ExternalTest):
    SETTINGS = dict(followers=4, steps=50, realizations=2500, batch=1000)

    def assert_equal_within_rounding(self):
        folder = os.path.join(self.output, "reference")
        live_platoon.reference(self.output, **{name: value for name, value in self.SETTINGS.items() if name != "batch"})
        measured, expected = rows(self.output), rows(folder)
        self.assertEqual(measured.keys(), expected.keys())
        for cell, (mean, variance, *_) in expected.items():
            # Positions reach 100 m, where the last bit is 1.4e-14 m; errors are about 0.1 m.
            self.assertLess(abs(measured[cell][0] - mean), 1e-11, cell)
            self.assertLess(abs(measured[cell][1] - variance), 1e-11, cell)

    def test_the_rospy_follower_is_the_built_in_vehicle_within_rounding(self):
        bag = os.path.join(self.folder, "run.bag")
        terminal = self.launch(master=self.master, external=2, record=bag, **self.SETTINGS)
        terminal.wait_for_text("waiting for external vehicle_2: start its node")
        self.start_example(2)
        terminal.wait()
        summary = live_platoon.completed_summary(self.output)
        self.assertTrue(summary, terminal.text())
        self.assert_equal_within_rounding()
        self.check_that_theory_speaks_of_vehicle_1_alone(summary, terminal.text())
        self.check_what_reads_the_results(bag)
        self.check_replay(bag)

    def test_the_rospy_follower_with_a_radio_is_the_built_in_vehicle_within_rounding(self):
        model = live_platoon.shared("config", "cacc.yaml")
        self.SETTINGS = dict(self.SETTINGS, model=model)
        self.start(live_platoon.shared("launch", "examples", "rospy_radio_follower.py"), "2")
        self.assert_keeps_the_contract(2, "--model", model)
        self.run_to_the_end(external=2, **self.SETTINGS)
        self.assert_equal_within_rounding()

    def check_that_theory_speaks_of_vehicle_1_alone(self, summary, said):
        for (vehicle, _), (_, _, mean, variance) in rows(self.output).items():
            self.assertEqual((mean is None, variance is None), (vehicle > 1, vehicle > 1))
        self.assertEqual([value is None for value in summary["theory"]["stationary_variance"]], [False, True, True, True])
        self.assertIs(summary["theory"]["string_stable"], True)
        self.assertIsNone(summary["theory"]["limit_variance"])
        self.assertLess(summary["agreement"]["max_abs_z_variance"], 5.0)
        self.assertIn("over all 50 (i, k)", said)
        self.assertIn("this speaks of follower 1, before vehicle_2, which is external", said)

    def check_what_reads_the_results(self, bag):
        with open(os.path.join(self.output, "statistics.csv")) as file:
            measured = file.read()
        csv_of_bag = subprocess.run([live_platoon.executable("bag_statistics"), bag, "--csv"], stdout=subprocess.PIPE,
                                    universal_newlines=True, check=True).stdout
        self.assertEqual(csv_of_bag, measured)
        figure = os.path.join(self.folder, "errors")
        plot = os.path.join(live_platoon.shared("src", "tools"), "plot")
        subprocess.run([plot, "errors", self.output, "--output", figure], check=True, stdout=subprocess.DEVNULL)
        self.assertGreater(os.path.getsize(figure + ".png"), 10000)

    def check_replay(self, bag):
        # Replays its input to the same node; no other vehicle runs.
        terminal = self.launch("replay.launch", master=self.master, bag=bag, drive="vehicle_2", external=2, output="")
        terminal.wait()
        self.assertIn("vehicle_2: 153 messages equal the recorded ones to the bit", terminal.text())
        # The other vehicle was recorded from the built-in implementation.
        self.start_example(3)
        terminal = self.launch("replay.launch", master=self.master, bag=bag, drive="vehicle_3", external=3, output="")
        terminal.wait()
        apart = re.search(r"vehicle_3: 153 messages as in the recording, positions at most (\S+) m apart", terminal.text())
        self.assertTrue(apart, terminal.text())
        self.assertLess(float(apart.group(1)), 1e-11)

    def test_it_stays_up_from_run_to_run_and_goes_with_one_process(self):
        self.start_example(3)
        self.assert_keeps_the_contract(3, "--headway", "2.4", "--model", live_platoon.shared("config", "mixed.yaml"))
        rejected = self.launch(master=self.master, **self.SETTINGS)
        self.assertNotEqual(rejected.wait(), 0)
        self.assertIn("/platoon/vehicle_3/position: node /vehicle_3 publishes it already: must be outside first:= .. last:=, or in external:=",
                      rejected.text())
        self.run_to_the_end(external=3, hosting="one_process", **self.SETTINGS)
        self.assert_equal_within_rounding()

    def test_the_built_in_vehicle_keeps_it(self):
        follower = self.start(live_platoon.executable("follower"), "_index:=2", "__ns:=/platoon", "__name:=vehicle_2")
        self.assert_keeps_the_contract(2)
        # Unlike SIGTERM, SIGINT lets it unregister. Otherwise the master would keep its address, which a vehicle_2 of another
        # master may then use.
        follower.send_signal(signal.SIGINT)
        follower.wait()


class Contract(ExternalTest):
    def test_the_page_has_the_words_of_the_programs(self):
        with open(live_platoon.shared("msg", "README.md")) as file:
            page = re.findall(r"^\| (\d+) \| (.*?) \|", file.read(), re.M)
        self.start_example(3)
        said = re.findall(r"^ ?(\d+) holds +(.*)$", self.check_vehicle(3).stdout, re.M)
        self.assertEqual(len(said), len(CLAUSES))
        self.assertEqual(page, said)

    def test_each_broken_vehicle_fails_at_its_clause(self):
        faults = [clause for clause in CLAUSES if clause != "one_publisher"] + ["foreign", "twice", "place"]
        self.start(os.path.join(HERE, "broken_follower.py"), *["{}:{}".format(i + 1, fault) for i, fault in enumerate(faults)])
        for i, fault in enumerate(faults):
            with self.subTest(fault=fault):
                said = self.assert_broken({"foreign": "run", "twice": "turn", "place": "start_anew"}.get(fault, fault), i + 1)
                # The attempt number is larger if the vehicle misses the first messages while it connects.
                why = {"size": "999 positions, of 1000", "finite": "a NaN or an infinity", "answer": "no answer within 1 s",
                       "place": r": at 0 m, of -{} m, its initial position".format(5 * (i + 1)),
                       "spacing": r"m behind a predecessor that drives 2 m per step; due: 5 \+ 5 \* 2 = 15 m",
                       "twice": r"step 6 of the realizations from 0, attempt \d+ was due, and came: step 5"}
                self.assertRegex(said, why.get(fault, "step "))
        second = self.start_example(len(faults))
        live_platoon.wait_for(lambda: live_platoon.process_of("/vehicle_{}".format(len(faults)), self.master), "a second publisher")
        self.assertRegex(self.assert_broken("one_publisher", len(faults)), r"/broken_followers_\d+_\d+ and /vehicle_{0} publish /platoon/vehicle_{0}/position".format(len(faults)))
        second.terminate()

    def test_a_vehicle_that_is_not_there_or_no_number_is_named(self):
        self.assertIn("vehicle_4 is not running: it must publish /platoon/vehicle_4/position and subscribe to "
                      "/platoon/vehicle_4/predecessor_position", self.check_vehicle(4, "--wait", "0.1").stdout)
        self.assertIn("waiting for external vehicle_4: start its node", self.check_vehicle(4, "--wait", "0.1").stdout)
        for word in ("0", "three", "3.0"):
            done = self.check_vehicle(word)
            self.assertEqual(done.returncode, 1)
            self.assertIn("vehicle: {}: must be the number of a follower, 1 or more".format(word), done.stdout)

    def test_the_monitor_names_it_with_the_clause_and_the_run_goes_on(self):
        self.start(os.path.join(HERE, "broken_follower.py"), "2:each")
        terminal = self.run_to_the_end(followers=3, external=2, steps=20, realizations=700, batch=100, stall_timeout=0.5)
        said = terminal.text()
        stands = r"run stalled: vehicle_2 has sent nothing since step {} \(realizations from {}\); the vehicle is external: {}clause {} of the"
        self.assertRegex(said, stands.format(4, 100, "", 2))
        for step, first, what, number in ((5, 200, "out of turn", 6), (4, 300, "wrong batch size", 3), (4, 400, "not finite", 4),
                                          (4, 500, "of another run", 11)):
            self.assertRegex(said, stands.format(step, first, "its last message was dropped, as {}; ".format(what), number))
        self.assertRegex(said, r"/platoon/vehicle_2/position: dropped a message that is out of turn: .*vehicle_2 is external: it violates clause 6 of")
        summary = live_platoon.completed_summary(self.output)
        self.assertEqual(summary["positions_lost"], 0)
        # One more attempt for each violation from the second on, independent of the attempts at start-up.
        second = re.search(r"/platoon/vehicle_2/position: dropped a message that is out of turn: attempt (\d+), realizations from 200,", said)
        self.assertEqual(summary["attempts"], int(second.group(1)) + 4)

    def test_a_vehicle_that_never_answers_is_named_once_however_often_the_leader_retries(self):
        self.start(os.path.join(HERE, "broken_follower.py"), "2:mute")
        terminal = self.launch(master=self.master, followers=3, external=2, steps=20, realizations=100, rate=100, stall_timeout=0.5)
        terminal.wait_for_text("run stalled: vehicle_2 has sent nothing at all; the vehicle is external: clause 2 of the vehicle contract", 40)
        terminal.interrupt()
        self.assertEqual(terminal.text().count("run stalled: vehicle_2 has sent nothing at all"), 1)

    def test_the_recorder_names_a_vehicle_without_stamps(self):
        self.start(os.path.join(HERE, "broken_follower.py"), "2:unstamped")
        terminal = self.launch(master=self.master, followers=2, external=2, realizations=10, record=os.path.join(self.folder, "run.bag"))
        terminal.wait_for_text("/platoon/vehicle_2/position: dropped a message without a stamp, which a bag cannot hold; clause 5 of the vehicle")
        terminal.interrupt()

    def test_the_monitor_names_a_second_publisher(self):
        self.start_example(2)
        self.start(os.path.join(HERE, "broken_follower.py"), "2:none")
        terminal = self.run_to_the_end(followers=2, external=2, steps=20, realizations=500, batch=10)
        self.assertRegex(terminal.text(), r"/platoon/vehicle_2/position has two publishers: .*; the vehicle is external: clause 1 of the vehicle contract: ")


class Car(ExternalTest):
    """A simulated car, in 8 s of wall time; with PLATOON_MINUTE=1 in the environment in real time, one minute."""

    STEPS = 600 if "PLATOON_MINUTE" in os.environ else 400
    SPEED = 5.0   # [m/s]
    START = 123.0  # [m] of the car, in the frame of its odometry
    HEADWAY = 3.2

    def recorded(self, bag, topic):
        """The position at each step, in order (one realization)."""
        with rosbag.Bag(bag) as opened:
            found = {message.step: message.position for _, message, _ in opened.read_messages(["/platoon/" + topic])}
        self.assertEqual(sorted(found), list(range(-1, self.STEPS)))
        return [found[step][0] for step in sorted(found)]

    def test_a_car_that_has_never_heard_of_positions_drives_as_vehicle_2_of_4(self):
        """Checks values that pass through the adapter, to the bit. The car's position at a step depends on scheduling."""
        period = 0.1 if "PLATOON_MINUTE" in os.environ else 0.02
        model = self.model_with(sample_period=period, noise_variance=0.0001,
                                leader="{{speed: [{{from_step: 0, value: {}}}]}}".format(self.SPEED))
        diagnostics, log, bag = (os.path.join(self.folder, name) for name in ("diagnostics", "car", "run.bag"))
        terminal = self.launch(master=self.master, followers=4, external=2, realizations=1, steps=self.STEPS, model=model,
                               rate=round(1.0 / period), stall_timeout=0, record=bag)
        terminal.wait_for_text("waiting for external vehicle_2: start its node")
        self.start(os.path.join(HERE, "car.py"), log, "__ns:=/car")
        self.start(os.path.join(live_platoon.shared("src", "nodes"), "odometry_vehicle"), "_index:=2", "~odometry:=/car/odom",
                   "~reference:=/car/reference")
        with open(diagnostics, "w") as file:
            listener = subprocess.Popen(["/usr/bin/python3", "-c", LISTENER], env=self.environment, stdout=file)
        self.addCleanup(listener.wait)
        self.addCleanup(listener.terminate)
        terminal.wait()
        summary = live_platoon.completed_summary(self.output)
        self.assertTrue(summary, terminal.text())
        self.assertEqual(summary["positions_lost"], 0)
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
        with open(diagnostics) as file:
            said = [values for values in map(json.loads, file) if "largest latency [s]" in values]
        self.assertTrue(said, "nothing of the car's on /diagnostics")
        self.assertTrue(0 < int(said[-1]["steps"]) <= self.STEPS + 1)
        self.assertGreater(float(said[-1]["largest latency [s]"]), 0.0)
        self.assertGreaterEqual(int(said[-1]["missed ticks"]), 0)

    def check_what_passes(self, log, own, received):
        """Checks that the platoon received positions that the car reported, in order, and the car references from the platoon."""
        with open(log) as file:
            lines = [line.split() for line in file.read().splitlines()]
        places = [float(x) - self.START for word, x in lines if word == "at"]
        at = 0
        for step, position in enumerate(own, -1):
            while at < len(places) and places[at] != position:
                at += 1
            self.assertLess(at, len(places), "at step {} the car was said to be at {} m, where it has not been since".format(step, position))
        references = [float(x) for word, x in lines if word == "to"]
        self.assertGreater(len(references), 0)
        self.assertEqual(set(references) - {position + self.START for position in received}, set())

    def test_a_batch_of_many_is_refused_in_words(self):
        self.start(os.path.join(HERE, "car.py"), "__ns:=/car")
        log = os.path.join(self.folder, "said")
        with open(log, "w") as file:
            adapter = subprocess.Popen([os.path.join(live_platoon.shared("src", "nodes"), "odometry_vehicle"), "_index:=2",
                                        "~odometry:=/car/odom"], env=self.environment, stderr=file)
        self.addCleanup(adapter.wait)
        self.addCleanup(adapter.terminate)
        self.launch(master=self.master, followers=2, external=2, realizations=30, batch=10, stall_timeout=0)

        def refused():
            with open(log) as file:
                return "a message of 10 positions: must be one, as there is one car" in file.read()

        live_platoon.wait_for(refused, "its words", 30)


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


class OtherPackage(ExternalTest):
    def test_a_package_of_its_own_builds_against_the_devel_space_and_saturates(self):
        build = os.path.join(self.folder, "build")
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
            self.output = os.path.join(self.folder, limit)
            self.run_to_the_end(external=3, output=self.output, **settings)
            means.append(rows(self.output)[3, 39][0])
            variances.append([rows(self.output)[vehicle, 39][1] for vehicle in (1, 2, 3)])
            node.terminate()
            node.wait()
        live_platoon.reference(self.folder, **settings)
        built_in = rows(os.path.join(self.folder, "reference"))
        for vehicle, own in enumerate(variances[0], 1):  # an actuator that never saturates
            self.assertAlmostEqual(own, built_in[vehicle, 39][1], 9)
        self.assertEqual(variances[1][:2], [built_in[vehicle, 39][1] for vehicle in (1, 2)])
        self.assertAlmostEqual(means[0], built_in[3, 39][0], 9)
        self.assertGreater(means[1], 10.0)    # it cannot keep up with an accelerating leader


if __name__ == "__main__":
    unittest.main()
