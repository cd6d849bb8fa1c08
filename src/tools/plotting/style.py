"""The common style of all figures, and the parts that several of them share."""

from __future__ import annotations

import re
import textwrap
from typing import TYPE_CHECKING, Any, List, Optional, Protocol, Sequence, Tuple, Union

import matplotlib
import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.mathtext import MathTextParser
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from plotting.values import Array

if TYPE_CHECKING:
    from numpy.typing import NDArray

    AxesGrid = NDArray[np.object_]
    Indices = NDArray[np.int_]

Line = Union[str, Tuple[float, Tuple[float, ...]]]  # a line style

# Okabe and Ito's colours, which colour-blind readers can distinguish.
PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
INK = "#222222"
GREY = "#8a8a8a"
BOUND = "#D55E00"
DASHED: Line = (0, (5, 2.5))
SHORT_DASHED: Line = (0, (3, 1.5))

# First follower dark blue, last dark red, as in the paper; no colour is too light for a line on white.
FOLLOWERS = LinearSegmentedColormap.from_list(
    "followers", ["#08205c", "#1f5fb4", "#3ba3c8", "#7fb77e", "#e3b23c", "#e0702b", "#c0261f", "#5c0410"])

MARKERS = "os^Dv<>"
POINTS = {"markersize": 4.5, "elinewidth": 1.0, "capsize": 2.5}  # measurements with error bars
LINE = 50  # characters per line of a column's title
LETTERS = 12.0  # in a line of text per inch
LEGEND_LINE = 0.16  # [inch]
FORMULA = re.compile(r"(?<!\\)\$.*?(?<!\\)\$")
MANY = 60  # a curve with more points than this gets no marker on each
MOST_CURVES = 40  # longer strings show only some followers
CURVES_OF_MANY = 16
SHOWN_ERRORS = 2  # half length of error bars in standard errors
FAR = 3.0  # gaps farther above 0 than this multiple of their range are drawn without the line gap = 0
WIDE_RANGE = 1000.0  # curves that differ by more than this factor need a logarithmic axis
WIDE_STRING = 30.0  # the same for the variances along a string


NARROW = 5.2  # [inch]: a narrower figure has its panels below each other
WIDTHS = (40.0, 400.0)  # [mm] of a figure


class Named(Protocol):
    @property
    def name(self) -> str: ...


def apply(width: Optional[float] = None) -> None:
    """Sets the style, independent of the user's matplotlib settings. `width`: of all figures [mm]; each has its own without it.
    Raises ValueError."""
    global chosen_width
    if width is not None and not WIDTHS[0] <= width <= WIDTHS[1]:
        raise ValueError("--width: {:g}: must be from {:g} to {:g} mm".format(width, *WIDTHS))
    chosen_width = None if width is None else width / 25.4
    matplotlib.rcdefaults()
    matplotlib.rcParams.update({
        "figure.dpi": 100, "savefig.dpi": 200, "pdf.fonttype": 42, "svg.hashsalt": "platoon",
        "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 9.5, "axes.labelsize": 9.5,
        "legend.fontsize": 8.5, "xtick.labelsize": 8.5, "ytick.labelsize": 8.5,
        "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": INK, "axes.linewidth": 0.8,
        "axes.grid": True, "axes.formatter.useoffset": False, "grid.color": "#e4e4e4", "grid.linewidth": 0.6, "axes.axisbelow": True,
        "legend.framealpha": 0.9, "legend.edgecolor": "#cccccc", "legend.fancybox": False,
        "figure.constrained_layout.w_pad": 0.06, "figure.constrained_layout.h_pad": 0.05,
        "hatch.linewidth": 0.6, "hatch.color": "#9a9a9a",
    })
    if is_narrow():
        matplotlib.rcParams.update({"font.size": 7.5, "axes.titlesize": 7.5, "axes.labelsize": 7.5, "legend.fontsize": 7, "xtick.labelsize": 7,
                                    "ytick.labelsize": 7})


def is_narrow() -> bool:
    """Whether the chosen width leaves room for one panel only."""
    return chosen_width is not None and chosen_width < NARROW


chosen_width: Optional[float] = None  # [inch]


