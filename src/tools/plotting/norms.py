"""Norms of the tracking errors along the string against their bounds (the paper's fig:boundary_norms)."""

import os
from collections import namedtuple

import numpy as np

from plotting import style
from plotting.inputs import InputError, number, numbers, read_analysis, read_run, require_same_platoon

# What is drawn in one column; arrays have an element per follower, None where there is none.
Case = namedtuple("Case", "name followers measured_mean measured_variance mean variance "
                          "has_bounds mean_bound variance_bound steps")


def read_cases(paths):
    """Run folders and analyses, in any order: the first folder goes with the first analysis, and so on."""
    runs, analyses = [], []
    for path in paths:
        if not os.path.exists(path):
            raise InputError("{}: no such file or folder".format(path))
        if os.path.isdir(path):
            runs.append(read_run(path))
        else:
            analyses.append(read_analysis(path))
    if runs and analyses and len(runs) != len(analyses):
        raise InputError("{}: {} runs and {} analyses cannot be paired: give as many of each, or only one kind"
                         .format(paths[-1], len(runs), len(analyses)))
    for run in runs:
        if run.time_average:
            raise InputError("{}: holds time averages: norms over the steps need a run of an ensemble"
                             .format(run.path))
    count = max(len(runs), len(analyses))
    return [case(run, analysis) for run, analysis in zip(runs or [None] * count, analyses or [None] * count)]


def case(run, analysis):
    values = dict.fromkeys(Case._fields)
    values["has_bounds"] = analysis is not None
    if run:
        values.update(name=run.name, followers=run.mean.shape[0], steps=run.steps,
                      measured_mean=l2_norm(run.mean), measured_variance=supremum(run.variance),
                      mean=l2_norm(run.theoretical_mean), variance=supremum(run.theoretical_variance))
    if analysis:
        path, document = analysis.path, analysis.document
        mean, variance = (numbers(path, document, "norms." + key) for key in ("mean_l2", "variance_linf"))
        if mean.size != variance.size:
            raise InputError("{}: norms.mean_l2 has {} followers, but norms.variance_linf has {}"
                             .format(path, mean.size, variance.size))
        if run:
            require_same_platoon(run, analysis, mean.size)
        values.update(name=values["name"] or analysis.name, followers=mean.size, mean=mean, variance=variance,
                      mean_bound=number(path, document, "norms.mean_bound"),
                      variance_bound=number(path, document, "norms.variance_bound"))
    return Case(**values)


def l2_norm(curves):
    return np.sqrt(np.nansum(curves ** 2, axis=1))


def supremum(curves):
    return np.nanmax(np.where(np.isnan(curves), -np.inf, curves), axis=1)


def draw(cases, titles):
    names = style.names_of(titles, cases)
    figure, axes = style.new_figure(2, len(cases), 1.2 + 3.8 * len(cases), 5.4)
    for column, (shown, name) in enumerate(zip(cases, names)):
        letter = "({}) ".format(chr(ord("a") + column)) if len(cases) > 1 else ""
        top, bottom = axes[:, column]
        top.set_title(letter + name)
        draw_norm(top, shown, shown.measured_mean, shown.mean, shown.mean_bound, "none", (0, (5, 2.5)))
        draw_norm(bottom, shown, shown.measured_variance, shown.variance, shown.variance_bound, None, "-")
        top.set_ylabel("$\\|\\mu_{\\zeta_i}\\|_{\\mathcal{L}_2}$ [m]")
        bottom.set_ylabel("$\\|P_{\\zeta_i}\\|_{\\mathcal{L}_\\infty}$ [m$^2$]")
        style.follower_axis(bottom, shown.followers)
    return figure


def draw_norm(axes, shown, measured, theory, bound, face, bound_style):
    i = np.arange(1, shown.followers + 1)
    axes.plot(i, theory, color=style.INK, linewidth=0.9, label="theory")
    if measured is not None:
        at = style.thinned(shown.followers, style.MANY)
        axes.plot(i[at], measured[at], "o", color=style.PALETTE[0], markerfacecolor=face, markersize=5,
                  label="measured")
    if shown.has_bounds and np.isfinite(bound):
        axes.axhline(bound, color=style.BOUND, linewidth=1.4, linestyle=bound_style, label="bound")
    elif shown.has_bounds:
        axes.plot([], [], " ", label="no bound exists")
    if style.spread(theory[:, np.newaxis]) > style.WIDE_RANGE:
        axes.set_yscale("log")
    else:
        axes.set_ylim(bottom=0.0)
        axes.margins(y=0.12)
    axes.legend()
