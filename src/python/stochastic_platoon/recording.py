"""Recorded platoons: the bags that a run with record:=FILE wrote."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Iterable, Iterator, List, Optional, Tuple, Union

import numpy as np

from .model import Configuration, Model, PathLike, checked_vehicle
from .results import Results
from .simulation import Trajectories, listed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._recordings import Source


class Recording:
    """The bag, or the bags, of one run. Every message is checked by its checksum when it is read."""

    def __init__(self, path: Union[PathLike, Iterable[PathLike]], *, partial: bool = False, unverified: bool = False) -> None:
        """`partial`: also reads the existing part of a bag that was not closed or is cut off, or of a recording without some of its
        parts. `unverified`: also reads bags without checksums, as `rosbag record` writes them. Raises FileNotFoundError, and ValueError
        if it is no recording of one run of a platoon."""
        from . import _recordings  # loads the libraries of ROS

        files: List[str] = [os.fspath(path)] if isinstance(path, (str, os.PathLike)) else [os.fspath(file) for file in path]
        for file in files:
            if not os.path.exists(file):
                hint = ". There is {}.active, of a run that is endless, is still running or was killed".format(file)
                raise FileNotFoundError("{}: no such file{}".format(file, hint if os.path.exists(file + ".active") else ""))
        #: the files
        self.files = files
        self._source: Source = _recordings.Source(files, partial, unverified)
        #: model and options of the run
        self.configuration = Configuration.parse(_recordings.configuration(self._source))

    @property
    def model(self) -> Model:
        return self.configuration.model

    @property
    def realizations(self) -> range:
        """The numbers of the realizations: from 0 on, or those of a resumed run."""
        run = self.configuration.run
        return range(run["first_realization"], run["realizations"])

    def _values(self, stream: str, vehicle: int) -> NDArray[np.float64]:
        return self._streams([(stream, checked_vehicle(vehicle))], self.realizations.start, self.realizations.stop)[0][0]

    def _streams(self, streams: List[Tuple[str, int]], first: int, end: int) -> Tuple[List[NDArray[np.float64]], List[bool]]:
        """Several streams of vehicles, read at once, of the realizations from `first` to before `end`, and which of these are whole."""
        from . import _recordings

        return _recordings.values(self._source, streams, first, end)

    def trajectories(self, first: int = 0, count: int = 1) -> Iterator[Trajectories]:
        """All vehicles in `count` realizations, from `first` on, with the quantities of trajectories.csv that follow from the recorded
        positions. Raises IndexError if `count` is below 1, or if the run does not have all of them, and ValueError if the recording lacks
        a step of one; with `partial` these realizations are left out."""
        for _, trajectories in self.numbered_trajectories(first, count):
            yield trajectories

    def numbered_trajectories(self, first: int, count: int) -> Iterator[Tuple[int, Trajectories]]:
        """The same, with the numbers of the realizations. Internal."""
        model, followers = self.model, self.configuration.run["followers"]
        start, total = self.realizations.start, self.realizations.stop
        if not start <= first < total:
            raise IndexError("first: {}: must be from {} to {}".format(first, start, total - 1))
        if not 1 <= count <= total - first:
            raise IndexError("count: {}: must be from 1 to {}, as the run has {} realizations".format(count, total - first, total))
        vehicles = [model.vehicle(i) for i in range(followers + 1)]
        end = first + count
        names = [("position", i) for i in range(followers + 1)] + [("received_position", i) for i in range(1, followers + 1)]
        streams, whole = self._streams(names, first, end)
        positions, received = streams[:followers + 1], streams[followers + 1:]
        period = model.sample_period
        steps = np.arange(-1.0, positions[0].shape[1] - 1.0)
        seconds = np.array([float("{:.10g}".format(step * period)) for step in steps])
        for row in np.flatnonzero(whole).tolist():
            quantities = {name: np.full((followers + 1, steps.size), np.nan) for name in Trajectories.QUANTITIES}
            y = quantities["position"]
            for i, table in enumerate(positions):
                y[i] = table[row, :steps.size]
            for i, table in enumerate(received, 1):
                quantities["received_position"][i] = table[row, :steps.size]
            moved = np.diff(y, axis=1, prepend=y[:, :1] - model.start_slope)
            for i in range(1, followers + 1):
                apart, own = y[i - 1] - y[i], vehicles[i]
                quantities["gap"][i] = apart - vehicles[i - 1].vehicle_length
                quantities["relative_speed"][i] = (moved[i - 1] - moved[i]) / period
                quantities["tracking_error"][i] = apart - own.standstill_distance - own.time_headway * moved[i]
            rate = moved
            for order, name in enumerate(("speed", "acceleration", "jerk"), 1):
                quantities[name][:] = rate / period ** order
                rate = np.diff(rate, axis=1, prepend=rate[:, :1])
            for name in ("gap", "tracking_error", "speed", "acceleration", "jerk", "relative_speed"):
                quantities[name][:, 0] = np.nan  # signals begin at step 0
            name = "realization {}".format(first + row)
            yield first + row, Trajectories(steps, seconds, quantities, self.files[0], name)

    def positions(self, vehicle: int) -> NDArray[np.float64]:
        """y_i(k) [m], a row for each of `realizations` and a column per step, from step -1 on. Raises IndexError for a vehicle that the
        platoon does not have, and ValueError if the recording lacks a value; with `partial` it is NaN, as in the row of an
        endless run."""
        return self._values("position", vehicle)

    def predecessor_positions(self, vehicle: int) -> NDArray[np.float64]:
        """y_{i-1}(k) [m] as follower i used it, of the same shape: in place of a lost position its prediction (on_loss)."""
        return self._values("predecessor_position", vehicle)

    def inputs(self, vehicle: int) -> NDArray[np.float64]:
        """v_i(k) = u_i(k - 1) [m/s^2], of the same shape. Raises IndexError if no follower receives it."""
        return self._values("input", vehicle)

    def predecessor_inputs(self, vehicle: int) -> NDArray[np.float64]:
        """v_{i-1}(k) as follower i received it."""
        return self._values("predecessor_input", vehicle)

    def received(self, vehicle: int, n: int) -> NDArray[np.float64]:
        """Input n of follower i as it received it, in the order of `inputs` in the model file and in the unit of its signal: of the same
        shape. Raises IndexError for an input that the follower does not have."""
        return self._values("received/{}".format(checked_vehicle(n)), vehicle)

    def results(self, signals: Optional[Iterable[str]] = None) -> Results:
        """The results of the run, bit for bit those that its monitor wrote, or with other signals. Raises ValueError if the
        recording is not complete, unless `partial` was given."""
        from . import _recordings

        chosen = None if signals is None else listed(signals)
        summary, tables, report, findings = _recordings.results(self._source, chosen)
        if findings:
            raise ValueError("{}: {}".format(self.files[0], "; ".join(findings)))
        return Results(summary, tables, self.files[0], report)
