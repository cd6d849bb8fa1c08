"""Norms of the tracking errors along the string against their bounds (the paper's fig:boundary_norms)."""

from __future__ import annotations

from statistics import NormalDist
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plotting import style
from plotting.values import LARGEST, Array, drawable_errors, drawable_numbers, require_same_platoon

CONFIDENCE = 0.95  # probability that the variances of all steps of a follower lie within their intervals
SETTLED = 0.01  # relative; if a run's own theory differs more from the analysis, it is drawn as well


class Measured(NamedTuple):
    """A norm along the string, with the half width of its confidence interval."""

    value: Array
    half_width: Optional[Array]


class Norm(NamedTuple):
    """A norm along the string: arrays with an element per follower. A run has `measured` and its `own` theory, an analysis has
    `theory` and `bound`, NaN if none exists."""

    measured: Optional[Measured] = None
    own: Optional[Array] = None
    theory: Optional[Array] = None
    bound: Optional[float] = None


class Case(NamedTuple):
    """The content of one column of the figure."""

    name: str
    verdict: str
    followers: int
    mean: Norm
    variance: Norm


def cases_of(runs: Sequence[sp.Results], analyses: Sequence[sp.Analysis]) -> List[Case]:
    """The first run with the first analysis, and so on; or only one kind."""
    if runs and analyses and len(runs) != len(analyses):
        raise ValueError("{}: {} runs and {} analyses cannot be paired: give as many of each, or only one kind".format(
            analyses[-1].path, len(runs), len(analyses)))
    of_runs, of_analyses = [case_of_run(run) for run in runs], [case_of_analysis(analysis) for analysis in analyses]
    for run, analysis, case in zip(runs, analyses, of_analyses):
        require_same_platoon(run, analysis, case.followers)
    return [joined(one, other) for one, other in zip(of_runs, of_analyses)] or of_runs or of_analyses


def case_of_run(run: sp.Results) -> Case:
    if run.time_average:
        raise ValueError("{}: holds time averages: norms over the steps need a run of an ensemble".format(run.path))
    if run.spectral_radius >= 1.0:
        raise ValueError("{}: is of an unstable loop, spectral radius {:.6g}: its norms are infinite".format(run.path, run.spectral_radius))
    errors = drawable_errors(run)
    return Case(run.name, style.verdict(run.string_stable), run.followers,
                Norm(measured_l2_norm(errors), l2_norm(errors.theoretical_mean)),
                Norm(measured_supremum(errors), supremum(errors.theoretical_variance)))


def case_of_analysis(analysis: sp.Analysis) -> Case:
    mean, variance = (drawable_numbers(analysis, "norms." + key) for key in ("mean_l2", "variance_linf"))
    if mean.size != variance.size:
        raise ValueError("{}: norms.mean_l2 has {} followers, but norms.variance_linf has {}".format(
            analysis.path, mean.size, variance.size))
    return Case(analysis.name, style.verdict(analysis.string_stable), mean.size,
                Norm(theory=mean, bound=analysis.number("norms.mean_bound")),
                Norm(theory=variance, bound=analysis.number("norms.variance_bound")))


def joined(run: Case, analysis: Case) -> Case:
    """The measurements of a run with the verdict and the bounds of an analysis."""
    mean, variance = (of._replace(measured=measured.measured, own=measured.own)
                      for of, measured in ((analysis.mean, run.mean), (analysis.variance, run.variance)))
    return analysis._replace(name=run.name, mean=mean, variance=variance)


def l2_norm(curves: Array) -> Array:
    return np.asarray(np.sqrt(np.nansum(curves ** 2, axis=1)))


def supremum(curves: Array) -> Array:
    return np.asarray(np.max(np.where(np.isnan(curves), 0.0, curves), axis=1))


