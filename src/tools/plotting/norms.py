"""Norms of the tracking errors along the string against their bounds (the paper's fig:boundary_norms)."""

import os
from collections import namedtuple
from statistics import NormalDist

import numpy as np

from plotting import style
from plotting.inputs import InputError, number, numbers, read_analysis, read_run, require_same_platoon, truth_if_any

# The content of one column of the figure; arrays have an element per follower, missing entries are None.
Case = namedtuple("Case", "name verdict followers measured_mean measured_variance mean variance "
                          "own_mean own_variance has_bounds mean_bound variance_bound")

# A norm along the string, with the half width of its confidence interval or None.
Measured = namedtuple("Measured", "value half_width")

CONFIDENCE = 0.95  # probability that the variances of all steps of a follower lie within their intervals
SETTLED = 0.01  # relative; if a run's own theory differs more from the analysis, it is drawn as well


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
        if run.spectral_radius >= 1.0:
            raise InputError("{}: is of an unstable loop, spectral radius {:.6g}: its norms are infinite"
                             .format(run.path, run.spectral_radius))
    count = max(len(runs), len(analyses))
    return [case(run, analysis) for run, analysis in zip(runs or [None] * count, analyses or [None] * count)]


def case(run, analysis):
    values = dict.fromkeys(Case._fields)
    values["has_bounds"] = analysis is not None
    if run:
        values.update(name=run.name, followers=run.mean.shape[0], verdict=style.verdict(run.string_stable),
                      measured_mean=measured_l2_norm(run), measured_variance=measured_supremum(run),
                      own_mean=l2_norm(run.theoretical_mean), own_variance=supremum(run.theoretical_variance))
    if analysis:
        path, document = analysis.path, analysis.document
        mean, variance = (numbers(path, document, "norms." + key) for key in ("mean_l2", "variance_linf"))
        if mean.size != variance.size:
            raise InputError("{}: norms.mean_l2 has {} followers, but norms.variance_linf has {}"
                             .format(path, mean.size, variance.size))
        if run:
            require_same_platoon(run, analysis, mean.size)
        values.update(name=values["name"] or analysis.name, followers=mean.size, mean=mean, variance=variance,
                      verdict=style.verdict(truth_if_any(path, document, "string_stable")),
                      mean_bound=number(path, document, "norms.mean_bound"),
                      variance_bound=number(path, document, "norms.variance_bound"))
    return Case(**values)


def l2_norm(curves):
    return np.sqrt(np.nansum(curves ** 2, axis=1))


def supremum(curves):
    return np.max(np.where(np.isnan(curves), 0.0, curves), axis=1)


def measured_l2_norm(run):
    """The l2 norm of the means from an unbiased estimate of its square: sampling adds variance/count to every squared mean."""
    square = np.nansum(run.mean ** 2 - run.variance / run.count, axis=1)
    return Measured(np.sqrt(np.maximum(square, 0.0)), None)


def measured_supremum(run):
    """The supremum of the variances with its confidence interval.

    The largest of many estimates is biased upwards; the interval covers all steps of a follower at once (Bonferroni).
    """
    quantile = NormalDist().inv_cdf(1.0 - 0.5 * (1.0 - CONFIDENCE) / run.steps.size)
    return Measured(supremum(run.variance),
                    quantile * supremum(style.standard_error_of_variance(run.variance, run.count)))


def draw(cases, titles):
    names = style.names_of(titles, cases)
    figure, axes = style.new_figure(2, len(cases), 1.2 + 3.8 * len(cases), 5.4)
    for column, (shown, name) in enumerate(zip(cases, names)):
        top, bottom = axes[:, column]
        top.set_title(style.column_title(column, len(cases), "{}, {}".format(name, shown.verdict)))
        draw_theory(top, shown.mean, shown.own_mean)
        draw_theory(bottom, shown.variance, shown.own_variance)
        draw_bound(top, shown, shown.mean_bound, (0, (5, 2.5)))
        draw_bound(bottom, shown, shown.variance_bound, "-")
        if shown.measured_mean:
            draw_measured(top, shown.measured_mean, "white")
            draw_measured(bottom, shown.measured_variance, style.PALETTE[0])
        choose_scale(top, shown.mean if shown.own_mean is None else shown.own_mean)
        choose_scale(bottom, shown.variance if shown.own_variance is None else shown.own_variance)
        for axis in (top, bottom):
            axis.legend()
        top.set_ylabel("$\\Vert\\mu_{\\zeta_i}\\Vert_{\\mathcal{L}_2}$ [m]")
        bottom.set_ylabel("$\\Vert P_{\\zeta_i}\\Vert_{\\mathcal{L}_\\infty}$ [m$^2$]")
        style.follower_axis(bottom, shown.followers)
    return figure


def draw_bound(axes, shown, bound, line):
    if shown.has_bounds and np.isfinite(bound):
        axes.axhline(bound, color=style.BOUND, linewidth=1.4, linestyle=line, label="bound")
    elif shown.has_bounds:
        axes.plot([], [], " ", label="no bound exists")


def draw_theory(axes, theory, own):
    """Draws the norms of the analysis, and those of the run's own theory if there is no analysis or if they differ from it."""
    norms = [(own if theory is None else theory, "-", "theory")]
    if theory is not None and own is not None and not np.allclose(own, theory, rtol=SETTLED, atol=0.0):
        norms.append((own, ":", "theory over the run's steps"))
    for norm, line, label in norms:
        axes.plot(np.arange(1, norm.size + 1), norm, color=style.INK, linewidth=0.9, linestyle=line, label=label,
                  marker="_" if norm.size == 1 else "")


def draw_measured(axes, measured, face):
    at = style.thinned(measured.value.size, style.MANY)
    label, bars = "measured", None
    if measured.half_width is not None:
        label, bars = "measured, {:.0%} confidence".format(CONFIDENCE), measured.half_width[at]
    axes.errorbar(at + 1, measured.value[at], yerr=bars, fmt="o", color=style.PALETTE[0], markerfacecolor=face,
                  markersize=4.5, elinewidth=1.0, capsize=2.5, label=label)


def choose_scale(axes, norm):
    """Sets a linear axis from zero, or a logarithmic one if the followers' norms are far apart."""
    if style.spread(norm[:, np.newaxis]) > style.WIDE_RANGE:
        style.logarithmic(axes)
    else:
        top = axes.get_ylim()[1]
        axes.set_ylim(-0.03 * top, 1.05 * top)
