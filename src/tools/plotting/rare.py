"""Probabilities of small gaps: along the string, and over the standstill distance of several estimations."""

from __future__ import annotations

import json
from typing import Any, Dict, List, Sequence

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from plotting import style
from plotting.values import Array

LN10 = np.log(10.0)
ALONG_A_LINE = ("standstill_distance", "safe_gap", "vehicle_length", "allow_unstable")  # the distance, and keys that the event does not depend on
LEGEND_LINE = 34  # characters


def distance_of(run: sp.Rare) -> float:
    """The standstill distance of the default vehicle [m]."""
    return float(run.document["configuration"]["model"]["standstill_distance"])


def experiment_of(run: sp.Rare) -> str:
    """The event and all that its probability depends on but the standstill distance. Only estimations that share it lie on one line."""
    of = run.document["configuration"]
    model = {key: value for key, value in of["model"].items() if key not in ALONG_A_LINE}
    return json.dumps([model, run.followers, of["run"]["steps"], run.document["burn_in"], run.below], sort_keys=True)


def lines_of(runs: Sequence[sp.Rare]) -> List[List[int]]:
    """The numbers of the runs on each line over the standstill distance, in its order. A line has two distances or more."""
    lines: Dict[str, List[int]] = {}
    for at in sorted(range(len(runs)), key=lambda at: distance_of(runs[at])):
        lines.setdefault(experiment_of(runs[at]), []).append(at)
    return sorted((line for line in lines.values() if distance_of(runs[line[0]]) < distance_of(runs[line[-1]])), key=min)


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
    lines = lines_of(runs)
    panels = 2 if lines else 1
    figure, axes = style.new_figure(1, panels, 5.7 * panels, 5.0)
    along = axes[0, 0]
    along.set_title("{}probability of a gap below {} m in a run\nwith intervals of 95 %".format(
        "(a) " if panels > 1 else "", " / ".join(sorted({"{:g}".format(run.below) for run in runs}))))
    for at, (run, name) in enumerate(zip(runs, names)):
        draw_string(along, run, name, at)
    style.follower_axis(along, max(run.followers for run in runs))
    if lines:
        draw_distances(axes[0, 1], runs, names, lines)
    for axis in axes[0]:
        axis.yaxis.set_major_locator(MaxNLocator(8, integer=True))
        axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: "$10^{{{:g}}}$".format(value)))
        axis.set_ylabel("probability")
    style.legends_below(axes[0])
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


def draw_distances(axes: Axes, runs: Sequence[sp.Rare], names: Sequence[str], lines: Sequence[Sequence[int]]) -> None:
    """Draws the last common follower and any follower over the standstill distance, of several lines with the names of their runs."""
    last = min(runs[at].followers for line in lines for at in line)
    axes.set_title("(b) over the standstill distance")
    for line in lines:
        on_it = [runs[at] for at in line]
        several = len(lines) > 1
        for at, (label, values) in enumerate((
                ("follower {}".format(last), [(run.log10_probability[last - 1], run.relative_error[last - 1], run.lower[last - 1],
                                               run.upper[last - 1]) for run in on_it]),
                ("any follower", [tuple(run.any[name] for name in ("log10_probability", "relative_error", "lower", "upper")) for run in on_it]))):
            logarithm, error, lower, upper = np.array(values).T
            if several:
                label = style.column_title(0, 1, "{}: {}".format(label, ", ".join(names[run] for run in line)), LEGEND_LINE)
            axes.errorbar([distance_of(run) for run in on_it], logarithm, yerr=interval(logarithm, error, lower, upper), marker="o",
                          color=style.colour(min(line) if several else at), linestyle=style.SHORT_DASHED if several and at else "-",
                          markerfacecolor="white", linewidth=1.2, label=label, **style.POINTS)
    axes.set_xlabel("standstill distance [m]")