def new_figure(rows: int, columns: int, width: float, height: float) -> Tuple[Figure, Any]:
    """A figure and its axes as an array (rows, columns). With a chosen width the panels keep their shape, but those of a narrow
    figure lie below each other, column by column."""
    if chosen_width is None or columns == 1 or not is_narrow():
        wanted = chosen_width or width
        figure = Figure(figsize=(wanted, height * max(min(wanted / width, 1.0), 0.62)), constrained_layout=True)
        return figure, figure.subplots(rows, columns, squeeze=False, sharex="col")
    panel = height / rows * min(1.0, chosen_width / (width / columns))
    figure = Figure(figsize=(chosen_width, rows * columns * max(panel, 1.9)), constrained_layout=True)
    return figure, figure.subplots(rows * columns, 1, squeeze=False).reshape(columns, rows).T


def column_title(column: int, columns: int, text: str, longest: int = LINE) -> str:
    """The text in lines that fit a column, of at most `longest` characters, with a letter in front if there are several columns."""
    text = "({}) {}".format(chr(ord("a") + column), text) if columns > 1 else text
    if chosen_width is not None:
        longest = max(20, min(longest, int(15.0 * chosen_width / (1 if is_narrow() else columns))))
    return lines_of(text, longest)


def lines_of(text: str, longest: int) -> str:
    return "\n".join(wrapped(line, longest) for line in text.split("\n"))


def wrapped(line: str, longest: int) -> str:
    """The text in lines of at most `longest` characters, or longer ones where a formula is: it stays whole."""
    marked, formulas = FORMULA.subn(lambda formula: formula.group().replace(" ", "\0"), line)
    return textwrap.fill(marked, longest, break_long_words=not formulas, break_on_hyphens=not formulas).replace("\0", " ")


def verdict(string_stable: Optional[bool]) -> str:
    return {None: "no verdict", True: "string stable", False: "not string stable"}[string_stable]


def period_of(run: sp.Results) -> float:
    """T_s [s]; NaN for runs of versions that did not write it."""
    try:
        return run.sample_period
    except ValueError:
        return float("nan")


def time_of_step(run: sp.Results, step: int) -> str:
    """9.9 s (step 99)."""
    period, words = period_of(run), "step {}".format(spaced(step))
    return words if np.isnan(period) else "{:.4g} s ({})".format(step * period, words)


def end_of_average(run: sp.Results) -> str:
    """Where the averages over time of a run end: up to 9.9 s (step 99); paused, if no step of its latest attempt is in them."""
    step = int(run.steps[-1])
    return "up to " + time_of_step(run, step) if step >= 0 else "(paused)"


def follower_ticks(followers: int) -> List[float]:
    """First, last and round numbers between them, without those so close to the ends that the labels would touch."""
    between = MaxNLocator(nbins=5, steps=[1, 2, 5, 10], integer=True).tick_values(1, followers)
    room = 0.05 * followers
    return [1] * (followers > 1) + [t for t in between if 1 + room < t < followers - room] + [followers]


def follower_axis(axes: Axes, followers: int) -> None:
    axes.set_xlabel("follower $i$")
    axes.set_xticks(follower_ticks(followers))
    pad = 0.5 if followers < 30 else 0.02 * followers
    axes.set_xlim(1 - pad, followers + pad)


def colour(at: int) -> str:
    """The colour of a figure's input `at`."""
    return PALETTE[at % len(PALETTE)]


def marker(at: int) -> str:
    return MARKERS[at % len(MARKERS)]


def drawn_followers(followers: int) -> Indices:
    """Rows of the followers whose curves are drawn."""
    return thinned(followers, followers if followers <= MOST_CURVES else CURVES_OF_MANY)


def follower_colours(followers: int) -> ScalarMappable:
    """The colours of the followers by to_rgba(i)."""
    colours = ScalarMappable(Normalize(1, max(followers, 2)), FOLLOWERS)
    colours.set_array([])
    return colours


def add_colour_bar(figure: Figure, axes: AxesGrid, colours: ScalarMappable, followers: int) -> None:
    bar = figure.colorbar(colours, ax=list(axes.flat), location="top", aspect=60, fraction=0.05, pad=0.02)
    bar.set_label("follower $i$")
    bar.set_ticks(follower_ticks(followers))
    bar.outline.set_visible(False)


def draw_theory(axes: Axes, values: Array, first: int = 1, **look: Any) -> List[Line2D]:
    """Draws a curve along the string, whose first value belongs to vehicle `first`."""
    lines: List[Line2D] = axes.plot(first + np.arange(values.size), values, marker="_" if values.size == 1 else "", **look)
    return lines


