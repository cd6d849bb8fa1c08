"""Variance of the last vehicle over a swept parameter: measured with standard errors, theory as lines."""

from __future__ import annotations

import textwrap
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plotting import style
from plotting.values import Array, drawable

VERDICTS = ("not string stable", "string stable", "no verdict")


class Curve(NamedTuple):
    """Arrays over `at`, the parameter on the horizontal axis."""

    name: str
    at: Array
    variance: Array
    variance_standard_error: Array
    theoretical_variance: Array
    string_stable: Array


class Tails(NamedTuple):
    """The last vehicles of a sweep: the parameter on the horizontal axis, and the curves over it."""

    over: str
    curves: List[Curve]


def last_rows(sweep: sp.Sweep) -> style.Indices:
    """For each point the row of the last vehicle at its last step."""
    point, vehicle, step = (sweep.numbers(name) for name in ("point", "vehicle", "step"))
    order = np.lexsort((step, vehicle, point))
    rows: style.Indices = order[np.append(np.diff(point[order]) != 0.0, True)]
    return rows


def chosen_axis(sweep: sp.Sweep, over: Optional[str]) -> str:
    """The parameter `over` if given, otherwise the numeric parameter with the most values."""
    if over:
        if over not in sweep.varied:
            raise ValueError("--over: {}: must be a varying parameter of {}: {}".format(over, sweep.path, ", ".join(sweep.varied)))
        return over
    columns = {name: sweep.columns[name] for name in sweep.varied}
    sizes = {name: np.unique(column).size for name, column in columns.items()
             if isinstance(column, np.ndarray) and np.isfinite(column).all()}
    if not sizes:
        raise ValueError("{}: no number varies in it: {}".format(sweep.path, ", ".join(sweep.varied)))
    return max(sizes, key=lambda name: sizes[name])


def tails_of(sweep: sp.Sweep, over: Optional[str] = None) -> Tails:
    over = chosen_axis(sweep, over)
    rows, at = last_rows(sweep), sweep.numbers(over)
    # Paired axes move together: a parameter with a different value at every point of the axis does not define curves.
    others = [name for name in sweep.varied if name != over]
    groups: Dict[Tuple[str, ...], List[int]] = {}
    for row in rows:
        groups.setdefault(tuple(str(sweep.columns[name][row]) for name in others), []).append(row)
    if len(groups) == len(rows) and len(rows) > len(style.PALETTE):
        groups, others = {(): list(rows)}, []
    if len(groups) > len(style.PALETTE):
        raise ValueError("{}: {} curves over {}: must be at most {}: sweep less, or --over another".format(
            sweep.path, len(groups), over, len(style.PALETTE)))
    curves = []
    for group in groups.values():
        group.sort(key=lambda row: float(at[row]))
        name = ", ".join("{} = {}".format(other, shown(sweep.columns[other][group[0]])) for other in others)
        curves.append(Curve(name, at[group], **{name: drawable(sweep.numbers(name)[group]) for name in Curve._fields[2:]}))
    if not any(np.isfinite(curve.variance).any() for curve in curves):
        raise ValueError("{}: variance is NaN everywhere: nothing to draw".format(sweep.path))
    return Tails(over, curves)


def shown(value: Any) -> str:
    return value if isinstance(value, str) else "{:g}".format(value)


def draw(tails: Tails) -> Figure:
    figure, axes = style.new_figure(1, 1, 6.2, 4.2)
    axes = axes[0, 0]
    for at, curve in enumerate(tails.curves):
        draw_curve(axes, curve, style.colour(at), style.marker(at))
    if style.spread(np.concatenate([curve.variance for curve in tails.curves])) > style.WIDE_STRING:
        style.logarithmic(axes)
    else:
        axes.set_ylim(bottom=0.0)
    names = {"headway": "time headway $h$ [samples]", "loss": "loss probability $q$",
             "noise_variance": "noise variance $P_d$ [m$^2$]", "delay": "delay [steps]", "followers": "followers $N$"}
    axes.set_xlabel(names.get(tails.over, tails.over.replace("$", "\\$")))
    axes.set_ylabel("variance of the last $\\zeta_i$ [m$^2$]")
    style.legends_below([axes], [legend_of(tails.curves, int(style.LETTERS * figure.get_figwidth()))])
    return figure


def verdicts_of(curve: Curve) -> style.Indices:
    """The index of each point's verdict in VERDICTS."""
    verdicts: style.Indices = np.where(np.isnan(curve.string_stable), 2, curve.string_stable == 1.0)
    return verdicts


def face(verdict: int, colour: str) -> str:
    """The inside of a point."""
    return (colour, "white", "#c4c4c4")[verdict]


def has_theory(curve: Curve) -> bool:
    return bool(np.isfinite(curve.theoretical_variance).any())


def draw_curve(axes: Axes, curve: Curve, colour: str, marker: str) -> None:
    """Draws the theory and the measurements of a curve."""
    if has_theory(curve):
        axes.plot(curve.at, curve.theoretical_variance, "_" if curve.at.size == 1 else "-", color=colour, linewidth=1.3)
    many = curve.at.size > style.MANY
    for verdict in range(len(VERDICTS)):
        part = verdicts_of(curve) == verdict
        if part.any():
            axes.errorbar(curve.at[part], curve.variance[part],
                          yerr=style.SHOWN_ERRORS * curve.variance_standard_error[part], fmt=marker, color=colour,
                          markersize=2.5 if many else 4.5, markerfacecolor=face(verdict, colour),
                          markeredgewidth=0.6 if many else 1.0, capsize=0 if many else 2.5,
                          elinewidth=0.7 if many else 1.0)


def legend_of(curves: List[Curve], letters: int) -> List[Any]:
    """An entry for each curve with a name, in lines of so many letters, and the entries of all curves."""
    # A dollar sign begins no formula. Marked as such only after the line breaks, which could part it from its mark.
    legend = [style.legend_entry(color=style.colour(at), marker=style.marker(at), markersize=4.5, linewidth=1.3,
                                 markerfacecolor=face(verdicts_of(curve)[-1], style.colour(at)), linestyle="-" if has_theory(curve) else "",
                                 label=textwrap.fill(curve.name, letters).replace("$", "\\$"))
              for at, curve in enumerate(curves) if curve.name]
    if any(map(has_theory, curves)):
        legend.append(style.legend_entry(color=style.INK, linewidth=1.3, label="theory"))
    legend.append(style.legend_entry(marker="|", linestyle="", color=style.INK, markersize=9,
                                     label="measured, $\\pm${} standard errors".format(style.SHOWN_ERRORS)))
    found = set(np.concatenate([verdicts_of(curve) for curve in curves]))
    return legend + [style.legend_entry(marker="o", linestyle="", color=style.INK, markersize=4.5, markerfacecolor=face(verdict, style.INK),
                                        label=label) for verdict, label in enumerate(VERDICTS) if verdict in found]
