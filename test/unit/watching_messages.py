"""Messages of a platoon with the fields that the page and the table read, without ROS."""

import json
import math
import os
import sys
import types

import stochastic_platoon as sp

TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "src", "tools")
sys.path.insert(0, TOOLS)
from watching import state, table  # noqa: E402

NAN = math.nan
RUN = {"realizations": 1000, "batch": 100, "rate": 0.0, "seed": 1, "hosting": "processes", "output": "/tmp/run", "burn_in": 200,
       "resume": False, "first_realization": 0, "record": "", "record_split_mb": 0, "record_compression": "none", "launch_id": "1",
       "window": 16, "stall_timeout": 2.0}


def message(**fields):
    return types.SimpleNamespace(**fields)


def configuration(followers=3, steps=4, run=None, **model):
    document = model if "leader" in model else dict(sp.Model.load("paper.yaml").to_dict(), **model)
    return message(data=json.dumps({"version": sp.__version__, "model": document, "run": dict(RUN, followers=followers, steps=steps, **(run or {}))}))


def overview(followers=3, step=(0, 1, 2, 3), **changes):
    cells = [float(10 * i + j) for i in range(1, followers + 1) for j in range(len(step))]
    of = dict(run=1, attempt=1, manoeuvre=False, counted_from=0, realizations=100, time_average=False, complete=False, wall_seconds=1.5, theory="exact", string_stable=True, undecided=False,
              reason="string stable: because", warnings=[], limit_variance=2.5, stationary_variance=[2.0] * followers, step=list(step),
              mean=[0.1 * c for c in cells], variance=cells, stable_headways=[0.5, 1.0, 2.8, 320.0], theoretical_mean=[0.0] * len(cells), theoretical_variance=[c + 1 for c in cells],
              standard_error=[0.5] * followers, variance_score=[-1.0] * followers, max_abs_z_mean=1.5, max_abs_z_variance=2.5,
              plausible_z=4.0, realizations_needed=NAN, smallest_gap=[], smallest_gap_realization=[], smallest_gap_step=[], collisions=[],
              collision_bound=[], provisional_mean=[], provisional_variance=[])
    return message(**dict(of, **changes))


def endless(followers, step, **changes):
    of = dict(time_average=True, realizations=1, standard_error=[NAN] * followers, variance_score=[NAN] * followers,
              max_abs_z_mean=NAN, max_abs_z_variance=NAN, plausible_z=NAN)
    return overview(followers, (step,), **dict(of, **changes))


def burning_in(followers, step, **changes):
    """An overview of an endless run that has provisional averages alone."""
    nothing = [NAN] * followers
    of = dict(mean=nothing, variance=nothing, provisional_mean=[0.01 * i for i in range(followers)], provisional_variance=[3.0 + i for i in range(followers)],
              counted_from=200)
    return endless(followers, step, **dict(of, **changes))


def snapshot(step, followers=3, realization=0, run=1):
    return message(run=run, realization=realization, step=step, position=[2.0 * step - 6.4 * i for i in range(followers + 1)],
                   tracking_error=[0.25 * i for i in range(followers)], speed=[20.0 + i for i in range(followers + 1)])


def table_of(followers, lines, **changes):
    """The table of a platoon with this overview, on a terminal of so many lines."""
    known = state.PlatoonState()
    known.take_configuration(configuration(followers))
    known.take_overview(overview(followers, **changes), 0.0)
    return table.table(known.document(), lines)
