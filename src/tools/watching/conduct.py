"""What the vehicles of a run do, from its snapshots: collisions, reversing, accelerations."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Set

from stochastic_platoon.model import HARDEST, REVERSING

APART = 5  # steps between two snapshots over which an acceleration is formed at most


class Conduct:
    """The conduct of followers 1 .. N, now and since the run began. Snapshots are thinned: between them more may have happened."""

    def __init__(self, lengths: Sequence[float], sample_period: float) -> None:
        self.lengths, self.sample_period = lengths, sample_period  # of vehicles 0 .. N [m]; T_s [s]
        self.before: Any = None
        self.acceleration: List[float] = []  # [m/s^2] of vehicles 0 .. N since the snapshot before; empty if that is too long ago
        self.collided: Set[int] = set()
        self.reversed: Set[int] = set()
        self.strongest: Optional[Dict[str, float]] = None  # acceleration [m/s^2] of the largest modulus so far
        self.colliding: List[int] = []
        self.reversing: List[int] = []

    def take(self, message: Any) -> bool:
        """Takes a Snapshot; whether it is the first one, or has changed the document."""
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
        return before is None or self.document() != known

    def document(self) -> Dict[str, Any]:
        """Followers that collide and reverse now, how many have done so, and the acceleration of the largest modulus so far."""
        impossible = self.strongest is not None and abs(self.strongest["acceleration"]) > HARDEST
        return {"colliding": self.colliding, "reversing": self.reversing, "collided": len(self.collided), "reversed": len(self.reversed),
                "strongest": self.strongest, "possible": not (self.collided or self.reversed or impossible)}


def numbered(followers: Sequence[int]) -> str:
    """The word follower or followers with their numbers; of more than five followers the first five numbers."""
    return "follower{} {}{}".format("s" if followers[1:] else "", ", ".join(str(i) for i in followers[:5]), ", ..." if followers[5:] else "")


def conduct_words(of: Dict[str, Any]) -> str:
    """The conduct in one sentence."""
    words = []
    for now, ever, doing, done in (("colliding", "collided", ("overlaps the vehicle ahead", "overlap the vehicles ahead"), "overlapped"),
                                   ("reversing", "reversed", ("reverses", "reverse"), "reversed")):
        if of[now]:
            words.append("{} {}".format(numbered(of[now]), doing[len(of[now]) > 1]))
        elif of[ever]:
            words.append("{} follower{} {} earlier".format(of[ever], "s" if of[ever] > 1 else "", done))
    if not words:
        words.append("no collision, no reversing")
    if of["strongest"]:
        words.append("strongest acceleration so far {acceleration:+.3g} m/s\N{SUPERSCRIPT TWO} (follower {follower})".format(**of["strongest"]))
    return "; ".join(words)
