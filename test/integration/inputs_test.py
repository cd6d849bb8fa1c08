#!/usr/bin/python3
"""Vehicles that hear any vehicles ahead: the live graph equals monte_carlo to the bit in every hosting, agrees with the theory, is
recorded and replayed whole, and an external vehicle hears the same inputs."""

import collections
import csv
import json
import os
import unittest

import numpy as np
import rosbag
import stochastic_platoon as sp
import yaml

import live_platoon
from external import ExternalTest, rows

FOLLOWERS, STEPS, REALIZATIONS = 5, 60, 3000
BATCHES = 6
SETTINGS = dict(followers=FOLLOWERS, steps=STEPS, realizations=REALIZATIONS)


def shipped(name):
    with open(live_platoon.shared("config", name)) as file:
        return yaml.safe_load(file)


def mixed():
    """Unlike cars: two positions and a control input from further ahead, a packet that loses in bursts, and a plain follower."""
    losses = {"probability": 0.2, "mean_burst": 3.0}
    return {
        "sample_period": 0.1, "time_headway": 6, "standstill_distance": 4.0, "start": "steady",
        "plant": {"actuator_lag": 0.3}, "controller": {"kp": 0.5, "kd": 1.2},
        "initial_position": {"mean": 0.0, "variance": 0.0},
        "inputs": [{"signal": "input", "from": 2, "gain": 0.2, "noise_variance": 0.01, "channel": {"delay": 2}},
                   {"signal": "position", "from": "predecessor", "weight": 0.7, "noise_variance": 0.02},
                   {"signal": "position", "from": 3, "weight": 0.3, "noise_variance": 0.05, "channel": {"delay": 1}},
                   {"signal": "speed", "from": "leader", "gain": 0.1, "noise_variance": 0.03,
                    "channel": {"packet": "leader", "loss": losses}},
                   {"signal": "acceleration", "from": "leader", "gain": 0.1, "noise_variance": 0.03, "channel": {"packet": "leader"}}],
        "vehicle_types": {"human": {"time_headway": 15, "inputs": [{"signal": "position", "from": "predecessor", "noise_variance": 0.02}]}},
        "string": ["default", "default", "human", "default"],
        "leader": {"speed": [{"from_step": 0, "value": 20.0}]},
    }


