"""The page on runs as HTML, with its figures as SVG within it."""

from __future__ import annotations

import hashlib
import os
import re
import shlex
from typing import Any, Callable, Iterator, List, Optional, Sequence, Tuple

import numpy as np
import stochastic_platoon as sp
from matplotlib.figure import Figure
from plotting import amplification, files, gaps, style, tracking_errors
from reporting import losses
from reporting.markup import badge, escaped, hundredths, number, pairs, table, warning
from scipy import special
from stochastic_platoon.tables import Table

SHOWN_ENDS = 10  # rows of a table at either end of a long string
LONGEST_VALUE = 160  # characters of a value of the model
MEANING_OF_SCORE = "z: a standard normal variable exceeds it as probably as chance alone exceeds the difference of measurement and theory"
MEANING_OF_DISTANCE = "z: the difference of measurement and theory in standard errors, as the errors are not normal or averages over time"
# Units of a model's values by the end of their path.
UNITS = {"sample_period": "s", "time_headway": "sample periods", "standstill_distance": "m", "vehicle_length": "m", "safe_gap": "m",
         "noise_variance": "m²", "initial_position/mean": "m", "initial_position/variance": "m²",
         "channel/delay": "sample periods", "channel/quantisation_step": "m", "loss/mean_burst": "sample periods",
         "loss/by_distance": "gap in m, probability", "leader/speed": "m/s", "leader/positions": "m", "limits/input": "m/s²",
         "limits/speed": "m/s", "input_delay": "s", "actuator_lag": "s", "kp": "1/s²", "kd": "1/s", "ki": "1/s³"}
STYLE = """
body { font: 15px/1.45 "DejaVu Sans", Verdana, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.3rem; margin-top: 2.4rem; border-bottom: 2px solid #222; }
h3 { font-size: 1.05rem; margin: 1.4rem 0 .4rem; }
table { border-collapse: collapse; font-size: .86rem; font-variant-numeric: tabular-nums; } caption { text-align: left; padding: .2rem 0; }
th, td { border-bottom: 1px solid #ccc; padding: .15rem .7rem .15rem 0; text-align: left; vertical-align: top; }
td.number, th.number { text-align: right; } code { font-size: .95em; overflow-wrap: anywhere; }
.badge { display: inline-block; padding: .1rem .6rem; border-radius: 4px; font-weight: bold; margin-right: .5rem; }
.good { background: #d9efe2; color: #0b5a33; } .bad { background: #f8dcd6; color: #8c2008; } .open { background: #e8e8e8; color: #444; }
.warning { border-left: 4px solid #c05000; padding-left: .7rem; } svg { max-width: 100%; height: auto; }
.sign td { height: 2.2rem; width: 16rem; border-bottom: 1px solid #222; }
@media print { body { margin: 0; max-width: none; font-size: 10.5pt; } h2 { break-before: page; } h2:first-of-type { break-before: auto; }
  figure, tr, .badge { break-inside: avoid; } @page { size: A4; margin: 16mm; } }
"""