def draw_measured(axes: Axes, values: Array, half_lengths: Optional[Array] = None, **look: Any) -> Any:
    """Draws points along the string with error bars; NaN: without. Returns the legend entry."""
    at = thinned(values.size, MANY)
    bars = None if half_lengths is None or not np.isfinite(half_lengths).any() else half_lengths[at]
    return axes.errorbar(at + 1, values[at], yerr=bars, **POINTS, **look)


def spread(curves: Array) -> float:
    """Ratio of the largest to the smallest peak of the curves (rows of an array), or of these values; 1 if all are zero."""
    magnitude = np.where(np.isfinite(curves), np.abs(curves), 0.0)
    peaks = magnitude.reshape(len(magnitude), -1).max(axis=1)
    peaks = peaks[peaks > 0.0]
    return float(peaks.max() / peaks.min()) if peaks.size else 1.0


def logarithmic(axes: Axes) -> None:
    """Sets a logarithmic y axis; labels are plain numbers if these are few and short."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if 1e-4 < low and high < 1e5:
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 1e3 * low else (1.0,)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: "{:g}".format(value)))
        axes.yaxis.set_minor_formatter(NullFormatter())


def thinned(size: int, most: int) -> Indices:
    """At most `most` evenly spaced indices of range(size), including both ends."""
    indices: Indices = np.unique(np.round(np.linspace(0, size - 1, min(size, most))).astype(int))
    return indices


def legend_entry(**line: Any) -> Line2D:
    return Line2D([], [], **line)


def legends_below(panels: Sequence[Axes], legends: Optional[Sequence[Sequence[Any]]] = None) -> None:
    """A legend below each of the panels, which lie side by side, or below each other in a narrow figure: there it hides no data. The
    figure grows by its lines. `legends`: the entries; without them those of the panels."""
    figure = panels[0].figure
    letters = int(LETTERS * figure.get_figwidth() / (1 if is_narrow() else len(panels)))
    heights = []
    for axes, entries in zip(panels, legends or [axes.get_legend_handles_labels()[0] for axes in panels]):
        labels = [lines_of(entry.get_label(), letters) if chosen_width is not None else entry.get_label() for entry in entries]
        longest = max((len(line) for label in labels for line in label.split("\n")), default=0)
        columns = 1 if is_narrow() or longest > 0.45 * letters else 2
        heights.append(sum(label.count("\n") + 1 for label in labels) / columns)
        axes.legend(entries, labels, loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=4.6, frameon=False, columnspacing=1.6,
                    ncol=columns)
    figure.set_figheight(figure.get_figheight() + LEGEND_LINE * (sum(heights) if is_narrow() else max(heights)))


def mark_collisions(axes: Axes) -> None:
    """Draws the line gap = 0 and shades the collisions below it, unless all gaps are far above it."""
    low, high = axes.get_ylim()
    if low > FAR * (high - low):
        return
    low, high = min(low, -0.04 * high), max(high, -0.04 * low)
    axes.axhline(0.0, color=BOUND, linewidth=1.2, label="gap 0: below it a collision")
    axes.axhspan(low, 0.0, color=BOUND, alpha=0.08, linewidth=0, zorder=0)
    axes.set_ylim(low, high)


def signed(value: float) -> str:
    """The value to three digits, with a minus sign as on the axes."""
    return "{:.3g}".format(value).replace("-", "\u2212")


def counted(realizations: int) -> str:
    return "{} realization{}".format(spaced(realizations), "s" * (realizations != 1))


def spaced(integer: int) -> str:
    """The integer with thin spaces between groups of three digits: 1 000 000."""
    return "{:,}".format(integer).replace(",", "\u2009")


def names_of(titles: Sequence[str], cases: Sequence[Named]) -> List[str]:
    """The titles if given, otherwise the names of the cases."""
    if not titles:
        return [case.name.replace("$", "\\$") for case in cases]
    if len(titles) != len(cases):
        raise ValueError("--titles: must be one for each of the {} inputs, not {}".format(len(cases), len(titles)))
    for title in titles:
        try:
            MathTextParser("path").parse(title)
        except ValueError as error:
            raise ValueError("--titles: {}: {}".format(title, str(error).strip().splitlines()[-1]))
    return list(titles)
