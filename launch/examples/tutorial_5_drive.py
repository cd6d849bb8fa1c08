#!/usr/bin/python3
"""A recorded drive through a city as the leader: does the string amplify it?"""

import argparse
import os

import matplotlib.pyplot as plt
import numpy as np
import stochastic_platoon as sp

parser = argparse.ArgumentParser(description=__doc__, epilog="Example: tutorial_5_drive.py /tmp/tutorial")
parser.add_argument("folder", nargs="?", default=".", help="folder for the picture, made if there is none (default: %(default)s)")
folder = parser.parse_args().folder
os.makedirs(folder, exist_ok=True)
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e4e4"})
figure, (speed, gaps, amplification) = plt.subplots(1, 3, figsize=(9.5, 3.4), constrained_layout=True)

city = sp.shipped_file("city.csv", "config/leaders")  # or a table of your own
linear = sp.Model.load("acc.yaml").replace({  # the car of tutorial_2_car.py, behind this leader
    "plant/actuator_lag": 0.3, "plant/input_delay": 0.2, "controller/kp": 0.45, "controller/kd": 1.0,
    "standstill_distance": 3.0, "sample_period": 0.05, "leader": city})
car = linear.replace({"limits/input": [-6.0, 3.0], "limits/speed": [0.0, 40.0]})  # [m/s^2], [m/s]

times, recorded = np.loadtxt(city, delimiter=",", skiprows=1, unpack=True)
speed.plot(times, recorded, color="#222222", linewidth=1.0, label="leader")
i = np.arange(1, 9)
for headway, colour in ((1.8, "#D55E00"), (2.5, "#0072B2")):
    model = car.replace(time_headway_seconds=headway)
    results = sp.monte_carlo(model, signals=["speed", "gap"], followers=8, realizations=1000, seed=1)
    seconds = results.steps * results.sample_period
    ratio = results.amplification.measured["l2_head_to_tail"]
    without_limits = linear.replace(time_headway_seconds=headway)
    theory = sp.analyze(without_limits, signals=["speed"], followers=8)["amplification.l2_head_to_tail"]
    gap = results.signals["gap"].mean[-1]
    print("headway {} s: speed of follower 8 over that of the leader: measured {:.4f}, linear theory {:.4f}".format(
        headway, ratio[-1], theory[-1]))
    print("headway {} s: smallest mean gap of follower 8: {:.2f} m".format(headway, gap.min()))
    speed.plot(seconds, results.signals["speed"].mean[-1], color=colour, label="follower 8, {} s".format(headway))
    gaps.plot(seconds, gap, color=colour)
    amplification.plot(i, ratio[1:], "o", color=colour, markersize=4, label="measured, {} s".format(headway))
    amplification.plot(i, theory[1:], color="#222222", linewidth=0.8, label="linear theory" if headway == 2.5 else None)
gaps.axhline(0, color="#222222", linewidth=0.8)
amplification.axhline(1, color="#222222", linestyle=":")
speed.set(xlabel="time [s]", ylabel="mean speed [m/s]", ylim=(-1, 30))
gaps.set(xlabel="time [s]", ylabel="mean gap of follower 8 [m]")
amplification.set(xlabel="follower $i$", ylabel="speed over that of the leader (L2)", xticks=i)
speed.legend(loc="upper left", fontsize=8)
amplification.legend(loc="upper left", fontsize=8)
figure.savefig(os.path.join(folder, "tutorial_5_drive.png"), dpi=200)
