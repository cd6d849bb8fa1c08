#!/usr/bin/python3
"""How far apart do the cars have to be, and which of 10,000 realizations is the worst?"""

import argparse
import os

import matplotlib.pyplot as plt
import numpy as np
import stochastic_platoon as sp

parser = argparse.ArgumentParser(description=__doc__, epilog="Example: tutorial_4_gaps.py /tmp/tutorial")
parser.add_argument("folder", nargs="?", default=".", help="folder for the picture, made if there is none (default: %(default)s)")
folder = parser.parse_args().folder
os.makedirs(folder, exist_ok=True)
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e4e4"})
figure, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.8), constrained_layout=True)

model = sp.Model.load("paper_at_rest.yaml")  # leader at rest, standstill distance 2 m
analysis = sp.analyze(model, signals=["gap"], collision_probability=1e-6)
required = analysis["collision.required_standstill_distances"]  # [m], one per follower
print("required standstill distance: {:.3f} m of follower 1, {:.3f} m of follower 20".format(required[0], required[-1]))

i = np.arange(1, 21)
for distance, colour in ((model.vehicle(1).standstill_distance, "#D55E00"), (required[-1], "#0072B2")):
    apart = model.replace(standstill_distance=distance)
    results = sp.monte_carlo(apart, signals=["gap"], realizations=10000, seed=1)
    left.plot(i, results.gaps.smallest_gap, "o-", color=colour, markersize=4, label="{:.3f} m apart".format(distance))
    print("{:.3f} m apart: follower 20 collides in {:.0f} of 10000 realizations, the smallest gap of follower 20 is {:.3f} m".format(
        distance, results.gaps.collisions[-1], results.gaps.smallest_gap[-1]))
    if distance == 2.0:
        worst = results.summary["smallest_gap"]  # of all followers
        replay = sp.trajectories(apart, worst["realization"], realizations=10000, seed=1)
left.axhline(0, color="#222222", linewidth=0.8)
left.set(xlabel="follower $i$", ylabel="smallest gap in 10,000 realizations [m]", xticks=[1, 5, 10, 15, 20])
left.set_title("Leader at rest, smallest gap of each follower")
left.legend()

# The same noise gives the same realization, now with all its signals.
vehicle, step = worst["vehicle"], worst["step"]
at = np.flatnonzero(replay.steps == step)[0]
print("worst: {gap:.3f} m, follower {vehicle}, realization {realization}, step {step}".format(**worst))
print("replayed: {:.3f} m at {:.1f} s".format(replay["gap"][vehicle, at], replay.seconds[at]))
right.plot(replay.seconds, replay["gap"][1:].T, color="#c8c8c8", linewidth=0.8)
right.plot(replay.seconds, replay["gap"][vehicle], color="#D55E00", label="follower {}".format(vehicle))
right.plot(replay.seconds[at], replay["gap"][vehicle, at], "o", color="#222222", markersize=5, label="worst gap")
right.plot([], [], color="#c8c8c8", label="other followers")
right.axhline(0, color="#222222", linewidth=0.8)
right.set(xlabel="time [s]", ylabel="gap [m]", title="Realization {}, 2 m apart".format(worst["realization"]), ylim=(None, 6.5))
right.legend(loc="upper left", ncol=3, columnspacing=1.0, handlelength=1.2, fontsize=8)
figure.savefig(os.path.join(folder, "tutorial_4_gaps.png"), dpi=200)
