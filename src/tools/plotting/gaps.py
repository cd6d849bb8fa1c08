"""The smallest gaps of runs: their distribution per follower, and the probability of a collision along the string."""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plotting import style
from plotting.values import Array, require_same_platoon

BANDS = ((0.01, 0.99, "#c6dbef"), (0.25, 0.75, "#6baed6"))  # quantiles of the realizations, and their colour
SAFE = style.PALETTE[2]
BAR = 0.72  # width of a bar
WIDE_LINE = 72  # characters per line of a title
SPARSE = 10  # a curve with at most this many points has a dot on each
ROOM = 0.05  # below the smallest gap, of the axis
DEEPEST = 1e-4  # the axis of probabilities reaches this far below one realization


def quantile(gaps: sp.Gaps, share: float) -> Array:
    """Per follower the quantile [m] of the smallest gap at this share of the realizations, interpolated within a bin."""
    width = bin_width(gaps.bins)
    result = np.empty(gaps.count.size)
    for row, counts in enumerate(gaps.histogram):
        below = np.cumsum(counts)
        at = int(np.searchsorted(below, share * below[-1]))
        inside = (share * below[-1] - (below[at] - counts[at])) / max(counts[at], 1.0)
        result[row] = gaps.bins[at] + inside * width
    return np.maximum(result, gaps.smallest_gap)


def bin_width(bins: Array) -> float:
    """The width [m]: only bins that hold a gap are known, so that it may be less than their least distance. All of them are multiples
    of it, and it is 1, 2 or 5 times a power of ten."""
    if bins.size < 2:
        return 0.0
    filled, most = np.abs(bins[bins != 0.0]), np.diff(bins).min() * (1.0 + 1e-9)
    widths = sorted((factor * 10.0 ** power for power in range(-12, 7) for factor in (1.0, 2.0, 5.0)), reverse=True)
    return next((width for width in widths if width <= most and np.allclose(np.round(filled / width) * width, filled, rtol=1e-9, atol=0.0)), 0.0)


def interval(events: Array, count: Array) -> Tuple[Array, Array]:
    """Wilson's interval for the probability of an event, of as many standard errors as the figures show."""
    z = style.SHOWN_ERRORS
    share = events / count
    middle = (share + 0.5 * z ** 2 / count) / (1.0 + z ** 2 / count)
    half = z * np.sqrt(share * (1.0 - share) / count + 0.25 * (z / count) ** 2) / (1.0 + z ** 2 / count)
    return np.minimum(middle - half, share), np.maximum(middle + half, share)  # despite rounding


def draw(runs: Sequence[sp.Results], analyses: Sequence[sp.Analysis], titles: Sequence[str]) -> Figure:
    """Draws runs, one panel each, and beside them their probabilities, with the probability per step of their analyses."""
    names = style.names_of(titles, runs)
    if analyses and len(analyses) != len(runs):
        raise ValueError("--analysis: must be one for each of the {} runs, not {}".format(len(runs), len(analyses)))
    for run in runs:
        if not np.isfinite(run.gaps.smallest_gap).all():
            raise ValueError("{}: the smallest gap is not finite: no realization is complete".format(run.path))
    for run, analysis in zip(runs, analyses):
        require_same_platoon(run, analysis, analysis.numbers("collision.probability").size, with_means=True)
    columns = len(runs) + 1
    figure, axes = style.new_figure(1, columns, 5.7 * columns, 5.0)
    chances = axes[0, -1]
    for column, (run, name) in enumerate(zip(runs, names)):
        axes[0, column].set_title(style.column_title(column, columns, "{}, {}\n{}, seed {}{}\n{}".format(
            name, style.verdict(run.string_stable), style.counted(realizations_of(run.gaps)), run.seed,
            "" if run.complete else ", incomplete run", worst_in_words(run)), WIDE_LINE))
        draw_distribution(axes[0, column], run.gaps)
        draw_distances(axes[0, column], top_speed(run))
        looks = LOOKS if len(runs) == 1 else Looks(style.colour(column), style.colour(column), style.colour(column), style.marker(column))
        draw_probabilities(chances, run.gaps, analyses[column] if analyses else None, looks, "" if len(runs) == 1 else name + ": ")
    of_safe_gap = " or of\na gap below {:g} m".format(runs[0].gaps.safe_gap) if len(runs) == 1 and has_safe_gap(runs[0].gaps) else ""
    share_limits(axes[0, :-1], min(run.gaps.smallest_gap.min() for run in runs))
    for axis in axes[0, :-1]:
        style.mark_collisions(axis)
    limit_probabilities(chances, min(DEEPEST / realizations_of(run.gaps) for run in runs))
    chances.set_title(style.column_title(columns - 1, columns, "probability of a collision{}\nmeasured with $\\pm${} standard errors".format(
        of_safe_gap, style.SHOWN_ERRORS)))
    for axis in axes[0]:
        style.follower_axis(axis, max(run.followers for run in runs))
    # Panels below each other with the same entries share the legend below the last of them.
    style.legends_below([axis for axis, following in zip(axes[0], [*axes[0, 1:], None])
                         if not style.is_narrow() or following is None or labels_of(axis) != labels_of(following)])
    return figure


