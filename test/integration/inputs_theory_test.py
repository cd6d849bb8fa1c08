#!/usr/bin/python3
"""Compares analyze for random cars that hear up to four vehicles ahead and the leader, any signals, with the second moments of the whole
string: mean and variance of every step, where packets lose in all modes of their chains, and stationary variances.

inputs_theory_test.py [ANALYZE] [--models M] [--seed SEED]
"""

import random

import numpy as np

from inputs_reference import String, drawn
from random_models import analysis_of, parsed

FOLLOWERS, STEPS = 6, 25
CLOSE = 1e-9


def difference(found, expected):
    """The largest one of variances, relative; of those that are not rounding."""
    positive = expected > 1e-8 * np.max(expected)
    return np.max(abs(np.array(found)[positive] / expected[positive] - 1))


def check(name, model, followers):
    """The largest relative difference; None if analyze rejects the model."""
    found = analysis_of(ANALYZE, name, model, followers=followers, steps=STEPS)
    if not found:
        return None
    string = String(model, followers)
    means, variances = string.tables(20.0, STEPS)
    worst = np.max(abs(np.array(found["mean"]) - means)) / np.max(abs(means))
    worst = max(worst, difference(found["variance"], variances))
    if not string.packets:
        worst = max(worst, difference(found["stationary_variance"], string.settled()))
    assert worst <= CLOSE, "%s: differs by %.2g, relative: %s" % (name, worst, model)
    return worst


def main():
    for kind, lossy, followers in (("inputs", False, FOLLOWERS), ("lossy_inputs", True, FOLLOWERS - 1)):
        checked, number, worst = 0, 0, 0.0
        while checked < ARGUMENTS.models:
            name = "%s-%d-%d" % (kind, ARGUMENTS.seed, number)
            one = check(name, drawn(random.Random(name), lossy), followers)
            number += 1
            assert number < 4 * ARGUMENTS.models + 20, kind + ": nearly all models are rejected"
            checked, worst = checked + (one is not None), max(worst, one or 0.0)
        print("%s: %d models, differences up to %.2g, relative" % (kind, checked, worst))


if __name__ == "__main__":
    ARGUMENTS = parsed(__doc__, 3)
    ANALYZE = ARGUMENTS.analyze
    main()
