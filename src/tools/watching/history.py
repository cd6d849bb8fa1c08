"""Values over a time that grows without bound, in bounded memory."""

from __future__ import annotations

import collections
from typing import Any, Deque, List, Optional, Tuple

RATE_WINDOW = 5.0  # [s]


class ThinnedHistory:
    """At most `most` evenly spaced columns over a step that grows without bound: when full, it drops every second column."""

    def __init__(self, most: int) -> None:
        self.most, self.stride = most, 1
        self.columns: List[Tuple[int, Any]] = []

    def add(self, step: int, column: Any) -> None:
        if self.columns and step < self.columns[-1][0] + self.stride:
            return
        self.columns.append((step, column))
        if len(self.columns) > self.most:
            del self.columns[1::2]
            self.stride *= 2


class Rate:
    """The rate of a growing count over the latest RATE_WINDOW seconds."""

    def __init__(self) -> None:
        self.seen: Deque[Tuple[float, int]] = collections.deque()

    def saw(self, count: int, now: float) -> None:
        if self.seen and count < self.seen[-1][1]:
            self.seen.clear()
        if self.seen and now - self.seen[-1][0] < RATE_WINDOW / 100:
            return
        self.seen.append((now, count))
        while len(self.seen) > 2 and now - self.seen[0][0] > RATE_WINDOW:
            self.seen.popleft()

    def per_second(self) -> Optional[float]:
        if len(self.seen) < 2 or self.seen[-1][0] <= self.seen[0][0]:
            return None
        return (self.seen[-1][1] - self.seen[0][1]) / (self.seen[-1][0] - self.seen[0][0])
