"""The paper's platoon: identical vehicles and white noise only. Norms by the recursion of Astrom, Jury and Agniel instead of
quadrature; poles, peaks and spectral factors by polynomial roots."""

import random

from mpmath import mp, mpf

from audit import tables
from audit.loops import design_loop, roundings_decide
from audit.polynomials import squared_norm, times

FOLLOWERS, STEPS = 4, 40

# Relative tolerances that the package guarantees.
STATIONARY = 1e-12
LIMIT = 1e-9
DECAY = 1e-11  # relative to 1 - rho(A)
PEAK = 1e-9


def check(name, model, loop, found, findings):
    check_stationary(name, model, loop, found, findings)
    check_bounds(name, tables.check(name, model, found, FOLLOWERS, STEPS, findings), found, findings)
    check_stability(name, model, loop, found, findings)
    if "plant" in model:
        check_headways(name, model, loop, found, findings)


def check_stationary(name, model, loop, found, findings):
    noise = mpf(model["noise_variance"])
    total, numerator, denominator = squared_norm(loop.hn, loop.zd), loop.s, loop.zd
    for i, theirs in enumerate(found["stationary_variance"][:FOLLOWERS]):
        findings.compare("stationary variance", total * noise, theirs, STATIONARY * total * noise, name, " of %d" % (i + 1))
        numerator, denominator = times(numerator, loop.n), times(denominator, loop.d)
        total += squared_norm(numerator, denominator)


def check_bounds(name, table, found, findings):
    means, variances = table
    if found["norms"]["mean_bound"] is not None:
        for row in means:
            norm = mp.sqrt(sum(x * x for x in row))
            findings.fail_unless(norm <= mpf(found["norms"]["mean_bound"]) * (1 + mpf(10) ** -9), name,
                                 "the bound of the means is exceeded")
    if found["norms"]["variance_bound"] is not None:
        largest = max(x for row in variances for x in row)
        findings.fail_unless(largest <= mpf(found["norms"]["variance_bound"]) * (1 + mpf(10) ** -9), name,
                             "the bound of the variances is exceeded")


def check_stability(name, model, loop, found, findings):
    findings.compare("1 - rho(A)", loop.rho, found["spectral_radius"], DECAY * (1 - loop.rho) + mpf(10) ** -15, name)
    stable = loop.is_string_stable()
    if stable is None:
        return
    if found["string_stable"] is None and "closed_loop" in model and roundings_decide(model, random.Random(name)):
        findings.undecided[name.split("-")[0], "by analyze: " + found["reason"]] += 1
        return
    findings.fail_unless(found["string_stable"] == stable, name,
                         "string stable: %s, and analyze reports %s" % (stable, found["string_stable"]))
    peak = mpf(1) if stable else loop.peak()
    if peak > 1:
        findings.compare("peak |T|", peak, found["peak_gain"], PEAK * peak, name)
    if stable and found["string_stable"]:
        limit = loop.limit() * mpf(model["noise_variance"])
        undetermined = loop.undetermined_limit() if "closed_loop" in model else 0
        findings.compare("limit variance", limit, found["limit_variance"], (LIMIT + undetermined) * limit, name)
        findings.fail_unless(found["bounds"]["alpha_2"] == found["limit_variance"], name, "alpha_2 is the limit")


def check_headways(name, model, loop, found, findings):
    intervals, h = found["stable_headways"], model["time_headway"]

    def inside(x):
        return any(a <= x <= b for a, b in intervals)
    findings.fail_unless(inside(h) == found["string_stable"], name, "verdict and headways contradict each other")
    low, high = h / 50, h * 50
    for i in range(3):
        probe = low * (high / low) ** ((i + 0.37) / 3)
        stable = design_loop(model, probe).is_string_stable()
        if stable is not None:
            findings.fail_unless(inside(probe) == stable, name, "headway %r: %s" % (probe, stable))
    for a, _ in intervals[:1]:
        if low < a < high:
            for probe, expected in ((a * (1 + 1e-7), True), (a * (1 - 1e-7), False)):
                stable = design_loop(model, probe).is_string_stable()
                findings.fail_unless(stable in (None, expected), name, "border %r is not one" % a)