def measured_l2_norm(errors: sp.Moments) -> Measured:
    """The l2 norm of the means from an unbiased estimate of its square: sampling adds variance/count to every squared mean."""
    square = np.nansum(errors.mean ** 2 - errors.variance / errors.count, axis=1)
    return Measured(np.sqrt(np.maximum(square, 0.0)), None)


def measured_supremum(errors: sp.Moments) -> Measured:
    """The supremum of the variances with its confidence interval.

    The largest of many estimates is biased upwards; the interval covers all steps of a follower at once (Bonferroni).
    """
    quantile = NormalDist().inv_cdf(1.0 - 0.5 * (1.0 - CONFIDENCE) / errors.variance.shape[1])
    return Measured(supremum(errors.variance), quantile * supremum(style.standard_error_of_variance(errors.variance, errors.count)))


def draw(cases: Sequence[Case], titles: Sequence[str]) -> Figure:
    names = style.names_of(titles, cases)
    figure, axes = style.new_figure(2, len(cases), 1.2 + 3.8 * len(cases), 5.4)
    for column, (shown, name) in enumerate(zip(cases, names)):
        top, bottom = axes[:, column]
        top.set_title(style.column_title(column, len(cases), "{}, {}".format(name, shown.verdict)))
        draw_norm(top, shown.mean, (0, (5, 2.5)), "white")
        draw_norm(bottom, shown.variance, "-", style.PALETTE[0])
        top.set_ylabel("$\\Vert\\mu_{\\zeta_i}\\Vert_{\\mathcal{L}_2}$ [m]")
        bottom.set_ylabel("$\\Vert P_{\\zeta_i}\\Vert_{\\mathcal{L}_\\infty}$ [m$^2$]")
        style.follower_axis(bottom, shown.followers)
    return figure


def draw_norm(axes: Axes, norm: Norm, line: style.Line, face: str) -> None:
    theories = list(theories_of(norm))
    for values, look, label in theories:
        axes.plot(np.arange(1, values.size + 1), values, color=style.INK, linewidth=0.9, linestyle=look, label=label,
                  marker="_" if values.size == 1 else "")
    if norm.bound is not None and norm.bound < LARGEST:
        axes.axhline(norm.bound, color=style.BOUND, linewidth=1.4, linestyle=line, label="bound")
    elif norm.bound is not None:
        axes.plot([], [], " ", label="no bound exists")
    if norm.measured:
        draw_measured(axes, norm.measured, face)
    choose_scale(axes, theories[-1][0])
    axes.legend()


def theories_of(norm: Norm) -> Iterator[Tuple[Array, str, str]]:
    """The norms of the analysis, and those of the run's own theory if there is no analysis or if they differ from it: each with
    its line and label."""
    if norm.theory is not None:
        yield norm.theory, "-", "theory"
    if norm.own is not None and norm.theory is None:
        yield norm.own, "-", "theory"
    if norm.own is not None and norm.theory is not None and not np.allclose(norm.own, norm.theory, rtol=SETTLED, atol=0.0):
        yield norm.own, ":", "theory over the run's steps"


def draw_measured(axes: Axes, measured: Measured, face: str) -> None:
    at = style.thinned(measured.value.size, style.MANY)
    label, bars = "measured", None
    if measured.half_width is not None:
        label, bars = "measured, {:.0%} confidence".format(CONFIDENCE), measured.half_width[at]
    axes.errorbar(at + 1, measured.value[at], yerr=bars, fmt="o", color=style.PALETTE[0], markerfacecolor=face,
                  markersize=4.5, elinewidth=1.0, capsize=2.5, label=label)


def choose_scale(axes: Axes, norm: Array) -> None:
    """Sets a linear axis from zero, or a logarithmic one if the followers' norms are far apart."""
    if style.spread(norm[:, np.newaxis]) > style.WIDE_RANGE:
        style.logarithmic(axes)
    else:
        top = axes.get_ylim()[1]
        axes.set_ylim(-0.03 * top, 1.05 * top)
