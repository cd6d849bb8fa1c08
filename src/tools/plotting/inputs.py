"""Reads and checks the inputs of the figures: run folders, analyses and stability maps.

Every fault raises InputError, which names the file and the fault.
"""

import json
import os
import re
import zlib
from collections import namedtuple

import numpy as np

# A run folder. count, mean [m], variance [m^2], theoretical_mean, theoretical_variance have a row per follower and
# a column per step (one column for time averages); steps holds the columns' step numbers. standard_error_of_variance
# [m^2] has an element per follower, at the last step; unknown ones are NaN.
class Run(namedtuple("Run", "path name steps count mean variance theoretical_mean theoretical_variance "
                            "standard_error_of_variance realizations seed complete time_average spectral_radius string_stable")):
    @property
    def followers(self):
        return self.mean.shape[0]


# An output file of `analyze --json`: its path, a name for labels, and its content.
Analysis = namedtuple("Analysis", "path name document")

# Columns of a map over headway (columns) and gain or loss probability (rows), each value an array (heights, headways).
StabilityMap = namedtuple("StabilityMap", "over xs up ys spectral_radius peak_gain string_stable loss_gain")

STATISTICS = ["vehicle", "step", "count", "mean", "variance", "theoretical_mean", "theoretical_variance"]
AXES = ["headway", "gain", "loss", "mean_burst"]  # of a map
MAP_VALUES = ["spectral_radius", "peak_gain", "string_stable"]


LARGEST = 1e150  # larger values, of unstable loops, overflow when squared and do not fit on an axis


class InputError(Exception):
    """Input that cannot be drawn; the message names the file and the fault."""


def read_text(path):
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except FileNotFoundError:
        raise InputError("{}: no such file".format(path))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("{}: cannot be read: {}".format(path, getattr(error, "strerror", None) or "not text"))


def read_json(path):
    try:
        document = json.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise InputError("{}: not JSON: {}".format(path, error))
    if not isinstance(document, dict):
        raise InputError("{}: must be a JSON object".format(path))
    return document


def lookup(path, document, key):
    """The value of a dotted key such as "norms.mean_l2"."""
    value = document
    for part in key.split("."):
        if not isinstance(value, dict) or part not in value:
            raise InputError("{}: {} is missing".format(path, key))
        value = value[part]
    return value


def number(path, document, key):
    """A number, NaN for null (a value that does not exist)."""
    value = lookup(path, document, key)
    if value is None:
        return float("nan")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError("{}: {} must be a number or null".format(path, key))
    return float(value) if abs(value) < LARGEST else float("nan")


def truth(path, document, key):
    value = lookup(path, document, key)
    if not isinstance(value, bool):
        raise InputError("{}: {} must be true or false".format(path, key))
    return value


def truth_if_any(path, document, key):
    """True, False, or None if there is no verdict."""
    return None if lookup(path, document, key) is None else truth(path, document, key)


def numbers(path, document, key):
    """A list of numbers as an array, NaN for null. Raises InputError unless at least one is finite."""
    array = numbers_if_any(path, document, key)
    require_some(path, key, array)
    return array


def numbers_if_any(path, document, key):
    """A list of numbers as an array, NaN for null."""
    values = lookup(path, document, key)
    if not isinstance(values, list) or not values:
        raise InputError("{}: {} must be a list of numbers, not empty".format(path, key))
    try:
        return drawable(np.array([np.nan if value is None else value for value in values], dtype=float))
    except (TypeError, ValueError, OverflowError):
        raise InputError("{}: {} must be a list of numbers".format(path, key))


def drawable(array):
    """The array with NaN in place of values that a figure cannot show."""
    with np.errstate(invalid="ignore"):
        return np.where(np.abs(array) < LARGEST, array, np.nan)


def require_some(path, what, array):
    if not np.isfinite(array).any():
        raise InputError("{}: {} is NaN everywhere: nothing to draw".format(path, what))


def read_columns(path, names, prefix=None):
    """The named columns of a CSV file with a heading, and those whose names begin with the prefix, each as an array of floats."""
    lines = read_text(path).splitlines()
    heading = [name.strip() for name in lines[0].split(",")] if lines else []
    for name in names:
        if name not in heading:
            reason = "column {} is missing".format(name) if heading else "is empty"
            raise InputError("{}: {}".format(path, reason))
    rows = lines[1:]
    if not rows:
        raise InputError("{}: holds no rows, only its heading".format(path))
    table = np.empty((len(rows), len(heading)))
    for at, row in enumerate(rows):
        values = row.split(",")
        if len(values) != len(heading):
            raise InputError("{}: line {} has {} values instead of {}"
                             .format(path, at + 2, len(values), len(heading)))
        try:
            # Without theory, its columns are empty.
            table[at] = [float(value) if value.strip() else np.nan for value in values]
        except ValueError as error:
            raise InputError("{}: line {}: {}".format(path, at + 2, error))
    more = [name for name in heading if prefix and name.startswith(prefix)]
    return {name: table[:, heading.index(name)] for name in list(names) + more}