def flattened(value: Any, path: str = "") -> Iterator[Tuple[str, str]]:
    """The keys of a model as paths, as Model.replace() takes them, with their values."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from flattened(inner, "{}/{}".format(path, key) if path else str(key))
        return
    yield path, str([shortened(inner) for inner in value] if path == "inputs" or path.endswith("/inputs") else shortened(value))


def shortened(value: Any) -> Any:
    """The value, with the beginnings of long texts and lists in their place."""
    if isinstance(value, dict):
        return {key: shortened(inner) for key, inner in value.items()}
    text = str(value)
    if len(text) <= LONGEST_VALUE:
        return value
    return text[:LONGEST_VALUE] + (" … ({} values)".format(len(value)) if isinstance(value, list) else " …")


def unit_of(path: str) -> str:
    return next((unit for end, unit in UNITS.items() if path == end or path.endswith("/" + end)), "")


def model_of(run: sp.Results) -> str:
    return pairs((path, "{} {}".format(value, unit_of(path)).rstrip()) for path, value in flattened(run.summary["configuration"]["model"]))


def shown_rows(count: int) -> List[int]:
    return [row for row in range(count) if count <= 3 * SHOWN_ENDS or row < SHOWN_ENDS or row >= count - SHOWN_ENDS]


def svg(figure: Figure, words: str) -> str:
    """A figure within the page; equal identifiers in two of them have equal content."""
    drawn = files.content(figure, "svg").decode()
    return '<figure role="img" aria-label="{}">\n{}\n</figure>'.format(escaped(words), drawn[drawn.index("<svg"):])


def figure(draw: Callable[[], Figure], words: str) -> str:
    """A figure, or the reason why there is nothing to draw."""
    try:
        return svg(draw(), words)
    except ValueError as error:
        return "<p>{}</p>".format(escaped(error))


def verdict(run: sp.Results, problems: Sequence[str]) -> str:
    theory, agreement = run.summary["theory"], run.summary["agreement"]
    kinds = {None: "open", True: "good", False: "bad"}
    parts = [badge(style.verdict(run.string_stable), kinds[run.string_stable])]
    means_only = agreement["max_abs_z_variance"] is None
    agreeing = "complete, undamaged, {}in agreement".format("means " if means_only else "")
    parts.append(badge(agreeing, "good") if not problems and run.max_abs_z is not None
                 else badge("complete and undamaged, " + compared_part(agreement), "open") if not problems else badge("check failed", "bad"))
    collisions = collisions_of(run)
    if collisions is not None:
        parts.append(badge("collisions: in {} of {} realizations of the follower with the most".format(*collisions), "bad") if collisions[0]
                     else badge("collisions: in none of {} realizations".format(collisions[1]), "good"))
        parts += below_safe_gap(run.gaps, run.realizations)
    text = "<p>{}</p>\n<p>Theory: {}.</p>".format("".join(parts), escaped(theory["reason"] or "none"))
    if "reason" in agreement:
        text += "\n<p>No verdict on the tracking errors: {}.</p>".format(escaped(agreement["reason"]))
    if run.max_abs_z is not None:
        of_mean, of_variance, plausible = (number(agreement.get(key), 3) for key in ("max_abs_z_mean", "max_abs_z_variance", "plausible_z"))
        text += "\n<p>{}. Over all followers and steps the largest |z| is {} of the mean{}; chance alone exceeds " \
                "{} at most once in 1000 runs.</p>".format(
                    meaning_of_z(run), of_mean, "" if means_only else " and {} of the variance".format(of_variance), plausible)
    return "\n".join([text, *("<p>{} {}</p>".format(badge("check", "bad"), escaped(problem)) for problem in problems),
                      *(warning("Warning: " + sentence) for sentence in warnings_of(run))])


def compared_part(agreement: Any) -> str:
    """What was compared of a run whose tracking errors were not."""
    signals = ", ".join(name.replace("_", " ") for name, of in agreement.get("signals", {}).items() if of["max_abs_z_mean"] is not None)
    return ("tracking errors not compared with the theory" if "reason" in agreement else "not compared with a theory") + \
        (", signals in agreement ({})".format(signals) if signals else "")


def warnings_of(run: sp.Results) -> List[str]:
    kept = run.summary.get("warning")
    return [*run.summary.get("warnings", []), *([kept] if kept else [])]


def collisions_of(run: sp.Results) -> Optional[Tuple[int, int]]:
    """The most realizations with a collision of one follower, and all realizations; None without gaps."""
    if "gaps" not in run.summary["crc32"]:
        return None
    return int(run.gaps.collisions.max()), run.realizations


def below_safe_gap(of: sp.Gaps, realizations: int) -> List[str]:
    """The badge of the model's safe_gap; empty without one."""
    if not np.isfinite(of.below_safe_gap).any():
        return []
    most = int(np.nanmax(of.below_safe_gap))
    name = "gap below {:g} m: in ".format(of.safe_gap)
    return [badge("{}{} of {} realizations of the follower with the most".format(name, most, realizations), "bad") if most
            else badge("{}none of {} realizations".format(name, realizations), "good")]


