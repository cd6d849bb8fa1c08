"""The smallest gaps of a run: their distribution per follower, and the probability of a collision along the string."""

import os
from collections import namedtuple

import numpy as np

from plotting import style
from plotting.inputs import (InputError, lookup, number, numbers_if_any, read_columns, read_summary, require_folder,
                             require_same_platoon, truth, truth_if_any)

COLUMNS = ["vehicle", "count", "smallest_gap", "realization", "step", "collisions", "below_safe_gap", "theoretical_collision_bound"]
BANDS = ((0.01, 0.99, "#c6dbef"), (0.25, 0.75, "#6baed6"))  # quantiles of the realizations, and their colour
PER_STEP = style.PALETTE[3]
SAFE = style.PALETTE[2]
BAR = 0.72  # width of a bar
SPARSE = 10  # a curve with at most so many points has a dot on each
DEEPEST = 1e-4  # the axis of probabilities reaches this far below one realization

# Arrays have an element per follower, histogram a row per follower and a column per bin; below_safe_gap and bound (the upper bound
# of the probability of a collision in a realization) are NaN where there is none, safe_gap [m] too.
GapRun = namedtuple("GapRun", "path name followers count smallest realization step collisions below_safe_gap bound bins histogram "
                              "safe_gap realizations seed complete spectral_radius string_stable")

# P(gap < 0) per step in the steady state, per follower and for an endless string (NaN where it does not exist).
Theory = namedtuple("Theory", "probability limit")


def read_gaps(path):
    """The smallest gaps of the run in a folder."""
    require_folder(path)
    table_path = os.path.join(path, "gaps.csv")
    if not os.path.exists(table_path):
        raise InputError("{}: no such file: run with signals:=gap (monte_carlo --signals gap)".format(table_path))
    columns = read_columns(table_path, COLUMNS, "bin_")
    followers = columns["vehicle"].size
    order = np.argsort(columns["vehicle"])
    if not np.array_equal(columns["vehicle"][order], np.arange(1, followers + 1)):
        raise InputError("{}: must hold one row for each vehicle 1..N; rows are missing or double".format(table_path))
    summary_path, summary = read_summary(path, "gaps", followers)
    bins, histogram = histogram_of(table_path, columns)
    table = {name: columns[name][order] for name in COLUMNS[1:]}
    if not np.array_equal(histogram[order].sum(axis=1), table["count"]):
        raise InputError("{}: the bins do not add up to count".format(table_path))
    if not np.isfinite(table["smallest_gap"]).all():
        raise InputError("{}: smallest_gap is not finite: no realization is complete".format(table_path))
    model = lookup(summary_path, summary, "configuration.model")
    return GapRun(path=path, name=os.path.basename(os.path.abspath(path)), followers=followers, count=table["count"],
                  smallest=table["smallest_gap"], realization=table["realization"], step=table["step"],
                  collisions=table["collisions"], below_safe_gap=table["below_safe_gap"], bound=table["theoretical_collision_bound"],
                  bins=bins, histogram=histogram[order],
                  safe_gap=number(summary_path, model, "safe_gap") if "safe_gap" in model else np.nan,
                  realizations=int(table["count"].max()), seed=lookup(summary_path, summary, "seed"),
                  complete=truth(summary_path, summary, "complete"),
                  spectral_radius=number(summary_path, summary, "theory.spectral_radius"),
                  string_stable=truth_if_any(summary_path, summary, "theory.string_stable"))


def histogram_of(path, columns):
    """The lower ends of the bins [m] in ascending order, and the counts as an array (rows of the file, bins)."""
    names = [name for name in columns if name.startswith("bin_")]
    try:
        bins = np.array([float(name[len("bin_"):]) for name in names])
    except ValueError as error:
        raise InputError("{}: the name of a column bin_X: {}".format(path, error))
    if not bins.size:
        raise InputError("{}: column bin_... is missing".format(path))
    order = np.argsort(bins)
    return bins[order], np.array([columns[names[at]] for at in order]).T


def read_theory(analysis, run):
    """The probabilities of an analysis of the same platoon."""
    probability = numbers_if_any(analysis.path, analysis.document, "collision.probability")
    require_same_platoon(run, analysis, probability.size)
    return Theory(probability, number(analysis.path, analysis.document, "collision.limit_probability"))


def quantile(run, share):
    """Per follower the smallest gap [m] that this share of the realizations falls below, linear within a bin."""
    width = np.diff(run.bins).min() if run.bins.size > 1 else 0.0
    result = np.empty(run.followers)
    for row, counts in enumerate(run.histogram):
        below = np.cumsum(counts)
        at = int(np.searchsorted(below, share * below[-1]))
        inside = (share * below[-1] - (below[at] - counts[at])) / max(counts[at], 1.0)
        result[row] = run.bins[at] + inside * width
    return np.maximum(result, run.smallest)


def interval(events, count):
    """Wilson's interval of so many standard errors as the figures show, for the probability of an event."""
    z = style.SHOWN_ERRORS
    share = events / count
    middle = (share + 0.5 * z ** 2 / count) / (1.0 + z ** 2 / count)
    half = z * np.sqrt(share * (1.0 - share) / count + 0.25 * (z / count) ** 2) / (1.0 + z ** 2 / count)
    return middle - half, middle + half


