"""The results of a run, as in its folder."""

from __future__ import annotations

import os
from functools import cached_property
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional

import numpy as np

from . import _platoon
from .model import Model, PathLike
from .tables import Ages, Amplification, Columns, Gaps, Grid, Moments, Table

if TYPE_CHECKING:
    from numpy.typing import NDArray


def check(folder: PathLike) -> List[str]:
    """The reasons why the run in a folder is not complete, undamaged and in agreement with its theory, as the program `check` prints
    them; empty if it is. Raises ValueError or OSError if there are no results that this version can read."""
    return _platoon.check_results(os.fspath(folder))[0]


class Results:
    """Mean and variance of every tracking error, and the other measurements of a run.

    `steps` holds the step numbers; for averages over time one, the step up to which all of them reach, or -1 if they have none of the
    latest attempt. `count`, `mean` [m], `variance` [m^2], `theoretical_mean` and `theoretical_variance` are arrays of shape
    (followers, steps): follower i is in row i - 1.
    """

    def __init__(self, summary: Dict[str, Any], tables: Mapping[str, Columns], path: str, report: Optional[str] = None) -> None:
        #: the folder, or its substitute in messages
        self.path = path
        #: summary.json
        self.summary = summary
        #: the report that the tools print; None for results from a folder
        self.report = report
        self._tables = tables
        grid = Grid(self._table("statistics"), 1, over_time=self.time_average)
        self.steps, self.followers = grid.steps, grid.vehicles
        #: of the tracking errors
        self.errors = errors = Moments._of(grid)
        self.count, self.mean, self.variance = errors.count, errors.mean, errors.variance
        self.theoretical_mean, self.theoretical_variance = errors.theoretical_mean, errors.theoretical_variance
        self._require_followers("statistics", grid.vehicles)

    @classmethod
    def load(cls, folder: PathLike) -> Results:
        """The results in a folder that a monitor, monte_carlo, merge or bag_statistics wrote.

        Raises FileNotFoundError, and ValueError if a file has changed since it was written.
        """
        path = os.fspath(folder)
        if not os.path.isdir(path):
            if os.path.exists(path):
                raise ValueError("{}: must be a run's folder".format(path))
            raise FileNotFoundError("{}: no such folder".format(path))
        summary, tables = _platoon.read_results(path)
        return cls(summary, tables, path)

    def table(self, name: str) -> Columns:
        """The columns of a table by its file's name without ending: arrays of numbers, lists of texts. Raises KeyError."""
        if name not in self._tables:
            raise KeyError("{}: has no table {}: must be one of {}".format(self.path, name, ", ".join(sorted(self._tables))))
        return self._tables[name]

    def _table(self, name: str) -> Table:
        return Table(self.table(name), os.path.join(self.path, name + ".csv"))

    def _require_followers(self, table: str, followers: int) -> None:
        if self._value("followers") != followers:
            raise ValueError("{}: followers is {}, but {}.csv beside it has {}".format(
                os.path.join(self.path, "summary.json"), self._value("followers"), table, followers))

    def _vehicles(self, table: str, first: int, signals: str) -> Grid:
        """A table with one row for each vehicle, which only runs with these signals have, and of the speed only those of two steps."""
        if table not in self._tables:
            needed = "signals:={} (monte_carlo --signals)".format(signals)
            if signals.split(",")[0] in self.signals:
                needed = "at least 2 steps"
            raise KeyError("{}: no such file: run with {}".format(os.path.join(self.path, table + ".csv"), needed))
        grid = Grid(self._table(table), first, has_steps=False)
        self._require_followers(table, grid.vehicles + first - 1)
        return grid

    def _value(self, key: str) -> Any:
        value: Any = self.summary
        for part in key.split("."):
            if not isinstance(value, dict) or part not in value:
                raise ValueError("{}: {} is missing".format(os.path.join(self.path, "summary.json"), key))
            value = value[part]
        return value

    def _number(self, key: str) -> float:
        value = self._value(key)
        return float("nan") if value is None else float(value)

    @property
    def name(self) -> str:
        """The name of the folder."""
        return os.path.basename(os.path.abspath(self.path))

    @property
    def realizations(self) -> int:
        return int(self._value("realizations"))

    @property
    def seed(self) -> int:
        return int(self._value("seed"))

    @property
    def complete(self) -> bool:
        """Whether the run is complete."""
        return bool(self._value("complete"))

    @property
    def time_average(self) -> bool:
        """Whether the moments are averages over time."""
        return bool(self._value("time_average"))

    @property
    def standard_error_of_variance(self) -> NDArray[np.float64]:
        """The standard error of every follower's variance at the last step [m^2]; NaN where it is unknown."""
        return np.array(self._value("standard_error_of_variance"), dtype=float)

    @property
    def largest_standard_error_of_variance(self) -> NDArray[np.float64]:
        """The largest of the standard errors of every follower's variance over all steps [m^2]; NaN where it is unknown."""
        return np.array(self._value("largest_standard_error_of_variance"), dtype=float)

    @property
    def spectral_radius(self) -> float:
        """rho(A); NaN without a theory."""
        return self._number("theory.spectral_radius")

    @property
    def string_stable(self) -> Optional[bool]:
        """The verdict of the theory; None if it has none."""
        value = self._value("theory.string_stable")
        return None if value is None else bool(value)

    @property
    def max_abs_z(self) -> Optional[float]:
        """The largest difference of measurement and theory over all tracking errors, in standard errors; None without a comparison. Of the means
        alone where the theory does not know the scatter of measured variances."""
        values = [self._value("agreement." + key) for key in ("max_abs_z_mean", "max_abs_z_variance")]
        return max((value for value in values if value is not None), default=None)

    @property
    def sample_period(self) -> float:
        """T_s [s]."""
        return self._number("configuration.model.sample_period")

    @property
    def model(self) -> Model:
        """The model of the run."""
        return Model.from_dict(self._value("configuration.model"))

    @property
    def signals(self) -> Dict[str, Moments]:
        """The moments of the requested signals by name, as "gap"; empty without any."""
        if "signals" not in self._tables:
            return {}
        table = self._table("signals")
        names = table.texts("signal")
        return {name: Moments._of(Grid(table, 1, rows=np.array(names) == name)) for name in dict.fromkeys(names)}

    @cached_property
    def gaps(self) -> Gaps:
        """The smallest gaps. Raises KeyError unless the gap was among the signals of the run."""
        return Gaps._of(self._vehicles("gaps", 1, "gap"), self._value("configuration.model").get("safe_gap"))

    @cached_property
    def amplification(self) -> Amplification:
        """The amplification of the speed. Raises KeyError unless the speed was among the signals of the run."""
        grid = self._vehicles("amplification", 0, "speed,acceleration")
        first, last = (self._number(key) * self.sample_period for key in ("configuration.run.burn_in", "steps"))
        return Amplification._of(grid, (first, last))

    @property
    def ages(self) -> Ages:
        """The ages of information on the links. Raises KeyError if no link of the run loses messages."""
        return Ages._of(self._table("ages"))

    def __repr__(self) -> str:
        return "Results({!r}: {} followers, {} steps, {} realizations)".format(
            self.path, self.followers, self.steps.size, self.realizations)
