"""What the vehicles of a run do: collisions, reversing, accelerations in its snapshots, and its count of collisions."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Set

from stochastic_platoon.model import HARDEST, REVERSING

APART = 5  # steps between two snapshots over which an acceleration is formed at most


class Conduct:
    """The conduct of followers 1 .. N, now and before. Snapshots are thinned, of single realizations, and missing before this program
    began: what they lack may have happened. Only a count of collisions covers every realization."""

    def __init__(self, lengths: Sequence[float], sample_period: float) -> None:
        self.lengths, self.sample_period = lengths, sample_period  # of vehicles 0 .. N [m]; T_s [s]
        self.before: Any = None
        self.acceleration: List[float] = []  # [m/s^2] of vehicles 0 .. N since the snapshot before; empty if that is too long ago
        self.collided: Set[int] = set()
        self.reversed: Set[int] = set()
        self.strongest: Optional[Dict[str, float]] = None  # acceleration [m/s^2] of the largest modulus so far
        self.colliding: List[int] = []
        self.reversing: List[int] = []
        self.realizations = 0
        self.collisions: Sequence[int] = []  # realizations with a collision of each follower; empty if they are not counted

    def count(self, collisions: Sequence[int], realizations: int) -> None:
        """Takes the collisions that the run has counted so far."""
        self.collisions, self.realizations = collisions, realizations

    def take(self, message: Any) -> bool:
        """Takes a Snapshot; whether it has changed the document."""
        known = self.document()
        position, speed = message.position, message.speed
        self.colliding = [i for i in range(1, len(position)) if position[i - 1] - position[i] < self.lengths[i - 1]]
        self.reversing = [i for i in range(1, len(speed)) if speed[i] < REVERSING]
        self.collided.update(self.colliding)
        self.reversed.update(self.reversing)
        before, self.before = self.before, message
        self.acceleration = []
        if before is not None and before.realization == message.realization and 0 < message.step - before.step <= APART:
            over = (message.step - before.step) * self.sample_period
            self.acceleration = [(now - then) / over for now, then in zip(speed, before.speed)]
        for i, acceleration in enumerate(self.acceleration):
            if i > 0 and (self.strongest is None or abs(acceleration) > abs(self.strongest["acceleration"])):
                self.strongest = {"acceleration": float("{:.3g}".format(acceleration)), "follower": i, "step": message.step}
        return self.document() != known

    def document(self) -> Optional[Dict[str, Any]]:
        """Followers that collide and reverse now, how many have done so, the acceleration of the largest modulus so far, and all of it
        in words. None as long as nothing is known."""
        if self.before is None and not self.collisions:
            return None
        impossible = self.strongest is not None and abs(self.strongest["acceleration"]) > HARDEST
        collided = self.collided.union(i for i, count in enumerate(self.collisions, 1) if count)
        return {"colliding": self.colliding, "reversing": self.reversing, "collided": len(collided), "reversed": len(self.reversed),
                "strongest": self.strongest, "possible": not (collided or self.reversed or impossible), "words": self.words()}

    def words(self) -> str:
        """The conduct in one sentence, which denies nothing that may have been missed."""
        most, shared = max(self.collisions, default=0), sum(map(bool, self.collisions)) > 1
        counted = "a collision in {} of {} realizations (follower {}{})".format(
            most, self.realizations, self.collisions.index(most) + 1, ", the most" if shared else "") if most else ""
        words = [done("overlaps the vehicle ahead", "overlap the vehicles ahead", "overlapped", self.colliding, set() if most else self.collided),
                 counted, done("reverses", "reverse", "reversed", self.reversing, self.reversed)]
        if not any(words):
            words = ["no collision in {} realizations".format(self.realizations), "no reversing seen" if self.before else ""] if self.collisions else [
                "no collision or reversing seen"]
        if self.strongest:
            words.append("strongest acceleration seen {acceleration:+.3g} m/s\N{SUPERSCRIPT TWO} (follower {follower})".format(**self.strongest))
        return "; ".join(filter(None, words))


def numbered(followers: Sequence[int]) -> str:
    """The word follower or followers with their numbers; of more than five followers the first five numbers."""
    return "follower{} {}{}".format("s" if followers[1:] else "", ", ".join(str(i) for i in followers[:5]), ", ..." if followers[5:] else "")


def done(does: str, do: str, did: str, now: Sequence[int], ever: Set[int]) -> str:
    """What followers do now, else how many have done it; empty if none."""
    if now:
        return "{} {}".format(numbered(now), do if now[1:] else does)
    return "{} follower{} {} earlier".format(len(ever), "s" if len(ever) > 1 else "", did) if ever else ""
