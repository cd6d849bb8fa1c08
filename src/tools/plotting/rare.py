"""Probabilities of small gaps: along the string, and over the standstill distance of several estimations."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from plotting import style
from plotting.values import Array

LN10 = np.log(10.0)


def distance_of(run: sp.Rare) -> float:
    """The standstill distance of the default vehicle [m]."""
    return float(run.document["configuration"]["model"]["standstill_distance"])


def interval(logarithm: Array, error: Array, lower: Array, upper: Array) -> Any:
    """Lengths of the error bars on the common logarithm; by the relative error where an end is below the range of double."""
    about = 1.96 * error / LN10
    with np.errstate(invalid="ignore", divide="ignore"):
        down = np.where(lower > 0.0, logarithm - np.log10(lower), about)
        up = np.where(upper > 0.0, np.log10(upper) - logarithm, about)
    return [np.maximum(down, 0.0), np.maximum(up, 0.0)]


def draw(runs: Sequence[sp.Rare], titles: Sequence[str]) -> Figure:
    names = style.names_of(titles, runs)
    for run in runs:
        if not np.isfinite(run.log10_probability).any():
            raise ValueError("{}: all probabilities are empty: nothing to draw".format(run.path))
    distances = sorted({distance_of(run) for run in runs})
    panels = 2 if len(distances) > 1 else 1
    figure, axes = style.new_figure(1, panels, 5.7 * panels, 5.0)
    along = axes[0, 0]
    along.set_title("{}probability of a gap below {} m in a run\nwith intervals of 95 %".format(
        "(a) " if panels > 1 else "", " / ".join(sorted({"{:g}".format(run.below) for run in runs}))))
    for at, (run, name) in enumerate(zip(runs, names)):
        draw_string(along, run, name, at)
    style.follower_axis(along, max(run.followers for run in runs))
    if panels > 1:
        draw_distances(axes[0, 1], runs)
    for axis in axes[0]:
        axis.yaxis.set_major_locator(MaxNLocator(8, integer=True))
        axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: "$10^{{{:g}}}$".format(value)))
        axis.set_ylabel("probability")
        style.legend_below(axis)
    return figure


def draw_string(axes: Axes, run: sp.Rare, name: str, at: int) -> None:
    """Draws the run number `at`; the first one has the labels of the lines."""
    colour = style.colour(at)
    followers = np.arange(1, run.followers + 1)
    logarithm = run.log10_probability
    shown = style.thinned(run.followers, style.MANY)
    shown = shown[np.isfinite(logarithm[shown])]
    bars = interval(*(values[shown] for values in (logarithm, run.relative_error, run.lower, run.upper)))
    axes.errorbar(followers[shown], logarithm[shown], yerr=bars, fmt="o", color=colour, markerfacecolor="white", label=name, zorder=3,
                  **style.POINTS)
    hidden = np.flatnonzero(~np.isfinite(logarithm) & (run.upper > 0.0))
    if hidden.size:
        axes.plot(followers[hidden], np.log10(run.upper[hidden]), "v", color=colour, label="{}: upper limit alone".format(name))
    if (run.bound > 0.0).any():
        with np.errstate(invalid="ignore", divide="ignore"):
            axes.plot(followers, np.log10(run.bound), color=colour, linewidth=1.1, linestyle=style.DASHED,
                      label="upper bound by theory" if not axes.get_legend_handles_labels()[1].count("upper bound by theory") else "")
    axes.axhline(run.any["log10_probability"], color=colour, linewidth=1.0, linestyle="-.", label="" if at else "any follower")


def draw_distances(axes: Axes, runs: Sequence[sp.Rare]) -> None:
    """Draws the last common follower and any follower over the standstill distance."""
    last = min(run.followers for run in runs)
    ordered = sorted(runs, key=distance_of)
    distances = [distance_of(run) for run in ordered]
    axes.set_title("(b) over the standstill distance")
    for at, (label, values) in enumerate((
            ("follower {}".format(last), [(run.log10_probability[last - 1], run.relative_error[last - 1], run.lower[last - 1], run.upper[last - 1])
                                          for run in ordered]),
            ("any follower", [tuple(run.any[name] for name in ("log10_probability", "relative_error", "lower", "upper")) for run in ordered]))):
        logarithm, error, lower, upper = np.array(values).T
        axes.errorbar(distances, logarithm, yerr=interval(logarithm, error, lower, upper), fmt="o-", color=style.colour(at), markerfacecolor="white",
                      linewidth=1.2, label=label, **style.POINTS)
    axes.set_xlabel("standstill distance [m]")
