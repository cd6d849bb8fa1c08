"""Monte Carlo in this process, with the bits of the nodes and tools."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Callable, Dict, Iterable, Optional

import numpy as np

from . import _platoon
from .model import Model, PathLike, handle_of
from .results import Results
from .tables import Grid, Table

if TYPE_CHECKING:
    from numpy.typing import NDArray


def run_settings(**values: object) -> Dict[str, str]:
    """The settings of a run as texts, without those that are None. Internal."""
    return {name: str(value) for name, value in values.items() if value is not None}


def listed(names: Iterable[str]) -> str:
    """Names in the format of the settings, separated by commas. Internal."""
    return names if isinstance(names, str) else ",".join(names)


def monte_carlo(model: Model, *, realizations: int = 10000, followers: int = 20, steps: Optional[int] = None, seed: int = 1,
                signals: Iterable[str] = (), burn_in: Optional[int] = None, threads: Optional[int] = None,
                output: Optional[PathLike] = None, checkpoint_seconds: float = 10.0,
                progress: Optional[Callable[[int, int], None]] = None) -> Results:
    """Computes `realizations` of a platoon of `followers` over `steps` (10 s of driving by default), with the bits of the nodes.

    `signals`: gap, speed, acceleration, jerk, beside the tracking errors. `burn_in`: steps that the amplification leaves out.
    `threads`: one per core by default; the results do not depend on it. `output`: a folder for the results, in which a run that
    was interrupted or killed continues; without it they are only returned. `progress(done, realizations)` is called about ten
    times a second; its exceptions, and Ctrl-C, end the run.

    Raises ValueError with all problems of the settings, and OSError if the folder cannot be written.
    """
    settings = run_settings(followers=followers, steps=steps, realizations=realizations, seed=seed, signals=listed(signals) or None,
                            burn_in=burn_in, output=None if output is None else os.path.abspath(output))
    if threads is not None and threads < 1:
        raise ValueError("threads: {}: must be 1 or more".format(threads))

    def report_progress(done: int) -> None:
        if progress is not None:
            progress(done, realizations)

    summary, tables, report = _platoon.monte_carlo(
        handle_of(model), settings, threads or 0, checkpoint_seconds, report_progress, lambda text: warnings.warn(text, stacklevel=3))
    return Results(summary, tables, settings.get("output", "monte_carlo"), report)


class Trajectories:
    """All vehicles in one realization of a run, as arrays of shape (vehicles 0..N, steps) from step -1 on; NaN where a value does
    not exist, as the tracking error of the leader."""

    QUANTITIES = ("position", "received_position", "input", "received_input", "tracking_error", "gap", "speed", "acceleration", "jerk")

    def __init__(self, table: Table, name: str, rows: Optional[NDArray[np.bool_]] = None) -> None:
        self.path = table.path
        #: the name of the file's folder
        self.name = name
        self._grid = Grid(table, 0, rows=rows)
        #: step numbers
        self.steps = self._grid.steps
        #: [s]
        self.seconds = self._grid.numbers("seconds")[0]

    @classmethod
    def load(cls, path: PathLike) -> Trajectories:
        """The trajectories.csv that `monte_carlo --only R --trajectories` wrote, or its folder. Raises FileNotFoundError, and
        ValueError if it is not such a file."""
        file = os.path.join(path, "trajectories.csv") if os.path.isdir(path) else os.fspath(path)
        return cls(Table.load(file), os.path.basename(os.path.dirname(os.path.abspath(file))))

    def between(self, first: float, last: float) -> Trajectories:
        """The same from step `first` to step `last`. Raises ValueError if it has no step there."""
        step = self._grid.table.numbers("step")
        return Trajectories(self._grid.table, self.name, (first <= step) & (step <= last))

    def __getitem__(self, quantity: str) -> NDArray[np.float64]:
        """A quantity, as "gap" [m]. Raises KeyError."""
        if quantity not in self.QUANTITIES:
            raise KeyError("{}: must be one of {}".format(quantity, ", ".join(self.QUANTITIES)))
        return self._grid.numbers(quantity)


def trajectories(model: Model, realization: int, *, realizations: int = 10000, followers: int = 20, steps: Optional[int] = None,
                 seed: int = 1) -> Trajectories:
    """One realization of a run, with the run's bits. The settings are those of the run. Raises ValueError."""
    if realization < 0:
        raise ValueError("realization: {}: must be 0 or more".format(realization))
    settings = run_settings(followers=followers, steps=steps, realizations=realizations, seed=seed)
    name = "realization {}".format(realization)
    return Trajectories(Table(_platoon.trajectories(handle_of(model), settings, realization), name), name)