def what_was_run(run: sp.Results) -> str:
    of, period = run.summary, run.sample_period
    steps = "{} ({:.6g} s of {:g} s)".format(of["steps"], of["steps"] * period, period)
    if run.time_average:
        steps = "endless, averages over time" + (" up to step {:.0f}".format(run.steps[-1]) if run.steps[-1] >= 0 else ", paused")
    return pairs([("followers", of["followers"]), ("steps", steps), ("realizations", run.realizations), ("seed", run.seed),
                  ("hosting", of["hosting"]), ("attempts", of["attempts"]), *losses.rows_of(run),
                  ("date (UTC)", of["date"]), ("machine", of["host"]), ("version", "stochastic_platoon {}, revision {}{}".format(
                      of["version"], of["revision"], " (of changed sources)" if str(of["revision"]).endswith("-dirty") else "")),
                  ("command", " ".join(map(shlex.quote, of["command_line"])))])


def is_normal(run: sp.Results) -> bool:
    """Whether the program compares the variances as those of independent normal values: its standard errors are theirs, and no measured ones."""
    count, theory = run.count[:, -1], run.theoretical_variance[:, -1]
    known = np.isfinite(theory) & (count > 1)
    of_normal = theory[known] * np.sqrt(2.0 / (count[known] - 1.0))
    return bool(known.any() and not run.time_average and np.allclose(run.standard_error_of_variance[known], of_normal, rtol=1e-9, atol=0.0))


def meaning_of_z(run: sp.Results) -> str:
    return MEANING_OF_SCORE if is_normal(run) else MEANING_OF_DISTANCE


def score_of_variance(measured: float, theory: float, count: float) -> float:
    """The z of a variance of normal values, as the program computes it (math/statistics/agreement.hpp), and for scores beyond 36 the same
    approximation. Without the allowance for rounding, which matters only for a theory near 0."""
    if not (measured > 0.0 and theory > 0.0 and count > 1.0):
        return float("nan")
    freedom, ratio = count - 1.0, measured / theory
    above = ratio > 1.0
    tail = float((special.gammaincc if above else special.gammainc)(0.5 * freedom, 0.5 * freedom * ratio))
    if tail > 1e-290:
        score = float(-special.ndtri(tail))
    else:
        root = np.sqrt(freedom * (ratio - 1.0 - np.log(ratio)))
        score = float(root + np.log(abs(ratio - 1.0) * np.sqrt(0.5 * freedom) / root) / root)
    return score if above else -score


def numbers(run: sp.Results) -> str:
    normal = is_normal(run)
    errors, spread = run.errors, run.standard_error_of_variance
    stationary = run.summary["theory"].get("stationary_variance") or [None] * run.followers
    last = int(run.steps[-1])
    rows = []
    for row in shown_rows(run.followers):
        measured, theory = errors.variance[row, -1], errors.theoretical_variance[row, -1]
        with np.errstate(invalid="ignore", divide="ignore"):
            apart = score_of_variance(measured, theory, run.count[row, -1]) if normal else (measured - theory) / spread[row]
        rows.append([str(row + 1), number(errors.mean[row, -1]), number(errors.theoretical_mean[row, -1]), number(measured),
                     number(spread[row], 2), number(theory), hundredths(apart), number(stationary[row])])
    return table(["follower", "mean [m]", "theory [m]", "variance [m²]", "standard error", "theory [m²]",
                  "z of the variance" if normal else "(variance − theory) / standard error", "stationary variance, theory [m²]"], rows,
                 "Tracking errors, averages over time" if run.time_average else
                 "Tracking errors at {:.6g} s (step {}){}".format(last * run.sample_period, last, "; " + MEANING_OF_SCORE if normal else ""))


def gap_numbers(run: sp.Results) -> str:
    of = run.gaps
    head = ["follower", "smallest gap [m]", "in realization", "at [s]", "realizations with a collision"]
    safe = np.isfinite(of.below_safe_gap).any()
    if safe:
        head.append("with a gap below {:g} m".format(of.safe_gap))
    rows = []
    for row in shown_rows(run.followers):
        rows.append([str(row + 1), number(of.smallest_gap[row]), "{:.0f}".format(of.realization[row]), number(of.step[row] * run.sample_period),
                     "{:.0f} of {:.0f}".format(of.collisions[row], of.count[row])])
        if safe:
            rows[-1].append("{:.0f} of {:.0f}".format(of.below_safe_gap[row], of.count[row]))
        rows[-1].append(number(of.theoretical_collision_bound[row], 3))
    return table([*head, "probability of a collision, at most, by theory"], rows, "Gaps over {} realizations".format(run.realizations))


