"""A lower bound of a figure over a box of controller coefficients, by branch and bound.

With x the one or two variables and L = G K = n / d, where d and n are affine in x at every frequency w, V = d + H n and M = |V|^2 -
|n|^2, or V = H (d + n) behind a headway filter with d replaced by H d in the numerator below:

    limit_variance = P_d (< |d|^2 / M > - 1),   peak_gain = max |n| / |V|,   sensitivity_peak = max |d| / |V|

(Without a headway filter: S / T = d / n. The mean of |H T|^2 - |S|^2 over the circle is -1 for a stable loop.) |d|^2, |n|^2, |V|^2 and M
are quadratic in x. Over a cell of frequencies, by the inequality of Cauchy and Schwarz, for every x with M > 0 there and every phase p(w),

    integral of |d|^2 / M >= |integral of d p|^2 / integral of M,

again a quotient of two quadratics in x, whose least value over a box is bounded by their extremes. No frequency is left out, so the bound
holds for every string stable point of the box. A box is excluded only with proof: the integral of M is not positive over a cell for any
of its x, or its centre is unstable and V has no zero on the circle for any of its x, so that every x has as many unstable poles.
"""

from __future__ import annotations

import heapq
import math
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from . import _platoon
from .model import Model, handle_of
from .quadratics import combined, extremes, least_quotient, square, value

if TYPE_CHECKING:
    from .quadratics import Array, Complex, Quadratic

TOLERANCE = 0.005  # relative distance between bound and goal at which a box is not divided further
ROUNDING = 1e-9
MEAN, MAXIMA = "limit_variance", ("peak_gain", "sensitivity_peak")
BATCH = 32


def reason_without_bound(model: Model, figure: str, variables: Sequence[str]) -> str:
    """Why there is no bound of a figure over these keys of a model; empty if there is one."""
    if figure != MEAN and figure not in MAXIMA:
        return "it exists for {} only, not for {}".format(", ".join((MEAN,) + MAXIMA), figure)
    if len(variables) > 2:
        return "it exists for up to two variables, not for {}".format(len(variables))
    document = model.to_dict()
    others = [key for key in variables if not _is_coefficient(key, document.get("controller", {}))]
    if others:
        return "it exists for gains of the controller and numbers of its numerator and denominator, not for {}".format(", ".join(others))
    channel = document.get("channel", {})
    if not model.is_homogeneous or document.get("inputs") or "closed_loop" in document or any(
            channel.get(key) for key in ("loss", "delay", "quantisation_step", "noise_filter")):
        return "it exists for one type of vehicle with radar over channels that add white noise only"
    return ""


def _is_coefficient(key: str, controller: Mapping[str, Any]) -> bool:
    parts = key.split("/")
    if parts[0] != "controller" or len(parts) not in (2, 3):
        return False
    if len(parts) == 2:
        return parts[1] in ("kp", "kd", "ki")
    # The leading coefficient of the denominator, and a denominator beside gains, are no affine parameters of n and d.
    return parts[1] in ("numerator", "denominator") and parts[2].isdigit() and parts[1:] != ["denominator", "0"]


