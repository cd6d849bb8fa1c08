"""The theory: everything that `analyze` reports, as arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Iterable, Iterator, List, Mapping, Optional, Tuple

import numpy as np

from . import _platoon
from .model import Model, PathLike, handle_of
from .simulation import listed, positive, run_settings
from .tables import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray


def at_path(document: Any, path: str) -> Any:
    """The value at a path into JSON, "norms/mean_l2/3" or with dots. Raises KeyError. Internal."""
    for part in path.replace(".", "/").split("/"):
        if isinstance(document, Mapping) and part in document:
            document = document[part]
        elif isinstance(document, (list, np.ndarray)) and part.isdigit() and int(part) < len(document):
            document = document[int(part)]
        else:
            raise KeyError(path)
    return document


class Analysis(Mapping[str, Any]):
    """The results of the theory for a platoon. As a mapping it has the keys of `analyze --json`; lists of numbers are arrays, with
    NaN for values that do not exist."""

    def __init__(self, document: Dict[str, Any], path: str, report: Optional[str] = None) -> None:
        #: the file, or its substitute in messages
        self.path = path
        #: the report that the tool prints; None for an analysis from a file
        self.report = report
        self._document = document

    @classmethod
    def load(cls, path: PathLike) -> Analysis:
        """The file that `analyze --json` wrote. Raises FileNotFoundError, and ValueError if it is another file."""
        file = os.fspath(path)
        if os.path.isdir(file):
            raise ValueError("{}: must be a file that analyze --json wrote, not a folder".format(file))
        document = _platoon.read_json(file)
        # Of cars without a theory only the reason is known.
        if "spectral_radius" not in document and document.get("theory") != "none":
            raise ValueError("{}: spectral_radius is missing: must be a file that analyze --json wrote".format(file))
        return cls(document, file)

    @property
    def name(self) -> str:
        """The name of the file, without ending."""
        return os.path.splitext(os.path.basename(self.path))[0]

    def __getitem__(self, key: str) -> Any:
        """The value of a key, also of a nested one: "norms.mean_l2" or "norms/mean_l2/3". Raises KeyError."""
        try:
            return at_path(self._document, key)
        except KeyError:
            raise KeyError("{}: {} is missing{}".format(self.path, key, self._why_missing(key))) from None

    def _why_missing(self, key: str) -> str:
        if self._document.get("theory") != "none":
            return ""
        linear = "linear." + key
        of_linear = "; {} is that of the same cars without limits".format(linear) if not key.startswith("linear.") and linear in self else ""
        return "; theory: {}{}".format(self.reason, of_linear)

    def __iter__(self) -> Iterator[str]:
        return iter(self._document)

    def __len__(self) -> int:
        return len(self._document)

    def number(self, key: str) -> float:
        """The number at a key, NaN if it does not exist. Raises KeyError, and ValueError for anything else."""
        value = self[key]
        if value is not None and (isinstance(value, bool) or not isinstance(value, (int, float))):
            raise ValueError("{}: {} must be a number or null".format(self.path, key))
        return float("nan") if value is None else float(value)

    def numbers(self, key: str) -> NDArray[np.float64]:
        """The numbers at a key, with NaN for those that do not exist. Raises KeyError, and ValueError for anything else."""
        value = self[key]
        if not isinstance(value, np.ndarray) or value.size == 0:
            raise ValueError("{}: {} must be a list of numbers, not empty".format(self.path, key))
        return value

    def _number(self, key: str) -> float:
        return self.number(key) if key in self._document else float("nan")

    @property
    def string_stable(self) -> Optional[bool]:
        """The verdict; None if there is none."""
        value: Optional[bool] = self._document.get("string_stable")
        return value

    @property
    def reason(self) -> str:
        """The reason of the verdict."""
        return str(self._document.get("reason", ""))

    @property
    def critical_headway(self) -> float:
        """[sample periods]; NaN if there is none."""
        return self._number("critical_headway")

    @property
    def spectral_radius(self) -> float:
        """rho(A)."""
        return self._number("spectral_radius")

    @property
    def limit_variance(self) -> float:
        """The stationary variance along an endless string [m^2]; NaN if there is none."""
        return self._number("limit_variance")

    @property
    def stationary_variance(self) -> NDArray[np.float64]:
        """[m^2], one per follower; NaN where it does not exist."""
        return self.numbers("stationary_variance")

    @property
    def mean(self) -> NDArray[np.float64]:
        """The mean of every tracking error [m], shape (followers, steps)."""
        return self.numbers("mean")

    @property
    def variance(self) -> NDArray[np.float64]:
        """The variance of every tracking error [m^2], shape (followers, steps)."""
        return self.numbers("variance")

    @property
    def limits_over_headway(self) -> Optional[Tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Headways [s] and the limit variance at each [m^2], NaN where there is none; None without `analyze --sweep-headway`."""
        if "sweep" not in self._document:
            return None
        points = [Analysis(point, self.path) for point in self["sweep"]]
        headways, limits = (np.array([point.number(key) for point in points]) for key in ("headway", "limit_variance"))
        return headways * self.number("sample_period"), limits

    def __repr__(self) -> str:
        return "Analysis({!r}: {})".format(self.path, self.reason or "no theory")