def read_statistics(path):
    """The step numbers, and the columns of statistics.csv as arrays (followers, steps)."""
    columns = read_columns(path, STATISTICS)
    vehicle = columns.pop("vehicle")
    step = columns.pop("step")
    order = np.lexsort((step, vehicle))
    followers, steps = np.unique(vehicle).size, np.unique(step)
    if not np.array_equal(vehicle[order], np.repeat(np.arange(1, followers + 1), steps.size)) \
            or not np.array_equal(step[order], np.tile(steps, followers)):
        raise InputError("{}: must hold one row for each vehicle 1..N and step; rows are missing or double"
                         .format(path))
    table = {name: drawable(column)[order].reshape(followers, steps.size) for name, column in columns.items()}
    require_some(path, "mean", table["mean"])
    if not np.isfinite(table["variance"]).any():
        raise InputError("{}: variance is NaN everywhere: it takes at least two realizations".format(path))
    return steps, table


def read_run(path):
    """The run in a folder that a monitor, monte_carlo or bag_statistics wrote."""
    require_folder(path)
    steps, table = read_statistics(os.path.join(path, "statistics.csv"))
    summary_path, summary = read_summary(path, "statistics", table["mean"].shape[0])
    time_average = truth(summary_path, summary, "time_average")
    return Run(path=path, name=os.path.basename(os.path.abspath(path)), steps=steps,
               realizations=int(np.nan_to_num(number(summary_path, summary, "realizations"))),
               seed=lookup(summary_path, summary, "seed"),
               standard_error_of_variance=numbers_if_any(summary_path, summary, "standard_error_of_variance"),
               complete=truth(summary_path, summary, "complete"),
               time_average=time_average,
               spectral_radius=number(summary_path, summary, "theory.spectral_radius"),
               string_stable=truth_if_any(summary_path, summary, "theory.string_stable"), **table)


def require_folder(path):
    if not os.path.isdir(path):
        reason = "must be a run's folder" if os.path.exists(path) else "no such folder"
        raise InputError("{}: {}".format(path, reason))


def read_summary(folder, table, followers):
    """Path and content of a run's summary.json. Raises InputError unless it describes TABLE.csv beside it, with so many followers."""
    path = os.path.join(folder, "summary.json")
    summary = read_json(path)
    require_undamaged(path, summary, table)
    if number(path, summary, "followers") != followers:
        raise InputError("{}: followers is {}, but {}.csv beside it has {}".format(path, summary["followers"], table, followers))
    return path, summary


def require_undamaged(summary_path, summary, table):
    """Raises InputError unless the CRC-32 of the summary and of TABLE.csv beside it match the summary. The summary's own is taken
    with zeros in its place."""
    table_path = os.path.join(os.path.dirname(summary_path), table + ".csv")
    with open(summary_path, "rb") as file:
        blank = re.sub(b'("summary": ")[0-9a-f]{8}"', b'\\g<1>00000000"', file.read())
    with open(table_path, "rb") as file:
        content = file.read()
    for path, written, key in ((summary_path, blank, "crc32.summary"), (table_path, content, "crc32." + table)):
        if "{:08x}".format(zlib.crc32(written)) != lookup(summary_path, summary, key):
            raise InputError("{}: is not as it was written: damaged, or changed by hand".format(path))


def read_analysis(path):
    if os.path.isdir(path):
        raise InputError("{}: must be a file that analyze --json wrote, not a folder".format(path))
    return Analysis(path, os.path.splitext(os.path.basename(path))[0], read_json(path))


def require_same_platoon(run, analysis, followers):
    """Raises InputError unless run and analysis have the same string length and the same spectral radius."""
    if run.followers != followers:
        raise InputError("{}: has {} followers, but {} has {}".format(run.path, run.followers, analysis.path, followers))
    if "spectral_radius" in analysis.document:
        radius = number(analysis.path, analysis.document, "spectral_radius")
        if abs(radius - run.spectral_radius) > 1e-6 * abs(radius):
            raise InputError("{}: is of another platoon than {}: spectral radius {:.6g} instead of {:.6g}"
                             .format(run.path, analysis.path, run.spectral_radius, radius))


def read_map(path):
    """The map over the two columns of AXES that vary. Its values are spectral_radius, peak_gain and string_stable, and loss_gain where
    losses vary (else all NaN)."""
    heading = read_text(path).split("\n", 1)[0].split(",")
    names = [name for name in AXES if name in heading]
    lossy = "loss_gain" in heading
    columns = read_columns(path, names + MAP_VALUES + (["loss_gain"] if lossy else []))
    varying = [name for name in names if np.unique(columns[name]).size > 1]
    if len(varying) != 2:
        raise InputError("{}: {}: must be two of {}, each with two or more values".format(
            path, " and ".join(varying) + " vary" if varying else "nothing varies", ", ".join(AXES)))
    over, up = varying
    x, y = columns[over], columns[up]
    xs, ys = np.unique(x), np.unique(y)
    order = np.lexsort((x, y))
    if not np.array_equal(x[order], np.tile(xs, ys.size)) or not np.array_equal(y[order], np.repeat(ys, xs.size)):
        raise InputError("{}: must hold one row for each point of a grid of {} and {}".format(path, over, up))
    values = {name: drawable(columns[name])[order].reshape(ys.size, xs.size) for name in MAP_VALUES}
    for name, array in values.items():
        require_some(path, name, array)
    values["loss_gain"] = drawable(columns["loss_gain"])[order].reshape(ys.size, xs.size) if lossy else np.full((ys.size, xs.size), np.nan)
    return StabilityMap(over, xs, up, ys, **values)
