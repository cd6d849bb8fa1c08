"""Which values of a model's keys make a figure of the theory least, within a box and subject to other figures."""

from __future__ import annotations

import json
import math
import os
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .bounds import MAXIMA, MEAN, lower_bound
from .files import write_all
from .model import Model, PathLike
from .simulation import monte_carlo, positive, run_settings
from .tuning_input import axes_of, box_of, constraints_of, minimise_of, realizations_of, seconds_of
from .tuning_problem import Condition, Constraint, Figure, Point, Problem, Progress, more_is_better
from .tuning_search import STEP, derivative, kinks, neighbours, one_sided, search

if TYPE_CHECKING:
    from .tuning_problem import Array


@dataclass
class Tuning:
    """The result of tune()."""

    model: Model  #: the tuned model
    minimise: str
    variables: Dict[str, float]
    goal: float
    figures: Dict[str, Figure]  #: those of the constraints, at the optimum
    binding: List[str]  #: the constraints, and the variables at an end of their box
    sensitivity: Dict[str, float]  #: derivatives of the goal: by each variable, and by each binding constraint's bound
    kinks: Dict[str, List[float]]  #: the slopes of the goal behind and ahead, by each variable by which it has no derivative
    bound: Optional[float]  #: no point of the box has a smaller goal; None without a proof
    bound_reason: str  #: how the bound was found, or why there is none
    evaluations: int
    confirmation: Optional[Dict[str, Any]] = None  #: realizations, max_abs_z, agrees and verdict of monte_carlo()
    front: List[Dict[str, Any]] = field(default_factory=list)  #: the Pareto front: `over`, `against` and `variables` of each point
    axes: Tuple[str, str] = ("", "")  #: of the front: over, against
    without_point: List[float] = field(default_factory=list)  #: the bounds of `against` for which no point was found

    def to_dict(self) -> Dict[str, Any]:
        """The content of tune.json."""
        document: Dict[str, Any] = {
            name: getattr(self, name) for name in ("minimise", "variables", "goal", "figures", "binding", "sensitivity", "kinks",
                                                   "bound", "bound_reason", "evaluations", "confirmation")}
        if self.front:
            document["pareto"] = {"over": self.axes[0], "against": self.axes[1], "points": self.front, "without_point": self.without_point}
        return document

    def save(self, folder: PathLike) -> None:
        """Writes tune.json and model.yaml into a new or empty folder. Raises FileExistsError if it has one of them."""
        os.makedirs(folder, exist_ok=True)
        for name in ("model.yaml", "tune.json"):
            if os.path.lexists(os.path.join(folder, name)):
                raise FileExistsError("{}: has a {} already".format(folder, name))
        model, tuned = ((json.dumps(document, indent=1) + "\n").encode() for document in (
            self.model.to_dict(), dict(self.to_dict(), crc32={"summary": "00000000"})))
        tuned = tuned.replace(b'"summary": "00000000"', b'"summary": "%08x"' % zlib.crc32(tuned))  # as with_checksums() of the C++ library
        write_all({os.path.join(folder, "model.yaml"): model, os.path.join(folder, "tune.json"): tuned})

    @property
    def report(self) -> str:
        """The result as text."""
        lines = ["Least {}: {:.9g}".format(self.minimise, self.goal)]
        lines += ["  {}: {:.9g}{}".format(key, value, " (at an end of its box)" if key in self.binding else "")
                  for key, value in self.variables.items()]
        lines += ["  {}: {}{}".format(name, "{:.9g}".format(value) if isinstance(value, float) else str(value).lower(),
                                      " (binding)" if name in self.binding else "") for name, value in self.figures.items()]
        ends = [key for key in self.variables if key in self.binding]
        if ends:
            lines.append("The box binds: a smaller goal may lie beyond the end of {}".format(", ".join(ends)))
        lines += ["Sensitivity: the goal changes by {:.6g} per unit of {}".format(value, name + (" bound" if name in self.figures else ""))
                  for name, value in self.sensitivity.items()]
        lines += ["Kink of the goal at {}: it changes by {:.6g} per unit more, and by {:.6g} per unit less".format(key, ahead, -behind)
                  for key, (behind, ahead) in self.kinks.items()]
        if self.bound is None:
            lines.append("No lower bound: " + self.bound_reason)
        else:
            below = " ({:.3g} % below the goal)".format(100.0 * (1.0 - self.bound / self.goal)) if self.goal else ""
            lines.append("No point of this box reaches less than {:.9g}{}: {}".format(self.bound, below, self.bound_reason))
        if self.confirmation:
            lines.append("monte_carlo, {realizations} realizations: {verdict}".format(**self.confirmation))
        return "\n".join(lines + self.table_of_front()) + "\n"

    def table_of_front(self) -> List[str]:
        """The front as lines of text, and the bounds without a point; empty without a front."""
        if not self.front:
            return []
        over, against = self.axes
        rows = [[against, over, *self.variables]]
        rows += [["{:.6g}".format(value) for value in (point["against"], point["over"], *point["variables"].values())] for point in self.front]
        widths = [max(map(len, column)) for column in zip(*rows)]
        lines = ["Front: the {} {} for {} bounds of {}".format("greatest" if more_is_better(over) else "least", over,
                                                              "lower" if more_is_better(against) else "upper", against)]
        lines += ["  " + "  ".join(map(str.rjust, row, widths)) for row in rows]
        if self.without_point:
            lines.append("  no point found for {} {} {}".format(against, "of at least" if more_is_better(against) else "of at most",
                                                               ", ".join(map("{:.6g}".format, self.without_point))))
        return lines


