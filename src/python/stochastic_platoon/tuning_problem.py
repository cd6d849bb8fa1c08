"""The goal and the constraints of a tuning, as functions of a place in the unit cube."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _platoon
from .model import SIGNALS, Model, handle_of
from .theory import at_path, key_of

if TYPE_CHECKING:  # numpy.typing is younger than the NumPy of Debian 11
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Figure = Union[float, bool, None]
Condition = Union[bool, float, Sequence[Optional[float]]]
Progress = Callable[[str, int, float], None]

#: Figures of which more is better: a single number is their lower bound.
AT_LEAST = ("phase_margin", "delay_margin", "string_margin", "critical_delay", "critical_loss_probability", "critical_mean_burst")
NEAR = 0.02  # violation up to which the search computes the goal
WORST = 1e12  # above every goal: an infeasible point


def figures_of(document: Any, prefix: str = "") -> List[str]:
    """The paths of all numbers and truth values of an analysis; lists by their first entry. Internal."""
    if isinstance(document, Mapping):
        return [path for key in document for path in figures_of(document[key], prefix + "/" + key if prefix else key)]
    if isinstance(document, (list, np.ndarray)) and len(document):
        return figures_of(document[0], prefix + "/0")
    return [] if isinstance(document, (str, list, np.ndarray)) else [prefix]


def more_is_better(figure: str) -> bool:
    """Whether a figure is one of AT_LEAST. Internal."""
    return figure.replace(".", "/").split("/")[-1] in AT_LEAST


def whole_number(value: Any) -> Figure:
    """A figure as Python's own number; None for one that does not exist. Raises ValueError for a list or a text."""
    if value is None or isinstance(value, (bool, np.bool_)):
        return None if value is None else bool(value)
    if isinstance(value, (str, list, dict, np.ndarray)):
        raise ValueError("must be a single number")
    return float(value) if math.isfinite(float(value)) else None


def model_value(model: Model, path: str) -> Any:
    """The value of a key of a model. Raises KeyError. Internal."""
    return model.time_headway_seconds if path == "time_headway_seconds" else at_path(model.to_dict(), path)


@dataclass(frozen=True)
class Constraint:
    """A figure and what it must be: `wanted`, or from `low` to `high`."""

    figure: str
    low: float = -math.inf
    high: float = math.inf
    wanted: Optional[bool] = None
    follows: bool = False  #: from another constraint

    def margin(self) -> Constraint:
        """The margin of the verdict string_stable, which has no slope: it leads the search along the border."""
        return Constraint(self.figure.replace("string_stable", "string_margin"), low=0.0, follows=True)

    @property
    def scale(self) -> float:
        return max((abs(bound) for bound in (self.low, self.high) if math.isfinite(bound)), default=0.0) or 1.0

    def margins(self, value: Figure) -> List[float]:
        """Relative distances to each bound, negative if it is violated. A figure without bounds has to exist."""
        if self.wanted is not None:
            return [0.0 if value == self.wanted else -1.0]
        finite = (math.isfinite(self.low), math.isfinite(self.high))
        if value is None or not any(finite):
            return [-1.0 if value is None else 1.0] * max(sum(finite), 1)
        return [(value - self.low) / self.scale] * finite[0] + [(self.high - value) / self.scale] * finite[1]

    @property
    def condition(self) -> str:
        """As in subject_to."""
        if self.wanted is not None:
            return str(self.wanted).lower()
        bounds = ["{:g}".format(bound) for bound in (self.low, self.high) if math.isfinite(bound)]
        return bounds[0] if len(bounds) == 1 else "[{}]".format(", ".join(bounds or ["null", "null"]))

    def __str__(self) -> str:
        if self.wanted is not None:
            return "must be {}".format(str(self.wanted).lower())
        if self.low == -math.inf or self.high == math.inf:
            return "must be {} {:g}".format(*("at most", self.high) if self.low == -math.inf else ("at least", self.low))
        return "must be from {:g} to {:g}".format(self.low, self.high)


