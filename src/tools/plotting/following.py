"""The figure of a running experiment, redrawn as its statistics arrive."""

import math
import sys
import time

import numpy as np

from plotting import style
from plotting.inputs import InputError, Run, drawable

PERIOD = 2.0  # [s] from one figure to the next, at least


def run_of(configuration, overview):
    """The present state of a run in the form of inputs.read_run, at the steps of the monitor's overview."""
    followers, steps = configuration["followers"], np.array(overview.step)
    table = {name: drawable(np.array(getattr(overview, name)).reshape(followers, steps.size))
             for name in ("mean", "variance", "theoretical_mean", "theoretical_variance")}
    verdict = overview.string_stable if overview.theory == "exact" and not overview.undecided else None
    return Run(path="/overview", name="h = {:g}".format(configuration["headway"]), steps=steps,
               standard_error_of_variance=drawable(np.array(overview.standard_error)),
               count=np.full((followers, steps.size), float(overview.realizations)), realizations=overview.realizations,
               seed=configuration["seed"], complete=overview.complete, time_average=overview.time_average,
               spectral_radius=math.nan, string_stable=verdict, **table)


def follow(namespace, draw, stem):
    """Redraws draw([Run]) until the run is complete or the ROS master is gone. Raises InputError without a master."""
    try:
        import rosgraph
        import rospy
        from watching.listening import listen
        from watching.state import PlatoonState
    except ImportError as error:
        raise InputError("--follow: {}: needs ROS: . devel/setup.bash first".format(error))
    if not rosgraph.is_master_online():
        raise InputError("--follow: there is no ROS master at {}: launch a platoon, or set ROS_MASTER_URI"
                         .format(rosgraph.get_master_uri()))
    rospy.init_node("plot", anonymous=True, disable_rosout=True)
    state = PlatoonState(namespace=namespace)
    listen(state, "/{}/".format(namespace), snapshots=False)
    drawn = None
    while not rospy.is_shutdown() and rosgraph.is_master_online():
        with state.lock:
            configuration, overview = state.configuration, state.overview
        if overview is not None and overview is not drawn and np.isfinite(overview.variance).any():
            paths = style.save(draw([run_of(configuration, overview)]), stem)
            if drawn is None:
                print("\n".join(paths), flush=True)
            drawn = overview
            if overview.complete:
                return
        time.sleep(PERIOD)
    if drawn is None:
        print("plot: --follow: nothing was drawn: no statistics came before the end", file=sys.stderr)
