"""The model of a platoon, as its model file defines it."""

from __future__ import annotations

import json
import operator
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Tuple, Union

from . import _platoon

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

PathLike = Union[str, "os.PathLike[str]"]


def _as_json(value: Any, name: str = "model") -> str:
    """The value as JSON; arrays and numbers of NumPy become lists and numbers. Raises ValueError for anything else."""
    try:
        return json.dumps(value, default=lambda other: other.tolist())
    except (AttributeError, TypeError, ValueError, RecursionError):
        raise ValueError("{}: {:.80}: must be a number, a text, true or false, a list or a mapping of these".format(
            name, repr(value))) from None


def checked_vehicle(index: int) -> int:
    """The number of a vehicle. Raises IndexError if it is negative, and ValueError for what is no whole number of 64 bits. Internal."""
    try:
        number = operator.index(index)
    except TypeError:
        number = 2**64
    if number < 0:
        raise IndexError("vehicle: {}: must be 0 or more".format(index))
    if number >= 2**64:
        raise ValueError("vehicle: {:.80}: must be a whole number from 0 to {}".format(repr(index), 2**64 - 1))
    return number


FASTEST_CAR = _platoon.fastest_car  #: [m/s], of the warnings about implausible runs, as the next two
HARDEST = _platoon.hardest  #: [m/s^2]: no road vehicle brakes or accelerates more
REVERSING = _platoon.reversing  #: [m/s]: slower is backwards, beyond the noise of a standing vehicle
SIGNALS = tuple(_platoon.signals.split(", "))  #: that a run measures on request


@dataclass(frozen=True)
class Vehicle:
    """One vehicle of a platoon. Its closed loop is x(k + 1) = A x(k) + B y_{i-1}(k), y_i(k) = C x(k)."""

    A: NDArray[np.float64]  #: shape (n, n)
    B: NDArray[np.float64]  #: shape (n,)
    C: NDArray[np.float64]  #: shape (n,)
    time_headway: float  #: h [sample periods]
    standstill_distance: float  #: delta [m], to the predecessor
    vehicle_length: float  #: [m]
    noise_variance: float  #: P_d [m^2] of the link into it
    loss_probability: Optional[float]  #: of that link, or of the radio if there is one; None without losses
    place: float  #: [m] at step -1: in formation, the leader at 0; behind it by the headways for a steady start
    speed: float  #: V [m/s], at which all vehicles have driven up to step -1: 0 from rest, else the leader's first speed


#: The keys of the default vehicle that a key of a type excludes.
EXCLUDED = {"closed_loop": ("plant", "controller", "limits"), "plant": ("closed_loop",), "spacing": ("time_headway",)}