class Point(NamedTuple):
    """A point of the box and its figures."""

    values: Tuple[float, ...]
    goal: Figure
    figures: Tuple[Figure, ...]  #: one per constraint
    violation: float  #: 0 if all constraints hold and the goal exists
    failure: str = ""  #: why nothing was computed

    @property
    def merit(self) -> float:
        """The goal, or a number above every goal that grows with the violation."""
        return float(self.goal or 0.0) if self.violation == 0.0 else WORST * (1.0 + self.violation)


@dataclass
class Problem:
    """The goal as a function of the place in the unit cube. Values below a decade of range are linear, others logarithmic."""

    model: Model
    minimise: str
    over: Dict[str, Tuple[float, float]]
    constraints: List[Constraint]
    settings: Dict[str, str]
    collision_probability: str = ""
    progress: Progress = lambda stage, evaluations, goal: None
    stage: str = "search"
    also: Sequence[str] = ()  #: further figures that must exist
    sign: float = 1.0  #: of the goal: -1 finds the largest value of `minimise`
    evaluated: Dict[Tuple[float, ...], Point] = field(default_factory=dict)
    least: Optional[Point] = None
    threads: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(os.cpu_count()))

    def __post_init__(self) -> None:
        conditions = {constraint.figure: constraint for constraint in self.constraints if not constraint.follows}
        paths = [path for path in dict.fromkeys([self.minimise, *conditions, *self.also]) if path]
        self.signals = ",".join(name for name in SIGNALS if any(path.replace(".", "/").startswith("signals/" + name) for path in paths))
        self.of_model = set()
        problems = []
        if any(path.startswith("collision") for path in paths) and not self.collision_probability:
            problems.append("collision_probability: missing: must be given for figures of collision")
            paths = [path for path in paths if not path.startswith("collision")]
        try:
            everything = self.analyze(self.model, set())
        except ValueError as error:  # settings; the figures do not depend on them
            lines = str(error).split("\n")  # several have a heading
            problems += [line.strip() for line in lines[1:] or lines]
            everything = self.figures_without_settings(problems)
        for path in paths:
            try:
                found = at_path(everything, path)
            except KeyError:
                try:
                    found = model_value(self.model, path)
                    self.of_model.add(path)
                except KeyError:
                    problems.append("{}: no figure of the analysis and no key of the model: must be one of {}".format(
                        path, ", ".join(sorted(figures_of(everything)))))
                    continue
            try:
                value = whole_number(found)
            except ValueError as error:
                entries = figures_of(found, path)
                problems.append("{}: {}".format(path, "{}: name one of its entries, as {}".format(error, entries[0]) if entries else
                                                "{}, and is {!r}".format(error, found)))
                continue
            condition = conditions.get(path)
            if value is not None and isinstance(value, bool) != (condition is not None and condition.wanted is not None):
                problems.append("{}: is {}{}".format(
                    path, "true or false: must be in subject_to, with true or false" if isinstance(value, bool)
                    else "a number: must be a number or [low, high] in subject_to", ", not " + condition.condition if condition else ""))
        if problems:
            raise ValueError("\n".join(problems))
        figures = [self.minimise] + [constraint.figure for constraint in self.constraints]
        first, *others = (None if path in self.of_model else key_of(path) for path in figures)
        self.goal_key = first
        self.keys = {key for key in others if key is not None}
        self.logarithmic = [low > 0.0 and high >= 10.0 * low for low, high in self.over.values()]

    def analyze(self, model: Model, keys: set) -> Dict[str, Any]:  # type: ignore[type-arg]
        return _platoon.analyze(handle_of(model), self.settings, self.signals, self.collision_probability, keys)[0]

    def figures_without_settings(self, problems: List[str]) -> Dict[str, Any]:
        """All figures with the default settings. Raises ValueError with the problems if the settings are not what is wrong."""
        try:
            return _platoon.analyze(handle_of(self.model), {}, self.signals, "0.01" if self.collision_probability else "", set())[0]
        except ValueError:
            raise ValueError("\n".join(problems)) from None

    def values_at(self, place: Array) -> Tuple[float, ...]:
        """The keys' values at a place of the unit cube; places outside count as their nearest inside."""
        values = []
        for u, (low, high), logarithmic in zip(np.clip(place, 0.0, 1.0), self.over.values(), self.logarithmic):
            value = low * (high / low) ** float(u) if logarithmic else low + float(u) * (high - low)
            values.append(low if u == 0.0 else high if u == 1.0 else min(max(value, low), high))
        return tuple(values)

    def place_of(self, values: Sequence[float]) -> Array:
        return np.array([math.log(value / low) / math.log(high / low) if logarithmic else (value - low) / (high - low)
                         for value, (low, high), logarithmic in zip(values, self.over.values(), self.logarithmic)])

    def model_at(self, values: Sequence[float], **changes: Any) -> Model:
        return self.model.replace({**dict(zip(self.over, values)), **changes})

    def at(self, place: Array) -> Point:
        """The figures at a place; each place is computed once."""
        values = self.values_at(place)
        if values not in self.evaluated:
            self.keep(self.compute(values))
        return self.evaluated[values]

    def keep(self, point: Point) -> None:
        self.evaluated[point.values] = point
        if self.least is None or point.merit < self.least.merit:
            self.least = point
        self.progress(self.stage, len(self.evaluated), self.least.merit * (self.sign if self.least.violation == 0.0 else 1.0))

    def prepare(self, places: Sequence[Array]) -> None:
        """Computes several places at once; the theory runs in threads."""
        values = [value for value in dict.fromkeys(self.values_at(place) for place in places) if value not in self.evaluated]
        for point in self.threads.map(self.compute, values):
            self.keep(point)

    def compute(self, values: Tuple[float, ...]) -> Point:
        """The constraints first; while the search looks for the region, the goal only where they hold."""
        missing = (None,) * len(self.constraints)
        try:
            model = self.model_at(values)
            document = self.analyze(model, self.keys) if self.keys else {}
            figures = tuple(self.value(constraint.figure, model, document) for constraint in self.constraints)
            violation = 0.0
            for constraint, figure in zip(self.constraints, figures):
                violation += sum(max(0.0, -margin) for margin in constraint.margins(figure))
            if violation > NEAR and self.stage == "search":
                return Point(values, None, figures, violation + (self.amplification(model) if None in figures else 0.0))
            if self.goal_key is not None and self.goal_key not in self.keys:
                document = self.analyze(model, {self.goal_key})
            goal = self.value(self.minimise, model, document)
            if goal is None:
                violation += 1.0 + self.amplification(model)
        except (ValueError, KeyError) as error:  # a figure may have no theory here
            return Point(values, None, missing, 2.0 + len(missing) + self.instability(values), str(error))
        return Point(values, None if goal is None else self.sign * goal, figures, violation)

    def value(self, path: str, model: Model, document: Mapping[str, Any]) -> Figure:
        return whole_number(model_value(model, path) if path in self.of_model else at_path(document, path))

    def of_loop(self, model: Model, figure: str) -> float:
        """A figure of the loop, for cars with limits without them. Raises TypeError if it does not exist."""
        document = self.analyze(model, {figure, "linear/" + figure})
        return float(document.get("linear", document)[figure])

    def amplification(self, model: Model) -> float:
        """How far a loop is from string stability, below 1: where the figures of an endless string do not exist, it shows the way."""
        try:
            return 1.0 - 1.0 / max(self.of_loop(model, "peak_gain"), 1.0)
        except (ValueError, TypeError, KeyError):
            return 0.0

    def instability(self, values: Tuple[float, ...]) -> float:
        """How far a loop that the model file does not allow is from stability, below 1."""
        try:
            return 1.0 - 1.0 / max(self.of_loop(self.model_at(values, allow_unstable=True), "spectral_radius"), 1.0)
        except (ValueError, TypeError, KeyError):
            return 1.0

    def best(self) -> Point:
        assert self.least is not None
        return self.least
