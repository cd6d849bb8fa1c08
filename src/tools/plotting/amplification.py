"""Amplification of the speed along the string: ratio per vehicle and head to tail, and the acceleration, measured beside theory."""

from __future__ import annotations

from typing import List, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plotting import style
from plotting.values import Array, drawable

RATIOS = ["l2_ratio", "linf_ratio", "l2_head_to_tail", "linf_head_to_tail"]
Kind = Tuple[str, str, style.Line, str]  # name, marker, line, label
NORMS: Sequence[Kind] = (("l2", "o", "-", "$L_2$"), ("linf", "s", style.SHORT_DASHED, "$L_\\infty$"))
ACCELERATIONS: Sequence[Kind] = (("rms_acceleration", "o", "-", "with noise"),
                                 ("rms_mean_acceleration", "s", style.SHORT_DASHED, "of the mean motion"))


def drawable_amplification(run: sp.Results) -> sp.Amplification:
    """The amplification of a run. Raises ValueError unless a figure can show some ratios."""
    given = run.amplification
    measured, theory = ({name: drawable(values) for name, values in table.items()} for table in (given.measured, given.theory))
    if not any(np.isfinite(table[name]).any() for table in (measured, theory) for name in RATIOS):
        reason = "the leader drives at constant speed" if measured["rms_mean_speed"][0] == 0.0 else "noise hides the motion"
        if run.realizations == 1:
            reason = "one realization does not separate the motion from the noise"
        raise ValueError("{}: all ratios are empty, as {}: nothing to draw".format(run.path, reason))
    return sp.Amplification(measured, theory, given.seconds)


def draw(runs: Sequence[sp.Results], titles: Sequence[str]) -> Figure:
    names, tables = style.names_of(titles, runs), [drawable_amplification(run) for run in runs]
    accelerated = any(np.isfinite(table.measured["rms_acceleration"]).any() for table in tables)
    figure, axes = style.new_figure(1, 2 + accelerated, 4.6 * (2 + accelerated), 4.3)
    ratio, tail = axes[0, :2]
    draw_ratios(ratio, tables, "ratio")
    draw_ratios(tail, tables, "head_to_tail")
    for column, text in enumerate(("speed, ratio to the predecessor", "speed, ratio to the leader (head to tail)")):
        axes[0, column].set_title(style.column_title(column, 3, text))
    for axis in (ratio, tail):
        axis.axhline(1.0, color=style.GREY, linewidth=1.0, zorder=1)
        axis.set_ylabel("ratio of norms\nabout the average")
    if accelerated:
        draw_accelerations(axes[0, 2], tables)
    for axis in axes[0]:
        style.follower_axis(axis, max(run.followers for run in runs))
    legends = [[entry_of_run(at, run, name) for at, (run, name) in enumerate(zip(runs, names))], entries_of(NORMS, tables)]
    if accelerated:
        acceleration = axes[0, 2]
        acceleration.set_xlim(-0.7, acceleration.get_xlim()[1])
        # Without the tick 1 where its label would touch that of the leader.
        acceleration.set_xticks([0] + [tick for tick in acceleration.get_xticks() if tick > 0.05 * max(run.followers for run in runs)])
        acceleration.set_xlabel("vehicle $i$, 0 the leader")
        legends.append(entries_of(ACCELERATIONS, tables))
    style.legends_below(axes[0], legends)
    return figure


def entry_of_run(at: int, run: sp.Results, name: str) -> Line2D:
    return style.legend_entry(color=style.colour(at), linewidth=3.0, label="{}, {}{}\n{}, {:g} to {:g} s".format(
        name, style.verdict(run.string_stable), "" if run.complete else ", incomplete run", style.counted(run.realizations),
        *run.amplification.seconds))


def entries_of(kinds: Sequence[Kind], tables: Sequence[sp.Amplification]) -> List[Line2D]:
    entries = []
    for name, marker, line, label in kinds:
        if any(np.isfinite(values).any() for table in tables for key, values in table.theory.items() if key.startswith(name)):
            entries.append(style.legend_entry(color=style.INK, linewidth=1.3, linestyle=line, label=label + ", theory"))
        entries.append(style.legend_entry(
            color=style.INK, linestyle="", marker=marker, markerfacecolor="white", markersize=5, label=label + ", measured"))
    return entries


def draw_pair(axes: Axes, at: int, first: int, measured: Array, theory: Array, marker: str, line: style.Line) -> None:
    """Draws the theory as a line and the measurement as markers; the first value belongs to vehicle `first`."""
    style.draw_theory(axes, theory, first, color=style.colour(at), linewidth=1.3, linestyle=line)
    shown = style.thinned(measured.size, style.MANY)
    axes.plot(first + shown, measured[shown], marker, color=style.colour(at), markerfacecolor="white", markersize=4.5, zorder=3)


def draw_ratios(axes: Axes, tables: Sequence[sp.Amplification], kind: str) -> None:
    drawn = []
    for at, table in enumerate(tables):
        for norm, marker, line, _ in NORMS:
            measured, theory = (of["{}_{}".format(norm, kind)][1:] for of in (table.measured, table.theory))
            draw_pair(axes, at, 1, measured, theory, marker, line)
            drawn += [measured, theory]
    values = np.concatenate(drawn)
    values = values[np.isfinite(values)]
    if values.size and values.max() > 10.0 * values.min():
        style.logarithmic(axes)


def draw_accelerations(axes: Axes, tables: Sequence[sp.Amplification]) -> None:
    axes.set_title("(c) acceleration")
    axes.set_ylabel("RMS acceleration [m/s$^2$]")
    largest = []
    for at, table in enumerate(tables):
        for name, marker, line, _ in ACCELERATIONS:
            draw_pair(axes, at, 0, table.measured[name], table.theory[name], marker, line)
            if np.isfinite(table.measured[name]).any():
                largest.append(np.nanmax(table.measured[name]))
    if max(largest) > 30.0 * min(largest) > 0.0:
        style.logarithmic(axes)
    else:
        axes.set_ylim(bottom=0.0)