class Loop:
    """d and n of a model as polynomials in z that are affine in the variables: rows 1, x, y."""

    def __init__(self, model: Model, variables: Sequence[str]) -> None:
        document = model.to_dict()
        controller = document["controller"]
        period = model.sample_period
        self.headway, self.noise = model.time_headway, model.noise_variance
        self.filtered = bool(controller.get("headway_filter"))
        given = {key.split("/", 1)[1]: row for row, key in enumerate(variables, 1)}
        if "kp" in controller or "kd" in controller or "ki" in controller:
            # K = (kp z (z - 1) + kd (z - 1)^2 / T_s + ki T_s z^2) / (z (z - 1)); without ki the factor z - 1 cancels
            with_integral = bool(controller.get("ki")) or "ki" in given
            parts = {"kp": [1.0, -1.0, 0.0], "kd": [1.0 / period, -2.0 / period, 1.0 / period], "ki": [period, 0.0, 0.0]} if with_integral \
                else {"kp": [1.0, 0.0], "kd": [1.0 / period, -1.0 / period]}
            below = np.zeros((3, 3 if with_integral else 2))
            above = np.zeros_like(below)
            below[0, :2] = [1.0, -1.0] if with_integral else [1.0, 0.0]
            for name, polynomial in parts.items():
                above[given[name] if name in given else 0] += np.array(polynomial) * (1.0 if name in given else float(controller.get(name, 0.0)))
        else:
            above, below = (self._coefficients(controller[name], name, given) for name in ("numerator", "denominator"))
        if controller.get("divide_by_one_plus_headway"):
            below = below * (1.0 + self.headway)
        numerator, denominator = _platoon.plant(handle_of(model))
        self.d = np.array([np.convolve(denominator, row) for row in below])
        self.n = np.array([np.convolve(numerator, row) for row in above])
        # In V = d z + n ((1 + h) z - h) or d + n: its zeros are the poles of the loop.
        policy = [1.0] if self.filtered else [1.0 + self.headway, -self.headway]
        fed_back = np.array([np.convolve(row, policy) for row in self.n])
        opened = self.d if self.filtered else np.pad(self.d, ((0, 0), (0, 1)))
        self.v = opened + np.pad(fed_back, ((0, 0), (opened.shape[1] - fed_back.shape[1], 0)))

    @staticmethod
    def _coefficients(values: Sequence[float], name: str, given: Mapping[str, int]) -> Array:
        rows = np.zeros((3, len(values)))
        for k, value in enumerate(values):
            row = given.get("{}/{}".format(name, k), 0)
            rows[row, k] = value if row == 0 else 1.0
        return rows

    def responses(self, w: Array) -> Tuple[Complex, Complex, Complex]:
        """d (times H behind a filter), n and V at these frequencies, rows 1, x, y on the first axis."""
        z = np.exp(1j * w)
        d, n, v = (np.array([np.polyval(row, z) for row in rows]) for rows in (self.d, self.n, self.v))
        if self.filtered:
            policy = (1.0 + self.headway) - self.headway / z
            return policy * d, n, policy * v
        return d, n, v / z

    def is_stable(self, x: Array) -> bool:
        roots = np.roots(np.trim_zeros(self.v[0] + x @ self.v[1:], "f"))
        return bool((np.abs(roots) < 1.0).all())


