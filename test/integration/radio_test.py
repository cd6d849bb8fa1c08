#!/usr/bin/python3
"""Platoons with radar and radio: the live graph equals monte_carlo to the bit in every hosting, agrees with the theory, and is
recorded and replayed whole."""

import json
import subprocess
import unittest

import numpy as np
import rosbag
import rosgraph
import stochastic_platoon as sp
import yaml

import live_platoon
from terminal import LaunchTest, kept_master

FOLLOWERS, STEPS, REALIZATIONS = 4, 60, 3000
BATCHES = 6
SETTINGS = dict(followers=FOLLOWERS, steps=STEPS, realizations=REALIZATIONS)


def cacc():
    with open(live_platoon.shared("config", "cacc.yaml")) as file:
        return yaml.safe_load(file)


class Radio(LaunchTest):
    def check(self, model, **arguments):
        self.output = self.path("run-" + "-".join(arguments.values()))
        bag = self.output + ".bag"
        terminal = self.launch(model=model, output=self.output, batch=REALIZATIONS // BATCHES, record=bag, **SETTINGS, **arguments)
        summary = self.completed(terminal)
        self.assertLess(summary["agreement"]["max_abs_z_variance"], 6)
        self.assertGreater(summary["agreement"]["max_abs_z_variance"], 0.5)
        measured = live_platoon.statistics(self.output)
        self.assertEqual(measured, live_platoon.reference(self.output, model=model, **SETTINGS))
        return bag, measured

    def test_from_processes_with_recording_and_replay(self):
        bag, measured = self.check("cacc.yaml")
        with rosbag.Bag(bag) as opened:
            counts = {topic: info.message_count for topic, info in opened.get_type_and_topic_info().topics.items()}
        for i in range(FOLLOWERS):
            for topic in ("/platoon/vehicle_{}/input".format(i), "/platoon/vehicle_{}/predecessor_input".format(i + 1)):
                self.assertEqual(counts[topic], BATCHES * (STEPS + 1), topic)
        self.assertNotIn("/platoon/vehicle_{}/input".format(FOLLOWERS), counts, "nobody hears the last vehicle")
        recording = sp.Recording(bag)
        np.testing.assert_array_equal(recording.predecessor_inputs(2), recording.received(2, 1))
        # The radio delays u_i by 2 steps. The value that the vehicle publishes, v_i(k) = u_i(k - 1), includes the first of them.
        noise = recording.predecessor_inputs(2)[:, 2:] - recording.inputs(1)[:, 1:-1]
        self.assertLess(abs(noise.var() / cacc()["inputs"][1]["noise_variance"] - 1), 5 * (2 / noise.size) ** 0.5)
        self.assert_statistics_of(bag, measured)
        self.assert_replayed_run(bag, measured)
        self.assert_replays(bag, BATCHES * (STEPS + 1), "vehicle_1", "vehicle_3")
        behind = self.path("behind")  # the recorded leader sends the acceleration of its drive
        text = self.replayed(bag, drive="leader", output=behind)
        self.assertTrue(live_platoon.completed_summary(behind), text)
        self.assertLess(live_platoon.completed_summary(behind)["agreement"]["max_abs_z_variance"], 6)

    def test_a_mixed_string_with_lost_inputs_in_one_process(self):
        model = cacc()
        model["inputs"][1]["channel"].update(delay=3, loss={"probability": 0.2, "on_loss": "zero"})
        model["vehicle_types"] = {"human": {"time_headway_seconds": 1.5, "inputs": [{"signal": "position"}]}}
        model["string"] = ["default", "human", "default"]
        self.check(self.write("model.yaml", json.dumps(model)), hosting="one_process")

    def test_an_external_vehicle_that_sends_no_input_to_a_radio_is_named(self):
        self.background(live_platoon.shared("launch", "examples", "rospy_follower.py"), "2", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                        env=live_platoon.ros_environment(kept_master(), ROS_HOME=self.folder))
        terminal = self.launch(model="cacc.yaml", external=2, **SETTINGS)
        terminal.wait_for_text("vehicle_2 is external and publishes no vehicle_2/input, which vehicle_3 receives by radio")
        terminal.interrupt()

    def test_without_radios_nobody_publishes_inputs(self):
        terminal = self.launch(model="acc.yaml", own_master=True, stay="true", **SETTINGS)
        live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output), "the run")
        topics = [topic for topic, _ in rosgraph.Master("/radio_test", terminal.master).getTopicTypes()]
        self.assertIn("/platoon/vehicle_1/position", topics)
        self.assertFalse([topic for topic in topics if "input" in topic])
        terminal.interrupt()


if __name__ == "__main__":
    unittest.main()
