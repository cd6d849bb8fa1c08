"""Platoons over links and mixed strings: all results of analyze, and the verdicts on both sides of every border."""

import random

from mpmath import mpf

import link_reference
from audit import tables
from audit.paper import DECAY, LIMIT, STATIONARY
from audit.string_theory import String

FOLLOWERS, STEPS = 20, 100
LOSS_GAIN = 1e-9  # relative
PEAK = 1e-9       # relative
BORDER = 1e-7     # distance of probes from borders: headways relative, loss probabilities absolute


def check(name, model, found, findings, undecided):
    draw, string = random.Random(name + " places"), String(model)
    kind = name.split("-")[0]
    followers = draw.choice([2, 2, 3, 3, 6])
    tables.check(name, model, found, min(followers, len(found["mean"])), STEPS, findings)
    check_stationary(name, string, found, findings)
    check_verdict(name, kind, string, found, findings)
    check_headways(name, model, found, draw, findings, undecided)
    check_losses(name, model, found, draw, findings, undecided)


def check_stationary(name, string, found, findings):
    if not string.mean_square_stable():
        return
    variances, means = string.stationary(len(found["stationary_variance"]))
    for i, (ours, theirs) in enumerate(zip(variances, found["stationary_variance"])):
        findings.compare("stationary variance", ours, theirs, STATIONARY * ours, name, " of %d" % (i + 1))
    largest = max(abs(x) for x in means)
    for i, (ours, theirs) in enumerate(zip(means, found["stationary_mean"])):
        findings.compare("stationary mean", ours, theirs, tables.MEAN * 10 * largest, name, " of %d" % (i + 1))


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
        undetermined = max(f.undetermined for f in string.kinds)
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
    stable, why = String(model).verdict()
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
    for x in [h * 50 ** draw.uniform(-1, 1)] + [a * (1 + side * BORDER) for a in ends[:2] for side in (-1, 1)]:
        if low < x < high:
            probe(name, "headway", dict(model, time_headway=x), x, inside(x, intervals), findings, undecided)


def check_losses(name, model, found, draw, findings, undecided):
    intervals, q = found["stable_loss_probabilities"], model.get("channel", {}).get("loss", {}).get("probability")
    varies = q is not None and "default" in model.get("string", ["default"])
    findings.fail_unless(intervals is not None or not varies, name, "no stable loss probabilities are reported")
    if intervals is None or not varies:
        return
    if q < 0.99:
        findings.fail_unless(is_undecided(found) or inside(q, intervals) == found["string_stable"], name,
                             "verdict and loss probabilities %s contradict each other" % intervals)
    critical = found["critical_loss_probability"]
    first = intervals[0] if intervals and intervals[0][0] == 0 else None
    findings.fail_unless(critical == (first[1] if first and first[1] < 0.98 else critical), name,
                         "critical loss probability %s, intervals %s" % (critical, intervals))
    ends = [a for interval in intervals for a in interval if 0 < a < 0.99]
    for x in [draw.uniform(0, 0.98)] + [a + side * BORDER for a in ends[:2] for side in (-1, 1)]:
        if 0 <= x < 0.989:
            channel = link_reference.merged(model["channel"], {"loss": {"probability": x}})
            probe(name, "loss probability", dict(model, channel=channel), x, inside(x, intervals), findings,
                  undecided)
