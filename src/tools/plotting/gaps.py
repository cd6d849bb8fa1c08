"""The smallest gaps of a run: their distribution per follower, and the probability of a collision along the string."""

from __future__ import annotations

from typing import Optional, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plotting import style
from plotting.values import Array, require_same_platoon

BANDS = ((0.01, 0.99, "#c6dbef"), (0.25, 0.75, "#6baed6"))  # quantiles of the realizations, and their colour
PER_STEP = style.PALETTE[3]
SAFE = style.PALETTE[2]
BAR = 0.72  # width of a bar
SPARSE = 10  # a curve with at most this many points has a dot on each
DEEPEST = 1e-4  # the axis of probabilities reaches this far below one realization


def quantile(gaps: sp.Gaps, share: float) -> Array:
    """Per follower the quantile [m] of the smallest gap at this share of the realizations, interpolated within a bin."""
    width = np.diff(gaps.bins).min() if gaps.bins.size > 1 else 0.0
    result = np.empty(gaps.count.size)
    for row, counts in enumerate(gaps.histogram):
        below = np.cumsum(counts)
        at = int(np.searchsorted(below, share * below[-1]))
        inside = (share * below[-1] - (below[at] - counts[at])) / max(counts[at], 1.0)
        result[row] = gaps.bins[at] + inside * width
    return np.maximum(result, gaps.smallest_gap)


def interval(events: Array, count: Array) -> Tuple[Array, Array]:
    """Wilson's interval for the probability of an event, of as many standard errors as the figures show."""
    z = style.SHOWN_ERRORS
    share = events / count
    middle = (share + 0.5 * z ** 2 / count) / (1.0 + z ** 2 / count)
    half = z * np.sqrt(share * (1.0 - share) / count + 0.25 * (z / count) ** 2) / (1.0 + z ** 2 / count)
    return middle - half, middle + half


def draw(run: sp.Results, analysis: Optional[sp.Analysis], titles: Sequence[str]) -> Figure:
    """Draws a run, and the probability per step of an analysis."""
    name, = style.names_of(titles, [run])
    gaps = run.gaps
    if not np.isfinite(gaps.smallest_gap).all():
        raise ValueError("{}: the smallest gap is not finite: no realization is complete".format(run.path))
    if analysis is not None:
        require_same_platoon(run, analysis, analysis.numbers("collision.probability").size)
    figure, axes = style.new_figure(1, 2, 11.4, 5.0)
    smallest, chances = axes[0]
    smallest.set_title("(a) {}, {}\n{}, seed {}{}\n{}".format(
        name, style.verdict(run.string_stable), style.counted(realizations_of(gaps)), run.seed,
        "" if run.complete else ", incomplete run", worst_in_words(gaps)))
    chances.set_title("(b) probability of a collision\nmeasured with $\\pm${} standard errors".format(style.SHOWN_ERRORS))
    draw_distribution(smallest, gaps)
    draw_probabilities(chances, gaps, analysis)
    for axis in (smallest, chances):
        style.follower_axis(axis, run.followers)
        style.legend_below(axis)
    return figure


def realizations_of(gaps: sp.Gaps) -> int:
    return int(gaps.count.max())


def worst_of(gaps: sp.Gaps) -> int:
    """The row of the follower with the smallest gap, the first of equal ones."""
    return int(np.argmin(gaps.smallest_gap))


def worst_in_words(gaps: sp.Gaps) -> str:
    row = worst_of(gaps)
    return "smallest gap {} m: follower {}, realization {}, step {}".format(
        style.signed(gaps.smallest_gap[row]), row + 1, style.spaced(int(gaps.realization[row])), int(gaps.step[row]))