def draw(run, theory, titles):
    name, = style.names_of(titles, [run])
    figure, axes = style.new_figure(1, 2, 11.4, 5.0)
    gaps, chances = axes[0]
    gaps.set_title("(a) {}, {}\n{} realization{}, seed {}{}\n{}".format(
        name, style.verdict(run.string_stable), style.spaced(run.realizations), "s" * (run.realizations != 1), run.seed,
        "" if run.complete else ", incomplete run", worst_in_words(run)))
    chances.set_title("(b) probability of a collision\nmeasured with $\\pm${} standard errors".format(style.SHOWN_ERRORS))
    draw_distribution(gaps, run)
    draw_probabilities(chances, run, theory)
    for axis in (gaps, chances):
        style.follower_axis(axis, run.followers)
        style.legend_below(axis)
    return figure


def worst_of(run):
    """The row of the follower with the smallest gap, the first of equal ones."""
    return int(np.argmin(run.smallest))


def worst_in_words(run):
    row = worst_of(run)
    return "smallest gap {} m: follower {}, realization {}, step {}".format(
        style.signed(run.smallest[row]), row + 1, style.spaced(int(run.realization[row])), int(run.step[row]))


def draw_distribution(axes, run):
    """Draws quantiles of the smallest gap per realization, the smallest of all realizations, and the worst of these."""
    followers = np.arange(1, run.followers + 1)
    few = run.followers <= style.MANY
    for low, high, colour in BANDS:
        bottom, top = quantile(run, low), quantile(run, high)
        label = "{:g} % of the realizations".format(100 * (high - low))
        if few:
            axes.bar(followers, top - bottom, BAR, bottom, color=colour, label=label)
        else:
            axes.fill_between(followers, bottom, top, color=colour, linewidth=0, label=label)
    if few:
        axes.hlines(quantile(run, 0.5), followers - 0.5 * BAR, followers + 0.5 * BAR, color=style.INK, linewidth=1.2, label="median")
    else:
        axes.plot(followers, quantile(run, 0.5), color=style.INK, linewidth=1.2, label="median")
    axes.plot(followers, run.smallest, "v", color=style.PALETTE[0], markersize=4.5 if few else 2.0, label="smallest of all realizations")
    worst = worst_of(run)
    axes.plot([worst + 1], [run.smallest[worst]], "o", color=style.INK, markersize=9, markerfacecolor="none", markeredgewidth=1.4)
    if np.isfinite(run.safe_gap):
        axes.axhline(run.safe_gap, color=SAFE, linewidth=1.2, linestyle=(0, (5, 2.5)), label="safe gap {:g} m".format(run.safe_gap))
    style.mark_collisions(axes)
    axes.set_ylabel("smallest gap of a realization [m]")


def draw_probabilities(axes, run, theory):
    followers = np.arange(1, run.followers + 1)
    dots = "." if run.followers <= SPARSE else ""
    lowest = DEEPEST / run.realizations
    draw_shares(axes, run, run.collisions, style.PALETTE[0], "o", "per realization, measured")
    if (run.bound >= lowest).any():
        axes.plot(followers, visible(np.minimum(run.bound, 1.0)), color=style.BOUND, linewidth=1.3, marker=dots,
                  label="per realization, upper bound by theory")
    if np.isfinite(run.below_safe_gap).any():
        draw_shares(axes, run, run.below_safe_gap, SAFE, "s", "gap below {:g} m, measured".format(run.safe_gap))
    if theory:
        if (theory.probability >= lowest).any():
            axes.plot(followers, visible(theory.probability), color=PER_STEP, linewidth=1.3, linestyle="-.", marker=dots,
                      label="per step, theory")
        if theory.limit >= lowest:
            axes.axhline(theory.limit, color=PER_STEP, linewidth=1.0, linestyle=(0, (5, 2.5)),
                         label="per step, endless string: {:.3g}".format(theory.limit))
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    low = max(low, lowest)
    axes.set_ylim(low, min(max(high, 100.0 * low), 2.0))
    axes.set_ylabel("probability")


def visible(probability):
    """The probabilities with NaN in place of zeros, which a logarithmic axis does not have."""
    return np.where(probability > 0.0, probability, np.nan)


def draw_shares(axes, run, events, colour, marker, label):
    """Draws the share of the realizations per follower; a triangle is the upper end of the interval where there is no event."""
    at = style.thinned(run.followers, style.MANY)
    low, high = interval(events[at], run.count[at])
    seen = events[at] > 0
    share = events[at] / run.count[at]
    if seen.any():
        axes.errorbar(at[seen] + 1, share[seen], yerr=[(share - low)[seen], (high - share)[seen]], fmt=marker, color=colour,
                      markerfacecolor="white", markersize=4.5, elinewidth=1.0, capsize=2.5, label=label, zorder=3)
    if not seen.all():
        axes.plot(at[~seen] + 1, high[~seen], "v", color=colour, markerfacecolor="none", markersize=5, alpha=0.7,
                  label="none in {}: upper limit".format(style.spaced(run.realizations)))
