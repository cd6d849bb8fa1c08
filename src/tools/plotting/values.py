"""The values that a figure can show."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

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


def require_same_platoon(run: sp.Results, analysis: sp.Analysis, followers: int) -> None:
    """Raises ValueError unless run and analysis have the same string length, spectral radius and stationary variances, where both
    have them."""
    if run.followers != followers:
        raise ValueError("{}: has {} followers, but {} has {}".format(run.path, run.followers, analysis.path, followers))
    radius = analysis.spectral_radius
    if abs(radius - run.spectral_radius) > 1e-6 * abs(radius):
        raise ValueError("{}: is of another platoon than {}: spectral radius {:.6g} instead of {:.6g}".format(
            run.path, analysis.path, run.spectral_radius, radius))
    own, other = (np.array(of.get("stationary_variance", []), dtype=float) for of in (run.summary["theory"], analysis))
    known = np.isfinite(own) & np.isfinite(other) if own.shape == other.shape else np.zeros(0, bool)
    if known.any() and not np.allclose(own[known], other[known], rtol=1e-6, atol=0.0):
        first = int(np.argmax(known & ~np.isclose(own, other, rtol=1e-6, atol=0.0)))
        raise ValueError("{}: is of another platoon than {}: stationary variance of follower {} {:.6g} m^2 instead of {:.6g} m^2".format(
            run.path, analysis.path, first + 1, own[first], other[first]))
