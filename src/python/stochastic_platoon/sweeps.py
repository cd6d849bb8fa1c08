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
        #: names of the parameters that vary
        self.varied: List[str] = [name for name in columns if name not in self.MEASURED]
        if not self.varied:
            raise ValueError("{}: nothing varies in it".format(path))
