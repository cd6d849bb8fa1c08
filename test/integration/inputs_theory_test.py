#!/usr/bin/python3
"""Compares the theory for random cars that hear up to four vehicles ahead and the leader, any signals, with the second moments of the whole
string: mean and variance of every step, where packets lose in all modes of their chains, and stationary variances.

inputs_theory_test.py [--models M] [--seed SEED]
"""

import random

import numpy as np
import stochastic_platoon as sp

from inputs_reference import String, drawn
from random_models import parsed

FOLLOWERS, STEPS = 6, 25
CLOSE = 1e-9
KEYS = ("mean", "variance", "stationary_variance")  # not the searches for critical values, which take minutes


def difference(found, expected):
    """The largest one of variances, relative; of those that are not rounding."""
    positive = expected > 1e-8 * np.max(expected)
    return np.max(abs(np.array(found)[positive] / expected[positive] - 1))


def check(name, model, followers):
    """The largest relative difference; None if the model is rejected, as its loop or its predictions are unstable."""
    try:
        found = sp.analyze(sp.Model.from_dict(model), followers=followers, steps=STEPS, keys=KEYS)
    except ValueError as error:
        assert any(words in str(error) for words in ("rho(A)", "variance grows")), "%s: %s: %s" % (name, error, model)
        return None
    string = String(model, followers)
    means, variances = string.tables(20.0, STEPS)
    apart = [np.max(abs(np.array(found["mean"]) - means)) / np.max(abs(means)), difference(found["variance"], variances)]
    if not string.packets:
        apart.append(difference(found["stationary_variance"], string.settled()))
    worst = np.max(apart)  # NaN if one is
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
    main()
