"""Model files with links, and their theory by analyze."""

import json

import numpy as np

from folder import FolderTest
from live_platoon import tool

PLANTS = {"numerator": [1.0], "denominator": [1.0, -2.0, 1.0]}


def controller(poles, gain):
    """K = gain / (1 + h) z^n / prod (z - pole): a loop of order n + 2."""
    return {"numerator": [gain] + [0.0] * len(poles), "denominator": np.poly(poles).tolist(), "divide_by_one_plus_headway": True}


LOOPS = {
    2: {"plant": {"numerator": [1.0, 0.0], "denominator": [1.0, -2.0, 1.0]},
        "controller": {"numerator": [1.26], "denominator": [1.0], "divide_by_one_plus_headway": True}},
    3: {"plant": PLANTS, "controller": controller([-0.89], 1.35)},
    4: {"plant": PLANTS, "controller": controller([-0.89, 0.2], 1.05)},
    5: {"plant": PLANTS, "controller": controller([-0.89, 0.2, -0.1], 1.15)},
}


def model_of(order=3, channel=None, **changes):
    model = {"time_headway": 3.2, "standstill_distance": 2.0, "sample_period": 0.1, "noise_variance": 0.6,
             "leader": {"speed": [{"from_step": 0, "value": 20.0}]}, "initial_position": {"mean": 0.3, "variance": 0.5},
             "channel": channel or {}}
    model.update(LOOPS[order])
    model.update(changes)
    return model


COLOUR = {"numerator": [0.8, 0.3, 0.1], "denominator": [1.0, -0.5, 0.2]}


class AnalyzeTest(FolderTest):
    def analyze(self, model, followers=5, steps=40, *options):
        """The JSON of analyze."""
        file, result = self.write("model.yaml", json.dumps(model)), self.path("theory.json")
        done = tool("analyze", *options, model=file, followers=followers, steps=steps, json=result)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(result) as stream:
            return json.load(stream)