def sensitivities(problem: Problem, best: Point) -> Tuple[List[str], Dict[str, float], Dict[str, List[float]]]:
    """The binding constraints and variables, the derivatives of the goal, and its slopes behind and ahead where it has a kink. A constraint
    binds if it is violated within the step of the differences."""
    place = problem.place_of(best.values)
    at_end = [key for key, u in zip(problem.over, place) if min(u, 1.0 - u) <= 1e-6]
    problem.prepare([at for size in (STEP, 10.0 * STEP) for pair in neighbours(place, size) for at in pair])
    near = [point for point in (problem.at(at) for pair in neighbours(place) for at in pair) if (point.goal, *point.figures).count(None)
            <= len(point.figures)]  # where nothing exists, the constraints are not what ends the region
    binding = {constraint.figure: k for k, constraint in enumerate(problem.constraints)
               if any(min(constraint.margins(point.figures[k])) < 0.0 for point in near
                      if point.figures[k] is not None or constraint.wanted is not None)}  # a figure that ends has not reached its bound

    def goal_at(at: Array) -> float:
        return _number(problem.at(at).goal)

    goal, kinked = derivative(goal_at, place), kinks(goal_at, place)
    by_value = derivative(lambda at: np.array(problem.values_at(at)), place).diagonal()
    result = {key: float(slope / unit) for key, slope, unit, kink in zip(problem.over, goal, by_value, kinked)
              if math.isfinite(slope) and not kink}
    sides = zip(problem.over, *one_sided(goal_at, place), by_value, kinked)
    at_kink = {key: [float(behind / unit), float(ahead / unit)] for key, behind, ahead, unit, kink in sides if kink}
    free = [axis for axis, key in enumerate(problem.over) if key not in at_end]
    rows = [k for k in binding.values() if problem.constraints[k].wanted is None]
    if rows and free:
        def figures_at(at: Array) -> Array:
            return np.array([_number(problem.at(at).figures[k]) for k in rows])

        slopes = derivative(figures_at, place)[:, free]
        if np.isfinite(slopes).all() and np.isfinite(goal).all() and not (kinked[free].any() or kinks(figures_at, place)[:, free].any()):
            multipliers = np.linalg.lstsq(slopes.T, goal[free], rcond=None)[0]
            result.update({problem.constraints[k].figure: float(value) for k, value in zip(rows, multipliers)})
    return list(binding) + at_end, result, at_kink


def _number(value: Figure) -> float:
    return math.nan if value is None else float(value)


def require_dependence(problem: Problem, best: Point) -> None:
    """Raises ValueError for variables that change neither the goal nor a constraint."""
    place = problem.place_of(best.values)
    idle = []
    for axis, key in enumerate(problem.over):
        def same_along_the_axis(start: Array) -> bool:
            known = problem.at(start)
            moved = (problem.at(np.where(np.arange(start.size) == axis, u, start)) for u in (0.1, 0.35, 0.6, 0.85))
            return all(point.goal == known.goal and point.figures == known.figures for point in moved)

        if all(same_along_the_axis(start) for start in (place, np.full(place.size, 0.3), np.full(place.size, 0.7))):
            idle.append("over: {}: neither {} nor a constraint depends on it: must be left out".format(key, problem.minimise))
    if idle:
        raise ValueError("\n".join(idle))


