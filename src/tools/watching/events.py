"""The log of a platoon's events: runs and their changes, attempts, manoeuvres, stalls, orders."""

from __future__ import annotations

import collections
import math
import time
from typing import Any, Deque, Dict, Optional

MOST = 100  # events
# The fields of a configuration that a change of the run may alter, with their names and units; None for sample periods.
CHANGES = (("followers", "followers", ""), ("headway", "headway", None), ("noise_variance", "noise variance", " m^2"),
           ("loss", "loss", ""), ("link", "link", ""))


def is_paused(overview: Any) -> bool:
    """Whether averages over time exclude the present errors of some follower."""
    return bool(overview.time_average and overview.attempt > 0 and overview.step[-1] < overview.counted_from)


def continuation(overview: Any) -> str:
    """What averages over time do behind this pause. During the first one, some followers have an average before the others."""
    return "go on" if all(map(math.isfinite, overview.mean)) else "begin"


def shown(configuration: Dict[str, Any], key: str, unit: Optional[str]) -> str:
    value = configuration[key]
    if isinstance(value, str):
        return value
    ends = value if isinstance(value, list) else [value]

    def words(scale: float) -> str:
        return " to ".join("{:g}".format(scale * end) for end in ends)

    return words(1.0) + unit if unit is not None else "{} s ({} sample periods)".format(words(configuration["sample_period"]), words(1.0))


class EventLog:
    """The latest events, each with its time [s since 1970], kind, text, and step if it has one."""

    def __init__(self) -> None:
        self.news = False
        self.events: Deque[Dict[str, Any]] = collections.deque(maxlen=MOST)
        self.first: Optional[int] = None  # attempt and realizations of the latest restart
        self.restarted: Optional[int] = None

    def add(self, kind: str, text: str, step: Optional[int] = None) -> None:
        self.events.append({"time": time.time(), "kind": kind, "step": step, "text": text})
        self.news = True

    def take_news(self) -> bool:
        """Whether there are new events since the last call."""
        news, self.news = self.news, False
        return news

    def add_run(self, before: Optional[Dict[str, Any]], now: Dict[str, Any]) -> None:
        """Adds another configuration: see description.described()."""
        known = [row for row in CHANGES if now[row[0]] is not None and (before is None or before[row[0]] is not None)]
        if before is None:  # constant spacing has no headway
            changes = [name + " " + shown(now, key, unit) for key, name, unit in known if key not in ("headway", "loss") or now[key]]
        else:
            changes = ["{} {} -> {}".format(name, shown(before, key, unit), shown(now, key, unit)) for key, name, unit in known
                       if before[key] != now[key]]
        self.add("run", "a run with " + ", ".join(changes) if changes else "another run with the same configuration")

    def add_changes(self, before: Any, now: Any) -> bool:
        """Adds the changes between two overviews of a run; `before` may be None. Returns whether the run has restarted."""
        began_again = bool(before is not None and 0 < before.attempt < now.attempt)
        if began_again:
            self.add_restart(before, now)
        elif before is None or not before.attempt:
            self.add("run", "the first step has arrived" if now.attempt == 1 else "attempt {} is under way".format(now.attempt))
        # A short manoeuvre may begin and end between two overviews.
        departed = now.manoeuvre if before is None or began_again else now.counted_from > before.counted_from
        if departed and not (before and before.manoeuvre):
            self.add("manoeuvre", "the leader manoeuvres: averages are paused", now.step[-1])
        if not now.manoeuvre and not began_again and (departed or (before and before.manoeuvre)):
            self.add("manoeuvre", "the manoeuvre is over: averages {} at step {}".format(continuation(now), now.counted_from), now.step[-1])
        elif before and is_paused(before) and not is_paused(now):
            self.add("averages", "averages " + continuation(before), now.step[-1])
        if now.complete and not (before and before.complete):
            self.add("run", "complete")
        return began_again

    def add_restart(self, before: Any, now: Any) -> None:
        """Adds a restart. A stalled platoon restarts every few seconds: consecutive attempts without progress are one event."""
        step = before.step[-1] if now.time_average else None
        latest = self.events[-1] if self.events else {}
        stalled = latest.get("kind") == "restart" and (step <= 0 if now.time_average else before.realizations == self.restarted)
        if stalled:
            step = self.events.pop()["step"]
        else:
            self.first = now.attempt
        self.restarted = now.realizations
        attempts = "attempt {}".format(now.attempt) if self.first == now.attempt else "attempts {} to {}".format(self.first, now.attempt)
        self.add("restart", attempts + (": the platoon restarts at step 0; averages keep the earlier steps" if now.time_average else
                                        ": the batch from realization {} on is repeated".format(now.realizations)), step)
