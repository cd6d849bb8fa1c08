"""Recorded platoons: the bags that a run with record:=FILE wrote."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Iterable, List, Optional, Union

from .model import Configuration, Model, PathLike, checked_vehicle
from .results import Results
from .simulation import listed

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._recordings import Source


class Recording:
    """The bag, or the bags, of one run. Every message is checked by its checksum when it is read."""

    def __init__(self, path: Union[PathLike, Iterable[PathLike]], *, partial: bool = False, unverified: bool = False) -> None:
        """`partial`: also reads the existing part of a bag that was not closed or is cut off. `unverified`: also reads bags without
        checksums, as `rosbag record` writes them. Raises FileNotFoundError, and ValueError if it is no recording of a platoon."""
        from . import _recordings  # loads the libraries of ROS

        files: List[str] = [os.fspath(path)] if isinstance(path, (str, os.PathLike)) else [os.fspath(file) for file in path]
        for file in files:
            if not os.path.exists(file):
                raise FileNotFoundError("{}: no such file".format(file))
        #: the files
        self.files = files
        self._source: Source = _recordings.Source(files, partial, unverified)
        #: model and options of the run
        self.configuration = Configuration.parse(_recordings.configuration(self._source))

    @property
    def model(self) -> Model:
        return self.configuration.model

    def _values(self, stream: str, vehicle: int) -> NDArray[np.float64]:
        from . import _recordings

        return _recordings.values(self._source, stream, checked_vehicle(vehicle))

    def positions(self, vehicle: int) -> NDArray[np.float64]:
        """y_i(k) [m], shape (realizations, steps + 1), from step -1 on; NaN where the recording has none. Raises IndexError for a
        vehicle that the platoon does not have."""
        return self._values("position", vehicle)

    def predecessor_positions(self, vehicle: int) -> NDArray[np.float64]:
        """y_{i-1}(k) [m] as follower i received it, of the same shape; NaN where it was lost."""
        return self._values("predecessor_position", vehicle)

    def inputs(self, vehicle: int) -> NDArray[np.float64]:
        """v_i(k) = u_i(k - 1) [m/s^2], of the same shape. Raises IndexError if no follower receives it."""
        return self._values("input", vehicle)

    def predecessor_inputs(self, vehicle: int) -> NDArray[np.float64]:
        """v_{i-1}(k) as follower i received it."""
        return self._values("predecessor_input", vehicle)

    def results(self, signals: Optional[Iterable[str]] = None) -> Results:
        """The results of the run, bit for bit those that its monitor wrote, or with other signals. Raises ValueError if the
        recording is not complete, unless `partial` was given."""
        from . import _recordings

        chosen = None if signals is None else listed(signals).split(",")
        summary, tables, report, findings = _recordings.results(self._source, chosen)
        if findings:
            raise ValueError("{}: {}".format(self.files[0], "; ".join(findings)))
        return Results(summary, tables, self.files[0], report)
