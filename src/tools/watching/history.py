"""Values over a time that grows without bound, in bounded memory."""

import collections

RATE_WINDOW = 5.0  # [s]


class ThinnedHistory:
    """At most `most` evenly spaced columns over a step that grows without bound: when full, it drops every second column."""

    def __init__(self, most):
        self.most, self.stride, self.columns = most, 1, []

    def add(self, step, column):
        if self.columns and step < self.columns[-1][0] + self.stride:
            return
        self.columns.append((step, column))
        if len(self.columns) > self.most:
            del self.columns[1::2]
            self.stride *= 2


class Rate:
    """The rate of a growing count over the latest RATE_WINDOW seconds."""

    def __init__(self):
        self.seen = collections.deque(maxlen=200)

    def saw(self, count, now):
        if self.seen and count < self.seen[-1][1]:
            self.seen.clear()
        if self.seen and now - self.seen[-1][0] < RATE_WINDOW / 100:
            return
        self.seen.append((now, count))
        while len(self.seen) > 2 and now - self.seen[0][0] > RATE_WINDOW:
            self.seen.popleft()

    def per_second(self):
        if len(self.seen) < 2 or self.seen[-1][0] <= self.seen[0][0]:
            return None
        return (self.seen[-1][1] - self.seen[0][1]) / (self.seen[-1][0] - self.seen[0][0])
