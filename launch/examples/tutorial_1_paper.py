#!/usr/bin/python3
"""The paper's example: does the variance of the tracking error stay bounded along the string?"""

import argparse
import os

import matplotlib.pyplot as plt
import numpy as np
import stochastic_platoon as sp

COLOURS = {3.2: "#0072B2", 2.4: "#D55E00"}

parser = argparse.ArgumentParser(description=__doc__, epilog="Example: tutorial_1_paper.py /tmp/tutorial")
parser.add_argument("folder", nargs="?", default=".", help="folder for the picture, made if there is none (default: %(default)s)")
folder = parser.parse_args().folder
os.makedirs(folder, exist_ok=True)
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e4e4"})
figure, axes = plt.subplots(figsize=(7.2, 3.8), constrained_layout=True)

model = sp.Model.load("paper.yaml")
critical = sp.analyze(model).critical_headway  # [sample periods]
print("critical headway: {:.3f} s ({:.3f} sample periods)".format(critical * model.sample_period, critical))

i = np.arange(1, 21)
for h, colour in COLOURS.items():
    one = model.replace(time_headway=h)
    analysis = sp.analyze(one)
    results = sp.monte_carlo(one, realizations=10**5, seed=1)
    measured, error = results.variance[:, -1], results.standard_error_of_variance
    print("h = {}: follower 20: measured {:.4g} +- {:.2g} m^2, theory {:.4g} m^2, {}".format(
        h, measured[-1], error[-1], analysis.variance[-1, -1], "string stable" if analysis.string_stable else "not string stable"))
    axes.errorbar(i, measured, 2 * error, color=colour, fmt="o", markersize=4, capsize=2, label="measured, h = {} sample periods".format(h))
    axes.plot(i, analysis.variance[:, -1], color="#222222", linewidth=0.8, label="theory" if h == 2.4 else None)
    if analysis.string_stable:
        axes.axhline(analysis.limit_variance, color=colour, linestyle=":", label="limit of an endless string, h = {}".format(h))
        print("h = {}: limit of an endless string: {:.4g} m^2".format(h, analysis.limit_variance))

axes.set(xlabel="follower $i$", ylabel="variance of the tracking error [m$^2$]", yscale="log", xticks=[1, 5, 10, 15, 20])
axes.set_title("After 10 s, 100,000 realizations, bars: 2 standard errors", fontsize=9.5)
axes.legend()
figure.savefig(os.path.join(folder, "tutorial_1_paper.png"), dpi=200)
