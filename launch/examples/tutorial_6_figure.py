#!/usr/bin/python3
"""A figure for a paper: two columns wide, as vectors, with a confidence band, its data and its runs."""

import argparse
import os
from typing import Any, List

import matplotlib.pyplot as plt
import numpy as np
import stochastic_platoon as sp

REALIZATIONS, SHOWN = 1000, {1: "#0072B2", 5: "#009E73", 20: "#D55E00"}
CONFIDENCE = 1.96  # half width in standard errors of a band that holds 95 % of Gaussian estimates

parser = argparse.ArgumentParser(description=__doc__, epilog="Example: tutorial_6_figure.py /tmp/tutorial")
parser.add_argument("folder", nargs="?", default=".", help="folder for the picture, made if there is none (default: %(default)s)")
folder = parser.parse_args().folder
os.makedirs(folder, exist_ok=True)
plt.rcParams.update({
    "font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 8, "axes.linewidth": 0.6, "lines.linewidth": 1.0,
    "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False,
    "pdf.fonttype": 42, "svg.fonttype": "none"})  # text stays text: journals reject Type 3 fonts
figure, columns = plt.subplots(1, 2, figsize=(7.16, 2.4), constrained_layout=True)  # [inch]: two columns of the IEEE

rows: List[Any] = []
for axes, letter, h in zip(columns, "ab", (3.2, 2.4)):
    run = os.path.join(folder, "run_h{}".format(h))  # computed once; delete the folder to compute it anew
    if not os.path.exists(run):
        sp.monte_carlo(sp.Model.load("paper.yaml").replace(time_headway=h), realizations=REALIZATIONS, seed=1, output=run)
    results = sp.Results.load(run)
    error = results.variance * np.sqrt(2 / (results.count - 1))  # of the unbiased variance of Gaussian samples [m^2]
    seconds = results.steps * results.sample_period
    for follower, colour in SHOWN.items():
        measured, half, theory = (array[follower - 1] for array in (results.variance, CONFIDENCE * error, results.theoretical_variance))
        axes.fill_between(seconds, measured - half, measured + half, color=colour, alpha=0.3, linewidth=0)
        axes.plot(seconds, theory, color=colour, label="$i = {}$".format(follower))
        rows += zip([h] * seconds.size, [follower] * seconds.size, seconds, measured, error[follower - 1], theory)
    inside = np.abs(results.variance - results.theoretical_variance)[:, 1:] <= CONFIDENCE * error[:, 1:]  # at step 0 both are 0
    print("h = {}: theory within the band of {} of {} (follower, step) pairs: {:.1f} %".format(
        h, inside.sum(), inside.size, 100 * inside.mean()))
    print("h = {}: half width of the band of follower 20 at {:.1f} s: {:.1f} % of the variance".format(
        h, seconds[-1], 100 * CONFIDENCE * error[-1, -1] / results.variance[-1, -1]))
    axes.set(xlabel="time [s]", ylabel="variance of $\\zeta_i$ [m$^2$]", xlim=(0, 10), ylim=(0, None))
    axes.set_title("({}) $h = {}$, {}".format(letter, h, "string stable" if results.string_stable else "not string stable"), fontsize=8)
    axes.legend(loc="upper left" if h == 2.4 else "lower right")

np.savetxt(os.path.join(folder, "tutorial_6_figure.csv"), rows, delimiter=",", comments="", fmt="%.9g",
           header="time_headway,follower,seconds,variance,standard_error,theoretical_variance")
for kind in ("pdf", "svg", "png"):
    figure.savefig(os.path.join(folder, "tutorial_6_figure." + kind), dpi=300)
