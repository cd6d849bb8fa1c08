"""Tables of CSV files. Their columns are checked when they are read."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Dict, List, Optional, Type, TypeVar, Union

import numpy as np

from . import _platoon
from .model import PathLike

if TYPE_CHECKING:
    from numpy.typing import NDArray

Column = Union["NDArray[np.float64]", List[str]]
Columns = Dict[str, Column]
T = TypeVar("T", bound="Table")


class Table:
    """The columns of a CSV file by name: arrays of numbers or lists of texts."""

    def __init__(self, columns: Columns, path: str) -> None:
        self.columns = columns
        #: the file, or its substitute in messages
        self.path = path

    @classmethod
    def load(cls: Type[T], path: PathLike) -> T:
        """The table in a file. Raises FileNotFoundError, and ValueError if it is no such table."""
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
            try:
                float(cell or "nan")
            except ValueError:
                raise ValueError("{}: line {}: {}: {}: must be a number".format(self.path, line, name, cell)) from None
        return np.array([float(cell or "nan") for cell in column])

    def texts(self, name: str) -> List[str]:
        """A column of texts. Raises ValueError if it is missing."""
        column = self._column(name)
        return ["{:g}".format(value) for value in column] if isinstance(column, np.ndarray) else column


class Grid:
    """The rows of a table as a grid of vehicles and steps.

    Raises ValueError unless there is one row for each vehicle `first`, first + 1, ... and each step; without steps one row
    for each vehicle. Vehicle 1 must be among them. `rows`: uses only these rows of the table.
    """

    def __init__(self, table: Table, first: int, has_steps: bool = True, rows: Optional[NDArray[np.bool_]] = None):
        self.table = table
        vehicle = table.numbers("vehicle")
        step = table.numbers("step") if has_steps else np.zeros(vehicle.size)
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

    def numbers(self, name: str) -> NDArray[np.float64]:
        """A column, shape (vehicles, steps) or (vehicles,)."""
        column: NDArray[np.float64] = self.table.numbers(name)[self._order]
        return column.reshape(self._shape)
