"""All vehicles of one realization over time: gaps, tracking errors, speeds and accelerations, and where the gap is smallest."""

from __future__ import annotations

from typing import Optional, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from plotting import style
from plotting.values import Array, drawable

PANELS = (("gap", "gap [m]"), ("tracking_error", "tracking error [m]"), ("speed", "speed [m/s]"), ("acceleration", "acceleration [m/s$^2$]"))
AHEAD = style.SHORT_DASHED  # line of the predecessor
AROUND = 2.0  # [s] drawn on either side of --around


def around(realization: sp.Trajectories, step: int) -> sp.Trajectories:
    """The realization within AROUND seconds of a step."""
    steps, seconds = realization.steps, realization.seconds
    if not steps[0] <= step <= steps[-1]:
        raise ValueError("--around: {}: must be a step of {}, from {:.0f} to {:.0f}".format(step, realization.path, steps[0], steps[-1]))
    near = steps[np.abs(seconds - seconds[steps == step]) <= AROUND + 1e-9]
    return realization.between(near[0], near[-1])


def nearest(gap: Array) -> Tuple[int, int]:
    """The vehicle with the smallest gap, and the place of its step."""
    vehicle, at = np.unravel_index(np.argmin(np.where(np.isfinite(gap), gap, np.inf)), gap.shape)
    return int(vehicle), int(at)


def drawn(vehicles: int, worst: int) -> style.Indices:
    """The vehicles whose curves are drawn, always with the worst one and its predecessor."""
    return np.union1d(1 + style.drawn_followers(vehicles - 1), [0, worst - 1, worst])


def smallest_in_words(whole: sp.Trajectories, shown: sp.Trajectories) -> str:
    """The smallest gap of the steps that are shown, and that of the realization if it is another."""
    words = []
    for of in (shown, whole):
        gap = drawable(of["gap"])
        worst, at = nearest(gap)
        words.append("smallest gap {} m, follower {}, {:.4g} s (step {})".format(
            style.signed(gap[worst, at]), worst, of.seconds[at], int(of.steps[at])))
    if words[0] == words[1]:
        return words[0]
    return words[0].replace("gap", "gap in this window", 1) + ";\n" + words[1].replace("gap", "gap of the realization", 1)


def draw(whole: sp.Trajectories, titles: Sequence[str], step: Optional[int] = None) -> Figure:
    """Draws the realization, or its part around a step."""
    realization = whole if step is None else around(whole, step)
    name, = style.names_of(titles, [realization])
    gap, seconds = drawable(realization["gap"]), realization.seconds
    if not np.isfinite(gap).any():
        raise ValueError("{}: gap is empty everywhere: nothing to draw".format(realization.path))
    worst, at = nearest(gap)
    vehicles = gap.shape[0]
    shown = drawn(vehicles, worst)
    figure, axes = style.new_figure(2, 2, 11.4, 6.4)
    colours = style.follower_colours(vehicles - 1)
    for axis, (quantity, label) in zip(axes.flat, PANELS):
        draw_panel(axis, seconds, drawable(realization[quantity]), shown, worst, colours)
        axis.axvline(seconds[at], color=style.GREY, linewidth=1.0, zorder=1)
        axis.set_ylabel(label)
        axis.set_xlim(seconds[0], seconds[-1])
    for axis in axes[1]:
        axis.set_xlabel("time [s]")
    mark_smallest_gap(axes[0, 0], seconds[at], gap[worst, at])
    few = "" if shown.size == vehicles else ", {} of {} vehicles drawn".format(shown.size, vehicles)
    title = style.column_title(0, 1, "{}: {}{}".format(name, smallest_in_words(whole, realization), few), int(style.LETTERS * figure.get_figwidth()))
    figure.suptitle(title, fontsize=rcParams["axes.titlesize"])
    if np.setdiff1d(shown, [0, worst - 1, worst]).size:
        style.add_colour_bar(figure, axes, colours, vehicles - 1)
    of_vehicles = [
        style.legend_entry(color=style.INK, linewidth=2.4, label="follower {}: the smallest gap shown".format(worst)),
        style.legend_entry(color=style.INK, linewidth=1.3, linestyle=AHEAD,
                           label="{}, ahead of it".format("vehicle {}".format(worst - 1) if worst > 1 else "leader"))]
    collision, _ = axes[0, 0].get_legend_handles_labels()  # if it is near enough to be drawn
    style.legends_below(axes[1], [of_vehicles, [*collision, style.legend_entry(color=style.GREY, linewidth=1.0, label="the smallest gap shown")]])
    return figure


def draw_panel(axes: Axes, seconds: Array, values: Array, shown: style.Indices, worst: int, colours: ScalarMappable) -> None:
    """Draws the other vehicles thin, and above them the worst one and its predecessor."""
    crowded = seconds.size * shown.size > 4000
    for i in shown:
        if i not in (worst, worst - 1):
            axes.plot(seconds, values[i], color=style.INK if i == 0 else colours.to_rgba(i), linewidth=0.7, alpha=0.6,
                      rasterized=crowded)
    axes.plot(seconds, values[worst - 1], color=style.INK, linewidth=1.3, linestyle=AHEAD, zorder=4)
    axes.plot(seconds, values[worst], color="white", linewidth=4.2, zorder=4)
    axes.plot(seconds, values[worst], color=style.INK, linewidth=2.4, zorder=5)


def mark_smallest_gap(axes: Axes, second: float, gap: float) -> None:
    style.mark_collisions(axes)
    axes.plot([second], [gap], "o", color=style.INK, markersize=9, markerfacecolor="none", markeredgewidth=1.4, zorder=6)