class Inputs(ExternalTest):
    def check(self, model, **arguments):
        """Launches the model with a recording; returns bag and statistics."""
        self.output = self.path("run")
        bag = self.output + ".bag"
        terminal = self.launch(model=model, output=self.output, batch=REALIZATIONS // BATCHES, record=bag, **SETTINGS, **arguments)
        self.summary = self.completed(terminal)
        measured = live_platoon.statistics(self.output)
        self.assertEqual(measured, live_platoon.reference(self.output, model=model, **SETTINGS))
        self.assert_statistics_of(bag, measured)
        return bag, measured

    def test_of_predecessor_and_leader_from_processes_with_recording_and_replays(self):
        bag, measured = self.check("path_cacc.yaml")
        self.assertLess(self.summary["agreement"]["max_abs_z_variance"], 6)
        self.assertGreater(self.summary["agreement"]["max_abs_z_variance"], 0.5)
        with rosbag.Bag(bag) as opened:
            counts = {topic: info.message_count for topic, info in opened.get_type_and_topic_info().topics.items()}
            carried = {topic: message.header.frame_id for topic, message, _ in opened.read_messages() if "/inputs/" in topic}
        inputs = shipped("path_cacc.yaml")["inputs"]
        names = ["predecessor_position"] + ["inputs/{}".format(n) for n in range(1, len(inputs))]
        for i in range(1, FOLLOWERS + 1):
            for n, name in enumerate(names):
                topic = "/platoon/vehicle_{}/{}".format(i, name)
                self.assertEqual(counts[topic], BATCHES * (STEPS + 1), topic)
                self.assertEqual(carried[topic] if n > 0 else "position", inputs[n]["signal"])
        self.assertFalse([topic for topic in counts if topic.endswith("input")])
        self.check_received(bag)
        self.assert_replayed_run(bag, measured)
        self.assert_replays(bag, BATCHES * (STEPS + 1), "vehicle_1", "vehicle_3")

    def check_received(self, bag):
        """The received speed of the leader is its speed with the noise of the model."""
        recording = sp.Recording(bag)
        speed, leader = recording.received(4, 4), recording.positions(0)
        noise = speed[:, 1:] - (leader[:, 1:] - leader[:, :-1]) / recording.model.sample_period
        variance, count = noise.var(), noise.size
        self.assertLess(abs(variance / 0.04 - 1), 5 * (2 / count) ** 0.5)
        with self.assertRaisesRegex(IndexError, "input: 5: must be from 0 to 4"):
            recording.received(4, 5)

    def test_of_unlike_cars_that_lose_packets_in_one_process(self):
        bag, _ = self.check(self.write("model.yaml", json.dumps(mixed())), hosting="one_process")
        self.check_ages(bag)
        self.check_names(bag)

    def check_names(self, bag):
        """Every message on inputs/<n> names its signal, a position too."""
        with rosbag.Bag(bag) as opened:
            named = {(topic.split("/vehicle_1/inputs/")[1], message.header.frame_id) for topic, message, _ in opened.read_messages()
                     if "/vehicle_1/inputs/" in topic}
        self.assertEqual(named, {("0", "input"), ("2", "position"), ("3", "speed"), ("4", "acceleration")})

    def check_ages(self, bag):
        """ages.csv counts the losses of each input in the recording: noise makes every arrival another value."""
        recording, counted = sp.Recording(bag), collections.Counter()
        for i, n in ((i, n) for i in range(1, FOLLOWERS + 1) if i % 4 != 3 for n in (3, 4)):
            received = recording.received(i, n)[:, :STEPS]
            age = np.zeros(REALIZATIONS, dtype=int)
            for before, now in zip(received.T, received.T[1:]):
                age = np.where(now == before, age + 1, 0)
                counted.update((i, n, value) for value in age)
        with open(os.path.join(self.output, "ages.csv")) as file:
            ages = list(csv.DictReader(file))
        self.assertEqual({(int(row["vehicle"]), int(row["input"]), int(row["age"])): int(row["count"]) for row in ages if row["count"] != "0"},
                         counted)
        self.assertEqual({(row["input"], row["signal"]) for row in ages}, {("3", "speed"), ("4", "acceleration")})

    def test_of_unlike_cars_that_lose_packets_from_processes_and_an_external_vehicle(self):
        model = self.write("model.yaml", json.dumps(mixed()))
        bag, measured = self.check(model)
        self.assert_replays(bag, BATCHES * (STEPS + 1), *("vehicle_{}".format(i) for i in range(1, FOLLOWERS + 1)))
        program = os.path.join(os.environ["PLATOON_TEST_PROGRAMS"], "external_by_model")
        for vehicle in (2, 4):
            self.start(program, "_index:={}".format(vehicle), "__name:=external_{}".format(vehicle))
            self.assert_keeps_the_contract(vehicle, "--model", model)
        self.check_external(model, "2,4", FOLLOWERS, STEPS, 500)

    def check_external(self, model, external, followers, steps, realizations):
        settings, output = dict(followers=followers, steps=steps, realizations=realizations), self.path("external/" + os.path.basename(model))
        self.completed(self.launch(model=model, output=output, external=external, batch=realizations, **settings), output)
        live_platoon.reference(output, model=model, **settings)
        measured, expected = rows(output), rows(os.path.join(output, "reference"))
        self.assertEqual(len(measured), followers * steps)
        self.assertEqual({key: row[:2] for key, row in measured.items()}, {key: row[:2] for key, row in expected.items()})

    def test_of_a_kept_external_vehicle_whose_next_run_has_none_of_its_topics(self):
        self.start(os.path.join(os.environ["PLATOON_TEST_PROGRAMS"], "external_by_model"), "_index:=3")
        ahead = dict(mixed(), inputs=[{"signal": "position", "from": 2, "noise_variance": 0.02}], string=["default"])
        for name, model in (("predecessor", dict(mixed(), string=["human"])), ("second_ahead", ahead), ("both", mixed())):
            self.check_external(self.write(name + ".yaml", json.dumps(model)), "3", 4, 20, 50)


if __name__ == "__main__":
    unittest.main()
