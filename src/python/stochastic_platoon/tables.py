"""Columns of a CSV file, checked and shaped. Internal: the classes of this package return their contents."""

from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Optional, Union

import numpy as np

from . import _platoon

if TYPE_CHECKING:
    from numpy.typing import NDArray

Columns = Dict[str, Union["NDArray[np.float64]", List[str]]]


def read_table(path: str) -> Columns:
    """The columns of a file. Raises FileNotFoundError, and ValueError if it is no table."""
    try:
        return _platoon.read_table(path)
    except UnicodeDecodeError as error:
        raise ValueError("{}: must be text: {}".format(path, error)) from None


def numbers(columns: Columns, name: str, path: str) -> NDArray[np.float64]:
    """A column of numbers. Raises ValueError if it is missing, or with the line of a cell that is no number."""
    if name not in columns:
        raise ValueError("{}: column {} is missing".format(path, name))
    column = columns[name]
    if isinstance(column, np.ndarray):
        return column
    for line, cell in enumerate(column, 2):
        try:
            float(cell or "nan")
        except ValueError:
            raise ValueError("{}: line {}: {}: {}: must be a number".format(path, line, name, cell)) from None
    return np.array([float(cell or "nan") for cell in column])


def texts(columns: Columns, name: str, path: str) -> List[str]:
    """A column of texts. Raises ValueError if it is missing."""
    if name not in columns:
        raise ValueError("{}: column {} is missing".format(path, name))
    column = columns[name]
    return ["{:g}".format(value) for value in column] if isinstance(column, np.ndarray) else column


class Grid:
    """The rows of a table as a grid of vehicles and steps.

    Raises ValueError unless there is one row for each vehicle `first`, first + 1, ... and each step; without steps one row
    for each vehicle. Vehicle 1 must be among them.
    """

    def __init__(self, columns: Columns, path: str, first: int, has_steps: bool = True, rows: Optional[NDArray[np.bool_]] = None):
        self.columns, self.path = columns, path
        vehicle = numbers(columns, "vehicle", path)
        step = numbers(columns, "step", path) if has_steps else np.zeros(vehicle.size)
        kept = np.flatnonzero(np.ones(vehicle.size, bool) if rows is None else rows)
        self._order = kept[np.lexsort((step[kept], vehicle[kept]))]
        #: step numbers
        self.steps = np.unique(step[kept])
        #: number of vehicles
        self.vehicles = int(np.unique(vehicle[kept]).size)
        if not np.array_equal(vehicle[self._order], np.repeat(np.arange(first, first + self.vehicles), self.steps.size)) \
                or not np.array_equal(step[self._order], np.tile(self.steps, self.vehicles)) or first + self.vehicles < 2:
            raise ValueError("{}: must hold one row for each vehicle {}..N{}; rows are missing or double".format(
                path, first, " and step" if has_steps else ""))
        self._shape = (self.vehicles, self.steps.size) if has_steps else (self.vehicles,)

    def numbers(self, name: str) -> NDArray[np.float64]:
        """A column, shape (vehicles, steps) or (vehicles,)."""
        column: NDArray[np.float64] = numbers(self.columns, name, self.path)[self._order]
        return column.reshape(self._shape)
