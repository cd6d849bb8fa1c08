"""Mean and variance of the tracking errors zeta_i(k): over the steps, or along the string for time averages.

The paper's figures for zero and for non-zero initial conditions (fig:all_zero_ic, fig:all_dif_ic).
"""

from __future__ import annotations

from typing import Sequence

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from plotting import style
from plotting.values import Array, drawable, drawable_errors

MOST_CURVES = 40  # longer strings show only some followers
CURVES_OF_MANY = 16
CROWDED = 300  # more steps than this are drawn with finer lines, rasterized in the SVG


def draw(runs: Sequence[sp.Results], titles: Sequence[str]) -> Figure:
    if len({run.time_average for run in runs}) > 1:
        average = next(run for run in runs if run.time_average)
        raise ValueError("{}: holds time averages; they do not go into one figure with ensemble statistics"
                         .format(average.path))
    names = style.names_of(titles, runs)
    figure, axes = style.new_figure(2, len(runs), 1.2 + 4.0 * len(runs), 5.6)
    followers = max(run.followers for run in runs)
    colours = ScalarMappable(Normalize(1, max(followers, 2)), style.FOLLOWERS)
    colours.set_array([])
    for column, (run, name) in enumerate(zip(runs, names)):
        axes[0, column].set_title(style.column_title(column, len(runs), title(run, name)))
        (draw_time_average if run.time_average else draw_over_steps)(axes[:, column], run, colours)
    if not runs[0].time_average:
        axes[1, 0].legend(handles=[
            style.legend_entry(color="#8a8a8a", linewidth=3.0, alpha=0.75, label="measured"),
            style.legend_entry(color=style.INK, linewidth=0.7, label="theory")])
        if followers > 1:
            add_colour_bar(figure, axes, colours, followers)
    return figure


def add_colour_bar(figure: Figure, axes: style.AxesGrid, colours: ScalarMappable, followers: int) -> None:
    bar = figure.colorbar(colours, ax=list(axes.flat), location="top", aspect=60, fraction=0.05, pad=0.02)
    bar.set_label("follower $i$")
    bar.set_ticks(style.follower_ticks(followers))
    bar.outline.set_visible(False)


def title(run: sp.Results, name: str) -> str:
    second = "{} realization{}, seed {}".format(style.spaced(run.realizations), "s" * (run.realizations != 1),
                                               run.seed)
    if run.time_average:
        second = "average over time up to step {}, seed {}".format(style.spaced(int(run.steps[-1])), run.seed)
    elif drawn(run).size < run.followers:
        second += ", {} of {} followers drawn".format(drawn(run).size, run.followers)
    if not run.complete:
        second += ", incomplete run"
    return "{}, {}\n{}".format(name, style.verdict(run.string_stable), second)


def drawn(run: sp.Results) -> style.Indices:
    """Rows of the followers whose curves are drawn."""
    return style.thinned(run.followers, run.followers if run.followers <= MOST_CURVES else CURVES_OF_MANY)


def draw_over_steps(axes: style.AxesGrid, run: sp.Results, colours: ScalarMappable) -> None:
    errors = drawable_errors(run)
    draw_curves(axes[0], run, errors.mean, errors.theoretical_mean, colours, "mean of $\\zeta_i(k)$", "m")
    draw_curves(axes[1], run, errors.variance, errors.theoretical_variance, colours, "variance of $\\zeta_i(k)$", "m$^2$")
    axes[1].set_xlabel("step $k$")
    axes[1].xaxis.set_major_locator(MaxNLocator(nbins=6, integer=True))


def draw_curves(axes: Axes, run: sp.Results, measured: Array, theory: Array, colours: ScalarMappable, quantity: str, unit: str) -> None:
    """Draws measured curves broad and coloured, and theory thin and dark on top of them."""
    wide = style.spread(measured) > style.WIDE_RANGE or run.spectral_radius >= 1.0
    if wide:
        measured, theory = (np.where(curves == 0.0, np.nan, np.abs(curves)) for curves in (measured, theory))
        quantity = "|{}|".format(quantity) if unit == "m" else quantity
    axes.set_ylabel("{} [{}]".format(quantity, unit))
    crowded = run.steps.size > CROWDED
    for i in drawn(run):
        axes.plot(run.steps, measured[i], color=colours.to_rgba(i + 1), linewidth=1.2 if crowded else 2.4,
                  alpha=0.75, solid_capstyle="round", marker="." if run.steps.size == 1 else "",
                  rasterized=crowded)
        axes.plot(run.steps, theory[i], color=style.INK, linewidth=0.45, zorder=3, rasterized=crowded)
    if wide:
        seen = measured[np.isfinite(measured)]
        axes.set_ylim(0.1 * np.percentile(seen, 1), 5.0 * seen.max())
        style.logarithmic(axes)


def draw_time_average(axes: style.AxesGrid, run: sp.Results, _: ScalarMappable) -> None:
    average = drawable_errors(run)
    i = np.arange(1, run.followers + 1)
    shown = style.thinned(run.followers, style.MANY)
    for axis, measured, theory, errors, quantity in (
            (axes[0], average.mean, average.theoretical_mean, None, "mean of $\\zeta_i$ over time [m]"),
            (axes[1], average.variance, average.theoretical_variance, style.bars(drawable(run.standard_error_of_variance)[shown]),
             "variance of $\\zeta_i$ over time [m$^2$]")):
        axis.plot(i, theory[:, 0], color=style.INK, linewidth=1.0, label="theory, stationary")
        axis.errorbar(i[shown], measured[shown, 0], yerr=errors, fmt="o",
                      color=style.PALETTE[0], markersize=4.5, capsize=2.5, elinewidth=1.0, label="measured")
        axis.set_ylabel(quantity)
    if style.spread(average.variance) > style.WIDE_RANGE:
        style.logarithmic(axes[1])
    axes[0].legend()
    style.follower_axis(axes[1], run.followers)