def labels_of(axes: Axes) -> List[str]:
    return list(axes.get_legend_handles_labels()[1])


class Looks(NamedTuple):
    """The colours of one run's probabilities, and the marker of its measurement."""

    measured: str
    bound: str
    per_step: str
    marker: str


LOOKS = Looks(style.PALETTE[0], style.BOUND, style.PALETTE[3], "o")


def share_limits(panels: style.AxesGrid, smallest: float) -> None:
    """The same vertical axis in all panels, with room for the marks at the smallest gap: the axis of bars ends at the lowest one."""
    low, high = (pick(axis.get_ylim()[end] for axis in panels) for end, pick in ((0, min), (1, max)))
    low = min(low, smallest - ROOM * (high - low))
    for axis in panels:
        axis.set_ylim(low, high)


def realizations_of(gaps: sp.Gaps) -> int:
    return int(gaps.count.max())


def worst_of(gaps: sp.Gaps) -> int:
    """The row of the follower with the smallest gap, the first of equal ones."""
    return int(np.argmin(gaps.smallest_gap))


def worst_in_words(run: sp.Results) -> str:
    gaps, row = run.gaps, worst_of(run.gaps)
    return "smallest gap {} m: follower {}, realization {}, {}".format(
        style.signed(gaps.smallest_gap[row]), row + 1, style.spaced(int(gaps.realization[row])), style.time_of_step(run, int(gaps.step[row])))


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
    axes.set_ylabel("smallest gap of a realization [m]")


def top_speed(run: sp.Results) -> float:
    """The largest speed of the leader by its drive or profile [m/s]; NaN for a model without sample period."""
    leader, period = run.summary["configuration"]["model"].get("leader", {"speed": []}), style.period_of(run)
    if np.isnan(period):
        return period
    if "positions" in leader:
        driven = np.array(leader["positions"], dtype=float)[:int(run.steps.max()) + 2]
        return float(np.diff(driven).max() / period)
    return max([float(part["value"]) for part in leader["speed"] if part["from_step"] <= run.steps.max()], default=0.0)


def regulation_distance(speed: float) -> float:
    """Distance [m] behind another vehicle above 10 km/h: (1 s + v / (100 km/h) s) v, at least 2 m.

    Source: Regulation::MinDist of esmini's ControllerALKS_R157SM, after UN R157, 5.2.3.3."""
    return max(speed * (1.0 + 3.6 * speed / 100.0), 2.0)


def responsibility_distance(speed: float) -> float:
    """Safe longitudinal distance [m] of Responsibility-Sensitive Safety at equal speeds v.

    v r + a r^2 / 2 + (v + a r)^2 / (2 b) - v^2 / (2 c), at least 0: response time r = 1 s, then brakes of at least b = 4 m/s^2 behind
    a vehicle that brakes with at most c = 8 m/s^2; a = 3.5 m/s^2 during the response. Source: Shalev-Shwartz, Shammah, Shashua (2017);
    values as Apollo sets them in ad-rss-lib (rss_config_default_dynamics)."""
    response, acceleration, own, ahead = 1.0, 3.5, 4.0, 8.0
    after = speed + acceleration * response
    return max(speed * response + 0.5 * acceleration * response ** 2 + after ** 2 / (2.0 * own) - speed ** 2 / (2.0 * ahead), 0.0)


