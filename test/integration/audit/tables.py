"""Compares mean and variance of every (i, k) of the first followers."""

import re

from mpmath import mpf

import link_reference
from audit import burst_moments, received_moments, second_moments

MEAN = 1e-13      # relative to the larger of the largest mean and the largest displacement per step times 1 + headway
VARIANCE = 1e-12  # relative, per cell
OF_BURST = 1e-14  # times the mean burst, where that is more than VARIANCE: terms of the kernel cancel


def accuracy(model):
    """The relative accuracy of a variance."""
    bursts = [float(b) for b in re.findall("'mean_burst': ([0-9.e+]+)", str(model))]
    return max([VARIANCE] + [OF_BURST * b for b in bursts])


def is_received(model):
    """Whether the model has radios or losses in bursts."""
    return "'inputs'" in str(model) or "'mean_burst'" in str(model)


def moments(model, followers, steps):
    way = received_moments if "'inputs'" in str(model) else burst_moments if "'mean_burst'" in str(model) else second_moments
    return way.moments(model, followers, steps)


def check(name, model, found, followers, steps, findings):
    """Compares; returns the means and variances of the audit."""
    means, variances = moments(model, followers, steps)
    vehicles = link_reference.vehicles_of(model, followers)
    fastest = max(abs(entry["value"]) for entry in model["leader"]["speed"]) * model["sample_period"]
    reach = max(1 + vehicle["time_headway"] for vehicle in vehicles)
    scale = max(max(abs(x) for row in means for x in row), mpf(fastest) * reach)
    for what, ours, theirs, allowed in (("mean", means, found["mean"], lambda x: MEAN * scale),
                                        ("variance", variances, found["variance"], lambda x: accuracy(model) * x)):
        for i in range(followers):
            for k in range(steps):
                findings.compare(what, ours[i][k], theirs[i][k], allowed(ours[i][k]), name, " of %d at step %d" % (i + 1, k))
    return means, variances