def key_of(path: str) -> str:
    """The key that computes a figure: peak_gain, norms of norms/mean_l2, linear/norms of linear/norms/mean_l2."""
    parts = path.replace(".", "/").split("/")
    return "/".join(parts[:2] if parts[0] == "linear" else parts[:1])


def analyze(model: Model, *, followers: int = 20, steps: Optional[int] = None, signals: Iterable[str] = (),
            collision_probability: Optional[float] = None, burn_in: Optional[int] = None, keys: Iterable[str] = ()) -> Analysis:
    """The theory of a platoon of `followers` over `steps` (10 s of driving by default).

    `signals`: any of SIGNALS. `collision_probability`: per step; adds collisions, and the standstill distance that
    satisfies it. `burn_in`: steps that the amplification leaves out. `keys`: those of the JSON document that are needed, without a report;
    others are then null, empty or missing (default: all). Raises ValueError with all problems of the settings, and for keys that the
    theory of this model does not have.
    """
    settings = run_settings(followers=followers, steps=steps, burn_in=burn_in)
    probability = "" if collision_probability is None else repr(positive("collision_probability", collision_probability))
    needed = {key_of(key) for key in listed(keys, "keys").split(",") if key}
    document, report = _platoon.analyze(handle_of(model), settings, listed(signals), probability, needed)
    analysis = Analysis(document, "analysis", report)
    unknown = sorted(key for key in needed if key not in analysis)
    if unknown and document.get("theory") == "none":  # its keys are those of any model, missing here
        document = _platoon.analyze(handle_of(Model.load()), settings, listed(signals), probability, {"reason"})[0]
        unknown = [key for key in unknown if key.replace("linear/", "", 1) not in document]
    if unknown:
        raise ValueError("keys: {}: not in the theory of this model: must be of {}".format(", ".join(unknown), ", ".join(sorted(document))))
    return analysis


@dataclass(frozen=True)
class StabilityMap:
    """String stability over two of headway, gain, loss and mean_burst. The other arrays have shape (ys, xs)."""

    over: str  #: the parameter in xs
    xs: NDArray[np.float64]
    up: str  #: the parameter in ys
    ys: NDArray[np.float64]
    spectral_radius: NDArray[np.float64]
    peak_gain: NDArray[np.float64]
    string_stable: NDArray[np.float64]  #: 1, 0, or NaN for no verdict
    loss_gain: NDArray[np.float64]  #: NaN without losses
    phase_margin: NDArray[np.float64]  #: [deg]; this and the next three: NaN where there is none, and in a map from a file
    delay_margin: NDArray[np.float64]  #: [s]
    sensitivity_peak: NDArray[np.float64]
    critical_delay: NDArray[np.float64]  #: [s], of the radio
    path: str  #: the file, or its substitute in messages

    AXES = ("headway", "gain", "loss", "mean_burst")

    @classmethod
    def load(cls, path: PathLike) -> StabilityMap:
        """The file that `analyze --sweep-... --csv` wrote. Raises FileNotFoundError, and ValueError unless two parameters vary."""
        return cls._of(Table.load(path))

    @classmethod
    def _of(cls, table: Table) -> StabilityMap:
        axes = {name: table.numbers(name) for name in cls.AXES if name in table.columns}
        varying = [name for name, values in axes.items() if np.unique(values).size > 1]
        values = {name: table.numbers(name) for name in ("spectral_radius", "peak_gain", "string_stable")}
        if len(varying) != 2:
            raise ValueError("{}: {}: must be two of {}, each with two or more values".format(
                table.path, " and ".join(varying) + " vary" if varying else "nothing varies", ", ".join(cls.AXES)))
        over, up = varying
        x, y = axes[over], axes[up]
        xs, ys = np.unique(x), np.unique(y)
        order = np.lexsort((x, y))
        if not np.array_equal(x[order], np.tile(xs, ys.size)) or not np.array_equal(y[order], np.repeat(ys, xs.size)):
            raise ValueError("{}: must hold one row for each point of a grid of {} and {}".format(table.path, over, up))
        for name in ("loss_gain", "phase_margin", "delay_margin", "sensitivity_peak", "critical_delay"):
            values[name] = table.numbers(name) if name in table.columns else np.full(x.size, np.nan)
        return cls(over, xs, up, ys, **{name: value[order].reshape(ys.size, xs.size) for name, value in values.items()}, path=table.path)


def numbers_of(name: str, values: Iterable[float]) -> List[float]:
    """The numbers as a list. Raises ValueError for anything else. Internal."""
    try:
        return [float(value) for value in values]
    except (TypeError, ValueError):
        raise ValueError("{}: {!r}: must be a list of numbers".format(name, values)) from None


def stability_map(model: Model, *, headway: Iterable[float] = (), gain: Iterable[float] = (), loss: Iterable[float] = (),
                  mean_burst: Iterable[float] = ()) -> StabilityMap:
    """String stability over a grid of two of these parameters of the default vehicle. Raises ValueError."""
    axes = [numbers_of(name, values) for name, values in zip(StabilityMap.AXES, (headway, gain, loss, mean_burst))]
    return StabilityMap._of(Table(_platoon.stability_map(handle_of(model), *axes), "map"))
