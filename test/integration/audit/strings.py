"""Platoons over links and mixed strings: all results of analyze, and the verdicts on both sides of every border."""

import math
import random

from mpmath import mpf

import link_reference
from audit import received_strings, string_theory, tables
from audit.paper import DECAY, LIMIT

FOLLOWERS, STEPS = 20, 100
LOSS_GAIN = 1e-9  # relative
PEAK = 1e-9       # relative
BORDER = 1e-7     # distance of probes from borders: headways and mean bursts relative, loss probabilities absolute
LATE = 1e-9       # relative, of a table's last step and the stationary value
MOST_BURSTY = 3   # vehicles of a pattern with losses in bursts, for the time of the audit
MOST_STEPS = 4000, 400  # steps of a table that is compared with stationary values: in general, and behind losses in bursts


def string_of(model):
    return (received_strings if tables.is_received(model) else string_theory).String(model)


def check(name, model, found, findings, analysed):
    """Compares the JSON of analyze, and of analysed(model, options), which runs analyze on changed models."""
    draw, string = random.Random(name + " places"), string_of(model)
    kind = name.split("-")[0]
    bursts = "mean_burst" in str(model)
    followers, steps = draw.choice([2, 3] if bursts else [2, 2, 3, 3, 6]), 40 if bursts else STEPS

    def undecided(changed):
        return is_undecided(analysed(changed))
    tables.check(name, model, found, min(followers, len(found["mean"])), steps, findings)
    check_stationary(name, model, string, found, findings, analysed)
    check_verdict(name, kind, string, found, findings)
    check_headways(name, model, found, draw, findings, undecided)
    check_losses(name, model, found, draw, findings, undecided)
    check_bursts(name, model, found, findings, undecided)


def check_stationary(name, model, string, found, findings, analysed):
    if not string.mean_square_stable():
        return
    variances, means, shares = string.stationary(len(found["stationary_variance"]))
    for i, (ours, theirs) in enumerate(zip(variances, found["stationary_variance"])):
        findings.compare("stationary variance", ours, theirs, tables.accuracy(model) * ours, name, " of %d" % (i + 1))
    largest = max(abs(x) for x in means)
    for i, (ours, theirs) in enumerate(zip(means, found["stationary_mean"])):
        findings.compare("stationary mean", ours, theirs, tables.accuracy(model) * largest, name, " of %d" % (i + 1))
    if found["stationary_variance_by_input"]:
        for i, rows in enumerate(zip(*found["stationary_variance_by_input"])):
            for ours, theirs in zip(shares[i], rows):
                findings.compare("share of an input", ours, theirs, tables.accuracy(model) * variances[i], name, " of %d" % (i + 1))
    if tables.is_received(model):
        check_late(name, model, string, variances, findings, analysed)


def check_late(name, model, string, variances, findings, analysed):
    """Compares the table's last step with the stationary variance of the first two followers."""
    leader = string_of(dict(model, string=["default"]))  # losses amplify its motion, which may settle last
    decay = max(abs(z) for z in string.settling() + leader.settling())
    steps = int(math.log(1e-14) / math.log(decay) * 2) + 40 if decay < 1 else math.inf
    if steps <= MOST_STEPS["mean_burst" in str(model)]:
        table = analysed(model, "--followers", "2", "--steps", str(steps))["variance"]
        for i, row in enumerate(table):
            findings.compare("late step", variances[i], row[-1], LATE * variances[i], name, " of %d" % (i + 1))


def is_undecided(found):
    return found["string_stable"] is None or found["reason"].startswith("undecided")


def check_verdict(name, kind, string, found, findings):
    rho = string.rho()
    findings.compare("1 - rho(A)", rho, found["spectral_radius"], DECAY * (1 - rho) + mpf(10) ** -15, name)
    stable, why = string.verdict()
    if stable is None:
        findings.undecided[kind, "in the audit: " + why.split(",")[0]] += 1
        return
    if is_undecided(found):
        findings.undecided[kind, "by analyze: " + found["reason"]] += 1
        return
    if found["string_stable"] != stable:
        findings.fail_unless(False, name, "string stable: %s (%s), and analyze reports %s: %s" % (
            stable, why, found["string_stable"], found["reason"]))
    if not stable and string.mean_square_stable():
        peak = string.peak()
        if peak > 1:
            findings.compare("peak |T^|", peak, found["peak_gain"], PEAK * peak, name)
    if stable and found["string_stable"]:
        gain, limits = string.limits()
        undetermined = string.undetermined
        if string.lossy:
            findings.compare("loss gain", gain, found["loss_gain"], (LOSS_GAIN + undetermined) * gain, name)
        limit = max(limits)
        # Losses amplify the variance of losses: a geometric series in the gain.
        allowed = (LIMIT + undetermined) * limit / mpf(abs(1 - gain))
        findings.compare("limit variance", limit, found["limit_variance"], allowed, name)
    elif not stable and why.startswith("loss gain"):
        gain = string.loss_gain()
        findings.compare("loss gain", gain, found["loss_gain"], LOSS_GAIN * gain, name)


