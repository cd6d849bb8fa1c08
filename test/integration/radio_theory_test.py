#!/usr/bin/python3
"""Compares analyze with independent computations for random cars with radar and radio: stationary variances, their shares, the limit
and the verdict with Gamma at many frequencies in extended precision, and mean and variance of every step with the second moments of
the whole string, over all patterns of lost inputs with their probabilities.

radio_theory_test.py [ANALYZE] [--models M] [--seed SEED]
"""

import random

import numpy as np

from radio_reference import FOLLOWERS, STEPS, Car, Dense, drawn, stationary
from random_models import analysis_of, parsed

DENSE_FOLLOWERS = 3
CLOSE = 1e-9


def check(name, model, found):
    car = Car(model)
    before = None
    for cuts in (3, 5, 10, 20, 40):  # until the reference converges
        rows, excess, loss_gain, limit = stationary(car, cuts)
        if before is not None and np.max(abs(rows / before - 1)) < CLOSE / 10:
            break
        before = rows
    worst = np.max(abs(np.array(found["stationary_variance"]) / rows.sum(1).astype(float) - 1))
    worst = max(worst, np.max(abs(np.array(found["stationary_variance_by_input"]).T / rows.astype(float) - 1)))
    decided = abs(excess) > 1e-9 and (loss_gain is None or abs(loss_gain - 1) > 1e-9)
    assert not decided or found["string_stable"] == (limit is not None), "%s: excess %g, loss gain %s" % (name, excess, loss_gain)
    if limit is not None and excess < -1e-9:
        worst = max(worst, abs(found["limit_variance"] / float(limit) - 1))
    if loss_gain is not None and car.q > 0 and found["loss_gain"] is not None:
        worst = max(worst, abs(found["loss_gain"] / float(loss_gain) - 1))
    means, variances = Dense(car, DENSE_FOLLOWERS).tables(20.0)
    mean, variance = (np.array(found[key])[:DENSE_FOLLOWERS] for key in ("mean", "variance"))
    worst = max(worst, np.max(abs(mean - means)) / np.max(abs(means)))
    positive = variances > 1e-12 * np.max(variances)
    worst = max(worst, np.max(abs(variance[positive] / variances[positive] - 1)))
    assert worst <= CLOSE, "%s: differs by %.2g, relative" % (name, worst)
    return worst


def main():
    arguments = parsed(__doc__, 6)
    worst, stable = 0.0, 0
    for number in range(arguments.models):
        name = "radio_car-%d-%d" % (arguments.seed, number)
        model = drawn(random.Random(name))
        found = analysis_of(arguments.analyze, name, model, followers=FOLLOWERS, steps=STEPS)
        if found:
            worst = max(worst, check(name, model, found))
            stable += bool(found["string_stable"])
    print("%d models, %d of them string stable: largest difference %.2g, relative" % (arguments.models, stable, worst))
    assert 0 < stable < arguments.models, "both verdicts must occur"


if __name__ == "__main__":
    main()
