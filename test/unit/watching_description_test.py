#!/usr/bin/python3
"""Tests of the page's description of a configuration, without ROS."""

import json
import sys
import unittest

import stochastic_platoon as sp

sys.dont_write_bytecode = True
from watching_messages import configuration, message  # noqa: E402
from watching import description, state, table  # noqa: E402


class Configuration(unittest.TestCase):
    def test_a_radio_is_described_and_its_loss_is_the_one_to_change(self):
        found = description.described(configuration(**sp.Model.load("cacc.yaml").replace(loss=0.1).to_dict()).data)
        self.assertEqual(found["link"], "additive noise, radio with additive noise, delay 2, loss 0.1")
        self.assertEqual(found["loss"], 0.1)
        self.assertTrue(found["headway_in_seconds"])
        self.assertFalse(description.described(configuration().data)["headway_in_seconds"])

    def test_losses_by_distance_have_no_probability_to_change(self):
        found = description.described(configuration(**sp.Model.load("by_distance.yaml").to_dict()).data)
        self.assertEqual((found["link"], found["loss"]), ("additive noise, losses by distance", None))

    def test_the_vehicles_that_are_heard_are_listed_where_they_are_not_predecessors_alone(self):
        self.assertEqual(description.described(configuration().data)["heard"], [])
        self.assertEqual(description.described(self.without_paper("cacc.yaml"))["heard"], [])
        found = description.described(self.without_paper("two_ahead.yaml", followers=4))
        self.assertEqual(found["heard"], [[0], [0, 1], [1, 2], [2, 3]])
        self.assertEqual(found["link"], "hears position of the predecessor (additive noise); position of vehicle i-2 (additive noise)")
        self.assertEqual(description.described(self.without_paper("path_cacc.yaml", followers=3))["heard"], [[0], [0, 1], [0, 2]])

    @staticmethod
    def without_paper(name, followers=3, steps=4, **changes):
        """A configuration of a shipped model, without the keys of the paper's."""
        document = json.loads(configuration(followers, steps).data)
        document["model"] = sp.Model.load(name).replace(changes).to_dict()
        return json.dumps(document)

    def test_another_version_is_named(self):
        known = state.PlatoonState()
        known.take_configuration(message(data=configuration().data.replace(sp.__version__, "0.1.9")))
        self.assertIn("version: 0.1.9: must be 0.2.0 or " + sp.__version__, " ".join(table.table(known.document(), 24)))


class Strings(unittest.TestCase):
    """Only what holds for the vehicles of the string is said."""

    def described(self, name, changes=(), followers=7):
        known = state.PlatoonState()
        known.take_configuration(message(data=Configuration.without_paper(name, followers, 0, **dict(changes))))
        return known.document()

    def said(self, document):
        event, = document["events"]
        return event["text"]

    def test_unlike_links_are_named_with_their_types(self):
        found = self.described("cars_and_trucks.yaml")
        self.assertEqual(found["link"], "mixed string: additive noise (car_behind_truck, default); additive noise, delay 1, loss 0.1 (truck)")
        self.assertEqual((found["headway"], found["noise_variance"], found["loss"]), ([70.0, 80.0], 0.01, [0.0, 0.1]))
        self.assertIn("headway 3.5 to 4 s (70 to 80 sample periods), noise variance 0.01 m^2, loss 0 to 0.1, link", self.said(found))
        self.assertEqual(found["changeable"], {"headway": 70.0, "noise_variance": 0.01, "loss": 0.0})
        self.assertEqual(self.described("cars_and_trucks.yaml", followers=2)["link"], "additive noise, mixed string")
        many = {str(i): {"channel": {"delay": i}} for i in range(1, 8)}
        self.assertRegex(self.described("paper.yaml", {"vehicle_types": many, "string": list(many)})["link"],
                         r"^mixed string: additive noise, delay 1 \(1\); additive noise, delay 2 \(2\); 5 other links$")

    def test_a_default_vehicle_that_is_not_in_the_string_is_not_described(self):
        own = {"a": {"noise_variance": 0.1, "time_headway": 5.0, "channel": {"loss": {"probability": 0.05, "on_loss": "hold"}}}}
        lossy = {"channel/loss": {"probability": 0.3, "on_loss": "hold"}, "vehicle_types": own, "string": ["a"]}
        found = self.described("paper.yaml", lossy)
        self.assertEqual(found["link"], "additive noise, loss 0.05")
        self.assertIn("headway 0.5 s (5 sample periods), noise variance 0.1 m^2, loss 0.05, link", self.said(found))
        self.assertEqual(found["changeable"], {})
        own["a"].pop("noise_variance")
        self.assertEqual(self.described("paper.yaml", dict(lossy, vehicle_types=own))["changeable"], {"noise_variance": 0.6})

    def test_inputs_of_a_type_replace_the_channel_of_the_default_vehicle(self):
        types = {"a": {"inputs": [{"signal": "position", "noise_variance": 0.1}]}}
        found = self.described("lossy.yaml", {"vehicle_types": types, "string": ["a"]})
        self.assertEqual((found["link"], found["loss"], found["noise_variance"]), ("additive noise", 0.0, 0.1))

    def test_keys_of_the_default_vehicle_that_a_type_does_not_use_change_none(self):
        own = {"a": {"inputs": [{"signal": "position", "noise_variance": 0.1}], "spacing": "constant"}}
        self.assertEqual(self.described("cacc.yaml", {"vehicle_types": own, "string": ["a"], "loss": 0.1})["changeable"], {})

    def test_losses_of_another_form_are_no_probability(self):
        for loss in ({"by_distance": [[20.0, 0.01], [100.0, 0.2]], "on_loss": "hold"},
                     {"markov": {"transition": [[0.9, 0.1], [0.3, 0.7]], "probability": [0.02, 0.7]}, "on_loss": "hold"}):
            found = self.described("acc.yaml", {"channel/loss": loss})
            self.assertEqual((found["loss"], found["changeable"]["loss"]), (None, None))
            self.assertNotIn(" loss ", self.said(found))

    def test_noises_of_unlike_inputs_are_a_range(self):
        inputs = [{"signal": "position", "from": source, "weight": weight, "noise_variance": noise}
                  for source, weight, noise in ((2, 0.4, 0.05), ("predecessor", 0.6, 0.02))]
        self.assertIn("noise variance 0.02 to 0.05 m^2", self.said(self.described("two_ahead.yaml", {"inputs": inputs})))

    def test_constant_spacing_has_no_headway_to_change(self):
        found = self.described("consensus.yaml")
        self.assertEqual((found["headway"], sorted(found["changeable"])), (0.0, ["loss", "noise_variance"]))
        self.assertNotIn("headway", self.said(found))


if __name__ == "__main__":
    unittest.main()
