"""Variance of the last vehicle over a swept parameter: measured with standard errors, theory as lines."""

import csv
import io
from collections import namedtuple

import numpy as np

from plotting import style
from plotting.inputs import InputError, drawable, read_text

WIDE_RANGE = 30.0  # variances that differ by more than this factor need a logarithmic axis
MEASURED = ["variance", "variance_standard_error", "theoretical_variance", "string_stable"]
COLUMNS = ["point", "vehicle", "step", "count", "mean", "mean_standard_error", "variance", "variance_standard_error",
           "theoretical_mean", "theoretical_variance", "string_stable", "agrees"]

# The last vehicles of a sweep: the parameter on the horizontal axis, and for each curve its name and arrays over it.
Tails = namedtuple("Tails", "over curves")
Curve = namedtuple("Curve", "name at variance variance_standard_error theoretical_variance string_stable")


def number_of(path, line, name, text):
    try:
        return float(text) if text else float("nan")
    except ValueError:
        raise InputError("{}: line {}: {} is {}: must be a number".format(path, line, name, text))


def read_rows(path):
    """The names of the varied parameters, and for each point the row of the last vehicle at its last step."""
    lines = list(csv.reader(io.StringIO(read_text(path))))
    heading = lines[0] if lines else []
    missing = [name for name in COLUMNS if name not in heading]
    if missing:
        raise InputError("{}: {}".format(path, "column {} is missing".format(missing[0]) if heading else "is empty"))
    varied = [name for name in heading if name not in COLUMNS]
    if not varied:
        raise InputError("{}: nothing varies in it".format(path))
    last = {}
    for at, row in enumerate(lines[1:], 2):
        if len(row) != len(heading):
            raise InputError("{}: line {} has {} values instead of {}".format(path, at, len(row), len(heading)))
        named = dict(zip(heading, row), line=at)
        place = [number_of(path, at, name, named[name]) for name in ("vehicle", "step")]
        if named["point"] not in last or place >= last[named["point"]][0]:
            last[named["point"]] = (place, named)
    if not last:
        raise InputError("{}: holds no rows, only its heading".format(path))
    return varied, [row for _, row in last.values()]


def is_number(text):
    try:
        return np.isfinite(float(text))
    except ValueError:
        return False


def chosen_axis(path, varied, rows, over):
    """The parameter `over` if given, otherwise the numeric parameter with the most values."""
    if over:
        if over not in varied:
            raise InputError("--over: {}: must be what varies in {}: {}".format(over, path, ", ".join(varied)))
        for row in rows:
            number_of(path, row["line"], over, row[over] or "nothing")
        return over
    numeric = [name for name in varied if all(is_number(row[name]) for row in rows)]
    if not numeric:
        raise InputError("{}: no number varies in it: {}".format(path, ", ".join(varied)))
    return max(numeric, key=lambda name: len({row[name] for row in rows}))


def read_tails(path, over=None):
    varied, rows = read_rows(path)
    over = chosen_axis(path, varied, rows, over)
    # Paired axes move together: a parameter with a different value at every point of the axis does not define curves.
    others = [name for name in varied if name != over]
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[name] for name in others), []).append(row)
    if len(groups) == len(rows) and len(rows) > len(style.PALETTE):
        groups, others = {(): rows}, []
    if len(groups) > len(style.PALETTE):
        raise InputError("{}: {} curves over {}: must be at most {}: sweep less, or --over another".format(
            path, len(groups), over, len(style.PALETTE)))
    curves = []
    for values, group in groups.items():
        group.sort(key=lambda row: float(row[over]))
        at = np.array([float(row[over]) for row in group])
        columns = {name: drawable(np.array([number_of(path, row["line"], name, row[name]) for row in group]))
                   for name in MEASURED}
        name = ", ".join("{} = {}".format(label, "{:g}".format(float(value)) if is_number(value) else value)
                         for label, value in zip(others, values))
        curves.append(Curve(name, at, **columns))
    if not any(np.isfinite(curve.variance).any() for curve in curves):
        raise InputError("{}: variance is NaN everywhere: nothing to draw".format(path))
    return Tails(over, curves)


def draw(tails):
    figure, axes = style.new_figure(1, 1, 6.2, 4.2)
    axes = axes[0, 0]
    legend = []
    for at, curve in enumerate(tails.curves):
        legend += draw_curve(axes, curve, style.PALETTE[at], style.MARKERS[at % len(style.MARKERS)])
    if style.spread(np.concatenate([curve.variance for curve in tails.curves])[:, np.newaxis]) > WIDE_RANGE:
        style.logarithmic(axes)
    else:
        axes.set_ylim(bottom=0.0)
    names = {"headway": "time headway $h$ [samples]", "loss": "loss probability $q$",
             "noise_variance": "noise variance $P_d$ [m$^2$]", "delay": "delay [steps]", "followers": "followers $N$"}
    axes.set_xlabel(names.get(tails.over, tails.over.replace("$", "\\$")))
    axes.set_ylabel("variance of the last $\\zeta_i$ [m$^2$]")
    if any((curve.string_stable == 0).any() for curve in tails.curves):
        legend.append(style.legend_entry(marker="o", linestyle="", color=style.INK, markersize=4.5, label="not string stable"))
    if any((curve.string_stable == 1).any() for curve in tails.curves):
        legend.append(style.legend_entry(marker="o", linestyle="", color=style.INK, markersize=4.5,
                                         markerfacecolor="white", label="string stable"))
    axes.legend(handles=legend)
    return figure


def draw_curve(axes, curve, colour, marker):
    """Draws the theory and the measurements of a curve; returns the legend entries."""
    prefix = curve.name.replace("$", "\\$") + ": " if curve.name else ""
    legend = []
    if np.isfinite(curve.theoretical_variance).any():
        legend += axes.plot(curve.at, curve.theoretical_variance, color=colour, linewidth=1.3, label=prefix + "theory")
    many = curve.at.size > style.MANY
    label = "{}measured, $\\pm${} standard errors".format(prefix, style.SHOWN_ERRORS)
    shown = None
    for stable in (True, False):
        # Points without a verdict look like stable ones.
        part = (curve.string_stable != 0) if stable else (curve.string_stable == 0)
        if not part.any():
            continue
        shown = axes.errorbar(curve.at[part], curve.variance[part],
                              yerr=style.SHOWN_ERRORS * curve.variance_standard_error[part], fmt=marker, color=colour,
                              markersize=2.5 if many else 4.5, markerfacecolor="white" if stable else colour,
                              markeredgewidth=0.6 if many else 1.0, capsize=0 if many else 2.5,
                              elinewidth=0.7 if many else 1.0, label=label)
    return legend + [shown]
