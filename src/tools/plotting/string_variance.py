"""Stationary variance along the string with its limit (Corollary 1), and measured variances; beside it the limit over the headway
if an analysis swept it."""

from __future__ import annotations

from itertools import zip_longest
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plotting import style
from plotting.values import LARGEST, Array, drawable, drawable_errors, drawable_numbers, require_same_platoon

SETTLED = 0.01  # relative; if the theory of the last step differs more from the stationary variance, both are drawn


class Case(NamedTuple):
    name: str
    stationary: Array
    limit: float
    run: Optional[sp.Results]
    swept: Optional[Tuple[Array, Array]]


def case(analysis: sp.Analysis, run: Optional[sp.Results]) -> Case:
    stationary = drawable_numbers(analysis, "stationary_variance")
    if run:
        require_same_platoon(run, analysis, stationary.size)
    return Case(analysis.name, stationary, analysis.limit_variance, run, analysis.limits_over_headway)


def draw(analyses: Sequence[sp.Analysis], runs: Sequence[sp.Results], titles: Sequence[str]) -> Figure:
    """Draws the first run with the first analysis, and so on; there may be no run."""
    if runs and len(runs) != len(analyses):
        raise ValueError("--run: must be one for each of the {} analyses, not {}".format(len(analyses), len(runs)))
    cases = [case(analysis, run) for analysis, run in zip_longest(analyses, runs)]
    names = style.names_of(titles, cases)
    swept = any(shown.swept for shown in cases)
    figure, axes = style.new_figure(1, 2 if swept else 1, 11.4 if swept else 6.2, 4.2)
    panels, axes = axes[0], axes[0, 0]
    legend = []
    for at, (shown, name) in enumerate(zip(cases, names)):
        legend += draw_theory(axes, shown, name, style.colour(at))
        if shown.run:
            legend += draw_measured(axes, shown.run, shown.stationary, name, style.colour(at), style.marker(at))
    if style.spread(np.concatenate([shown.stationary for shown in cases])) > style.WIDE_STRING:
        style.logarithmic(axes)
    style.follower_axis(axes, max(shown.stationary.size for shown in cases))
    axes.set_ylabel("variance of $\\zeta_i$ [m$^2$]")
    if swept:
        draw_limits(panels[1], cases, names)
    style.legends_below(panels, [legend, *(panel.get_legend_handles_labels()[0] for panel in panels[1:])])
    return figure


def draw_limits(axes: Axes, cases: Sequence[Case], names: Sequence[str]) -> None:
    for at, (shown, name) in enumerate(zip(cases, names)):
        if shown.swept:
            headways, limits = shown.swept
            axes.plot(headways, drawable(limits), color=style.colour(at), linewidth=1.3, label=name)
    style.logarithmic(axes)
    axes.set_xlabel("time headway $h$ [s]")
    axes.set_ylabel("limit of the variance\nalong the string [m$^2$]")


def draw_theory(axes: Axes, shown: Case, name: str, colour: str) -> List[Any]:
    """Draws the stationary variances and their limit; returns the legend entries."""
    has_limit = shown.limit < LARGEST
    legend: List[Any] = list(style.draw_theory(axes, shown.stationary, color=colour, linewidth=1.3, label="{}: stationary, theory{}".format(
        name, "" if has_limit else " (no limit)")))
    if has_limit:
        legend.append(axes.axhline(shown.limit, color=colour, linewidth=1.0, linestyle=style.DASHED,
                                   label="{}: limit {:.4g} m$^2$".format(name, shown.limit)))
    return legend


def draw_measured(axes: Axes, run: sp.Results, stationary: Array, name: str, colour: str, marker: str) -> List[Any]:
    """Draws the variances of the run's last step; returns the legend entries."""
    measured = drawable_errors(run)
    last = style.time_of_step(run, int(run.steps[-1]))
    errors = style.SHOWN_ERRORS * drawable(run.standard_error_of_variance)
    label = "{}: {}{}".format(name, "time average " + style.end_of_average(run) if run.time_average else "measured at " + last,
                              ", $\\pm${} standard errors".format(style.SHOWN_ERRORS) if np.isfinite(errors).any() else "")
    legend = [style.draw_measured(axes, measured.variance[:, -1], errors, fmt=marker, color=colour, markerfacecolor="white", label=label)]
    theory = measured.theoretical_variance[:, -1]
    if not run.time_average and not np.allclose(theory, stationary, rtol=SETTLED, atol=0.0, equal_nan=True):
        legend += style.draw_theory(axes, theory, color=colour, linewidth=1.3, linestyle=":",
                                    label="{}: theory at {}, not yet stationary".format(name, last))
    return legend
