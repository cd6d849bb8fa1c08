"""The figure of a running experiment, redrawn as its statistics arrive."""

from __future__ import annotations

import sys
import time
from typing import Any, Callable, Dict, List, Sequence

import numpy as np
import stochastic_platoon as sp
from matplotlib.figure import Figure

from plotting import files

PERIOD = 2.0  # [s] from one figure to the next, at least


def results_of(configuration: Dict[str, Any], overview: Any) -> sp.Results:
    """The present state of a run, at the steps of the monitor's overview."""
    from watching.events import is_paused

    followers, steps = configuration["followers"], np.array([-1] if is_paused(overview) else overview.step, float)
    verdict = overview.string_stable if overview.theory == "exact" and not overview.undecided else None
    summary = {"followers": followers, "realizations": overview.realizations, "seed": configuration["seed"],
               "configuration": {"model": {"sample_period": configuration["sample_period"]}}, "complete": overview.complete,
               "time_average": overview.time_average, "standard_error_of_variance": list(overview.standard_error),
               "theory": {"spectral_radius": None, "string_stable": verdict}}
    table: Dict[str, Any] = {"vehicle": np.repeat(np.arange(1.0, followers + 1), steps.size), "step": np.tile(steps, followers),
             "count": np.full(followers * steps.size, float(overview.realizations)),
             **{name: np.array(getattr(overview, name)) for name in ("mean", "variance", "theoretical_mean", "theoretical_variance")}}
    return sp.Results(summary, {"statistics": table}, configuration["spacing"])


def follow(namespace: str, draw: Callable[[List[sp.Results]], Figure], stem: str, kinds: Sequence[str]) -> None:
    """Redraws draw([results]) until the run is complete or the ROS master is gone. Raises ValueError without a master."""
    try:
        import rosgraph
        import rospy
        from watching.listening import observe
    except ImportError as error:
        raise ValueError("--follow: {}: needs ROS: . devel/setup.bash first".format(error)) from None
    try:
        state = observe("plot", namespace)
    except ValueError as error:
        raise ValueError("--follow: {}".format(error)) from None
    drawn = None
    while not rospy.is_shutdown() and rosgraph.is_master_online():
        with state.lock:
            configuration, overview = state.configuration, state.overview
        if configuration and overview is not None and overview is not drawn and np.isfinite(overview.variance).any():
            paths = files.save(draw([results_of(configuration, overview)]), stem, kinds)
            if drawn is None:
                print("\n".join(paths), flush=True)
            drawn = overview
            if overview.complete:
                return
        time.sleep(PERIOD)
    if drawn is None:
        print("plot: --follow: nothing was drawn: no statistics came before the end", file=sys.stderr)
