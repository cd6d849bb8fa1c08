"""Norms of the tracking errors along the string against their bounds (the paper's fig:boundary_norms)."""

from __future__ import annotations

from statistics import NormalDist
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plotting import style
from plotting.values import LARGEST, Array, drawable, drawable_errors, drawable_numbers, require_same_platoon

CONFIDENCE = 0.95  # probability that the variances of all steps of a follower lie within their intervals
SETTLED = 0.01  # relative; if a run's own theory differs more from the analysis, it is drawn as well


class Norm(NamedTuple):
    """A norm along the string: arrays with an element per follower. A run has `measured`, perhaps the half width of its confidence
    interval, and its `own` theory; an analysis has `theory` and `bound`, NaN if none exists."""

    measured: Optional[Array] = None
    half_width: Optional[Array] = None
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
        require_same_platoon(run, analysis, case.followers, with_means=True)
    return [joined(one, other) for one, other in zip(of_runs, of_analyses)] or of_runs or of_analyses


def case_of_run(run: sp.Results) -> Case:
    if run.time_average:
        raise ValueError("{}: holds time averages: norms over the steps need a run of an ensemble".format(run.path))
    if run.spectral_radius >= 1.0:
        raise ValueError("{}: is of an unstable loop, spectral radius {:.6g}: its norms are infinite".format(run.path, run.spectral_radius))
    errors = drawable_errors(run)
    known = np.isfinite(errors.theoretical_variance).any()
    return Case(run.name, style.verdict(run.string_stable), run.followers,
                Norm(measured_l2_norm(errors), own=l2_norm(errors.theoretical_mean) if known else None),
                Norm(supremum(errors.variance), half_width(run), supremum(errors.theoretical_variance) if known else None))


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
    mean, variance = (measured._replace(theory=of.theory, bound=of.bound)
                      for of, measured in ((analysis.mean, run.mean), (analysis.variance, run.variance)))
    return analysis._replace(name=run.name, mean=mean, variance=variance)


def l2_norm(curves: Array) -> Array:
    return np.asarray(np.sqrt(np.nansum(curves ** 2, axis=1)))


def supremum(curves: Array) -> Array:
    return np.asarray(np.max(np.where(np.isnan(curves), 0.0, curves), axis=1))


def measured_l2_norm(errors: sp.Moments) -> Array:
    """The l2 norm of the means from an unbiased estimate of its square: sampling adds variance/count to every squared mean."""
    square = np.nansum(errors.mean ** 2 - errors.variance / errors.count, axis=1)
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))


def half_width(run: sp.Results) -> Array:
    """The half width of the confidence interval of the largest variance.

    The largest of many estimates is biased upwards; the interval covers all steps of a follower at once (Bonferroni).
    """
    quantile = NormalDist().inv_cdf(1.0 - 0.5 * (1.0 - CONFIDENCE) / run.steps.size)
    return np.asarray(quantile * drawable(run.largest_standard_error_of_variance))


def draw(cases: Sequence[Case], titles: Sequence[str]) -> Figure:
    names = style.names_of(titles, cases)
    figure, axes = style.new_figure(2, len(cases), 1.2 + 3.8 * len(cases), 5.4)
    for column, (shown, name) in enumerate(zip(cases, names)):
        top, bottom = axes[:, column]
        top.set_title(style.column_title(column, len(cases), "{}, {}".format(name, shown.verdict)))
        draw_norm(top, shown.mean, style.DASHED, "white")
        draw_norm(bottom, shown.variance, "-", style.PALETTE[0])
        top.set_ylabel("$\\Vert\\mu_{\\zeta_i}\\Vert_{\\mathcal{L}_2}$ [m]")
        bottom.set_ylabel("$\\Vert P_{\\zeta_i}\\Vert_{\\mathcal{L}_\\infty}$ [m$^2$]")
        style.follower_axis(bottom, shown.followers)
    return figure


def draw_norm(axes: Axes, norm: Norm, line: style.Line, face: str) -> None:
    theories = list(theories_of(norm))
    for values, look, label in theories:
        style.draw_theory(axes, values, color=style.INK, linewidth=0.9, linestyle=look, label=label)
    if norm.bound is not None and norm.bound < LARGEST:
        axes.axhline(norm.bound, color=style.BOUND, linewidth=1.4, linestyle=line, label="bound")
    elif norm.bound is not None:
        axes.plot([], [], " ", label="no bound exists")
    if norm.measured is not None:
        label = "measured" if norm.half_width is None else "measured, {:.0%} confidence".format(CONFIDENCE)
        style.draw_measured(axes, norm.measured, norm.half_width, fmt="o", color=style.PALETTE[0], markerfacecolor=face, label=label)
    decisive = theories[-1][0] if theories else norm.measured
    if decisive is not None:
        choose_scale(axes, decisive)
    axes.legend()


def theories_of(norm: Norm) -> Iterator[Tuple[Array, str, str]]:
    """The theory of the analysis, and the run's own if there is no analysis or if it differs: each with its line and label."""
    if norm.theory is not None:
        yield norm.theory, "-", "theory"
        if norm.own is not None and not np.allclose(norm.own, norm.theory, rtol=SETTLED, atol=0.0):
            yield norm.own, ":", "theory over the run's steps"
    elif norm.own is not None:
        yield norm.own, "-", "theory"


def choose_scale(axes: Axes, norm: Array) -> None:
    """Sets a linear axis from zero, or a logarithmic one if the followers' norms are far apart."""
    if style.spread(norm) > style.WIDE_RANGE:
        style.logarithmic(axes)
    else:
        top = axes.get_ylim()[1]
        axes.set_ylim(-0.03 * top, 1.05 * top)