def inside(x, intervals):
    return any(a <= x <= b for a, b in intervals)


def probe(name, what, model, value, expected, findings, undecided):
    """Checks that the verdict on the model with this value is the expected one. Stable intervals leave out values at which
    analyze finds the verdict undecided."""
    stable, why = string_of(model).verdict()
    agrees = stable in (None, expected) or (stable and undecided(model))
    findings.fail_unless(agrees, name, "%s %.12g: string stable: %s (%s), and analyze reports %s" % (
        what, value, stable, why, expected))


def check_headways(name, model, found, draw, findings, undecided):
    intervals, h = found["stable_headways"], model["time_headway"]
    varies = "plant" in model and "default" in model.get("string", ["default"])
    findings.fail_unless(intervals is not None or not varies, name, "no stable headways are reported")
    if intervals is None or not varies:
        return
    findings.fail_unless(is_undecided(found) or inside(h, intervals) == found["string_stable"], name,
                         "verdict and headways %s contradict each other" % intervals)
    low, high = max(h / 99, 0.0101), h * 99
    ends = [a for interval in intervals for a in interval if low < a < high]
    ends = ends[:1 if tables.is_received(model) else 2]
    for x in [h * 50 ** draw.uniform(-1, 1)] + [a * (1 + side * BORDER) for a in ends for side in (-1, 1)]:
        if low < x < high:
            probe(name, "headway", dict(model, time_headway=x), x, inside(x, intervals), findings, undecided)


def loss_of(model):
    """The losses that analyze varies, those of the radio if there is one, and a function that replaces their keys; None if there are
    none."""
    entries = model.get("inputs", [])
    varied = entries[-1] if entries else model
    if "loss" not in varied.get("channel", {}):
        return None, None

    def changed(keys):
        own = link_reference.merged(varied, {"channel": {"loss": keys}})
        return dict(model, inputs=entries[:-1] + [own]) if entries else dict(model, channel=own["channel"])
    return varied["channel"]["loss"], changed


def check_losses(name, model, found, draw, findings, undecided):
    loss, changed = loss_of(model)
    intervals, varies = found["stable_loss_probabilities"], loss is not None and "default" in model.get("string", ["default"])
    findings.fail_unless(intervals is not None or not varies, name, "no stable loss probabilities are reported")
    if intervals is None or not varies:
        return
    q, most = loss["probability"], 0.99
    if "mean_burst" in loss:  # above, no chain has this mean burst
        most = min(most, loss["mean_burst"] / (1 + loss["mean_burst"]))
    if q < most:
        findings.fail_unless(is_undecided(found) or inside(q, intervals) == found["string_stable"], name,
                             "verdict and loss probabilities %s contradict each other" % intervals)
    critical = found["critical_loss_probability"]
    first = intervals[0] if intervals and intervals[0][0] == 0 else None
    findings.fail_unless(critical == (first[1] if first and first[1] < 0.98 * most / 0.99 else critical), name,
                         "critical loss probability %s, intervals %s" % (critical, intervals))
    ends = [a for interval in intervals for a in interval if 0 < a < most]
    ends = ends[:1 if tables.is_received(model) else 2]
    for x in [draw.uniform(0, most - 0.01)] + [a + side * BORDER for a in ends for side in (-1, 1)]:
        if 0 <= x < most - 0.001:
            probe(name, "loss probability", changed({"probability": x}), x, inside(x, intervals), findings, undecided)


def check_bursts(name, model, found, findings, undecided):
    critical, (_, changed) = found["critical_mean_burst"], loss_of(model)
    designed = "closed_loop" not in model  # the reference of bursts forms T from plant and controller
    if critical is not None and designed and len(model.get("string", [])) <= MOST_BURSTY:
        for side in (-1, 1):
            x = critical * (1 + side * BORDER)
            probe(name, "mean burst", changed({"mean_burst": x}), x, side < 0, findings, undecided)