def require_feasible(problem: Problem, best: Point) -> None:
    """Raises ValueError if no point satisfies all constraints, with the nearest one."""
    if best.violation == 0.0:
        return
    nearest = nearest_of(problem)
    where = ", ".join("{} {:.6g}".format(key, value) for key, value in zip(problem.over, nearest.values))
    blamed = problem.constraints and not nearest.failure
    failure = "subject_to: no point found satisfies all constraints" if blamed else "over: the goal exists at no point found"
    broken = ["{}; nearest at {}:".format(failure, where)]
    if nearest.goal is None:
        broken.append("{}: does not exist there{}".format(problem.minimise, nearest.failure and ": " + nearest.failure))
    for k, constraint in enumerate(problem.constraints if blamed else []):
        if min(constraint.margins(nearest.figures[k]) + [0.0]) < 0.0:
            alone = [point.figures[k] for point in problem.evaluated.values() if point.figures[k] is not None]
            reached = max(alone, key=lambda value: min(constraint.margins(value) + [0.0])) if alone else None
            broken.append("{}: {}: {} (nearest of all points: {})".format(constraint.figure, _text(nearest.figures[k]), constraint, _text(reached)))
    raise ValueError("\n".join(broken))


def nearest_of(problem: Problem) -> Point:
    """The point of the least violation among those where the most figures exist. The search has not computed the goal of all: the twenty
    nearest get theirs."""
    def rank(point: Point) -> Tuple[int, float]:
        return point.figures.count(None) + (point.goal is None), point.violation

    ranked = sorted(problem.evaluated.values(), key=lambda point: (point.figures.count(None), bool(point.failure), point.violation))
    with_goal = [point for point in ranked if point.goal is not None][:1]
    return min((problem.compute(point.values) for point in ranked[:20] + with_goal), key=rank)


def _text(value: Figure) -> str:
    return "none" if value is None else str(value).lower() if isinstance(value, bool) else "{:.9g}".format(value)


def tune(model: Model, *, minimise: str, over: Mapping[str, Sequence[float]], subject_to: Optional[Mapping[str, Condition]] = None,
         pareto: Optional[Mapping[str, Any]] = None, followers: int = 20, steps: Optional[int] = None,
         collision_probability: Optional[float] = None, realizations: int = 1000, bound_seconds: float = 120.0,
         progress: Progress = lambda stage, evaluations, goal: None) -> Tuning:
    """The values of the keys `over` at which the figure `minimise` is least.

    `over`: {key of the model: [low, high]}, as {"controller/kp": [0.1, 2.0]}. `minimise`: the path of a figure in the JSON of
    `analyze`, as "limit_variance" or "stationary_variance/19", or a key of the model. `subject_to`: {figure: true, false, a bound, or
    [low, high]}; a single number is a lower bound of phase_margin, delay_margin, string_margin, critical_delay,
    critical_loss_probability and critical_mean_burst, and an upper bound of every other figure. A point where a figure does not exist
    is infeasible. `pareto`: {"over": figure, "against": figure, "points": n} adds a front. `collision_probability`, `followers` and
    `steps` as of analyze(). `realizations`: of the confirmation; 0: none. `bound_seconds`: most time for the lower bound; 0: none. The
    result does not depend on chance.

    Raises ValueError for unknown figures and keys, an empty box, a key that nothing depends on, and constraints that no point
    satisfies; ImportError without SciPy.
    """
    faults: List[str] = []
    minimise, box, constraints = minimise_of(minimise, faults), box_of(model, over, faults), constraints_of(subject_to, faults)
    constraints += [verdict.margin() for verdict in constraints if verdict.wanted and verdict.figure.endswith("string_stable")]
    axes, points = axes_of(pareto, faults)
    realizations, bound_seconds = realizations_of(realizations, faults), seconds_of(bound_seconds, faults)
    probability = ""
    try:
        probability = "" if collision_probability is None else repr(positive("collision_probability", collision_probability))
    except ValueError as error:
        faults.append(str(error))
        probability = "0.01"  # one that is valid: figures of collision are no further fault
    settings = run_settings(followers=followers, steps=steps, realizations=realizations or None)
    try:
        problem = Problem(model, minimise, box, constraints, settings, probability, progress, also=axes or ())
    except ValueError as error:
        faults.append(str(error))
    if faults:
        raise ValueError("\n".join(faults))
    best = search(problem)
    require_feasible(problem, best)
    require_dependence(problem, best)
    binding, slopes, at_kinks = sensitivities(problem, best)
    best = problem.best()
    found = problem.model_at(best.values)
    most = {constraint.figure: constraint.high for constraint in constraints
            if constraint.figure in (MEAN,) + MAXIMA and math.isfinite(constraint.high)}
    bound, reason = lower_bound(found, minimise, box, float(best.goal or 0.0), best.values, bound_seconds,
                                lambda boxes, least: progress("bound", boxes, least), most)
    ignored = [constraint.figure for constraint in constraints
               if constraint != Constraint("string_stable", wanted=True) and not constraint.follows
               and (constraint.figure not in most or math.isfinite(constraint.low))]
    if bound is not None and ignored:
        reason += "; it leaves out the constraints on " + ", ".join(ignored)
    result = Tuning(found, minimise, dict(zip(box, best.values)), _number(best.goal),
                    dict(zip((constraint.figure for constraint in constraints), best.figures)), binding, slopes, at_kinks, bound,
                    reason, len(problem.evaluated))
    if axes:
        result.axes = axes
        result.front, result.without_point = front_of(problem, *result.axes, points)
    if realizations > 0:
        progress("monte_carlo", realizations, result.goal)
        result.confirmation = confirmed(found, realizations, followers, steps)
    return result


