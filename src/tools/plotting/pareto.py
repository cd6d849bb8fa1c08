"""Pareto fronts of tune: the least value of one figure for each value of another, and the gains that reach it."""

from __future__ import annotations

import os
from typing import Any, Dict, NamedTuple, Sequence

import numpy as np
from matplotlib.figure import Figure
from stochastic_platoon import _platoon

from plotting import style
from plotting.values import Array


class Front(NamedTuple):
    """Arrays along the front, in ascending order of `against`."""

    name: str
    over_name: str
    against_name: str
    over: Array
    against: Array
    variables: Dict[str, Array]


def load(path: str) -> Front:
    """The front in a tune.json, or in the folder of one. Raises FileNotFoundError, and ValueError if there is none."""
    file = os.path.join(path, "tune.json") if os.path.isdir(path) else path
    try:
        front: Any = _platoon.read_json(file)["pareto"]
        points = sorted(front["points"], key=lambda point: float(point["against"]))
        over, against = (np.array([float(point[axis]) for point in points]) for axis in ("over", "against"))
        variables = {key: np.array([float(point["variables"][key]) for point in points]) for key in points[0]["variables"]}
        return Front(os.path.basename(os.path.dirname(os.path.abspath(file))), str(front["over"]), str(front["against"]), over, against, variables)
    except (ValueError, KeyError, TypeError, IndexError, AttributeError):
        raise ValueError("{}: must be a tune.json with a front, as tune writes it for a file with the key pareto".format(file)) from None


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
    upper.set_ylabel("least {}".format(fronts[0].over_name))
    if len(fronts) > 1:
        upper.legend()
    lower.set_xlabel(fronts[0].against_name)
    lower.set_ylabel("share of the largest value")
    style.legend_below(lower)
    return figure
