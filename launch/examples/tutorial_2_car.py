#!/usr/bin/python3
"""Your own car, described by its lag, delay and gains: how short may its headway be?"""

import argparse
import json
import os

import matplotlib.pyplot as plt
import numpy as np
import stochastic_platoon as sp

parser = argparse.ArgumentParser(description=__doc__, epilog="Example: tutorial_2_car.py /tmp/tutorial")
parser.add_argument("folder", nargs="?", default=".", help="folder for the picture, made if there is none (default: %(default)s)")
folder = parser.parse_args().folder
os.makedirs(folder, exist_ok=True)
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e4e4"})
figure, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.8), constrained_layout=True)

car = sp.Model.load("acc.yaml").replace({
    "plant/actuator_lag": 0.3, "plant/input_delay": 0.2,  # [s]
    "controller/kp": 0.45, "controller/kd": 1.0,          # [1/s^2], [1/s]
    "time_headway_seconds": 2.5, "sample_period": 0.05,   # [s]
    "standstill_distance": 3.0, "noise_variance": 0.01})  # [m], [m^2]
with open(os.path.join(folder, "your_car.yaml"), "w") as file:
    json.dump(car.to_dict(), file, indent=1)  # JSON is YAML: all tools and launch files read it
analysis = sp.analyze(car)
print("your car: critical headway {:.3f} s".format(analysis["critical_headway_seconds"]))


def critical_headway(model: sp.Model) -> float:
    """The critical headway [s]; NaN where no headway is string stable."""
    return sp.analyze(model, followers=1, steps=1).number("critical_headway_seconds")


delays = np.arange(0, 0.801, 0.05)
for kp, kd, colour in ((0.2, 0.7, "#009E73"), (0.45, 1.0, "#0072B2"), (1.0, 1.5, "#D55E00")):
    gains = car.replace({"controller/kp": kp, "controller/kd": kd})
    headways = [critical_headway(gains.replace({"plant/input_delay": delay, "allow_unstable": True})) for delay in delays]
    left.plot(delays, headways, "o-", color=colour, markersize=3, label="kp = {} s$^{{-2}}$, kd = {} s$^{{-1}}$".format(kp, kd))
    print("kp = {}: critical headway {:.3f} s without delay, {:.3f} s at a delay of 0.4 s; sqrt(2 / kp) = {:.3f} s".format(
        kp, headways[0], headways[8], np.sqrt(2 / kp)))
left.set(xlabel="input delay [s]", ylabel="critical headway [s]", ylim=(0, 6), title="String stable above the curve")
left.legend(loc="lower right")

for headway, colour in ((2.5, "#0072B2"), (1.8, "#CC79A7")):
    analysis = sp.analyze(car.replace(time_headway_seconds=headway), followers=40)
    deviation = 1000 * np.sqrt(analysis.stationary_variance)  # [mm]
    right.plot(np.arange(1, 41), deviation, "o-", color=colour, markersize=3, label="headway {} s".format(headway))
    print("headway {} s: standard deviation {:.1f} mm of follower 1, {:.1f} mm of follower 40".format(headway, deviation[0], deviation[-1]))
right.set(xlabel="follower $i$", ylabel="standard deviation of the tracking error [mm]", title="Your car, delay 0.2 s", ylim=(0, None))
right.legend(loc="upper left")
figure.savefig(os.path.join(folder, "tutorial_2_car.png"), dpi=200)