class Model:
    """A platoon as its model file describes it (config/README.md). Models are immutable: replace() returns another one."""

    def __init__(self, handle: _platoon.Model) -> None:
        if not isinstance(handle, _platoon.Model):
            raise TypeError("model: {:.80}: use Model.load(), Model.parse() or Model.from_dict()".format(repr(handle)))
        self._handle = handle

    @classmethod
    def load(cls, path: PathLike = "paper.yaml") -> Model:
        """The model in a file, or the shipped one of this name, as "acc.yaml".

        Raises FileNotFoundError, and ValueError with all problems of the file.
        """
        return cls(_platoon.Model.load(os.fspath(path)))

    @classmethod
    def parse(cls, text: str) -> Model:
        """The model of a text in the format of the file, or in JSON. Raises ValueError with all problems."""
        return cls(_platoon.Model.parse(text))

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Model:
        """The model of a dictionary that to_dict() returned. Raises ValueError with all problems."""
        if not isinstance(document, Mapping):
            raise ValueError("document: {:.80}: must be a dictionary, as to_dict() returns it".format(repr(document)))
        return cls.parse(_as_json(dict(document)))

    def replace(self, changes: Optional[Mapping[str, Any]] = None, **keys: Any) -> Model:
        """The model with other values of keys of the model file; nested ones as a path: replace({"channel/delay": 2}).

        The short names of launch arguments work, too: headway, headway_seconds, loss, mean_burst, delay, leader. A relative path of a table
        (leader/file, channel/loss/trace) is one from the working directory. Raises ValueError with all problems.
        """
        named = {str(name): _as_json(value, name) for name, value in {**(changes or {}), **keys}.items()}
        return Model(self._handle.replaced(named))

    def to_dict(self) -> Dict[str, Any]:
        """The keys and values of the model file, with all defaults."""
        return self._handle.document()

    def vehicle(self, index: int) -> Vehicle:
        """Vehicle `index`: 0 is the leader, the followers are 1, 2, ... without end, as the string of types repeats.

        Raises IndexError for a negative index.
        """
        return Vehicle(**self._handle.vehicle(checked_vehicle(index)))

    def manoeuvres(self) -> Dict[str, Any]:
        """What the leader's manoeuvres of an endless run are within its limits. Of speeds [m/s] and accelerations [m/s^2] lower and
        upper bound, None without one: an acceleration without bound changes the speed at once."""
        return self._handle.manoeuvres()

    def vehicle_to_dict(self, index: int) -> Dict[str, Any]:
        """The keys and values of the model file for vehicle `index`: those of its type in place of the default ones, without default
        ones that they exclude.

        Raises IndexError for a negative index.
        """
        document = self.to_dict()
        string, types = document.get("string", ["default"]), document.get("vehicle_types", {})
        own = types.get(string[(index - 1) % len(string)], {}) if checked_vehicle(index) > 0 else {}
        excluded = {key for name in own for key in EXCLUDED.get(name, ())}
        return {**{key: value for key, value in document.items() if key not in excluded}, **own}

    @property
    def spacing(self) -> str:
        """The spacing of the string's vehicles in words: "h = 0.32 s (3.2 sample periods)", "constant spacing of 9.2 m"."""
        return self._handle.spacing

    @property
    def noise(self) -> str:
        """The noise variances of what they hear in words: "P_d = 0.25 to 0.4 m^2, radio 0.04 (m/s^2)^2"."""
        return self._handle.noise

    @property
    def sample_period(self) -> float:
        """T_s [s]."""
        return float(self.to_dict()["sample_period"])

    @property
    def time_headway(self) -> float:
        """h of the default vehicle [sample periods]."""
        return self.vehicle(0).time_headway

    @property
    def time_headway_seconds(self) -> float:
        """h of the default vehicle [s]."""
        return self.time_headway * self.sample_period

    @property
    def noise_variance(self) -> float:
        """P_d of the default vehicle's link [m^2]."""
        return self.vehicle(0).noise_variance

    @property
    def is_homogeneous(self) -> bool:
        """Whether all followers have the default type."""
        return self._handle.is_homogeneous

    @property
    def start_slope(self) -> float:
        """Displacement of all vehicles per step before step -1 [m]: V T_s for a steady start, 0 at rest."""
        return self._handle.start_slope

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self.to_dict() == other.to_dict()

    def __hash__(self) -> int:
        return hash(_as_json(self.to_dict()))

    def __repr__(self) -> str:
        return "Model(time_headway={:g}, noise_variance={:g}, sample_period={:g})".format(
            self.time_headway, self.noise_variance, self.sample_period)

    def __reduce__(self) -> Tuple[Any, Tuple[Dict[str, Any]]]:
        return Model.from_dict, (self.to_dict(),)


@dataclass(frozen=True)
class Configuration:
    """The model and the options of a run, as the topic and the parameter `configuration` of a running platoon hold them."""

    model: Model
    run: Dict[str, Any]  #: the launch arguments by name

    @classmethod
    def parse(cls, text: str) -> Configuration:
        """The configuration of a JSON text. Raises ValueError with all problems, and if another version wrote it."""
        handle, run = _platoon.parse_configuration(text)
        return cls(Model(handle), run)


def handle_of(model: object) -> _platoon.Model:
    """The model as the C++ functions take it. Raises TypeError for anything else, as the path of a model file."""
    if not isinstance(model, Model):
        raise TypeError("model: {!r}: must be a Model, as Model.load() returns".format(model))
    return model._handle


def shipped_file(name: str, folder: str = "config") -> str:
    """The path of a shipped file, as "acc.yaml", or "city.csv" in the folder "config/leaders". Returns `name` itself if no such file is
    shipped, or if the working folder has one."""
    return _platoon.shipped_file(name, folder)
