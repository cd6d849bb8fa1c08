#!/usr/bin/python3
"""Positions by radio, some of them lost: how many losses does the string tolerate?"""

import argparse
import os

import matplotlib.pyplot as plt
import numpy as np
import stochastic_platoon as sp

parser = argparse.ArgumentParser(description=__doc__, epilog="Example: tutorial_3_losses.py /tmp/tutorial")
parser.add_argument("folder", nargs="?", default=".", help="folder for the picture, made if there is none (default: %(default)s)")
folder = parser.parse_args().folder
os.makedirs(folder, exist_ok=True)
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
figure, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.8), constrained_layout=True)

model = sp.Model.load("lossy.yaml")  # the paper's vehicle at h = 3.2, which extrapolates a lost position
for policy, colour in (("hold", "#0072B2"), ("extrapolate", "#D55E00")):
    link = model.replace({"channel/loss/on_loss": policy})
    losses = np.linspace(0, 0.3, 21)
    headways = [sp.analyze(link.replace(loss=q), followers=1, steps=1).critical_headway for q in losses]
    left.plot(losses, headways, color=colour, label=policy)
    tenth = sp.analyze(link.replace(loss=0.1))
    critical = tenth["critical_loss_probability"]
    print("{}: critical loss probability at h = 3.2: {}".format(policy, "none" if critical is None else "{:.4f}".format(critical)))
    print("{}: at a loss of 0.1: critical headway {:.4f} s, limit variance {:.3f} m^2".format(
        policy, tenth["critical_headway_seconds"], tenth.limit_variance))
left.axhline(3.2, color="#222222", linestyle=":", label="h = 3.2")
left.set(xlabel="loss probability", ylabel="critical headway [sample periods]", title="String stable above the curve", ylim=(2.5, 4.5))
left.legend(frameon=False, loc="upper left")

# Losses in bursts: white where a burst of this mean length cannot have this probability.
stability = sp.stability_map(model, loss=np.linspace(0.02, 0.6, 30), mean_burst=np.linspace(1, 4, 31))
colours = plt.matplotlib.colors.ListedColormap(["#f6d9c6", "#cfe3f1"])
right.pcolormesh(stability.xs, stability.ys, stability.string_stable, cmap=colours, shading="nearest", rasterized=True)
rates = np.linspace(0.02, 0.33, 16)
bursts = [sp.analyze(model.replace(loss=q), followers=1, steps=1)["critical_mean_burst"] for q in rates]
right.plot(rates, bursts, color="#222222", label="critical mean burst")
independent = np.linspace(0.02, 0.6, 30)
right.plot(independent, 1 / (1 - independent), color="#222222", linestyle=":", label="independent losses")
right.text(0.04, 1.6, "string stable")
right.text(0.30, 3.0, "not string stable")
right.set(xlabel="loss probability", ylabel="mean burst [steps]", title="extrapolate, h = 3.2", ylim=(0.95, 4.05))
right.legend(frameon=False, loc="upper right")

print("extrapolate: critical mean burst at a loss of 0.1: {:.3f} steps".format(sp.analyze(model)["critical_mean_burst"]))
results = sp.monte_carlo(model, realizations=20000, seed=1)
print("extrapolate: follower 20 at a loss of 0.1: measured {:.3f} +- {:.2g} m^2, theory {:.3f} m^2".format(
    results.variance[-1, -1], results.standard_error_of_variance[-1], results.theoretical_variance[-1, -1]))
figure.savefig(os.path.join(folder, "tutorial_3_losses.png"), dpi=200)
