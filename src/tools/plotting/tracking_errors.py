"""Mean and variance of the tracking errors zeta_i(k): over the steps, or along the string for time averages.

The paper's figures for zero and for non-zero initial conditions (fig:all_zero_ic, fig:all_dif_ic).
"""

from __future__ import annotations

from typing import Sequence

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from plotting import style
from plotting.values import Array, drawable, drawable_errors

CROWDED = 300  # more steps than this are drawn with finer lines, rasterized in the SVG


def draw(runs: Sequence[sp.Results], titles: Sequence[str]) -> Figure:
    if len({run.time_average for run in runs}) > 1:
        average = next(run for run in runs if run.time_average)
        raise ValueError("{}: holds time averages; they do not go into one figure with ensemble statistics"
                         .format(average.path))
    names = style.names_of(titles, runs)
    figure, axes = style.new_figure(2, len(runs), 1.2 + 4.0 * len(runs), 5.6)
    followers = max(run.followers for run in runs)
    colours = style.follower_colours(followers)
    for column, (run, name) in enumerate(zip(runs, names)):
        axes[0, column].set_title(style.column_title(column, len(runs), title(run, name)))
        if run.time_average:
            draw_time_average(axes[:, column], run)
        else:
            draw_over_steps(axes[:, column], run, colours)
    if not runs[0].time_average:
        entries = [style.legend_entry(color=style.GREY, linewidth=3.0, alpha=0.75, label="measured"),
                   style.legend_entry(color=style.INK, linewidth=0.7, label="theory")]
        has_theory = any(np.isfinite(run.theoretical_variance).any() for run in runs)
        axes[1, 0].legend(handles=entries if has_theory else entries[:1])
        if followers > 1:
            style.add_colour_bar(figure, axes, colours, followers)
    return figure


def title(run: sp.Results, name: str) -> str:
    drawn = style.drawn_followers(run.followers).size
    second = "{}, seed {}".format(style.counted(run.realizations), run.seed)
    if run.time_average:
        second = "average over time {}, seed {}".format(style.end_of_average(run), run.seed)
    elif drawn < run.followers:
        second += ", {} of {} followers drawn".format(drawn, run.followers)
    if not run.complete:
        second += ", incomplete run"
    return "{}, {}\n{}".format(name, style.verdict(run.string_stable), second)


def draw_over_steps(axes: style.AxesGrid, run: sp.Results, colours: ScalarMappable) -> None:
    errors = drawable_errors(run)
    draw_curves(axes[0], run, errors.mean, errors.theoretical_mean, colours, "mean of $\\zeta_i(k)$", "m")
    draw_curves(axes[1], run, errors.variance, errors.theoretical_variance, colours, "variance of $\\zeta_i(k)$", "m$^2$")
    in_seconds = np.isfinite(style.period_of(run))
    axes[1].set_xlabel("time [s]" if in_seconds else "step $k$")
    axes[1].xaxis.set_major_locator(MaxNLocator(nbins=6, integer=not in_seconds))


def draw_curves(axes: Axes, run: sp.Results, measured: Array, theory: Array, colours: ScalarMappable, quantity: str, unit: str) -> None:
    """Draws measured curves broad and coloured, and theory thin and dark on top of them."""
    wide = style.spread(measured) > style.WIDE_RANGE or run.spectral_radius >= 1.0
    if wide:
        measured, theory = (np.where(curves == 0.0, np.nan, np.abs(curves)) for curves in (measured, theory))
        quantity = "|{}|".format(quantity) if unit == "m" else quantity
    axes.set_ylabel("{} [{}]".format(quantity, unit))
    crowded = run.steps.size > CROWDED
    times = run.steps * style.period_of(run) if np.isfinite(style.period_of(run)) else run.steps
    for i in style.drawn_followers(run.followers):
        axes.plot(times, measured[i], color=colours.to_rgba(i + 1), linewidth=1.2 if crowded else 2.4,
                  alpha=0.75, solid_capstyle="round", marker="." if run.steps.size == 1 else "",
                  rasterized=crowded)
        axes.plot(times, theory[i], color=style.INK, linewidth=0.45, zorder=3, rasterized=crowded)
    if wide:
        seen = measured[np.isfinite(measured)]
        axes.set_ylim(0.1 * np.percentile(seen, 1), 5.0 * seen.max())
        style.logarithmic(axes)


def draw_time_average(axes: style.AxesGrid, run: sp.Results) -> None:
    average = drawable_errors(run)
    for axis, measured, theory, errors, quantity in (
            (axes[0], average.mean, average.theoretical_mean, None, "mean of $\\zeta_i$ over time [m]"),
            (axes[1], average.variance, average.theoretical_variance, style.SHOWN_ERRORS * drawable(run.standard_error_of_variance),
             "variance of $\\zeta_i$ over time [m$^2$]")):
        style.draw_theory(axis, theory[:, 0], color=style.INK, linewidth=1.0, label="theory, stationary")
        style.draw_measured(axis, measured[:, 0], errors, fmt="o", color=style.PALETTE[0], label="measured")
        axis.set_ylabel(quantity)
    if style.spread(average.variance) > style.WIDE_RANGE:
        style.logarithmic(axes[1])
    axes[0].legend()
    style.follower_axis(axes[1], run.followers)