def draw_distances(axes: Axes, speed: float) -> None:
    """Draws the distances of R157 and RSS at a speed above 10 km/h; the axis contains those below twice its largest gap."""
    if not 3.6 * speed >= 10.0:
        return
    high = axes.get_ylim()[1]
    for name, distance, colour in (("R157", regulation_distance(speed), style.PALETTE[3]), ("RSS", responsibility_distance(speed), style.PALETTE[4])):
        label = "{} at {:.3g} m/s: {:.3g} m".format(name, speed, distance)
        if distance <= 2.0 * high:
            axes.axhline(distance, color=colour, linewidth=1.2, linestyle=":", label=label)
            axes.set_ylim(min(axes.get_ylim()[0], 0.95 * distance), max(axes.get_ylim()[1], 1.05 * distance))
        else:
            axes.plot([], [], color=colour, linewidth=1.2, linestyle=":", label=label + ", above")


def draw_probabilities(axes: Axes, gaps: sp.Gaps, analysis: Optional[sp.Analysis], looks: Looks, of: str) -> None:
    """Draws shares and probabilities of one run; `of` begins their labels."""
    lowest = DEEPEST / realizations_of(gaps)
    safe = not of and has_safe_gap(gaps)
    draw_shares(axes, gaps, gaps.collisions, looks.measured, looks.marker, "collision" if safe else "per realization", "no collision", of)
    draw_theory(axes, np.minimum(gaps.theoretical_collision_bound, 1.0), lowest, looks.bound, "-", of + "per realization, upper bound by theory")
    if safe:
        event = "gap below {:g} m".format(gaps.safe_gap)
        draw_shares(axes, gaps, gaps.below_safe_gap, SAFE, "s", event, "no " + event)
    if analysis is not None:
        limit = analysis.number("collision.limit_probability")
        draw_theory(axes, analysis.numbers("collision.probability"), lowest, looks.per_step, "-.", of + "per step, theory")
        label = of + "per step, endless string: {:.3g}".format(limit)
        if limit >= lowest:
            axes.axhline(limit, color=looks.per_step, linewidth=1.0, linestyle=style.DASHED, label=label)
        elif limit >= 0.0:
            axes.plot([], [], color=looks.per_step, linewidth=1.0, linestyle=style.DASHED, label=label)


def draw_theory(axes: Axes, probability: Array, lowest: float, colour: str, dashes: str, label: str) -> None:
    """Draws a probability per follower. The legend gives the largest one where all of them are below the axis."""
    followers = np.arange(1, probability.size + 1)
    known = probability[~np.isnan(probability)]
    if not known.size:
        return
    seen = known.max() >= lowest
    axes.plot(followers if seen else [], visible(probability) if seen else [], color=colour, linewidth=1.3, linestyle=dashes,
              marker="." if followers.size <= SPARSE else "", label=label if seen else label + ": at most {:.3g}".format(known.max()))


def has_safe_gap(gaps: sp.Gaps) -> bool:
    return bool(np.isfinite(gaps.below_safe_gap).any())


def limit_probabilities(axes: Axes, lowest: float) -> None:
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    low = max(low, lowest)
    axes.set_ylim(low, min(max(high, 100.0 * low), 2.0))
    axes.set_ylabel("probability")


def visible(probability: Array) -> Array:
    """The probabilities with NaN in place of zeros, which a logarithmic axis does not have."""
    return np.where(probability > 0.0, probability, np.nan)


def draw_shares(axes: Axes, gaps: sp.Gaps, events: Array, colour: str, marker: str, event: str, none: str, of: str = "") -> None:
    """Draws the share of the realizations per follower; a triangle is the upper end of the interval where there is no event. `of` begins the labels,
    which name the event and its absence."""
    at = style.thinned(gaps.count.size, style.MANY)
    low, high = interval(events[at], gaps.count[at])
    seen = events[at] > 0
    share = events[at] / gaps.count[at]
    if seen.any():
        axes.errorbar(at[seen] + 1, share[seen], yerr=[(share - low)[seen], (high - share)[seen]], fmt=marker, color=colour,
                      markerfacecolor="white", label=of + event + ", measured", zorder=3, **style.POINTS)
    if not seen.all():
        axes.plot(at[~seen] + 1, high[~seen], "v", color=colour, markerfacecolor="none", markersize=5, alpha=0.7,
                  label=of + "{} in {}: upper limit".format(none, style.spaced(realizations_of(gaps))))
