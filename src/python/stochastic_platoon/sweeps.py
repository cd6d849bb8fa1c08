"""The results of the program `sweep`."""

from __future__ import annotations

from typing import List

from .tables import Columns, Table


class Sweep(Table):
    """A table of runs: sweep.csv, which `sweep` wrote."""

    MEASURED = ("point", "vehicle", "step", "count", "mean", "mean_standard_error", "variance", "variance_standard_error",
                "theoretical_mean", "theoretical_variance", "string_stable", "agrees")

    def __init__(self, columns: Columns, path: str) -> None:
        super().__init__(columns, path)
        for name in self.MEASURED:
            self.numbers(name)
        names = list(columns)
        #: names of the parameters that vary: the columns in front of `vehicle`
        self.varied: List[str] = names[1:names.index("vehicle")]
        if not self.varied:
            raise ValueError("{}: nothing varies in it".format(path))
