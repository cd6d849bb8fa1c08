"""The state of a running platoon, from its condensed topics. Its size does not depend on the length of the run.

This module does not import ROS: the state takes messages, or objects with the same fields, and returns JSON values.
"""

from __future__ import annotations

import collections
import math
import threading
from typing import Any, Callable, Deque, Dict, Iterable, List, Optional, Sequence, Set, Tuple

from .conduct import Conduct
from .description import described, start_of
from .events import EventLog, is_paused
from .history import Rate, ThinnedHistory

STRIP = 240          # snapshots in the space-time strip
COLUMNS = 120        # steps in the curves over k
MOST_CURVES = 40     # as in the figures of `plot`: longer strings show only some followers
CURVES_OF_MANY = 16
MOMENTS = ("mean", "variance", "theoretical_mean", "theoretical_variance")
GAPS = ("smallest_gap", "smallest_gap_realization", "smallest_gap_step", "collisions", "collision_bound")  # empty without the signal gap


def finite(value: float) -> Optional[float]:
    """The number, or None if JSON cannot hold it (NaN, infinity)."""
    return value if math.isfinite(value) else None


def numbers(values: Iterable[float]) -> List[Optional[float]]:
    return [value if math.isfinite(value) else None for value in values]


def rounded(values: Iterable[float]) -> List[Optional[float]]:
    """The values to six digits, more than a screen resolves, None for NaN or infinity: for curves and colours."""
    return [float("{:.6g}".format(value)) if math.isfinite(value) else None for value in values]


def drawn_followers(followers: int) -> List[int]:
    """Numbers of the followers whose curves are drawn: all, or an evenly spaced subset that includes both ends."""
    if followers <= MOST_CURVES:
        return list(range(1, followers + 1))
    return [1 + round(j * (followers - 1) / (CURVES_OF_MANY - 1)) for j in range(CURVES_OF_MANY)]


