"""The gain |T(e^{jw})| from a vehicle to its follower, and the line |T| = 1 that bounds it for string stability."""

from __future__ import annotations

from typing import Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.figure import Figure

from plotting import style
from plotting.values import Array, drawable, drawable_numbers

HIGHEST = 100.0  # top of the axis; a loop near instability has a higher peak


def transfer_of(analysis: sp.Analysis) -> Tuple[Array, Array]:
    """Numerator and denominator of T: coefficients in descending powers of z."""
    numerator, denominator = (drawable_numbers(analysis, "transfer." + key) for key in ("numerator", "denominator"))
    if not np.isfinite(np.concatenate((numerator, denominator))).all() or not denominator.any():
        raise ValueError("{}: transfer must hold finite coefficients, and a denominator that is not zero".format(analysis.path))
    return numerator, denominator


def gain(numerator: Array, denominator: Array, frequency: Array) -> Array:
    z = np.exp(1j * frequency)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.abs(np.polyval(numerator, z) / np.polyval(denominator, z)))


def draw(analyses: Sequence[sp.Analysis], titles: Sequence[str]) -> Figure:
    names = style.names_of(titles, analyses)
    figure, axes = style.new_figure(1, 1, 6.0, 3.8)
    axes = axes[0, 0]
    frequency = np.linspace(0.0, np.pi, 4001)
    top = 1.0
    for at, (analysis, name) in enumerate(zip(analyses, names)):
        numerator, denominator = transfer_of(analysis)
        where, height = (float(drawable(np.array(analysis.number(key)))) for key in ("peak_frequency", "peak_gain"))
        top = max(top, min(height, HIGHEST))
        stable = np.all(np.abs(np.roots(denominator)) < 1.0)
        axes.plot(frequency, gain(numerator, denominator, frequency), color=style.colour(at), linewidth=1.8,
                  label=("{}: peak {:.4g} at $\\omega = {:.3g}$".format(name, height, where) if stable
                         else "{}: the loop is unstable".format(name)))
        axes.plot([where], [height], style.marker(at), color=style.colour(at), markersize=6,
                  markeredgecolor="white", clip_on=False, zorder=5)
    axes.axhline(1.0, color=style.INK, linewidth=0.9, linestyle=style.DASHED)
    axes.axhspan(1.0, 1.15 * top, color=style.BOUND, alpha=0.07, linewidth=0)
    axes.text(0.99 * np.pi, 1.14 * top, "errors grow along the string", ha="right", va="top", color=style.BOUND)
    axes.set_ylim(0.0, 1.15 * top)
    axes.set_xlim(0.0, np.pi)
    axes.set_xticks(np.linspace(0.0, np.pi, 5))
    axes.set_xticklabels(["0", "$\\pi/4$", "$\\pi/2$", "$3\\pi/4$", "$\\pi$"])
    axes.set_xlabel("frequency $\\omega$ [rad/sample]")
    axes.set_ylabel("gain $|T(e^{j\\omega})|$")
    axes.legend()
    return figure
