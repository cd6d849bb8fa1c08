"""Amplification of the speed along the string: ratio per vehicle and head to tail, and the acceleration, measured beside theory."""

import os
from collections import namedtuple

import numpy as np

from plotting import style
from plotting.inputs import (InputError, drawable, number, read_columns, read_summary, require_folder, truth, truth_if_any)

RATIOS = ["l2_ratio", "linf_ratio", "l2_head_to_tail", "linf_head_to_tail"]
FIGURES = RATIOS + ["rms_mean_speed", "rms_acceleration", "rms_mean_acceleration"]
COLUMNS = ["vehicle"] + FIGURES + ["theoretical_" + name for name in FIGURES]
NORMS = (("l2", "o", "-", "$L_2$"), ("linf", "s", (0, (3, 1.5)), "$L_\\infty$"))
ACCELERATIONS = (("rms_acceleration", "o", "-", "with noise"), ("rms_mean_acceleration", "s", (0, (3, 1.5)), "of the mean motion"))

# measured and theory have an array per name of FIGURES with an element per vehicle 0..N, NaN where there is none.
Amplification = namedtuple("Amplification", "path name followers measured theory seconds realizations complete string_stable")


def read_amplification(path):
    """The amplification of the run in a folder."""
    require_folder(path)
    table_path = os.path.join(path, "amplification.csv")
    if not os.path.exists(table_path):
        raise InputError("{}: no such file: run with signals:=speed,acceleration (monte_carlo --signals)".format(table_path))
    columns = read_columns(table_path, COLUMNS)
    vehicles = columns["vehicle"].size
    order = np.argsort(columns["vehicle"])
    if vehicles < 2 or not np.array_equal(columns["vehicle"][order], np.arange(vehicles)):
        raise InputError("{}: must hold one row for each vehicle 0..N; rows are missing or double".format(table_path))
    summary_path, summary = read_summary(path, "amplification", vehicles - 1)
    measured = {name: drawable(columns[name])[order] for name in FIGURES}
    theory = {name: drawable(columns["theoretical_" + name])[order] for name in FIGURES}
    if not any(np.isfinite(table[name]).any() for table in (measured, theory) for name in RATIOS):
        reason = "the leader drives at constant speed" if measured["rms_mean_speed"][0] == 0.0 else "noise hides the motion"
        raise InputError("{}: all ratios are empty, as {}: nothing to draw".format(table_path, reason))
    from_step = number(summary_path, summary, "configuration.run.burn_in")
    period = number(summary_path, summary, "configuration.model.sample_period")
    return Amplification(path, os.path.basename(os.path.abspath(path)), vehicles - 1, measured, theory,
                         (from_step * period, number(summary_path, summary, "steps") * period),
                         int(number(summary_path, summary, "realizations")), truth(summary_path, summary, "complete"),
                         truth_if_any(summary_path, summary, "theory.string_stable"))


def draw(runs, titles):
    names = style.names_of(titles, runs)
    accelerated = any(np.isfinite(run.measured["rms_acceleration"]).any() for run in runs)
    figure, axes = style.new_figure(1, 2 + accelerated, 4.6 * (2 + accelerated), 4.9)
    ratio, tail = axes[0, :2]
    draw_ratios(ratio, runs, "ratio")
    draw_ratios(tail, runs, "head_to_tail")
    ratio.set_title("(a) speed, ratio to the predecessor")
    tail.set_title("(b) speed, ratio to the leader (head to tail)")
    for axis in (ratio, tail):
        axis.axhline(1.0, color="#8a8a8a", linewidth=1.0, zorder=1)
        axis.set_ylabel("ratio of norms about the average")
    if accelerated:
        draw_accelerations(axes[0, 2], runs)
    for axis in axes[0]:
        style.follower_axis(axis, max(run.followers for run in runs))
    style.legend_below(ratio, handles=[entry_of_run(at, run, name) for at, (run, name) in enumerate(zip(runs, names))])
    style.legend_below(tail, handles=[entry for _, marker, line, label in NORMS for entry in entries_of_kind(marker, line, label)])
    if accelerated:
        axes[0, 2].set_xlim(-0.7, axes[0, 2].get_xlim()[1])
        axes[0, 2].set_xticks([0] + [tick for tick in axes[0, 2].get_xticks() if tick > 1])
        axes[0, 2].set_xlabel("vehicle $i$, 0 the leader")
        style.legend_below(axes[0, 2], handles=[entry for _, marker, line, label in ACCELERATIONS
                                                for entry in entries_of_kind(marker, line, label)])
    return figure


def colour_of(at):
    return style.PALETTE[at % len(style.PALETTE)]


def entry_of_run(at, run, name):
    return style.legend_entry(color=colour_of(at), linewidth=3.0, label="{}, {}{}\n{} realization{}, {:g} to {:g} s".format(
        name, style.verdict(run.string_stable), "" if run.complete else ", incomplete run", style.spaced(run.realizations),
        "s" * (run.realizations != 1), *run.seconds))


def entries_of_kind(marker, line, label):
    return [style.legend_entry(color=style.INK, linewidth=1.3, linestyle=line, label=label + ", theory"),
            style.legend_entry(color=style.INK, linestyle="", marker=marker, markerfacecolor="white", markersize=5, label=label + ", measured")]


def draw_pair(axes, at, first, measured, theory, marker, line):
    """Draws the theory as a line and the measurement as markers; the first value belongs to vehicle `first`."""
    vehicles = first + np.arange(theory.size)
    axes.plot(vehicles, theory, color=colour_of(at), linewidth=1.3, linestyle=line, marker="_" if theory.size == 1 else "")
    shown = style.thinned(measured.size, style.MANY)
    axes.plot(vehicles[shown], measured[shown], marker, color=colour_of(at), markerfacecolor="white", markersize=4.5, zorder=3)


def draw_ratios(axes, runs, kind):
    curves = []
    for at, run in enumerate(runs):
        for norm, marker, line, _ in NORMS:
            name = "{}_{}".format(norm, kind)
            measured, theory = run.measured[name][1:], run.theory[name][1:]
            draw_pair(axes, at, 1, measured, theory, marker, line)
            curves += [values for values in (measured, theory) if np.isfinite(values).any()]
    values = np.concatenate(curves)
    values = values[np.isfinite(values)]
    if values.size and values.max() > 10.0 * values.min():
        style.logarithmic(axes)


def draw_accelerations(axes, runs):
    axes.set_title("(c) acceleration")
    axes.set_ylabel("RMS acceleration [m/s$^2$]")
    largest = []
    for at, run in enumerate(runs):
        for name, marker, line, _ in ACCELERATIONS:
            draw_pair(axes, at, 0, run.measured[name], run.theory[name], marker, line)
            largest += [np.nanmax(values) for values in (run.measured[name],) if np.isfinite(values).any()]
    if max(largest) > 30.0 * min(largest) > 0.0:
        style.logarithmic(axes)
    else:
        axes.set_ylim(bottom=0.0)
