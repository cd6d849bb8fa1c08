"""Quadratics of one or two variables at each frequency, and their extremes over boxes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Tuple

import numpy as np

if TYPE_CHECKING:  # numpy.typing is younger than the NumPy of Debian 11
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Complex = NDArray[np.complex128]
    Quadratic = Tuple[Array, Array, Array]  # c + b x + x' A x: arrays (..., ), (..., 2), (..., 3) for xx, xy, yy


def square(rows: Complex) -> Quadratic:
    """|r_0 + r_1 x + r_2 y|^2 at each frequency."""
    c, x, y = rows
    linear = 2.0 * np.stack([(np.conj(c) * x).real, (np.conj(c) * y).real], axis=-1)
    return np.abs(c) ** 2, linear, np.stack([np.abs(x) ** 2, 2.0 * (np.conj(x) * y).real, np.abs(y) ** 2], axis=-1)


def combined(one: Quadratic, other: Quadratic, factor: Any) -> Quadratic:
    """one + factor other."""
    return tuple(a + np.asarray(factor).reshape(np.shape(factor) + (1,) * (b.ndim - 1 if k else 0)) * b  # type: ignore[return-value]
                 for k, (a, b) in enumerate(zip(one, other)))


def value(q: Quadratic, x: Array, y: Array) -> Array:
    c, b, a = q
    result: Array = c + b[..., 0] * x + b[..., 1] * y + a[..., 0] * x * x + a[..., 1] * x * y + a[..., 2] * y * y
    return result


def extremes(q: Quadratic, low: Array, high: Array) -> Tuple[Array, Array]:
    """The exact least and largest value over boxes, rows of `low` and `high`, of quadratics along the last axis."""
    x0, y0, x1, y1 = low[:, :1], low[:, 1:], high[:, :1], high[:, 1:]
    _, b, a = q
    candidates = [value(q, x, y) for x in (x0, x1) for y in (y0, y1)]
    with np.errstate(divide="ignore", invalid="ignore"):
        for y in (y0, y1):  # on edges
            x = -(b[..., 0] + a[..., 1] * y) / (2.0 * a[..., 0])
            candidates.append(value(q, np.where((x > x0) & (x < x1), x, x0), y))
        for x in (x0, x1):
            y = -(b[..., 1] + a[..., 1] * x) / (2.0 * a[..., 2])
            candidates.append(value(q, x, np.where((y > y0) & (y < y1), y, y0)))
        determinant = 4.0 * a[..., 0] * a[..., 2] - a[..., 1] ** 2
        x = (a[..., 1] * b[..., 1] - 2.0 * a[..., 2] * b[..., 0]) / determinant
        y = (a[..., 1] * b[..., 0] - 2.0 * a[..., 0] * b[..., 1]) / determinant
        inside = (x > x0) & (x < x1) & (y > y0) & (y < y1)
    candidates.append(value(q, np.where(inside, x, x0), np.where(inside, y, y0)))
    every = np.stack(candidates)
    return every.min(axis=0), every.max(axis=0)


def least_quotient(above: Quadratic, below: Quadratic, low: Array, high: Array) -> Tuple[Array, NDArray[np.bool_]]:
    """A lower bound of above / below over boxes, where below > 0; and whether below is positive nowhere.

    With r the quotient at the centre and m = min (above - r below) <= 0: above / below is at least r + m / below and at least
    min above / below; the larger of both is least where they are equal."""
    least_above, _ = extremes(above, low, high)
    _, most_below = extremes(below, low, high)
    least_above = np.maximum(least_above, 0.0)
    centre = 0.5 * (low + high)
    x, y = centre[:, :1], centre[:, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        simple = np.where(most_below > 0.0, least_above / most_below, np.inf)
        at = value(above, x, y) / value(below, x, y)
        usable = np.isfinite(at) & (at > 0.0) & (value(below, x, y) > 0.0)
        ratio = np.where(usable, at, 0.0)
        below_at = tuple(np.broadcast_to(part, (len(low),) + part.shape) for part in below)
        weighted = (ratio * below_at[0], ratio[..., None] * below_at[1], ratio[..., None] * below_at[2])
        difference = tuple(np.broadcast_to(part, (len(low),) + part.shape) - other for part, other in zip(above, weighted))
        m, _ = extremes(difference, low, high)  # type: ignore[arg-type]
        m = np.minimum(m, 0.0)
        better = np.where(usable & (least_above > 0.0), ratio * least_above / (least_above - m), 0.0)
    return np.maximum(simple, better), most_below <= 0.0
