"""The updates of the open pages, as server-sent events."""

from __future__ import annotations

import json
import threading
from typing import Any, Callable, Dict, List, Optional, Tuple

MOST_PAGES = 32  # open at the same time


def encoded(content: Any) -> bytes:
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()


class Stream:
    """Events not yet sent to one page: only the latest of each kind, so a slow page takes bounded memory."""

    def __init__(self) -> None:
        self.waiting: Dict[str, bytes] = {}
        self.condition = threading.Condition()

    def put(self, kind: str, data: bytes) -> None:
        with self.condition:
            self.waiting.pop(kind, None)  # the event moves to the end
            self.waiting[kind] = data
            self.condition.notify()

    def take(self, timeout: float) -> List[Tuple[str, bytes]]:
        """The waiting events as a list of (kind, data); empty after the timeout [s]."""
        with self.condition:
            if not self.waiting:
                self.condition.wait(timeout)
            waiting, self.waiting = self.waiting, {}
            return list(waiting.items())


class Streams:
    """The streams of all open pages. Each event is encoded once for all of them, and not at all while no page is open."""

    def __init__(self, give: Callable[[str], Any]) -> None:
        self.give, self.lock = give, threading.Lock()
        self.streams: List[Stream] = []

    def open(self, kinds: Tuple[str, ...]) -> Optional[Stream]:
        """The stream of a new page, filled with the present content of all kinds; None if too many pages are open."""
        stream = Stream()
        with self.lock:
            if len(self.streams) >= MOST_PAGES:
                return None
            self.streams.append(stream)
        for kind in kinds:
            stream.put(kind, encoded(self.give(kind)))
        return stream

    def close(self, stream: Stream) -> None:
        with self.lock:
            self.streams.remove(stream)

    def send(self, kind: str) -> None:
        with self.lock:
            streams = list(self.streams)
        if streams:
            data = encoded(self.give(kind))
            for stream in streams:
                stream.put(kind, data)
