"""The findings of an audit: largest error of each kind relative to its tolerance, contradictions, rejected models and times."""

import collections
import math


class Findings:
    def __init__(self):
        self.worst, self.failures, self.failed = {}, [], set()
        self.models, self.rejected, self.undecided = (collections.Counter() for _ in range(3))
        self.seconds = []

    def note(self, what, error, allowed, name, place=""):
        ratio = float(error / allowed) if allowed else (0.0 if error == 0 else math.inf)
        if not ratio <= self.worst.get(what, (0.0, ""))[0]:
            self.worst[what] = (ratio, name)
        if not ratio <= 1 and (name, what) not in self.failed:  # only the first failure of each kind
            self.failed.add((name, what))
            self.failures.append("%s: %s%s is off by %.3g, allowed are %.3g" % (name, what, place, error, allowed))

    def compare(self, what, ours, theirs, allowed, name, place=""):
        """Compares a value of the audit (ours) with that of analyze (theirs; None if analyze reports null)."""
        if theirs is None:
            self.note(what, math.inf, 1, name, "%s (%.12g; null is reported)" % (place, ours))
        else:
            self.note(what, abs(ours - theirs), allowed, name, "%s (%.12g; %.12g is reported)" % (place, ours, theirs))

    def fail_unless(self, condition, name, what):
        if not condition:
            self.failures.append("%s: %s" % (name, what))

    def failed_of(self, name):
        return [failure for failure in self.failures if failure.startswith(name + ":")]

    def print(self, slow):
        print("models: %s" % dict(self.models))
        for what, counted in (("rejected", self.rejected), ("undecided", self.undecided)):
            for (kind, reason), count in sorted(counted.items()):
                print("%s: %d of %s: %s" % (what, count, kind, reason))
        times = sorted(self.seconds, reverse=True)
        over = [entry for entry in times if entry[0] > slow]
        print("analyze: slowest %.3f s of CPU (%s); %d of %d above %g s%s" % (
            times[0] + (len(over), len(times), slow, "".join("\n  %.2f s %s" % entry for entry in over[:40]))))
        for what, (ratio, name) in sorted(self.worst.items()):
            print("%-20s %.3g of what is allowed (%s)" % (what, ratio, name))
        for failure in self.failures[:200]:
            print("FAILED", failure)
