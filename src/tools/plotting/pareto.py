"""Pareto fronts of tune: the best value of one figure for each value of another, and the gains that reach it."""

from __future__ import annotations

import os
from typing import Any, Dict, NamedTuple, Sequence

import numpy as np
from matplotlib.figure import Figure
from stochastic_platoon import _platoon
from stochastic_platoon.tuning_problem import more_is_better

from plotting import style
from plotting.values import Array

UNITS = {"limit_variance": "m$^2$", "stationary_variance": "m$^2$", "variance": "m$^2$", "mean": "m", "phase_margin": "deg", "delay_margin": "s",
         "critical_delay": "s", "critical_headway": "samples", "critical_headway_seconds": "s", "time_headway": "samples",
         "time_headway_seconds": "s", "standstill_distance": "m", "required_standstill_distance": "m"}
SIGNALS = {"gap": "m", "speed": "m/s", "acceleration": "m/s$^2$", "jerk": "m/s$^3$"}


class Front(NamedTuple):
    """Arrays along the front, in ascending order of `against`."""

    name: str
    over_name: str
    against_name: str
    over: Array
    against: Array
    variables: Dict[str, Array]


def load(path: str) -> Front:
    """The front in a tune.json, or in the folder of one. Raises FileNotFoundError, and ValueError if there is none, or if it is damaged."""
    file = os.path.join(path, "tune.json") if os.path.isdir(path) else path
    document = _platoon.read_json(file)
    try:
        front: Any = document["pareto"]
        points = sorted(front["points"], key=lambda point: float(point["against"]))
        over, against = (np.array([float(point[axis]) for point in points]) for axis in ("over", "against"))
        variables = {key: np.array([float(point["variables"][key]) for point in points]) for key in points[0]["variables"]}
        return Front(os.path.basename(os.path.dirname(os.path.abspath(file))), str(front["over"]), str(front["against"]), over, against, variables)
    except (ValueError, KeyError, TypeError, IndexError, AttributeError):
        raise ValueError("{}: must be a tune.json with a front, as tune writes it for a file with the key pareto".format(file)) from None


def label(figure: str) -> str:
    """The figure and its unit, if it has one; that of the variance of a signal is the square of the signal's."""
    parts = [part for part in figure.replace(".", "/").split("/") if not part.isdigit() and part != "linear"]
    unit = UNITS.get(parts[-1]) if parts else None
    if len(parts) > 1 and parts[0] == "signals":
        signal = SIGNALS.get(parts[1])
        unit = None if signal is None or unit not in ("m", "m$^2$") else signal if unit == "m" else "({})$^2$".format(signal)
    return figure if unit is None else "{} [{}]".format(figure, unit)


def is_wide(curves: Sequence[Array]) -> bool:
    """Whether an axis must be logarithmic, and can be."""
    values = np.concatenate(curves)
    return bool(values.min() > 0.0) and style.spread(values) > style.WIDE_STRING


def draw(fronts: Sequence[Front], titles: Sequence[str] = ()) -> Figure:
    """The fronts in the upper panel, and below it each variable as a share of its largest value along the front."""
    axes_names = {(front.over_name, front.against_name) for front in fronts}
    if len(axes_names) != 1:
        raise ValueError("pareto: fronts of {}: must all have the same two figures".format(
            " and ".join(sorted("{} against {}".format(*names) for names in axes_names))))
    names = style.names_of(titles, fronts)
    figure, axes = style.new_figure(2, 1, 6.0, 6.0)
    upper, lower = axes[0, 0], axes[1, 0]
    for at, (front, name) in enumerate(zip(fronts, names)):
        upper.plot(front.against, front.over, color=style.colour(at), marker=style.marker(at), markersize=4, label=name)
        for k, (key, values) in enumerate(front.variables.items()):
            lower.plot(front.against, values / max(float(np.abs(values).max()), 1e-300), color=style.colour(at if len(fronts) > 1 else k),
                                linestyle=["-", "--", ":", "-."][k % 4], label="{} (largest {:.4g})".format(key, float(np.abs(values).max())))
    if is_wide([front.over for front in fronts]):
        style.logarithmic(upper)
    if is_wide([front.against for front in fronts]):
        lower.set_xscale("log")
    upper.set_ylabel("{} {}".format("greatest" if more_is_better(fronts[0].over_name) else "least", label(fronts[0].over_name)))
    if len(fronts) > 1:
        upper.legend()
    lower.set_xlabel(label(fronts[0].against_name))
    lower.set_ylabel("share of the largest value")
    style.legends_below([lower])
    return figure
