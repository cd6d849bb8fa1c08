"""A running platoon as a table on a terminal: follower, mean, variance, standard error, theory, z."""

from __future__ import annotations

from typing import Any, Dict, List, Optional


HEADING = "follower       mean [m]   variance [m^2]   standard error   theory [m^2]         z"
AROUND = 9  # lines other than the followers' rows


def cell(value: Optional[float], width: int, form: str, provisional: Optional[float] = None) -> str:
    """The value, or "~" and the provisional one, or "-"."""
    if value is None and provisional is not None:
        return "{:>{}}".format("~" + format(provisional, form), width)
    return "{:>{}}".format("-" if value is None else format(value, form), width)


def shown(followers: int, lines: int) -> List[int]:
    """Numbers of the followers that fit into this many lines: all, or both ends of the string with 0 for a line of dots between."""
    if followers <= lines:
        return list(range(1, followers + 1))
    half = max((lines - 1) // 2, 1)
    return list(range(1, half + 1)) + [0] + list(range(followers - half + 1, followers + 1))


def time_of_step(state: Dict[str, Any], step: int) -> str:
    return "{:.6g} s (step {})".format(step * state["sample_period"], step)


def heading(state: Dict[str, Any]) -> List[str]:
    if state["followers"] is None:
        return [state["start"] or "Waiting for a platoon's monitor"]
    period = state["sample_period"]
    first = "{}, {}, {}, N = {}".format(state["spacing"], state["noise"], state["link"], state["followers"])
    if "reason" not in state:
        return [first, "Starting: " + state["start"] if state["start"] else "Starting"]
    at = None if state["step"] is None else time_of_step(state, state["step"])
    if state["provisional"]:
        step, until = state["provisional"]["step"], state["paused_until"]
        second = "~ provisional averages{}, replaced when the burn-in is over{}".format(
            ", paused while the leader manoeuvres" if state["manoeuvre"] else "" if step is None else " up to " + time_of_step(state, step), "" if until is None else ": at the earliest at " + time_of_step(state, until))
    elif at is None:
        second = "nothing is measured yet" + (" (burn-in: {:.3g} s of driving, {} steps)".format(
            state["burn_in"] * period, state["burn_in"]) if state["endless"] else "")
        if state["present"] and not state["endless"]:
            second += ": realization {} at {:.6g} s of {}".format(
                state["present"]["realization"], state["present"]["step"] * period, time_of_step(state, state["steps"] - 1))
    elif state["time_average"]:
        second = "averages over time" + (" up to " + at if state["paused_until"] is None else ", {}: paused until {}".format(
            "manoeuvre" if state["manoeuvre"] else "burn-in", time_of_step(state, state["paused_until"])))
    else:
        second = "{}, {} of {} realizations".format(at, state["realizations"], state["realizations_wanted"])
        if state["max_abs_z"] is not None:
            second += ", largest |z| {:.2f} (plausible to {:.2f})".format(state["max_abs_z"], state["plausible_z"])
        elif state["realizations_needed"] is not None:
            second += ", no verdict before about {:.2g}".format(state["realizations_needed"])
    if state["vehicle_steps_per_second"] is not None:
        second += ", {:.3g} vehicle-steps/s".format(state["vehicle_steps_per_second"])
    if state["seconds_left"] is not None:
        second += ", {:.0f} s left".format(state["seconds_left"])
    limit = "" if state["limit_variance"] is None else "; limit {:.6g} m^2".format(state["limit_variance"])
    return [first, "Theory: {}{}".format(state["reason"], limit), second + (", complete" if state["complete"] else ""),
            *(["Now: " + state["conduct"]["words"]] if state["conduct"] else []),
            *("Warning: " + warning for warning in state["warnings"])]


def smallest_gap(state: Dict[str, Any]) -> List[str]:
    """A line on the smallest gap of all followers, the first of equal ones; empty without one."""
    known = [(gap, row) for row, gap in enumerate(state["smallest_gap"]) if gap is not None]
    if not known:
        return []
    gap, row = min(known)
    return ["smallest gap {:.3g} m: follower {}, realization {}, {}".format(
        gap, row + 1, state["smallest_gap_realization"][row], time_of_step(state, state["smallest_gap_step"][row]))]


def table(state: Dict[str, Any], lines: int) -> List[str]:
    """The lines of the table for a terminal of this many lines."""
    text = heading(state)
    if state["culprit"]:
        text.append("RUN STALLED: {} ({} retries)".format(state["culprit"], state["retries"]))
    text += smallest_gap(state)
    if not state["variance"]:
        return text
    text += ["", HEADING]
    early = state["provisional"] or {name: [None] * len(state["variance"]) for name in ("mean", "variance")}
    for i in shown(len(state["variance"]), max(lines - AROUND, 3)):
        row = i - 1
        text.append("     ..." if i == 0 else "{:8d} {} {} {} {} {}".format(
            i, cell(state["mean"][row], 14, ".6g", early["mean"][row]), cell(state["variance"][row], 16, ".6g", early["variance"][row]), cell(state["standard_error"][row], 16, ".2g"),
            cell(state["theoretical_variance"][row], 14, ".6g"), cell(state["score"][row], 9, ".2f")))
    return text