def limit_numbers(run: sp.Results) -> str:
    of = Table(run.table("limits"), os.path.join(run.path, "limits.csv"))
    names = ("input_low", "input_high", "speed_low", "speed_high")
    columns = [100.0 * of.numbers(name) for name in names]
    rows = [[str(row + 1), *(number(column[row], 3) for column in columns)] for row in shown_rows(run.followers)]
    head = ["follower", "input at its lower limit [%]", "at its upper limit [%]", "speed at its lower limit [%]", "at its upper limit [%]"]
    return table(head, rows, "Share of the steps at the limits, over {} realizations".format(run.realizations))


def checksums(run: sp.Results) -> str:
    rows = []
    for name in sorted({"summary.json", *(key + ".csv" for key in run.summary["crc32"] if key != "summary")}):
        with open(os.path.join(run.path, name), "rb") as file:
            rows.append([name, run.summary["crc32"][name.split(".")[0]], hashlib.sha256(file.read()).hexdigest()])
    return "<table><tr><th>file</th><th>CRC-32</th><th>SHA-256</th></tr>\n{}\n</table>".format(
        "\n".join("<tr><td>{}</td><td><code>{}</code></td><td><code>{}</code></td></tr>".format(*row) for row in rows))


def names_of(runs: Sequence[sp.Results]) -> List[str]:
    """Of each run the shortest end of its path that no other one has."""
    paths = [os.path.abspath(run.path).split(os.sep) for run in runs]
    lengths = [next(n for n in range(1, len(own) + 1) if all(path == own or path[-n:] != own[-n:] for path in paths)) for own in paths]
    return ["/".join(own[-length:]) for own, length in zip(paths, lengths)]


def section(run: sp.Results, name: str, at: int) -> str:
    parts = ["<h2>{}. {}</h2>".format(at, escaped(name)), verdict(run, sp.check(run.path)), "<h3>Figures</h3>",
             figure(lambda: tracking_errors.draw([run], []), "mean and variance of the tracking errors")]
    if collisions_of(run) is not None:
        parts.append(figure(lambda: gaps.draw([run], [], []), "smallest gaps and collisions"))
    if "amplification" in run.summary["crc32"]:
        parts.append(figure(lambda: amplification.draw([run], []), "amplification of the speed"))
    parts += ["<h3>Numbers</h3>", numbers(run)]
    if collisions_of(run) is not None:
        parts.append(gap_numbers(run))
    if "limits" in run.summary["crc32"]:
        parts.append(limit_numbers(run))
    parts += ["<h3>What was run</h3>", what_was_run(run), "<h3>Model</h3>",
              model_of(run), "<h3>Files</h3>", checksums(run)]
    return "\n".join(parts)


def overview(runs: Sequence[sp.Results]) -> str:
    meanings = dict.fromkeys(meaning_of_z(run) for run in runs if run.max_abs_z is not None)
    rows = [[name, style.verdict(run.string_stable), "passed" if not sp.check(run.path) else "failed", str(run.followers),
             str(run.realizations), number(run.max_abs_z, 3), number(run.errors.variance[-1, -1]),
             number(run.errors.theoretical_variance[-1, -1])] for run, name in zip(runs, names_of(runs))]
    return table(["run", "verdict", "check", "followers", "realizations", "largest |z|", "variance of the last follower [m²]", "theory [m²]"], rows,
                 "Largest |z| over all followers and steps, of mean or variance{}".format("".join("; " + meaning for meaning in meanings)))


def page_of(runs: Sequence[sp.Results], title: str) -> str:
    sign = '<table class="sign"><tr><th>prepared by</th><td></td><th>date</th><td></td></tr>' \
           '<tr><th>checked by</th><td></td><th>date</th><td></td></tr></table>'
    head = '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n'
    text = "\n".join([head.format(escaped(title), STYLE), "<p>stochastic_platoon {}. Figures: colours measured, thin lines theory.</p>".format(
        sp.__version__), overview(runs), sign, *map(section, runs, names_of(runs), range(1, len(runs) + 1)), "</body>\n</html>\n"])
    return re.sub(r"[ \t]+\n", "\n", text)
