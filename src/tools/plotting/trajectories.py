"""All vehicles of one realization over time: gaps, tracking errors, speeds and accelerations, and where the gap is smallest."""

import os
from collections import namedtuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from plotting import style
from plotting.inputs import InputError, drawable, read_columns
from plotting.tracking_errors import CURVES_OF_MANY, MOST_CURVES, add_colour_bar

PANELS = (("gap", "gap [m]"), ("tracking_error", "tracking error [m]"), ("speed", "speed [m/s]"), ("acceleration", "acceleration [m/s$^2$]"))
COLUMNS = ["vehicle", "step", "seconds"] + [name for name, _ in PANELS]
AHEAD = (0, (3, 1.5))  # line of the predecessor
AROUND = 2.0  # [s] drawn on either side of --around

# Arrays (vehicles 0..N, steps), NaN where there is no value; steps and seconds have an element per step.
Realization = namedtuple("Realization", "path name steps seconds gap tracking_error speed acceleration")


def read_realization(path):
    if os.path.isdir(path):
        path = os.path.join(path, "trajectories.csv")
    columns = read_columns(path, COLUMNS)
    vehicle, step = columns["vehicle"], columns["step"]
    order = np.lexsort((step, vehicle))
    vehicles, steps = np.unique(vehicle).size, np.unique(step)
    if vehicles < 2 or not np.array_equal(vehicle[order], np.repeat(np.arange(vehicles), steps.size)) \
            or not np.array_equal(step[order], np.tile(steps, vehicles)):
        raise InputError("{}: must hold one row for each vehicle 0..N and step; rows are missing or double".format(path))
    table = {name: drawable(columns[name])[order].reshape(vehicles, steps.size) for name, _ in PANELS}
    if not np.isfinite(table["gap"]).any():
        raise InputError("{}: gap is empty everywhere: nothing to draw".format(path))
    return Realization(path, os.path.basename(os.path.dirname(os.path.abspath(path))), steps,
                       columns["seconds"][order].reshape(vehicles, steps.size)[0], **table)


def around(realization, step):
    """The realization within AROUND seconds of a step."""
    first, last = int(realization.steps[0]), int(realization.steps[-1])
    if not first <= step <= last:
        raise InputError("--around: {}: must be a step of {}, from {} to {}".format(step, realization.path, first, last))
    kept = np.abs(realization.seconds - realization.seconds[realization.steps == step]) <= AROUND + 1e-9
    changes = {name: getattr(realization, name)[:, kept] for name, _ in PANELS}
    return realization._replace(steps=realization.steps[kept], seconds=realization.seconds[kept], **changes)


def nearest(realization):
    """The vehicle with the smallest gap, and the place of its step."""
    gap = np.where(np.isfinite(realization.gap), realization.gap, np.inf)
    return np.unravel_index(np.argmin(gap), gap.shape)


def drawn(vehicles, worst):
    """The vehicles whose curves are drawn, in any string the worst one and its predecessor."""
    followers = vehicles - 1
    if followers <= MOST_CURVES:
        return np.arange(vehicles)
    return np.union1d(np.append(0, 1 + style.thinned(followers, CURVES_OF_MANY)), [worst - 1, worst])


def draw(realization, titles):
    name, = style.names_of(titles, [realization])
    worst, at = nearest(realization)
    vehicles = realization.gap.shape[0]
    shown = drawn(vehicles, worst)
    figure, axes = style.new_figure(2, 2, 11.4, 6.4)
    colours = ScalarMappable(Normalize(1, max(vehicles - 1, 2)), style.FOLLOWERS)
    colours.set_array([])
    for axis, (quantity, label) in zip(axes.flat, PANELS):
        draw_panel(axis, realization, getattr(realization, quantity), shown, worst, colours)
        axis.axvline(realization.seconds[at], color="#8a8a8a", linewidth=1.0, zorder=1)
        axis.set_ylabel(label)
    for axis in axes[1]:
        axis.set_xlabel("time [s]")
        axis.set_xlim(realization.seconds[0], realization.seconds[-1])
    mark_smallest_gap(axes[0, 0], realization, worst, at)
    few = "" if shown.size == vehicles else ", {} of {} vehicles drawn".format(shown.size, vehicles)
    figure.suptitle("{}: smallest gap {} m, follower {}, step {} ({:.4g} s){}".format(
        name, style.signed(realization.gap[worst, at]), worst, int(realization.steps[at]), realization.seconds[at], few), fontsize=9.5)
    if np.setdiff1d(shown, [0, worst - 1, worst]).size:
        add_colour_bar(figure, axes, colours, vehicles - 1)
    style.legend_below(axes[1, 0], handles=[
        style.legend_entry(color=style.INK, linewidth=2.4, label="follower {}: the smallest gap".format(worst)),
        style.legend_entry(color=style.INK, linewidth=1.3, linestyle=AHEAD,
                           label="{}, ahead of it".format("vehicle {}".format(worst - 1) if worst > 1 else "leader"))])
    style.legend_below(axes[1, 1], handles=[
        style.legend_entry(color=style.BOUND, linewidth=1.2, label="gap 0: below it a collision"),
        style.legend_entry(color="#8a8a8a", linewidth=1.0, label="the smallest gap")])
    return figure


def draw_panel(axes, realization, values, shown, worst, colours):
    """Draws the other vehicles thin, and above them the worst one and its predecessor."""
    seconds = realization.seconds
    crowded = seconds.size * shown.size > 4000
    for i in shown:
        if i not in (worst, worst - 1):
            axes.plot(seconds, values[i], color=style.INK if i == 0 else colours.to_rgba(i), linewidth=0.7, alpha=0.6,
                      rasterized=crowded)
    axes.plot(seconds, values[worst - 1], color=style.INK, linewidth=1.3, linestyle=AHEAD, zorder=4)
    axes.plot(seconds, values[worst], color="white", linewidth=4.2, zorder=4)
    axes.plot(seconds, values[worst], color=style.INK, linewidth=2.4, zorder=5)


def mark_smallest_gap(axes, realization, worst, at):
    style.mark_collisions(axes)
    axes.plot([realization.seconds[at]], [realization.gap[worst, at]], "o", color=style.INK, markersize=9, markerfacecolor="none",
              markeredgewidth=1.4, zorder=6)
