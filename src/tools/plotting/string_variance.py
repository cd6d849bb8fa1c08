"""Stationary variance along the string with its limit (Corollary 1), measured variances over it."""

from collections import namedtuple

import numpy as np

from plotting import style
from plotting.inputs import InputError, number, numbers, require_same_platoon

SHOWN_ERRORS = 2.0  # standard errors to either side

Case = namedtuple("Case", "name stationary limit run")


def pair(analyses, runs):
    if runs and len(runs) != len(analyses):
        raise InputError("--run: must be one for each of the {} analyses, not {}".format(len(analyses), len(runs)))
    return [case(analysis, run) for analysis, run in zip(analyses, runs or [None] * len(analyses))]


def case(analysis, run):
    stationary = numbers(analysis.path, analysis.document, "stationary_variance")
    if run:
        require_same_platoon(run, analysis, stationary.size)
    return Case(analysis.name, stationary, number(analysis.path, analysis.document, "limit_variance"), run)


def standard_error(variance, count):
    """Of the unbiased variance of so many independent Gaussian samples."""
    return variance * np.sqrt(2.0 / np.maximum(count - 1.0, 1.0))


def draw(cases, titles):
    names = style.names_of(titles, cases)
    figure, axes = style.new_figure(1, 1, 6.2, 4.2)
    axes = axes[0, 0]
    for at, (shown, name) in enumerate(zip(cases, names)):
        draw_case(axes, shown, name, style.PALETTE[at % len(style.PALETTE)], style.MARKERS[at % len(style.MARKERS)])
    if style.spread(np.concatenate([shown.stationary for shown in cases])[:, np.newaxis]) > 30.0:
        axes.set_yscale("log")
    style.follower_axis(axes, max(shown.stationary.size for shown in cases))
    axes.set_ylabel("variance of $\\zeta_i$ [m$^2$]")
    axes.legend()
    return figure


def draw_case(axes, shown, name, colour, marker):
    i = np.arange(1, shown.stationary.size + 1)
    has_limit = np.isfinite(shown.limit)
    axes.plot(i, shown.stationary, color=colour, linewidth=1.3,
              label="{}: stationary, theory{}".format(name, "" if has_limit else " (no limit)"))
    if has_limit:
        axes.axhline(shown.limit, color=colour, linewidth=1.0, linestyle=(0, (5, 2.5)),
                     label="{}: limit {:.4g} m$^2$".format(name, shown.limit))
    if shown.run:
        draw_measured(axes, shown.run, name, colour, marker)


def draw_measured(axes, run, name, colour, marker):
    at = style.thinned(run.mean.shape[0], style.MANY)
    variance, count = run.variance[at, -1], run.count[at, -1]
    last = style.spaced(int(run.steps[-1]))
    if run.time_average:
        axes.plot(at + 1, variance, marker, color=colour, markersize=4.5, markerfacecolor="white",
                  label="{}: time average up to step {}".format(name, last))
    else:
        axes.errorbar(at + 1, variance, yerr=SHOWN_ERRORS * standard_error(variance, count), fmt=marker, color=colour,
                      markersize=4.5, markerfacecolor="white", capsize=2.5, linewidth=1.0,
                      label="{}: measured at step {}, $\\pm$2 standard errors".format(name, last))
