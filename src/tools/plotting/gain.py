"""The gain along the string over the frequency, and the line 1 below which it must stay for string stability: |T(e^{jw})| of the mean
response over one pattern, or the spectral radius of the companion matrix of vehicles that hear several ahead."""

from __future__ import annotations

from typing import Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plotting import style
from plotting.values import Array, drawable, drawable_numbers

HIGHEST = 100.0  # top of the axis; a loop near instability has a higher peak
MOST_TOGETHER = 3  # analyses in one panel; more get one each
COLUMNS = 5
PANEL = 2.25  # [inch] width of one of many panels
TITLE_LINE = 28  # characters
SHOWN = (0.01, 50.0)  # [rad/s], what cars do


def curve_of(analysis: sp.Analysis) -> Tuple[Array, Array]:
    """Frequencies [rad/s] and gains."""
    frequency, gain = (drawable_numbers(analysis, "gain_along_string." + key) for key in ("frequency", "gain"))
    if frequency.size != gain.size:
        raise ValueError("{}: gain_along_string must have as many gains as frequencies".format(analysis.path))
    return frequency / analysis.number("sample_period"), gain


def peak_of(analysis: sp.Analysis) -> Tuple[float, float]:
    """Frequency [rad/s] and height; NaN where the loop is unstable."""
    where, height = (float(drawable(np.array(analysis.number(key)))) for key in ("peak_frequency", "peak_gain"))
    return where / analysis.number("sample_period"), height


def draw_limit(axes: Axes, top: float) -> None:
    axes.axhline(1.0, color=style.INK, linewidth=0.9, linestyle=style.DASHED)
    axes.axhspan(1.0, top, color=style.BOUND, alpha=0.07, linewidth=0)
    axes.set_ylim(0.0, top)


def draw(analyses: Sequence[sp.Analysis], titles: Sequence[str]) -> Figure:
    names = style.names_of(titles, analyses)
    if len(analyses) > MOST_TOGETHER:
        return draw_each(analyses, names)
    figure, axes = style.new_figure(1, 1, 6.0, 3.8 + 0.17 * len(analyses))
    axes = axes[0, 0]
    top = 1.0
    for at, (analysis, name) in enumerate(zip(analyses, names)):
        frequency, gain = curve_of(analysis)
        where, height = peak_of(analysis)
        top = max(top, min(float(np.nanmax(gain)), HIGHEST))
        axes.plot(frequency, gain, color=style.colour(at), linewidth=1.8,
                  label=("{}: peak {:.4g} at {:.3g} rad/s".format(name, height, where) if np.isfinite(height)
                         else "{}: the loop is unstable".format(name)))
        axes.plot([max(where, SHOWN[0])], [height], style.marker(at), color=style.colour(at), markersize=6,
                  markeredgecolor="white", clip_on=False, zorder=5)
    draw_limit(axes, 1.15 * top)
    fastest = max(np.pi / analysis.number("sample_period") for analysis in analyses)
    axes.text(0.99 * fastest, 1.14 * top, "errors grow along the string", ha="right", va="top", color=style.BOUND)
    axes.set_xscale("log")
    axes.set_xlim(SHOWN[0], fastest)
    axes.set_xlabel("frequency [rad/s]")
    axes.set_ylabel("gain along the string")
    style.legends_below([axes])  # a legend in the axes may lie on the words above
    return figure


def draw_each(analyses: Sequence[sp.Analysis], names: Sequence[str]) -> Figure:
    """A panel for each analysis, with its verdict."""
    room = COLUMNS if style.chosen_width is None else 1 if style.is_narrow() else int(style.chosen_width / PANEL)
    columns = min(COLUMNS, len(analyses), room)
    rows = -(-len(analyses) // columns)
    figure, axes = style.new_figure(rows, columns, PANEL * columns, 2.0 * rows)
    for unused in axes.flat[len(analyses):]:
        unused.remove()
    curves = [curve_of(analysis) for analysis in analyses]
    top = min(HIGHEST, max(1.0, max(float(gain.max()) for _, gain in curves)))
    for at, (panel, analysis, name, (frequency, gain)) in enumerate(zip(axes.flat, analyses, names, curves)):
        where, height = peak_of(analysis)
        good = analysis.string_stable is True
        draw_limit(panel, 1.1 * top)
        panel.plot(frequency, gain, color=style.colour(0) if good else style.BOUND, linewidth=1.6)
        grows = ", peak {:.3f}".format(height) if not good and height > 1.0 else ""
        panel.set_title("{}\n{}{}".format(style.wrapped(name, TITLE_LINE), style.verdict(analysis.string_stable), grows), fontsize=8.5,
                        color=style.INK if good else style.BOUND)
        panel.set_xscale("log")
        panel.set_xlim(SHOWN)
        panel.set_xticks([0.01, 0.1, 1.0, 10.0])
        if at % columns == 0:
            panel.set_ylabel("gain along\nthe string")
        if at + columns >= len(analyses):
            panel.set_xlabel("frequency [rad/s]")
            panel.tick_params(labelbottom=True)  # also above an unused panel
    return figure
