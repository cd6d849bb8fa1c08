"""The smallest gaps in an overview: lists with an element per follower, empty unless the gap is among the signals of the run."""

from __future__ import annotations

import math
from typing import Any, Dict, List, Optional

NAMES = ("smallest_gap", "smallest_gap_realization", "smallest_gap_step", "collisions", "collision_bound")


def of_overview(overview: Any) -> Dict[str, List[Optional[float]]]:
    """The fields of /state.json, None for values that do not exist."""
    return {name: [value if math.isfinite(value) else None for value in getattr(overview, name)] for name in NAMES}


def nowhere() -> Dict[str, List[Optional[float]]]:
    """The fields without a run."""
    return {name: [] for name in NAMES}


def in_words(state: Dict[str, Any]) -> Optional[str]:
    """The smallest gap of all followers, the first of equal ones; None without one."""
    known = [(gap, i) for i, gap in enumerate(state["smallest_gap"]) if gap is not None]
    if not known:
        return None
    gap, row = min(known)
    return "smallest gap {:.3g} m: follower {}, realization {}, step {}".format(
        gap, row + 1, state["smallest_gap_realization"][row], state["smallest_gap_step"][row])
