"""Messages that links lose, which belongs to the model, and positions missing from the statistics, which is a fault of the run."""

from __future__ import annotations

from typing import List, Tuple

import numpy as np
import stochastic_platoon as sp


def between(shares: List[float]) -> str:
    """The least and the largest share in per cent, or the only one."""
    least, largest = ("{:.3g}".format(100.0 * share) for share in (min(shares), max(shares)))
    return "{} %".format(least) if least == largest else "{} to {} %".format(least, largest)


def rows_of(run: sp.Results) -> List[Tuple[str, str]]:
    """A row for each signal whose links lose messages, without those that lose them by distance, which no run counts; and one for the
    statistics."""
    rows = []
    if "ages" in run.summary["crc32"]:
        ages = run.ages
        for signal in dict.fromkeys(ages.signal):
            arrived = np.array([own == signal for own in ages.signal]) & (ages.age == 0.0)
            measured, theory = (1.0 - shares[arrived] for shares in (ages.share, ages.theoretical_share))
            text = "{} on {} link{}".format(between(list(measured)), measured.size, "s" * (measured.size > 1))
            if np.isfinite(theory).all():
                text += ", by theory {}".format(between(list(theory)))
            rows.append(("lost on the links, {}".format(signal), text))
    counts = "{}, {} missing".format(run.summary["positions_received"], run.summary["positions_lost"])
    return [*rows, ("positions in the statistics", counts)]