def confirmed(model: Model, realizations: int, followers: int, steps: Optional[int]) -> Optional[Dict[str, Any]]:
    """The scores of a simulation against the theory; None if it is not compared."""
    results = monte_carlo(model, realizations=realizations, followers=followers, steps=steps)
    verdicts = [line for line in str(results.report).splitlines() if "the largest |z| is" in line]
    if results.max_abs_z is None or not verdicts:
        return None
    return {"realizations": realizations, "max_abs_z": results.max_abs_z, "agrees": "DISAGREE" not in verdicts[0], "verdict": verdicts[0]}


def front_of(problem: Problem, over: str, against: str, points: int) -> Tuple[List[Dict[str, Any]], List[float]]:
    """The best `over` for evenly spaced bounds of `against`, between the value of `against` at the best `over` and its own best value, and
    the bounds for which no point was found. The best value is the least, and the largest of figures of which more is better. Raises
    ValueError."""
    signs = {figure: -1.0 if more_is_better(figure) else 1.0 for figure in (over, against)}

    def solve(goal: str, bounds: List[Constraint], starts: Sequence[Array]) -> Tuple[Problem, Point]:
        other = Problem(problem.model, goal, problem.over, problem.constraints + bounds, problem.settings, problem.collision_probability,
                        problem.progress, "front", sign=signs[goal])
        return other, search(other, starts)

    _, best_against = solve(against, [Constraint(over)], ())
    ends, best_over = solve(over, [Constraint(against)], ())
    sign = signs[against]
    best, worst = sign * _number(best_against.goal), _number(best_over.figures[-1])
    if best_against.violation or best_over.violation or not sign * best < sign * worst:
        raise ValueError("pareto: {} and {} do not compete in this box: both are best at the same point".format(over, against))
    front, without, place = [], [], ends.place_of(best_over.values)
    for level in np.linspace(worst, best, points):
        end = float(level) + sign * 1e-6 * abs(float(level))
        bound = Constraint(against, low=end) if sign < 0.0 else Constraint(against, high=end)
        for start in (place, ends.place_of(best_against.values)):
            _, found = solve(over, [bound], [start])
            if found.violation == 0.0:
                break
        if found.violation == 0.0:
            place = ends.place_of(found.values)
            front.append({"over": signs[over] * _number(found.goal), "against": found.figures[-1],
                          "variables": dict(zip(problem.over, found.values))})
        else:
            without.append(float(level))
    return front, without