class Integrand:
    """The quotient whose mean or maximum the figure is, cell by cell."""

    def __init__(self, loop: Loop, figure: str, optimum: Array) -> None:
        self.loop, self.figure, self.optimum = loop, figure, optimum
        edges = np.unique(np.concatenate([[0.0], np.geomspace(1e-4, math.pi, 200), np.linspace(0.0, math.pi, 100)[1:]]))
        self.nodes, self.weights = np.polynomial.legendre.leggauss(12)  # type: ignore[no-untyped-call]
        if figure == MEAN:
            edges = self._refined(edges)
        else:  # a maximum is that over the middles of the cells: many near the one of the optimum
            w = np.linspace(0.0, math.pi, 20001)[1:]
            d, n, v = (np.abs(np.tensordot(np.concatenate([[1.0], optimum]), rows, axes=1)) for rows in loop.responses(w))
            peak = w[np.argmax((n if figure == "peak_gain" else d) / v)]
            edges = np.unique(np.minimum(np.concatenate([edges, peak * np.linspace(0.7, 1.3, 122)]), math.pi))
        self.edges = edges
        self.width = np.diff(edges) / math.pi
        self.above, self.below = self._cells(edges)
        v = loop.v
        # Between the ends of a cell V departs from a line by at most the square of the width times |V''| / 8.
        powers = np.arange(v.shape[1])[::-1]
        self.curvature = np.abs(v) @ (powers - powers.mean()) ** 2  # with V turned by a mean power of z, which keeps |V|
        turn = np.exp(-1j * powers.mean() * edges)
        self.at_edges = turn * np.array([np.polyval(row, np.exp(1j * edges)) for row in v])

    def _cells(self, edges: Array) -> Tuple[Quadratic, Quadratic]:
        if self.figure != MEAN:
            d, n, v = self.loop.responses(0.5 * (edges[1:] + edges[:-1]))
            return square(n if self.figure == "peak_gain" else d), square(v)
        w = 0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * self.nodes
        weights = 0.5 * self.weights
        d, n, v = self.loop.responses(w)
        at = np.tensordot(np.concatenate([[1.0], self.optimum]), d, axes=1)
        phase = np.conj(at) / np.maximum(np.abs(at), 1e-300)
        above = square((d * phase) @ weights)
        below = combined(square(v), square(n), -1.0)
        return above, (below[0] @ weights, np.einsum("ijk,j->ik", below[1], weights), np.einsum("ijk,j->ik", below[2], weights))

    def _refined(self, edges: Array) -> Array:
        """Divides cells until their bounds at the optimum lose at most a fifth of the tolerance of its mean."""
        for _ in range(12):
            above, below = self._cells(edges)
            x, y = self.optimum
            with np.errstate(divide="ignore", invalid="ignore"):
                bounds = np.diff(edges) * value(above, x, y) / value(below, x, y)
            w = 0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * self.nodes
            d, n, v = (np.abs(np.tensordot(np.array([1.0, x, y]), rows, axes=1)) ** 2 for rows in self.loop.responses(w))
            exact = np.diff(edges) * ((d / (v - n)) @ (0.5 * self.weights))
            loss = np.abs(exact - bounds)
            mean = exact.sum() / math.pi - 1.0
            if loss.sum() / math.pi <= 0.2 * TOLERANCE * mean or edges.size > 3000:
                break
            wide = loss > 0.1 * TOLERANCE * mean * math.pi / edges.size
            edges = np.sort(np.concatenate([edges, 0.5 * (edges[1:] + edges[:-1])[wide]]))
        return edges

    def bounds(self, low: Array, high: Array) -> Array:
        """Lower bounds of the figure over boxes; infinite where a box has no string stable point."""
        least, impossible = least_quotient(self.above, self.below, low, high)
        if self.figure == MEAN:
            result = self.loop.noise * np.maximum(least @ self.width - 1.0, 0.0)
            result[impossible.any(axis=1)] = np.inf
        else:
            result = np.sqrt(least.max(axis=1))
        for k in np.flatnonzero(np.isfinite(result)):
            if not self.loop.is_stable(0.5 * (low[k] + high[k])) and self.keeps_unstable_poles(low[k], high[k]):
                result[k] = np.inf
        return result

    def keeps_unstable_poles(self, low: Array, high: Array) -> bool:
        """Whether V certainly has no zero on the circle at any point of a box: over each cell, V turned by its value at the middle of
        the box has a positive real part at the corners of the box."""
        corners = np.array([[1.0, x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
        at = corners @ self.at_edges
        middle = np.concatenate([[1.0], 0.5 * (low + high)]) @ self.at_edges
        turn = np.conj(middle[1:] + middle[:-1])
        real = np.minimum((turn * at[:, 1:]).real, (turn * at[:, :-1]).real) / np.maximum(np.abs(turn), 1e-300)
        curvature = np.abs(corners) @ self.curvature
        doubt = curvature[:, None] * np.diff(self.edges) ** 2 / 8.0 + ROUNDING * np.abs(corners @ np.abs(self.loop.v)).sum()
        return bool((real > doubt).all())


def lower_bound(model: Model, figure: str, box: Dict[str, Tuple[float, float]], goal: float, optimum: Sequence[float], seconds: float,
                progress: Callable[[int, float], None], most: Mapping[str, float] = {}) -> Tuple[Optional[float], str]:
    """A number that the figure exceeds at every string stable point of the box, and how it was found; or None and why there is none.
    `most`: upper bounds of other figures; a box whose own lower bound of such a figure is above it is excluded."""
    if seconds <= 0.0:
        return None, "its time is 0 s"
    reason = reason_without_bound(model, figure, list(box))
    if reason:
        return None, reason
    ends = np.array(list(box.values()) + [(0.0, 0.0)] * (2 - len(box)))
    at = np.array(list(optimum) + [0.0] * (2 - len(box)))
    loop = Loop(model, list(box))
    integrand = Integrand(loop, figure, at)
    others = [(Integrand(loop, name, at), value) for name, value in most.items()]
    size = np.maximum(ends[:, 1] - ends[:, 0], 1e-300)
    queue: List[Tuple[float, int, Array, Array]] = []
    finished, count, begun = math.inf, 0, time.monotonic()

    def add(low: Array, high: Array) -> None:
        nonlocal finished, count
        bounds = integrand.bounds(low, high)
        for constraint, value in others:
            bounds[constraint.bounds(low, high) > value * (1.0 + ROUNDING)] = np.inf
        for bound, one, other in zip(bounds, low, high):
            count += 1
            if bound < (1.0 - TOLERANCE) * goal:
                heapq.heappush(queue, (float(bound), count, one, other))
            else:
                finished = min(finished, float(bound))

    add(ends[None, :, 0], ends[None, :, 1])
    while queue and time.monotonic() - begun < seconds:
        boxes = [heapq.heappop(queue) for _ in range(min(BATCH, len(queue)))]
        lows, highs = [], []
        for _, _, low, high in boxes:
            axis = int(np.argmax((high - low) / size))
            middle = 0.5 * (low[axis] + high[axis])
            for start, end in ((low[axis], middle), (middle, high[axis])):
                one, other = low.copy(), high.copy()
                one[axis], other[axis] = start, end
                lows.append(one)
                highs.append(other)
        add(np.array(lows), np.array(highs))
        progress(count, queue[0][0] if queue else finished)
    found = min([finished, goal] + ([queue[0][0]] if queue else [])) * (1.0 - ROUNDING)
    return found, "branch and bound of {} boxes over {} cells of frequency, tolerance {:g} %{}".format(
        count, integrand.edges.size - 1, 100.0 * TOLERANCE, "" if not queue else ", ended by its time limit")
