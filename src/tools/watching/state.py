"""The state of a running platoon, from its condensed topics. Its size does not depend on the length of the run.

This module does not import ROS: the state takes messages, or objects with the same fields, and returns JSON values.
"""

from __future__ import annotations

import collections
import math
import threading
from typing import Any, Callable, Deque, Dict, Iterable, List, Optional, Sequence, Set, Tuple

from . import gaps
from .description import described, start_of
from .events import EventLog, is_paused
from .history import Rate, ThinnedHistory

STRIP = 240          # snapshots in the space-time strip
COLUMNS = 120        # steps in the curves over k
MOST_CURVES = 40     # as in the figures of `plot`: longer strings show only some followers
CURVES_OF_MANY = 16


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

    KINDS = ("configuration", "statistics", "curves", "snapshot", "told", "health", "log")

    def __init__(self, changed: Callable[[str], None] = lambda kind: None, namespace: str = "platoon") -> None:
        self.lock = threading.RLock()
        self.changed, self.namespace = changed, namespace
        self.text: Optional[str] = None
        self.culprit: Optional[str] = None
        self.retries = 0
        self.start: Optional[str] = None  # a text on the platoon before its first step
        self.log = EventLog()
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
        self.history = ThinnedHistory(COLUMNS)
        self.strip: Deque[Tuple[int, int, List[Optional[float]]]] = collections.deque(maxlen=STRIP)
        self.told: Optional[Dict[str, Any]] = None
        self.snapshot: Optional[Dict[str, Any]] = None

    def tell(self, *kinds: str) -> None:
        """Reports changes of these kinds, and of the log."""
        for kind in kinds + (("log",) if self.log.take_news() else ()):
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
        self.tell(*self.KINDS[:-1])

    def begin_described(self, now: Dict[str, Any]) -> None:
        if self.text is None or now != self.configuration or self.run is not None:
            self.log.add_run(self.configuration, now)
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
                self.log.add_run(known, known)
            self.early = None
            self.add_overview(message, now)
        self.tell("statistics", "curves", "health")

    def add_overview(self, message: Any, now: float) -> None:
        self.run, self.overview = message.run, message
        known = self.began and (self.began.attempt, self.began.step[-1])
        # A restarted monitor has no attempt yet, or the previous one.
        if message.attempt and (known is None or (message.attempt, message.step[-1]) >= known):
            if self.log.add_changes(self.began, message):
                self.restarts += 1
                self.history = ThinnedHistory(COLUMNS)
            self.began, self.start = message, None
        endless = message.time_average
        self.rate.saw(message.step[-1] if endless else message.realizations, now)
        if endless and any(map(math.isfinite, message.mean)):
            self.history.add(message.step[-1], (self.of_drawn(message.mean), self.of_drawn(message.variance)))

    def take_told(self, message: Any) -> None:
        with self.lock:
            self.told = {"realization": message.realization, "step": message.step, "position": numbers(message.position)}
        self.changed("told")

    def take_snapshot(self, message: Any) -> None:
        with self.lock:
            errors = rounded(message.tracking_error)
            self.snapshot = {"realization": message.realization, "step": message.step, "position": numbers(message.position),
                             "tracking_error": errors, "speed": rounded(message.speed)}
            if message.step >= 0:
                self.strip.append((message.realization, message.step, errors))
        self.changed("snapshot")

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
                    self.log.add("stall", "run stalled: " + self.culprit if self.culprit else "run continues")
            self.tell("health")

    def take_topics(self, topics: Set[str]) -> None:
        """Takes the names of the published topics in the platoon's namespace: before the first step they show the missing vehicles."""
        with self.lock:
            if self.configuration and not self.began:
                self.start = start_of(topics, self.configuration["followers"], self.configuration["external"])
        self.tell("health")

    def take_order(self, text: str) -> None:
        with self.lock:
            self.log.add("order", text)
        self.tell()

    def of_drawn(self, values: Sequence[float]) -> List[float]:
        """The values of the drawn followers."""
        return [values[i - 1] for i in drawn_followers(len(values))]

    # The content of events.

    def give(self, kind: str) -> Any:
        """The content of an event; None if there is none yet."""
        with self.lock:
            return getattr(self, "give_" + kind)()

    def give_configuration(self) -> Optional[Dict[str, Any]]:
        return self.configuration

    def give_snapshot(self) -> Optional[Dict[str, Any]]:
        return self.snapshot

    def give_told(self) -> Optional[Dict[str, Any]]:
        return self.told

    def give_health(self) -> Dict[str, Any]:
        return {"culprit": self.culprit, "retries": self.retries, "start": self.start}

    def give_log(self) -> List[Dict[str, Any]]:
        return list(self.log.events)

    def give_strip(self) -> List[Dict[str, Any]]:
        return [{"realization": r, "step": k, "tracking_error": errors} for r, k, errors in self.strip]

    def last_column(self, values: Sequence[float]) -> List[Optional[float]]:
        return numbers(values[len(self.overview.step) - 1::len(self.overview.step)])

    def give_statistics(self) -> Optional[Dict[str, Any]]:
        of = self.overview
        if of is None or self.configuration is None:
            return None
        scores = [score for score in (of.max_abs_z_mean, of.max_abs_z_variance) if not math.isnan(score)]
        per_second, followers = self.rate.per_second(), len(of.stationary_variance)
        wanted = self.configuration["realizations_wanted"]
        left = None
        if not of.time_average and not of.complete and per_second:
            left = (wanted - of.realizations) / per_second
        measured = any(map(math.isfinite, of.mean[len(of.step) - 1::len(of.step)]))
        work = followers * (1 if of.time_average else self.configuration["steps"])
        return {"step": of.step[-1] if measured else None, "latest_step": of.step[-1] if of.attempt else None, "realizations": of.realizations, "time_average": of.time_average,
                "attempt": of.attempt, "restarts": self.restarts, "manoeuvre": of.manoeuvre,
                "paused_until": of.counted_from if is_paused(of) else None, "complete": of.complete, "theory": of.theory, "reason": of.reason,
                "string_stable": of.string_stable if of.theory == "exact" and not of.undecided else None,
                "stable_headways": list(zip(of.stable_headways[::2], of.stable_headways[1::2])),
                "limit_variance": finite(of.limit_variance), "mean": self.last_column(of.mean),
                "variance": self.last_column(of.variance), "theoretical_mean": self.last_column(of.theoretical_mean),
                "theoretical_variance": self.last_column(of.theoretical_variance),
                "standard_error": numbers(of.standard_error), "score": numbers(of.variance_score),
                "max_abs_z": finite(max(scores)) if scores else None, "plausible_z": finite(of.plausible_z),
                "realizations_needed": finite(of.realizations_needed),
                "vehicle_steps_per_second": None if per_second is None or of.complete else per_second * work,
                "seconds_left": left, "wall_seconds": of.wall_seconds, **gaps.of_overview(of)}

    def give_curves(self) -> Optional[Dict[str, Any]]:
        """Mean and variance over k of the drawn followers, measured and theoretical: lists (drawn followers) of lists (steps)."""
        of = self.overview
        if of is None:
            return None
        followers = drawn_followers(len(of.stationary_variance))
        if of.time_average:
            columns = [column for _, column in self.history.columns]
            theory = {name: [[value] * len(columns) for value in rounded(self.of_drawn(values))] for name, values in
                      (("theoretical_mean", of.theoretical_mean), ("theoretical_variance", of.theoretical_variance))}
            return dict(theory, followers=followers, step=[step for step, _ in self.history.columns],
                        mean=[rounded(mean[row] for mean, _ in columns) for row in range(len(followers))],
                        variance=[rounded(variance[row] for _, variance in columns) for row in range(len(followers))])
        width = len(of.step)
        return dict({name: [rounded(getattr(of, name)[(i - 1) * width:i * width]) for i in followers]
                     for name in ("mean", "variance", "theoretical_mean", "theoretical_variance")},
                    followers=followers, step=list(of.step))

    def document(self) -> Dict[str, Any]:
        """The content of /state.json."""
        with self.lock:
            nothing: Dict[str, Any] = {"followers": None, "step": None, "realizations": None, "mean": [], "variance": [],
                       "theoretical_variance": [], "string_stable": None, "limit_variance": None, "max_abs_z": None, **gaps.nowhere()}
            return {**nothing, **(self.give_configuration() or {}), **(self.give_statistics() or {}), **self.give_health(),
                    "events": self.give_log()}
