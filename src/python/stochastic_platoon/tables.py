"""Tables of CSV files, checked when their columns are read, and the contents of the tables of a run."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Dict, List, Optional, Tuple, Type, TypeVar, Union

import numpy as np

from . import _platoon
from .model import PathLike

if TYPE_CHECKING:
    from numpy.typing import NDArray

Column = Union["NDArray[np.float64]", List[str]]
Columns = Dict[str, Column]
T = TypeVar("T", bound="Table")
NUMBER = re.compile(r"([+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf))?", re.ASCII)  # or empty, as the C++ library reads it


class Table:
    """The columns of a CSV file by name: arrays of numbers or lists of texts."""

    def __init__(self, columns: Columns, path: str) -> None:
        self.columns = columns
        #: the file, or its substitute in messages
        self.path = path

    @classmethod
    def load(cls: Type[T], path: PathLike) -> T:
        """The table in a file. Raises FileNotFoundError, and ValueError if it is no such table, or has changed since it was written: the
        checksum is in a JSON file of the same name beside it."""
        file = os.fspath(path)
        try:
            return cls(_platoon.read_table(file), file)
        except UnicodeDecodeError as error:
            raise ValueError("{}: must be text: {}".format(file, error)) from None

    def _column(self, name: str) -> Column:
        if name not in self.columns:
            raise ValueError("{}: column {} is missing".format(self.path, name))
        return self.columns[name]

    def numbers(self, name: str) -> NDArray[np.float64]:
        """A column of numbers. Raises ValueError if it is missing, or with the line of a cell that is no number."""
        column = self._column(name)
        if isinstance(column, np.ndarray):
            return column
        for line, cell in enumerate(column, 2):
            if not NUMBER.fullmatch(cell):
                raise ValueError("{}: line {}: {}: {:.80}: must be a number".format(self.path, line, name, cell))
        return np.array([float(cell or "nan") for cell in column])

    def texts(self, name: str) -> List[str]:
        """A column of texts. Raises ValueError if it is missing."""
        column = self._column(name)
        return ["{:g}".format(value) for value in column] if isinstance(column, np.ndarray) else column


class Grid:
    """The rows of a table as a grid of vehicles and steps.

    Raises ValueError unless there is one row for each vehicle `first`, first + 1, ... and each step; without steps one row
    for each vehicle. Vehicle 1 must be among them. `rows`: uses only these rows of the table. `over_time`: one row for each vehicle,
    whose steps may differ, as in an endless run: the least of them counts.
    """

    def __init__(self, table: Table, first: int, has_steps: bool = True, rows: Optional[NDArray[np.bool_]] = None,
                 over_time: bool = False):
        self.table = table
        vehicle = table.numbers("vehicle")
        step = table.numbers("step") if has_steps and not over_time else np.zeros(vehicle.size)
        kept = np.flatnonzero(np.ones(vehicle.size, bool) if rows is None else rows)
        self._order = kept[np.lexsort((step[kept], vehicle[kept]))]
        #: step numbers
        self.steps = np.unique(step[kept])
        #: number of vehicles
        self.vehicles = int(np.unique(vehicle[kept]).size)
        if not np.array_equal(vehicle[self._order], np.repeat(np.arange(first, first + self.vehicles), self.steps.size)) \
                or not np.array_equal(step[self._order], np.tile(self.steps, self.vehicles)) or first + self.vehicles < 2:
            raise ValueError("{}: must hold one row for each vehicle {}..N{}; rows are missing or double".format(
                table.path, first, " and step" if has_steps else ""))
        self._shape = (self.vehicles, self.steps.size) if has_steps else (self.vehicles,)
        if over_time:
            self.steps = np.array([table.numbers("step")[kept].min()])

    def numbers(self, name: str) -> NDArray[np.float64]:
        """A column, shape (vehicles, steps) or (vehicles,)."""
        column: NDArray[np.float64] = self.table.numbers(name)[self._order]
        return column.reshape(self._shape)


@dataclass(frozen=True)
class Moments:
    """Mean and variance of a signal over the realizations, or over time, beside the theory. Shape (followers, steps); NaN where
    there is no value. Units: those of the signal, and their square."""

    count: NDArray[np.float64]
    mean: NDArray[np.float64]
    variance: NDArray[np.float64]
    theoretical_mean: NDArray[np.float64]
    theoretical_variance: NDArray[np.float64]

    @classmethod
    def _of(cls, grid: Grid) -> Moments:
        return cls(*(grid.numbers(name) for name in ("count", "mean", "variance", "theoretical_mean", "theoretical_variance")))


@dataclass(frozen=True)
class Gaps:
    """The smallest gap of every realization. Arrays have an element per follower."""

    count: NDArray[np.float64]  #: realizations
    smallest_gap: NDArray[np.float64]  #: [m] of all realizations
    realization: NDArray[np.float64]  #: of the smallest gap
    step: NDArray[np.float64]  #: of the smallest gap
    collisions: NDArray[np.float64]  #: realizations with a gap below 0
    below_safe_gap: NDArray[np.float64]  #: realizations with a gap below the model's safe_gap; NaN without one
    theoretical_collision_bound: NDArray[np.float64]  #: probability of a collision in a realization, at most
    bins: NDArray[np.float64]  #: [m] lower ends of the histogram's bins, ascending
    histogram: NDArray[np.float64]  #: realizations by smallest gap, shape (followers, bins)
    safe_gap: float  #: [m] of the model; NaN without one

    @classmethod
    def _of(cls, grid: Grid, safe_gap: Optional[float]) -> Gaps:
        names = [name for name in grid.table.columns if name.startswith("bin_")]
        if not names:
            raise ValueError("{}: column bin_... is missing".format(grid.table.path))
        try:
            bins = np.array([float(name[len("bin_"):]) for name in names])
        except ValueError as error:
            raise ValueError("{}: the name of a column bin_X: {}".format(grid.table.path, error)) from None
        order = np.argsort(bins)
        histogram = np.array([grid.numbers(names[at]) for at in order]).T
        count = grid.numbers("count")
        if not np.array_equal(histogram.sum(axis=1), count):
            raise ValueError("{}: the bins do not add up to count".format(grid.table.path))
        values = {name: grid.numbers(name) for name in (
            "smallest_gap", "realization", "step", "collisions", "below_safe_gap", "theoretical_collision_bound")}
        return cls(count=count, bins=bins[order], histogram=histogram, safe_gap=float("nan") if safe_gap is None else safe_gap, **values)


@dataclass(frozen=True)
class Amplification:
    """The amplification of a manoeuvre along the string. `measured` and `theory` map a figure, as "l2_ratio", to an array with
    an element per vehicle 0..N, NaN where there is none."""

    measured: Dict[str, NDArray[np.float64]]
    theory: Dict[str, NDArray[np.float64]]
    seconds: Tuple[float, float]  #: the evaluated part of the run

    FIGURES = ("l2_ratio", "linf_ratio", "l2_head_to_tail", "linf_head_to_tail", "rms_mean_speed", "rms_acceleration",
               "rms_mean_acceleration")

    @classmethod
    def _of(cls, grid: Grid, seconds: Tuple[float, float]) -> Amplification:
        prefix = "theoretical_"
        names = dict.fromkeys([*cls.FIGURES, *(name[len(prefix):] for name in grid.table.columns if name.startswith(prefix))])
        return cls({name: grid.numbers(name) for name in names}, {name: grid.numbers(prefix + name) for name in names}, seconds)


@dataclass(frozen=True)
class Ages:
    """Steps since the last message that a link delivered: a row per follower, input and age."""

    vehicle: NDArray[np.float64]
    signal: List[str]  #: of the input, as "position"
    age: NDArray[np.float64]  #: [steps]
    count: NDArray[np.float64]  #: messages
    share: NDArray[np.float64]  #: of the messages of this link
    theoretical_share: NDArray[np.float64]  #: NaN for a recorded trace
    input: NDArray[np.float64]  #: its number n, from 0 in the order of `inputs`; NaN in results of earlier versions

    @classmethod
    def _of(cls, table: Table) -> Ages:
        numbers = [table.numbers(name) for name in ("vehicle", "age", "count", "share", "theoretical_share")]
        numbers.append(table.numbers("input") if "input" in table.columns else np.full(len(numbers[0]), np.nan))
        return cls(numbers[0], table.texts("signal"), *numbers[1:])
