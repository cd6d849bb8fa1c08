#!/usr/bin/python3
"""Runs monte_carlo for random mixtures of what models can contain: whom cars hear, delays, coloured noise, quantisation, losses of every
kind, packets, unlike cars, starts, signals. The measurement must agree with the theory wherever there is one.

mixtures_test.py [--models M] [--seed SEED]
"""

import argparse
import json
import os
import random
import tempfile

from live_platoon import tool

STEPS, REALIZATIONS = 60, 3000
SIGNALS = ["gap", "speed", "acceleration", "jerk", "input", "relative_speed"]
UNSTABLE = ("rho(A)", "variance grows", "predictions that grow")


def drawn_loss(draw, signal, source):
    on_loss = draw.choice(["hold", "hold", "hold", "extrapolate", [1.2, -0.2], [0.5, 0.5]] + (["zero"] * 3 if signal != "position" else []))
    kind = draw.random()
    if kind < 0.4:
        return {"probability": draw.uniform(0.01, 0.3), "on_loss": on_loss}
    if kind < 0.6:
        return {"probability": draw.uniform(0.02, 0.3), "mean_burst": draw.uniform(1.0, 5.0), "on_loss": on_loss}
    if kind < 0.8:
        states = draw.randint(2, 4)
        rows = [[draw.gammavariate(0.7, 1.0) + 1e-3 for _ in range(states)] for _ in range(states)]
        rows = [[x / sum(row) for x in row] for row in rows]
        return {"markov": {"transition": rows, "probability": [draw.uniform(0.0, 0.5) for _ in range(states)]}, "on_loss": on_loss}
    if kind < 0.9 and signal == "position" and source == "predecessor":
        return {"by_distance": [[0.0, 0.0], [50.0, draw.uniform(0.1, 0.4)]], "on_loss": on_loss}
    return {"runs": "5 2 7 1 30 3", "on_loss": on_loss}


def drawn_channel(draw, signal, source):
    channel = {"delay": draw.randint(1 if signal == "input" else 0, 3)} if signal == "input" or draw.random() < 0.4 else {}
    if draw.random() < 0.3:
        channel["noise_filter"] = {"numerator": [1.0, draw.uniform(-0.5, 0.5)], "denominator": [1.0, -draw.uniform(0.0, 0.8)]}
    if draw.random() < 0.25:
        channel["quantisation_step"] = draw.uniform(0.01, 0.5)
    if draw.random() < (0.3 if signal == "position" else 0.6):
        channel["loss"] = drawn_loss(draw, signal, source)
    return channel


def drawn_inputs(draw, plain, constant):
    """Of a car that hears its predecessor alone, or others, too."""
    far = ["predecessor"] if plain else ["predecessor", 2, 3] + (["leader"] if constant else [])
    sources = draw.sample(far, 1 if plain else draw.choice([1, 1, 1, 2]))
    if "predecessor" not in sources:
        sources[0] = "predecessor"  # a tracking error is a distance to it, and unbounded in a string where nobody hears it
    weights = [draw.uniform(0.3, 1.0) for _ in sources]
    inputs = [{"signal": "position", "from": source, "noise_variance": draw.choice([0.0, draw.uniform(0.01, 0.3)]),
               "channel": drawn_channel(draw, "position", source)} for source in sources]
    if len(inputs) > 1:
        inputs[0]["weight"] = weights[0] / sum(weights)
        inputs[1]["weight"] = 1.0 - inputs[0]["weight"]
    for _ in range(draw.choice([0, 1] if plain else [0, 1, 1, 2])):
        signal, source = "input" if plain else draw.choice(["speed", "acceleration", "input", "input"]), draw.choice(far)
        inputs.append({"signal": signal, "from": source, "gain": draw.uniform(0.05, 0.4), "noise_variance": draw.uniform(0.0, 0.1),
                       "channel": drawn_channel(draw, signal, source)})
    if len(inputs) > 1 and inputs[-2]["from"] == inputs[-1]["from"] and not plain and draw.random() < 0.5:
        inputs[-1]["channel"].pop("loss", None)
        inputs[-2]["channel"]["packet"] = inputs[-1]["channel"]["packet"] = "lost together"
    return inputs


