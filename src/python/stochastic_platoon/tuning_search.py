"""The search for the least goal of a tuning problem over its box."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Iterable, List, Sequence, Tuple

import numpy as np

from .tuning_problem import Point, Problem

if TYPE_CHECKING:
    from .tuning_problem import Array

FEASIBLE = 1e-7  # relative distance that the search keeps from a bound
STEP = 1e-4  # of differences, as a share of the box


def search(problem: Problem, starts: Sequence[Array] = ()) -> Point:
    """The best point: differential evolution over the box, sequential quadratic programming and a simplex from its best points. With
    `starts`, from these alone."""
    from scipy import optimize

    size = len(problem.over)
    places = list(starts)
    if not places:
        corners = np.array(np.meshgrid(*[[0.0, 1.0]] * size)).reshape(size, -1).T if size <= 4 else np.empty((0, size))
        random = np.random.RandomState(1)
        columns = [(random.permutation(10 * size) + 0.5) / (10 * size) for _ in range(size)]
        population = np.vstack([np.array(columns).T, 0.002 + 0.996 * corners])

        def evaluated(function: Callable[[Array], float], places: Iterable[Array]) -> List[float]:
            chosen = list(places)
            problem.prepare(chosen)
            return [function(place) for place in chosen]

        problem.prepare(list(corners))
        optimize.differential_evolution(lambda place: problem.at(place).merit, [(0.0, 1.0)] * size, init=population, maxiter=5 * size,
                                        tol=1e-3, seed=1, polish=False, updating="deferred", workers=evaluated)
        ranked = sorted(problem.evaluated.values(), key=lambda point: point.merit)
        for point in ranked:
            place = problem.place_of(point.values)
            if len(places) < 2 and all(np.abs(place - other).max() > 0.1 for other in places):
                places.append(place)
    problem.stage = "polish"
    for place in places:
        polish(problem, place)
    before = problem.best()
    simplex(problem, problem.place_of(before.values), 0.01)
    if problem.best().merit < before.merit - 1e-7 * abs(before.merit):
        polish(problem, problem.place_of(problem.best().values))
    return problem.best()


def simplex(problem: Problem, place: Array, size: float) -> None:
    from scipy import optimize

    # Beside the border of a verdict a simplex converges slowly.
    verdicts = any(constraint.wanted is not None for constraint in problem.constraints)
    corners = np.vstack([place, place + np.diag(np.where(place < 0.5, size, -size))])
    optimize.minimize(lambda at: problem.at(at).merit, place, method="Nelder-Mead",
                      options={"initial_simplex": corners, "maxfev": (60 if verdicts else 20) * place.size, "xatol": 1e-7, "fatol": 1e-12})


def polish(problem: Problem, place: Array) -> None:
    """Sequential quadratic programming with central differences inside the box."""
    from scipy import optimize

    start = problem.at(place)
    if start.goal is None:
        return
    unit = max(abs(float(start.goal)), 1e-12)

    def slope(function: Callable[[Array], Any], at: Array) -> Array:
        problem.prepare([at] + [place for pair in neighbours(np.clip(at, 0.0, 1.0)) for place in pair])
        return derivative(function, at)

    def margins(at: Array) -> Array:
        point = problem.at(at)
        return np.array([margin - FEASIBLE for constraint, figure in zip(problem.constraints, point.figures) if constraint.wanted is None
                         for margin in constraint.margins(figure)])

    def goal(at: Array) -> float:
        point = problem.at(at)
        broken = any(constraint.wanted is not None and constraint.wanted != figure
                     for constraint, figure in zip(problem.constraints, point.figures))
        return 10.0 if point.goal is None or broken else float(point.goal) / unit

    conditions = [] if margins(place).size == 0 else [
        {"type": "ineq", "fun": margins, "jac": lambda at: slope(margins, at)}]
    optimize.minimize(goal, place, jac=lambda at: slope(goal, at), method="SLSQP", bounds=[(0.0, 1.0)] * place.size,
                      constraints=conditions, options={"maxiter": 15, "ftol": 1e-9})


def neighbours(place: Array, size: float = STEP) -> List[Tuple[Array, Array]]:
    """For each axis the places behind and ahead, inside the unit cube."""
    steps = size * np.eye(place.size)
    return [(np.maximum(place - step, 0.0), np.minimum(place + step, 1.0)) for step in steps]


def derivative(function: Callable[[Array], Any], place: Array) -> Array:
    """By central differences, one-sided at the faces of the unit cube; the last axis is that of the place."""
    pairs = enumerate(neighbours(np.clip(place, 0.0, 1.0)))
    return np.stack([(np.asarray(function(ahead)) - np.asarray(function(behind))) / (ahead[axis] - behind[axis])
                     for axis, (behind, ahead) in pairs], axis=-1)


def one_sided(function: Callable[[Array], Any], place: Array, size: float = STEP) -> Tuple[Array, Array]:
    """The slopes behind and ahead, the same at the faces of the unit cube; the last axis is that of the place."""
    here, slopes = np.asarray(function(place)), []
    for axis, (behind, ahead) in enumerate(neighbours(place, size)):
        both = [(np.asarray(function(at)) - here) / (at[axis] - place[axis]) for at in (behind, ahead) if at[axis] != place[axis]]
        slopes.append((both[0], both[-1]))
    first, last = (np.stack(side, axis=-1) for side in zip(*slopes))
    return first, last


def kinks(function: Callable[[Array], Any], place: Array) -> Array:
    """Where the function has no derivative: its one-sided slopes differ by as much over ten times the step, while those of a smooth one
    differ by ten times as much. Rounding counts as smooth; the last axis is that of the place."""
    near, far = ((first, last, np.abs(last - first)) for first, last in (one_sided(function, place, size) for size in (STEP, 10.0 * STEP)))
    rounding = 1e-9 * np.abs(np.asarray(function(place)))[..., None] / STEP
    return np.asarray((near[2] > rounding) & (near[2] > 0.01 * np.abs(near[0] + near[1]) / 2.0) & (far[2] < 5.0 * near[2]))
