"""Probabilities of small gaps, however small: everything that `rare` reports."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, Callable, Dict, Optional

import numpy as np

from . import _platoon
from .model import Model, PathLike, handle_of
from .simulation import folder_of, positive, run_settings, whole

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Rare:
    """The probabilities that a gap falls below a bound during a run: arrays with one value per follower, and `any` for any of them.
    NaN where a figure does not exist or is below the range of double; `log10_probability` exists there, too."""

    FIGURES = ("probability", "log10_probability", "relative_error", "standard_error", "lower", "upper", "bound", "per_hour")

    def __init__(self, document: Dict[str, Any], path: str, report: Optional[str] = None) -> None:
        #: the folder, or its substitute in messages
        self.path = path
        #: the name of the folder
        self.name = os.path.basename(os.path.abspath(path))
        #: the report that the tool prints; None for results from a folder
        self.report = report
        #: the content of rare.json
        self.document = document
        try:
            *followers, last = document["rows"]
            figures = {name: np.array([self._number(row[name]) for row in followers]) for name in self.FIGURES}
            #: the same figures for any follower, by name
            self.any: Dict[str, float] = {name: self._number(last[name]) for name in self.FIGURES}
            #: [m]
            self.below = float(document["below"])
            #: condition or split
            self.method = str(document["method"])
            #: realizations, or repetitions of a splitting
            self.samples = int(document["samples"])
        except (KeyError, TypeError, ValueError):
            raise ValueError("{}: is not what rare wrote".format(path)) from None
        #: per follower, in one run
        self.probability: NDArray[np.float64] = figures["probability"]
        self.log10_probability: NDArray[np.float64] = figures["log10_probability"]
        #: of the probability
        self.standard_error: NDArray[np.float64] = figures["standard_error"]
        #: the standard error over the probability
        self.relative_error: NDArray[np.float64] = figures["relative_error"]
        #: the lower and the upper end of the interval of 95 %
        self.lower: NDArray[np.float64] = figures["lower"]
        self.upper: NDArray[np.float64] = figures["upper"]
        #: the upper bound of the theory; NaN without theory
        self.bound: NDArray[np.float64] = figures["bound"]
        #: -ln(1 - probability) per hour of the counted steps
        self.per_hour: NDArray[np.float64] = figures["per_hour"]

    @staticmethod
    def _number(value: Optional[float]) -> float:
        return float("nan") if value is None else float(value)

    @classmethod
    def load(cls, folder: PathLike) -> Rare:
        """The results in a folder that `rare` wrote. Raises FileNotFoundError, and ValueError if they are damaged."""
        path = os.fspath(folder)
        summary, _ = _platoon.read_rare(path)
        return cls(summary, path)

    @property
    def followers(self) -> int:
        return int(self.probability.size)

    def __repr__(self) -> str:
        return "Rare({!r}: {} followers, gap below {:g} m)".format(self.path, self.followers, self.below)


def rare(model: Model, *, below: float = 0.0, realizations: int = 10000, followers: int = 20, steps: Optional[int] = None,
         seed: int = 1, burn_in: Optional[int] = None, method: str = "auto", speed: Optional[float] = None,
         threads: Optional[int] = None, output: Optional[PathLike] = None, checkpoint_seconds: float = 10.0,
         progress: Optional[Callable[[int, int], None]] = None) -> Rare:
    """The probability that a gap falls below `below` [m] during `steps` (10 s of driving by default), however small.

    `method`: condition for links with normal errors, split for losses, quantisation and limits, auto for the one of the model.
    `realizations`: per follower, or per level of a splitting. `burn_in`: steps at the start in which a small gap does not count.
    `speed` [m/s]: the document also has probabilities per kilometre. `threads`, `output`, `checkpoint_seconds` and `progress`: as in
    monte_carlo(). Raises ValueError with all problems of the settings.
    """
    settings = run_settings(followers=followers, steps=steps, realizations=realizations, seed=seed, burn_in=burn_in,
                            output=None if output is None else folder_of(output))
    options = run_settings(below=below, method=method, speed=speed)
    workers = 0 if threads is None else whole("threads", threads, 1)
    seconds = positive("checkpoint_seconds", checkpoint_seconds)

    def report_progress(done: int, samples: int) -> None:
        if progress is not None:
            progress(done, samples)

    document, report = _platoon.rare(handle_of(model), settings, options, workers, seconds, report_progress,
                                     lambda text: warnings.warn(text, stacklevel=3))
    return Rare(document, settings.get("output", "rare"), report)
