"""String stability over two of headway, gain, loss probability and mean burst: the peak of |T|, or over losses and bursts the loss
gain, and the regions without a verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, List

import numpy as np
import stochastic_platoon as sp
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, FuncFormatter

from plotting import style
from plotting.values import Array, drawable, require_some

# Headway and gain of the paper's numerical example, and the side and alignment of the label.
PAPER_POINTS = ((3.2, 1.35, 1, "left"), (2.4, 1.35, -1, "right"))
PAPER_RADII = (0.5274, 0.6546)
BORDER = style.PALETTE[0]
REACH = 0.4  # share of the distance of two grid points by which the border may lie beside their middle
HIGHEST_PEAK = 10.0  # higher peaks share the last colour
HIGHEST_LOSS_GAIN = 2.0
LABELS = {"headway": "time headway $h$ [sample periods]", "gain": "controller gain", "loss": "loss probability $q$",
          "mean_burst": "mean burst $b$ [steps]"}
WIDTH = 6.4  # [inch]: two columns of the legend fit
PEAK_TICKS = [1, 1.2, 1.5, 2, 3, 5, 10]


def edges(centres: Array) -> Array:
    """The edges of the cells around the centres of a grid."""
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate((2 * centres[:1] - middle[:1], middle, 2 * centres[-1:] - middle[-1:]))


def draw(given: sp.StabilityMap) -> Figure:
    values = {name: drawable(getattr(given, name)) for name in ("spectral_radius", "peak_gain", "string_stable", "loss_gain")}
    for name in ("spectral_radius", "peak_gain", "string_stable"):
        require_some(given.path, name, values[name])
    stability = replace(given, **values)
    figure, axes = style.new_figure(1, 1, WIDTH, 4.6)
    axes = axes[0, 0]
    axes.grid(False)
    if "headway" in (stability.over, stability.up):
        draw_peaks(figure, axes, stability)
    else:
        draw_loss_gains(figure, axes, stability)
    entries: List[Any] = []
    if np.nanmax(stability.spectral_radius) > 1.0:
        axes.contourf(stability.xs, stability.ys, stability.spectral_radius,
                      levels=[1.0, np.nanmax(stability.spectral_radius) + 1.0], colors="white", hatches=["////"])
        entries.append(hatched("////", "loop unstable, $\\rho(A) \\geq 1$"))
    impossible = np.isnan(stability.spectral_radius)  # no Markov chain has these losses, so no loop exists
    undefined = np.isnan(stability.peak_gain) & ~(stability.spectral_radius >= 1.0) & ~impossible  # no finite variance exists
    for region, hatch, label in ((undefined, "\\\\\\\\", "not mean square stable"), (impossible, "..", "no such losses: $b < q / (1 - q)$")):
        if region.any():
            axes.contourf(stability.xs, stability.ys, region.astype(float), levels=[0.5, 1.5], colors="white", hatches=[hatch])
            entries.append(hatched(hatch, label))
    if draw_border(axes, stability):
        entries.insert(0, style.legend_entry(color=BORDER, linewidth=1.8, label="string stability border, between grid points"))
    if stability.up == "gain":
        entries += mark_paper_points(axes, stability)
    axes.set_xlim(stability.xs[0], stability.xs[-1])
    axes.set_ylim(stability.ys[0], stability.ys[-1])
    axes.set_xlabel(LABELS[stability.over])
    axes.set_ylabel(LABELS[stability.up])
    axes.legend(handles=entries, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=1 if figure.get_figwidth() < WIDTH else 2,
                frameon=False, columnspacing=1.0, handlelength=1.5, handletextpad=0.5)
    return figure


def hatched(hatch: str, label: str) -> Patch:
    return Patch(facecolor="white", edgecolor="#9a9a9a", hatch=hatch, label=label)


def draw_peaks(figure: Figure, axes: Axes, stability: sp.StabilityMap) -> None:
    # The peak grows without bound towards rho = 1: cells beyond that border take the last colour, and the hatching
    # on top of them gives a smooth border.
    unstable = stability.spectral_radius >= 1.0
    peaks = np.where(unstable, 2.0 * HIGHEST_PEAK, np.maximum(stability.peak_gain, 1.0))
    draw_cells(figure, axes, stability, peaks, LogNorm(1.0, HIGHEST_PEAK), "peak gain $\\max_\\omega |T(e^{j\\omega})|$",
               ticks=FixedLocator(PEAK_TICKS), format=FuncFormatter(lambda value, _: "{:g}".format(value))).minorticks_off()


def draw_loss_gains(figure: Figure, axes: Axes, stability: sp.StabilityMap) -> None:
    # If |T^| exceeds 1, the loss gain does not exist: these cells take the last colour.
    gains = np.where(np.isnan(stability.loss_gain) & (stability.peak_gain > 1.0), 2.0 * HIGHEST_LOSS_GAIN, stability.loss_gain)
    draw_cells(figure, axes, stability, gains, Normalize(0.0, HIGHEST_LOSS_GAIN), "loss gain")


def draw_cells(figure: Figure, axes: Axes, stability: sp.StabilityMap, values: Array, norm: Normalize, label: str, **options: Any) -> Any:
    """Colours the cells by their values; returns the colour bar."""
    mesh = axes.pcolormesh(edges(stability.xs), edges(stability.ys), values, cmap="YlOrBr", norm=norm, rasterized=True)
    bar = figure.colorbar(mesh, ax=axes, extend="max", aspect=30, pad=0.02, **options)
    bar.set_label(label)
    return bar


def draw_border(axes: Axes, stability: sp.StabilityMap) -> bool:
    """Returns whether the map has a border."""
    if stability.string_stable.min() > 0.5 or stability.string_stable.max() < 0.5:
        return False
    lines = border_lines(stability)
    for line in lines:
        axes.plot(*line.T, color=BORDER, linewidth=1.8)
    return bool(lines)


def border_lines(stability: sp.StabilityMap) -> List[Array]:
    """Lines that separate the points of the grid judged string stable from those that are not. Where between two points the verdict changes
    is not known."""
    rows, columns = stability.string_stable.shape
    contour = Figure().subplots().contour(np.arange(columns), np.arange(rows), stability.string_stable, levels=[0.5], corner_mask=False)
    lines = [smoothed(np.array(line)) for line in contour.allsegs[0] if len(line) > 0]
    return [np.column_stack([np.interp(line[:, at], np.arange(of.size), of) for at, of in enumerate((stability.xs, stability.ys))])
            for line in lines]


def smoothed(line: Array) -> Array:
    """A contour line of a grid with unit distances without its staircase. Each point is half way between two points of the grid with
    different verdicts, and moves between them only, so that the line still has each on its side; the ends stay."""
    movable = np.abs(line - np.round(line)) > 0.25
    low, high = np.where(movable, line - REACH, line), np.where(movable, line + REACH, line)
    closed = len(line) > 2 and np.array_equal(line[0], line[-1])
    for _ in range(min(30, len(line) // 4)):
        if closed:
            ring = line[:-1]
            ring = np.clip(0.5 * ring + 0.25 * (np.roll(ring, 1, axis=0) + np.roll(ring, -1, axis=0)), low[:-1], high[:-1])
            line = np.vstack((ring, ring[:1]))
        else:
            line = np.vstack((line[:1], np.clip(0.5 * line[1:-1] + 0.25 * (line[:-2] + line[2:]), low[1:-1], high[1:-1]), line[-1:]))
    return line


def is_papers(stability: sp.StabilityMap) -> bool:
    """Whether the map is that of the paper's example: the spectral radius of its two points is that of the nearest cells."""
    for (headway, gain, *_), radius in zip(PAPER_POINTS, PAPER_RADII):
        row, column = np.abs(stability.ys - gain).argmin(), np.abs(stability.xs - headway).argmin()
        if not abs(stability.spectral_radius[row, column] - radius) < 0.1:
            return False
    return not np.any(stability.loss_gain > 0.0)


def mark_paper_points(axes: Axes, stability: sp.StabilityMap) -> List[Any]:
    """Marks the points of the paper's example if the map has them; returns their entry of the legend."""
    shown = [point for point in PAPER_POINTS
             if stability.xs[0] <= point[0] <= stability.xs[-1] and stability.ys[0] <= point[1] <= stability.ys[-1]]
    if not shown or not is_papers(stability):
        return []
    for headway, gain, side, alignment in shown:
        axes.plot([headway], [gain], "o", color=style.INK, markerfacecolor="white", markersize=6)
        axes.annotate("$h = {:g}$".format(headway), (headway, gain), xytext=(7 * side, 0), ha=alignment,
                      va="center", textcoords="offset points", path_effects=[withStroke(linewidth=2.5, foreground="white")])
    return [style.legend_entry(color=style.INK, marker="o", linestyle="", markerfacecolor="white", markersize=6, label="the paper's example")]
