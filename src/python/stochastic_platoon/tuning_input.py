"""The arguments of a tuning. Every function appends the faults that it finds to a list, for one answer with all of them."""

from __future__ import annotations

import math
import operator
import re
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .model import Model
from .tables import NUMBER
from .tuning_problem import Constraint, more_is_better


def number(value: Any) -> float:
    """A number that was given, also as a text. Raises ValueError for anything else, a truth value, too."""
    try:
        if isinstance(value, (bool, np.bool_)) or (isinstance(value, str) and not (value and NUMBER.fullmatch(value))):
            raise ValueError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError("{!r}: must be a number".format(value)) from None


def pair(value: Any) -> Tuple[Any, Any]:
    """Two entries of a list. Raises ValueError for anything else."""
    if isinstance(value, str) or not isinstance(value, (Sequence, np.ndarray)) or len(value) != 2:
        raise ValueError("{!r}: must be a list of two".format(value))
    return value[0], value[1]


def box_of(model: Model, over: Mapping[str, Sequence[float]], faults: List[str]) -> Dict[str, Tuple[float, float]]:
    """The box. Faults: an empty one, keys that the model does not have."""
    box: Dict[str, Tuple[float, float]] = {}
    if not isinstance(over, Mapping):
        faults.append("over: {!r}: must be a mapping, as {{controller/kp: [0.1, 2.0]}}".format(over))
        return box
    for key, ends in over.items():
        try:
            low, high = (number(end) for end in pair(ends))
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise ValueError
        except ValueError:
            faults.append("over: {}: {!r}: must be [low, high], two finite numbers with low < high".format(key, ends))
            continue
        try:
            model.replace({str(key): low, "allow_unstable": True})
            box[str(key)] = (low, high)
        except ValueError as error:
            faults.append("over: {}: {}".format(key, error))
    if not over:
        faults.append("over: empty: must name at least one key of the model, as controller/kp: [0.1, 2.0]")
    return box


def constraints_of(subject_to: Any, faults: List[str]) -> List[Constraint]:
    """The constraints. Faults: conditions that are not true, false, a bound or a pair of bounds, not empty."""
    if subject_to is not None and not isinstance(subject_to, Mapping):
        faults.append("subject_to: {!r}: must be a mapping, as {{string_stable: true}}".format(subject_to))
        return []
    constraints = []
    for key, condition in (subject_to or {}).items():
        figure = str(key).replace(".", "/")
        if isinstance(condition, (bool, np.bool_)):
            constraints.append(Constraint(figure, wanted=bool(condition)))
            continue
        try:
            if isinstance(condition, (str, int, float, np.number)):
                low, high = (number(condition), math.inf) if more_is_better(figure) else (-math.inf, number(condition))
            else:
                first, last = pair(condition)
                low = -math.inf if first is None else number(first)
                high = math.inf if last is None else number(last)
        except ValueError:
            low, high = math.nan, math.nan
        if low <= high:
            constraints.append(Constraint(figure, low, high))
        else:
            faults.append("subject_to: {}: {!r}: must be true, false, a number, or [low, high] with low <= high".format(figure, condition))
    return constraints


def axes_of(pareto: Any, faults: List[str]) -> Tuple[Optional[Tuple[str, str]], int]:
    """The two figures of a front, and the number of its points; None without a front, or with a fault."""
    if pareto is None:
        return None, 0
    try:
        if not isinstance(pareto, Mapping) or set(pareto) - {"points"} != {"over", "against"}:
            raise ValueError
        points = operator.index(pareto.get("points", 20))
        if points >= 2:
            return (str(pareto["over"]), str(pareto["against"])), points
    except (TypeError, ValueError):
        pass
    shown = dict(pareto) if isinstance(pareto, Mapping) else pareto
    faults.append("pareto: {!r}: must be over: FIGURE, against: FIGURE, points: 2 or more".format(shown))
    return None, 0


def minimise_of(minimise: Any, faults: List[str]) -> str:
    """The path of the goal; empty with a fault."""
    if isinstance(minimise, str) and minimise:
        return minimise
    faults.append("minimise: {!r}: must be the path of a figure, as limit_variance".format(minimise))
    return ""


def seconds_of(bound_seconds: Any, faults: List[str]) -> float:
    """The most time for the lower bound."""
    try:
        seconds = number(bound_seconds)
    except ValueError:
        seconds = math.nan
    if not 0.0 <= seconds < math.inf:
        faults.append("bound_seconds: {}: must be a finite number >= 0 [s]".format(bound_seconds))
    return seconds


def realizations_of(realizations: Any, faults: List[str]) -> int:
    """The realizations of the confirmation; 0: none."""
    if isinstance(realizations, bool) or not re.fullmatch(r"\d+", str(realizations), re.ASCII):
        faults.append("run/realizations: {}: must be a whole number >= 0; 0: no confirmation".format(realizations))
        return 0
    return int(realizations)
