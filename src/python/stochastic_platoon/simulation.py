"""Monte Carlo in this process, with the bits of the nodes and tools."""

from __future__ import annotations

import math
import operator
import os
import warnings
from typing import TYPE_CHECKING, Callable, Dict, Iterable, Mapping, Optional

import numpy as np

from . import _platoon
from .model import SIGNALS, Model, PathLike, handle_of
from .results import Results
from .tables import Grid, Table

if TYPE_CHECKING:
    from numpy.typing import NDArray


def run_settings(**values: object) -> Dict[str, str]:
    """The settings of a run as texts, without those that are None. Internal."""
    return {name: str(value) for name, value in values.items() if value is not None}


def listed(names: Iterable[str], argument: str = "signals") -> str:
    """Names in the format of the settings, separated by commas. Raises ValueError for anything else. Internal."""
    if isinstance(names, str):
        return names
    try:
        return ",".join(names)
    except TypeError:
        raise ValueError("{}: {!r}: must be names, as in ['gap', 'speed']".format(argument, names)) from None


def positive(name: str, value: object) -> float:
    """The number. Raises ValueError unless it is a finite number above 0. Internal."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not 0.0 < number < math.inf:
        raise ValueError("{}: {!r}: must be a finite number > 0".format(name, value))
    return number


def whole(name: str, value: object, least: int) -> int:
    """The whole number. Raises ValueError if it is none, or below `least`. Internal."""
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise ValueError("{}: {!r}: must be a whole number".format(name, value)) from None
    if not least <= number < 2 ** 63:
        raise ValueError("{}: {}: must be {} or more, and below 2^63".format(name, number, least))
    return number


def folder_of(output: PathLike) -> str:
    """The absolute path of a folder for results. Raises ValueError if it is empty. Internal."""
    path = os.fsdecode(output)
    if not path or "\0" in path:
        raise ValueError("output: {!r}: must be a folder".format(path))
    return os.path.abspath(path)


class UnsavedResults(OSError):
    """The folder of a run could not be written at its end."""

    def __init__(self, reason: str, results: Results) -> None:
        super().__init__(reason + " (the results are in the attribute `results` of this exception)")
        #: the results that are not in the folder
        self.results = results


def monte_carlo(model: Model, *, realizations: int = 10000, followers: int = 20, steps: Optional[int] = None, seed: int = 1,
                signals: Iterable[str] = (), burn_in: Optional[int] = None, threads: Optional[int] = None,
                output: Optional[PathLike] = None, checkpoint_seconds: float = 10.0,
                progress: Optional[Callable[[int, int], None]] = None) -> Results:
    """Computes `realizations` of a platoon of `followers` over `steps` (10 s of driving by default), with the bits of the nodes.

    `signals`: any of SIGNALS, beside the tracking errors. `burn_in`: steps that the amplification leaves out.
    `threads`: one per core by default; the results do not depend on it. `output`: a folder for the results, in which a run that
    was interrupted or killed continues; without it they are only returned. `progress(done, realizations)` is called about ten
    times a second; its exceptions, and Ctrl-C, end the run.

    Raises ValueError with all problems of the settings, and OSError if the folder cannot be written. If it cannot be written at the
    end, as after someone has deleted it, the attribute `results` of the OSError holds the results.
    """
    settings = run_settings(followers=followers, steps=steps, realizations=realizations, seed=seed, signals=listed(signals) or None,
                            burn_in=burn_in, output=None if output is None else folder_of(output))
    workers = 0 if threads is None else whole("threads", threads, 1)
    seconds = positive("checkpoint_seconds", checkpoint_seconds)

    def report_progress(done: int) -> None:
        if progress is not None:
            progress(done, realizations)

    summary, tables, report, unsaved = _platoon.monte_carlo(
        handle_of(model), settings, workers, seconds, report_progress, lambda text: warnings.warn(text, stacklevel=3))
    results = Results(summary, tables, settings.get("output", "monte_carlo"), report)
    if unsaved:
        raise UnsavedResults(unsaved, results)
    return results


class Trajectories:
    """All vehicles in one realization of a run, as arrays of shape (vehicles 0..N, steps) from step -1 on; NaN where a value does
    not exist, as the tracking error of the leader."""

    QUANTITIES = ("position", "received_position", "input", "received_input", "tracking_error",
                  *(name for name in SIGNALS if name != "input"))

    def __init__(self, steps: NDArray[np.float64], seconds: NDArray[np.float64], quantities: Mapping[str, NDArray[np.float64]],
                 path: str, name: str) -> None:
        #: the file, or its substitute in messages
        self.path = path
        #: the name of the file's folder
        self.name = name
        #: step numbers
        self.steps = steps
        #: [s]
        self.seconds = seconds
        self._quantities = quantities

    @classmethod
    def load(cls, path: PathLike) -> Trajectories:
        """The trajectories.csv that `monte_carlo --only R --trajectories` wrote, or its folder. Raises FileNotFoundError, and
        ValueError if it is not such a file."""
        file = os.path.join(path, "trajectories.csv") if os.path.isdir(path) else os.fspath(path)
        grid = Grid(Table.load(file), 0)
        names = [*cls.QUANTITIES, *(name for name in grid.table.columns if name.startswith("received_") and name not in cls.QUANTITIES)]
        return cls(grid.steps, grid.numbers("seconds")[0], {name: grid.numbers(name) for name in names}, file,
                   os.path.basename(os.path.dirname(os.path.abspath(file))))

    def between(self, first: float, last: float) -> Trajectories:
        """The same from step `first` to step `last`. Raises ValueError if it has no step there."""
        chosen = (first <= self.steps) & (self.steps <= last)
        if not chosen.any():
            raise ValueError("{}: no step from {:g} to {:g}: must be from {:g} to {:g}".format(
                self.path, first, last, self.steps[0], self.steps[-1]))
        return Trajectories(self.steps[chosen], self.seconds[chosen],
                            {name: values[:, chosen] for name, values in self._quantities.items()}, self.path, self.name)

    def __getitem__(self, quantity: str) -> NDArray[np.float64]:
        """A quantity, as "gap" [m], or "received_2", the input 2 of vehicles that hear others than their predecessor. Raises
        KeyError."""
        if quantity not in self._quantities:
            raise KeyError("{}: must be one of {}".format(quantity, ", ".join(self._quantities)))
        return self._quantities[quantity]


def trajectories(model: Model, realization: int, *, realizations: int = 10000, followers: int = 20, steps: Optional[int] = None,
                 seed: int = 1) -> Trajectories:
    """One realization of a run, with the run's bits. The settings are those of the run. Raises ValueError."""
    settings = run_settings(followers=followers, steps=steps, realizations=realizations, seed=seed)
    name = "realization {}".format(realization)
    seconds, quantities = _platoon.trajectories(handle_of(model), settings, whole("realization", realization, 0))
    grids = {quantity: values.reshape(-1, seconds.size) for quantity, values in quantities.items()}
    return Trajectories(np.arange(-1.0, seconds.size - 1.0), seconds, grids, name, name)
