"""The results of the program `sweep`."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, List

from .model import PathLike
from .tables import Columns, numbers, read_table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Sweep:
    """A table of runs: sweep.csv, which `sweep` wrote. Columns are arrays of numbers or lists of texts."""

    MEASURED = ("point", "vehicle", "step", "count", "mean", "mean_standard_error", "variance", "variance_standard_error",
                "theoretical_mean", "theoretical_variance", "string_stable", "agrees")

    def __init__(self, columns: Columns, path: str) -> None:
        self.path = path
        self.columns = columns
        for name in self.MEASURED:
            self.numbers(name)
        #: names of the parameters that vary
        self.varied: List[str] = [name for name in columns if name not in self.MEASURED]
        if not self.varied:
            raise ValueError("{}: nothing varies in it".format(path))

    @classmethod
    def load(cls, path: PathLike) -> Sweep:
        """The table in a file. Raises FileNotFoundError, and ValueError if it is not a sweep.csv."""
        file = os.fspath(path)
        return cls(read_table(file), file)

    def numbers(self, name: str) -> NDArray[np.float64]:
        """A column of numbers. Raises ValueError if it is missing, or with the line of a cell that is no number."""
        return numbers(self.columns, name, self.path)