class PlatoonState:
    """Takes messages from any thread. Calls changed(kind) after each message that changes the state, without holding the lock."""

    KINDS = ("configuration", "statistics", "curves", "snapshot", "received", "conduct", "health", "log")

    def __init__(self, changed: Callable[[str], None] = lambda kind: None, namespace: str = "platoon") -> None:
        self.lock = threading.RLock()
        self.changed, self.namespace = changed, namespace
        self.text: Optional[str] = None
        self.culprit: Optional[str] = None
        self.retries = 0
        self.start: Optional[str] = None  # a text on the platoon before its first step
        self.events = EventLog()
        self.early: Optional[Tuple[Any, float]] = None  # (overview, arrival time) of a run whose configuration has not arrived yet
        self.over: Optional[int] = None  # the previous run
        self.begin(None)

    def begin(self, configuration: Optional[Dict[str, Any]]) -> None:
        """Starts another run and discards all data of the previous one."""
        self.configuration = configuration
        self.run: Optional[int] = None  # the run named in this configuration's overviews
        self.overview: Any = None
        self.began: Any = None  # the latest overview of an attempt
        self.restarts = 0
        self.rate = Rate()
        self.begin_history()
        self.latest: Deque[Dict[str, Any]] = collections.deque(maxlen=STRIP)  # snapshots
        self.received: Optional[Dict[str, Any]] = None
        self.snapshot: Optional[Dict[str, Any]] = None
        self.conducted = None if configuration is None else Conduct(configuration["vehicle_lengths"], configuration["sample_period"])

    def begin_history(self) -> None:
        self.history = ThinnedHistory(COLUMNS)
        self.provisional = ThinnedHistory(COLUMNS)  # drawn until the burn-in is over

    def report(self, *kinds: str) -> None:
        """Reports changes of these kinds, and of the log."""
        for kind in kinds + (("log",) if self.events.take_news() else ()):
            self.changed(kind)

    def take_configuration(self, message: Any) -> None:
        text = message.data.strip()  # the parameter ends with a newline, the topic's text does not
        with self.lock:
            if text == self.text:
                return
            try:
                self.begin_described(described(text))
            except ValueError as error:
                self.start = "the configuration cannot be read: {}".format(error)
            self.text = text
        self.report(*self.KINDS[:-1])

    def begin_described(self, now: Dict[str, Any]) -> None:
        if self.text is None or now != self.configuration or self.run is not None:
            self.events.add_run(self.configuration, now)
        self.over = self.run
        self.begin(now)
        early, self.early = self.early, None
        if early:
            self.add_overview(*early)

    def take_overview(self, message: Any, now: float) -> None:
        with self.lock:
            if message.run == self.over:
                return  # a late overview of the previous run
            known = self.configuration
            # Each topic has its own connection: an overview may arrive before its configuration. A second overview of another run
            # means that the present run is over.
            if known is None or (self.run is not None and message.run != self.run):
                if known is None or self.early is None or self.early[0].run != message.run:
                    self.early = (message, now)
                    return
                self.begin(known)
                self.events.add_run(known, known)
            self.early = None
            self.add_overview(message, now)
        self.report("statistics", "curves", "health", *(("conduct",) if message.collisions else ()))

    def add_overview(self, message: Any, now: float) -> None:
        self.run, self.overview = message.run, message
        known = self.began and (self.began.attempt, self.began.step[-1])
        # A restarted monitor has no attempt yet, or the previous one.
        if message.attempt and (known is None or (message.attempt, message.step[-1]) >= known):
            if self.events.add_changes(self.began, message):
                self.restarts += 1
                self.begin_history()
            self.began, self.start = message, None
        endless = message.time_average
        if self.conducted is not None:
            self.conducted.count(message.collisions, message.realizations)
        self.rate.saw(message.step[-1] if endless else message.realizations, now)
        if endless and any(map(math.isfinite, message.mean)):
            self.history.add(message.step[-1], (self.of_drawn(message.mean), self.of_drawn(message.variance)))
        elif endless and message.provisional_mean:
            self.provisional.add(message.step[-1], (self.of_drawn(message.provisional_mean), self.of_drawn(message.provisional_variance)))

    def take_received(self, message: Any) -> None:
        with self.lock:
            self.received = {"realization": message.realization, "step": message.step, "position": numbers(message.position)}
        self.changed("received")

    def take_snapshot(self, message: Any) -> None:
        with self.lock:
            news = self.conducted is not None and message.step >= 0 and self.conducted.take(message)
            self.snapshot = {"realization": message.realization, "step": message.step, "position": numbers(message.position),
                             "tracking_error": rounded(message.tracking_error), "speed": rounded(message.speed),
                             "acceleration": rounded(self.conducted.acceleration) if self.conducted else [],
                             "colliding": self.conducted.colliding if self.conducted else []}
            if message.step >= 0:
                self.latest.append(self.snapshot)
            # The vehicles drive, though the first figures may be a realization away.
            started = self.start is not None and message.step >= 0
            self.start = None if started else self.start
        self.report("snapshot", *(("conduct",) if news else ()), *(("health",) if started else ()))

    def take_diagnostics(self, message: Any) -> None:
        """Takes the status of this platoon's monitor from a diagnostic_msgs/DiagnosticArray and ignores all others."""
        for status in message.status:
            values = {entry.key: entry.value for entry in status.values}
            if not status.name.startswith(self.namespace + "/") or "culprit" not in values:
                continue
            with self.lock:
                before, self.culprit = self.culprit, values["culprit"] or None
                self.retries = int(values.get("retries") or 0)
                if bool(before) != bool(self.culprit):
                    self.events.add("stall", "run stalled: " + self.culprit if self.culprit else "run continues")
            self.report("health")

    def take_topics(self, topics: Set[str]) -> None:
        """Takes the names of the published topics in the platoon's namespace: before the first step they show the missing vehicles."""
        with self.lock:
            if self.configuration and not self.began and not self.latest:
                self.start = start_of(topics, self.configuration["followers"], self.configuration["external"])
        self.report("health")

    def take_order(self, text: str) -> None:
        with self.lock:
            self.events.add("order", text)
        self.report()

    def of_drawn(self, values: Sequence[float]) -> List[float]:
        """The values of the drawn followers."""
        return [values[i - 1] for i in drawn_followers(len(values))]

    # The contents of events by kind: these properties and the attributes configuration, snapshot and received. None: not yet known.

    def give(self, kind: str) -> Any:
        with self.lock:
            return getattr(self, kind)

    @property
    def health(self) -> Dict[str, Any]:
        return {"culprit": self.culprit, "retries": self.retries, "start": self.start}

    @property
    def conduct(self) -> Optional[Dict[str, Any]]:
        """What the vehicles do; None as long as nothing is known."""
        return None if self.conducted is None else self.conducted.document()

    @property
    def log(self) -> List[Dict[str, Any]]:
        return list(self.events.events)

    @property
    def strip(self) -> List[Dict[str, Any]]:
        return [{key: snapshot[key] for key in ("realization", "step", "tracking_error")} for snapshot in self.latest]

    @property
    def statistics(self) -> Optional[Dict[str, Any]]:
        of = self.overview
        if of is None or self.configuration is None:
            return None
        scores = [score for score in (of.max_abs_z_mean, of.max_abs_z_variance) if not math.isnan(score)]
        moments = {name: numbers(getattr(of, name)[len(of.step) - 1::len(of.step)]) for name in MOMENTS}
        is_measured = any(value is not None for value in moments["mean"])
        per_second, left = self.rate.per_second(), None
        if not of.time_average and not of.complete and per_second:
            left = (self.configuration["realizations_wanted"] - of.realizations) / per_second
        work = len(of.stationary_variance) * (1 if of.time_average else self.configuration["steps"])
        return {**moments,
                **{name: getattr(of, name) for name in (
                    "realizations", "time_average", "attempt", "manoeuvre", "complete", "theory", "reason", "warnings", "wall_seconds")},
                **{name: finite(getattr(of, name)) for name in ("limit_variance", "plausible_z", "realizations_needed")},
                **{name: numbers(getattr(of, name)) for name in ("standard_error", *GAPS)},
                "score": numbers(of.variance_score), "max_abs_z": finite(max(scores)) if scores else None,
                "step": of.step[-1] if is_measured else None, "latest_step": of.step[-1] if of.attempt else None,
                "provisional": {"step": self.provisional_end(of), "mean": numbers(of.provisional_mean), "variance": numbers(of.provisional_variance)}
                               if of.provisional_mean else None,
                "restarts": self.restarts, "paused_until": of.counted_from if is_paused(of) else None,
                "string_stable": of.string_stable if of.theory == "exact" and not of.undecided else None,
                "stable_headways": list(zip(of.stable_headways[::2], of.stable_headways[1::2])),
                "vehicle_steps_per_second": None if per_second is None or of.complete else per_second * work, "seconds_left": left}

    def provisional_end(self, of: Any) -> Optional[int]:
        """The step that all provisional averages have reached. None, as no message has it, until a manoeuvre has left the string."""
        assert self.configuration is not None
        return None if of.manoeuvre or of.step[-1] < of.counted_from - self.configuration["burn_in"] else of.step[-1]

    @property
    def curves(self) -> Optional[Dict[str, Any]]:
        """Mean and variance over k of the drawn followers, measured and theoretical: lists (drawn followers) of lists (steps). Until the
        burn-in is over, the measured ones are provisional."""
        of = self.overview
        if of is None:
            return None
        followers = drawn_followers(len(of.stationary_variance))
        if of.time_average:
            provisional = not self.history.columns and bool(self.provisional.columns)
            history = self.provisional if provisional else self.history
            columns = [column for _, column in history.columns]
            theory = {name: [[value] * len(columns) for value in rounded(self.of_drawn(values))] for name, values in
                      (("theoretical_mean", of.theoretical_mean), ("theoretical_variance", of.theoretical_variance))}
            return dict(theory, followers=followers, provisional=provisional, step=[step for step, _ in history.columns],
                        mean=[rounded(mean[row] for mean, _ in columns) for row in range(len(followers))],
                        variance=[rounded(variance[row] for _, variance in columns) for row in range(len(followers))])
        width = len(of.step)
        return dict({name: [rounded(getattr(of, name)[(i - 1) * width:i * width]) for i in followers] for name in MOMENTS},
                    followers=followers, provisional=False, step=list(of.step))

    def document(self) -> Dict[str, Any]:
        """The content of /state.json."""
        with self.lock:
            nothing: Dict[str, Any] = {
                **{name: None for name in ("followers", "step", "realizations", "string_stable", "limit_variance", "max_abs_z")},
                **{name: [] for name in ("mean", "variance", "theoretical_variance", *GAPS)}}
            present = self.snapshot and {name: self.snapshot[name] for name in ("realization", "step")}
            return {**nothing, "present": present, **(self.configuration or {}), **(self.statistics or {}), **self.health, "conduct": self.conduct, "events": self.log}
