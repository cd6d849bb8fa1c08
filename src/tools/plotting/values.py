"""The values that a figure can show."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Optional

import numpy as np
import stochastic_platoon as sp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
else:
    Array = Any

LARGEST = 1e150  # larger values, of unstable loops, overflow when squared and do not fit on an axis


def drawable(values: Array) -> Array:
    """The values with NaN in place of those that a figure cannot show."""
    with np.errstate(invalid="ignore"):
        return np.where(np.abs(values) < LARGEST, values, np.nan)


def require_some(path: str, what: str, values: Array) -> None:
    if not np.isfinite(values).any():
        raise ValueError("{}: {} is NaN everywhere: nothing to draw".format(path, what))


def drawable_numbers(analysis: sp.Analysis, key: str) -> Array:
    """Numbers of an analysis. Raises ValueError unless a figure can show at least one."""
    values = drawable(analysis.numbers(key))
    require_some(analysis.path, key, values)
    return values


def drawable_errors(run: sp.Results) -> sp.Moments:
    """The moments of a run's tracking errors. Raises ValueError unless a figure can show some means and variances."""
    errors = sp.Moments(**{name: drawable(values) for name, values in vars(run.errors).items()})
    table = os.path.join(run.path, "statistics.csv")
    require_some(table, "mean", errors.mean)
    if not np.isfinite(errors.variance).any():
        raise ValueError("{}: variance is NaN everywhere: it takes at least two realizations".format(table))
    return errors


def require_same_platoon(run: sp.Results, analysis: sp.Analysis, followers: int, with_means: bool = False) -> None:
    """Raises ValueError unless run and analysis have the same string length, spectral radius and stationary variances, and with_means
    the same means of errors and gaps at each step, which leader and standstill distance change; each where both have them."""
    if run.followers != followers:
        raise ValueError("{}: has {} followers, but {} has {}".format(run.path, run.followers, analysis.path, followers))
    radius = analysis.spectral_radius
    if abs(radius - run.spectral_radius) > 1e-6 * abs(radius):
        raise ValueError("{}: is of another platoon than {}: spectral radius {:.6g} instead of {:.6g}".format(
            run.path, analysis.path, run.spectral_radius, radius))
    require_equal(run, analysis, "stationary variance of follower {}", "m^2", run.summary["theory"].get("stationary_variance", []),
                  analysis.get("stationary_variance", []))
    for what, key, moments in (("mean error", "mean", run.errors), ("mean gap", "signals.gap.mean", run.signals.get("gap"))):
        theory = analysis.get(key)
        if with_means and moments and isinstance(theory, np.ndarray) and theory.ndim == 2:
            common = run.steps < theory.shape[1]
            steps = run.steps[common].astype(int)
            require_equal(run, analysis, what + " of follower {} at step {}:", "m", moments.theoretical_mean[:, common], theory[:, steps],
                          1e-6, steps)


def require_equal(run: sp.Results, analysis: sp.Analysis, what: str, unit: str, own: Any, other: Any, absolute: float = 0.0,
                  steps: Optional[NDArray[np.int_]] = None) -> None:
    """Raises ValueError if values that both have differ by more than rounding: per follower, or per follower and step."""
    own, other = (np.array(values, dtype=float) for values in (own, other))
    known = np.isfinite(own) & np.isfinite(other) if own.shape == other.shape else np.zeros(0, bool)
    if known.any() and not np.allclose(own[known], other[known], rtol=1e-6, atol=absolute):
        first = np.unravel_index(np.argmax(known & ~np.isclose(own, other, rtol=1e-6, atol=absolute)), own.shape)
        where = [first[0] + 1] + ([] if steps is None else [steps[first[1]]])
        raise ValueError("{}: is of another platoon than {}: {} {:.6g} {unit} instead of {:.6g} {unit}".format(
            run.path, analysis.path, what.format(*where), own[first], other[first], unit=unit))