def drawn_car(draw, plain, constant):
    length = draw.choice([4.0, 12.0])
    car = {"plant": {"actuator_lag": draw.choice([0.0, draw.uniform(0.05, 0.5)]), "input_delay": draw.choice([0, 0, 1, 2]) * 0.1},
           "controller": {"kp": draw.uniform(0.1, 0.6), "kd": draw.uniform(0.5, 1.2), "headway_filter": not constant and draw.random() < 0.5},
           "inputs": drawn_inputs(draw, plain, constant), "vehicle_length": length, "standstill_distance": length + draw.uniform(0.0, 5.0),
           "initial_position": draw.choice([{"mean": 0.0, "variance": 0.0}, {"mean": draw.uniform(-1.0, 1.0), "variance": draw.uniform(0.0, 1.0)}])}
    if not plain and draw.random() < 0.3:
        car["own_acceleration"] = -draw.uniform(0.0, 0.2)
    return car if constant else dict(car, time_headway=draw.uniform(3.0, 15.0))


def drawn_model(draw):
    plain = draw.random() < 0.4
    constant = not plain and draw.random() < 0.3
    model = dict(drawn_car(draw, plain, constant), sample_period=0.1, start=draw.choice(["rest", "steady"]),
                 leader={"speed": [{"from_step": k, "value": draw.uniform(5.0, 30.0)} for k in (0, 20)]})
    if constant:
        model["spacing"] = "constant"
    if draw.random() < 0.5:
        model["vehicle_types"] = {name: drawn_car(draw, plain, constant) for name in draw.choice(["a", "ab"])}
        for car in model["vehicle_types"].values():
            for of in car["inputs"]:
                of["channel"].pop("packet", None)
        model["string"] = [draw.choice(["default", *model["vehicle_types"]]) for _ in range(draw.randint(1, 4))]
    return model


def check(name, model, draw, folder):
    """Runs a model; returns whether it has a theory, None if it is not stable."""
    file, output = os.path.join(folder, name + ".yaml"), os.path.join(folder, name)
    with open(file, "w") as stream:
        json.dump(model, stream)
    done = tool("monte_carlo", model=file, followers=draw.choice([1, 3, 6]), steps=STEPS, realizations=REALIZATIONS, seed=draw.randrange(10**6),
                signals=",".join(SIGNALS), output=output)
    if done.returncode != 0 and any(words in done.stderr for words in UNSTABLE):
        return None
    assert done.returncode == 0, "%s: %s\n%s" % (name, done.stderr, json.dumps(model))
    with open(os.path.join(output, "summary.json")) as stream:
        summary = json.load(stream)
    assert "DISAGREE" not in done.stdout and not summary["contradictions"], "%s: %s\n%s" % (name, done.stdout, json.dumps(model))
    of_errors, *of_signals = (of["max_abs_z_mean"] is not None for of in (summary["agreement"], *summary["agreement"]["signals"].values()))
    assert all(of_signals) or not of_errors, "%s: a signal is not compared: %s\n%s" % (name, summary["agreement"], json.dumps(model))
    return of_errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--models", type=int, default=40)
    parser.add_argument("--seed", type=int, default=5)
    arguments = parser.parse_args()
    found = []
    for number in range(arguments.models):
        name = "mixture-%d-%d" % (arguments.seed, number)
        draw = random.Random(name)
        with tempfile.TemporaryDirectory() as folder:
            found.append(check(name, drawn_model(draw), draw, folder))
    print("%d models: %d compared with their theory, %d without one, %d not stable" % (
        arguments.models, found.count(True), found.count(False), found.count(None)))
    assert found.count(True) > arguments.models / 3, "too few have a theory"


if __name__ == "__main__":
    main()