def draw_distribution(axes: Axes, gaps: sp.Gaps) -> None:
    """Draws quantiles of the smallest gap per realization, the smallest of all realizations, and the worst of these."""
    followers = np.arange(1, gaps.count.size + 1)
    few = followers.size <= style.MANY
    for low, high, colour in BANDS:
        bottom, top = quantile(gaps, low), quantile(gaps, high)
        label = "{:g} % of the realizations".format(100 * (high - low))
        if few:
            axes.bar(followers, top - bottom, BAR, bottom, color=colour, label=label)
        else:
            axes.fill_between(followers, bottom, top, color=colour, linewidth=0, label=label)
    if few:
        axes.hlines(quantile(gaps, 0.5), followers - 0.5 * BAR, followers + 0.5 * BAR, color=style.INK, linewidth=1.2, label="median")
    else:
        axes.plot(followers, quantile(gaps, 0.5), color=style.INK, linewidth=1.2, label="median")
    axes.plot(followers, gaps.smallest_gap, "v", color=style.PALETTE[0], markersize=4.5 if few else 2.0,
              label="smallest of all realizations")
    worst = worst_of(gaps)
    axes.plot([worst + 1], [gaps.smallest_gap[worst]], "o", color=style.INK, markersize=9, markerfacecolor="none", markeredgewidth=1.4)
    if np.isfinite(gaps.safe_gap):
        axes.axhline(gaps.safe_gap, color=SAFE, linewidth=1.2, linestyle=style.DASHED, label="safe gap {:g} m".format(gaps.safe_gap))
    style.mark_collisions(axes)
    axes.set_ylabel("smallest gap of a realization [m]")


def draw_probabilities(axes: Axes, gaps: sp.Gaps, analysis: Optional[sp.Analysis]) -> None:
    followers = np.arange(1, gaps.count.size + 1)
    dots = "." if followers.size <= SPARSE else ""
    lowest = DEEPEST / realizations_of(gaps)
    draw_shares(axes, gaps, gaps.collisions, style.PALETTE[0], "o", "per realization, measured")
    bound = gaps.theoretical_collision_bound
    if (bound >= lowest).any():
        axes.plot(followers, visible(np.minimum(bound, 1.0)), color=style.BOUND, linewidth=1.3, marker=dots,
                  label="per realization, upper bound by theory")
    if np.isfinite(gaps.below_safe_gap).any():
        draw_shares(axes, gaps, gaps.below_safe_gap, SAFE, "s", "gap below {:g} m, measured".format(gaps.safe_gap))
    if analysis is not None:
        probability, limit = analysis.numbers("collision.probability"), analysis.number("collision.limit_probability")
        if (probability >= lowest).any():
            axes.plot(followers, visible(probability), color=PER_STEP, linewidth=1.3, linestyle="-.", marker=dots,
                      label="per step, theory")
        if limit >= lowest:
            axes.axhline(limit, color=PER_STEP, linewidth=1.0, linestyle=style.DASHED,
                         label="per step, endless string: {:.3g}".format(limit))
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    low = max(low, lowest)
    axes.set_ylim(low, min(max(high, 100.0 * low), 2.0))
    axes.set_ylabel("probability")


def visible(probability: Array) -> Array:
    """The probabilities with NaN in place of zeros, which a logarithmic axis does not have."""
    return np.where(probability > 0.0, probability, np.nan)


def draw_shares(axes: Axes, gaps: sp.Gaps, events: Array, colour: str, marker: str, label: str) -> None:
    """Draws the share of the realizations per follower; a triangle is the upper end of the interval where there is no event."""
    at = style.thinned(gaps.count.size, style.MANY)
    low, high = interval(events[at], gaps.count[at])
    seen = events[at] > 0
    share = events[at] / gaps.count[at]
    if seen.any():
        axes.errorbar(at[seen] + 1, share[seen], yerr=[(share - low)[seen], (high - share)[seen]], fmt=marker, color=colour,
                      markerfacecolor="white", label=label, zorder=3, **style.POINTS)
    if not seen.all():
        axes.plot(at[~seen] + 1, high[~seen], "v", color=colour, markerfacecolor="none", markersize=5, alpha=0.7,
                  label="none in {}: upper limit".format(style.spaced(realizations_of(gaps))))
