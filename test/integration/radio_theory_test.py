#!/usr/bin/python3
"""Compares analyze with independent computations for random cars with radar and radio: stationary variances, their shares, the limit
and the verdict with Gamma at many frequencies in extended precision, and mean and variance of every step with the second moments of
the whole string, in all modes of the chains that its links lose by; of these also the variances of all signals.

radio_theory_test.py [ANALYZE] [--models M] [--seed SEED]
"""

import random

import numpy as np

from link_reference import joint_chain
from radio_reference import FOLLOWERS, STEPS, Car, Dense, drawn, drawn_quick, drawn_with_chains, stationary
from random_models import analysis_of, parsed

DENSE_FOLLOWERS = 3
MOST_MODES = 16  # of two followers, whose states are counted in each
SIGNALS = ("gap", "speed", "acceleration", "jerk", "input", "relative_speed")
CLOSE, CLOSE_OF_CHAINS = 1e-9, 1e-10


def check(name, model, found):
    car = Car(model)
    before = None
    for cuts in (3, 5, 10, 20, 40):  # until the reference converges
        rows, excess, loss_gain, limit = stationary(car, cuts)
        if before is not None and np.max(abs(rows / before - 1)) < CLOSE / 10:
            break
        before = rows
    apart = [np.max(abs(np.array(found["stationary_variance"]) / rows.sum(1).astype(float) - 1)),
             np.max(abs(np.array(found["stationary_variance_by_input"]).T / rows.astype(float) - 1))]
    decided = abs(excess) > 1e-9 and (loss_gain is None or abs(loss_gain - 1) > 1e-9)
    assert not decided or found["string_stable"] == (limit is not None), "%s: excess %g, loss gain %s" % (name, excess, loss_gain)
    if limit is not None and excess < -1e-9:
        apart.append(abs(found["limit_variance"] / float(limit) - 1))
    if loss_gain is not None and car.q > 0 and found["loss_gain"] is not None:
        apart.append(abs(found["loss_gain"] / float(loss_gain) - 1))
    [means], [variances] = Dense(car, DENSE_FOLLOWERS).tables(20.0)
    mean, variance = (np.array(found[key])[:DENSE_FOLLOWERS] for key in ("mean", "variance"))
    apart += [np.max(abs(mean - means)) / np.max(abs(means)), difference(variance, variances)]
    worst = np.max(apart)  # NaN if one is
    assert worst <= CLOSE, "%s: differs by %.2g, relative" % (name, worst)
    return worst


def difference(found, expected):
    """The largest one of variances, relative."""
    positive = expected > 1e-12 * np.max(expected)
    return np.max(abs(np.array(found)[positive] / expected[positive] - 1))


def check_chains(name, model, found, followers):
    """Every step of a car whose links lose by chains, in all their modes."""
    [means], [variances] = Dense(Car(model), followers).tables(20.0)
    worst = np.max([np.max(abs(np.array(found["mean"]) - means)) / np.max(abs(means)), difference(found["variance"], variances)])
    assert worst <= CLOSE_OF_CHAINS, "%s: differs by %.2g, relative" % (name, worst)
    return worst


def check_stationary(name, model, found, followers):
    variances = Dense(Car(model), followers).tables(0.0, 800, ("error",) + SIGNALS)[1]
    assert np.max(abs(variances[..., 700] / variances[..., -1] - 1)) < CLOSE_OF_CHAINS / 100, name + ": must settle within 700 steps"
    apart = [difference(found["stationary_variance"], variances[0, :, -1])]
    for signal, of_signal in zip(SIGNALS, variances[1:]):
        apart += [difference(found["signals"][signal]["variance"], of_signal[:, :STEPS]),
                  difference(found["signals"][signal]["stationary_variance"], of_signal[:, -1])]
    worst = np.max(apart)
    assert worst <= CLOSE_OF_CHAINS, "%s: differs by %.2g, relative" % (name, worst)
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
    for kind, drawn_one, check_one in (("chain", drawn_with_chains, check_chains), ("quick", drawn_quick, check_stationary)):
        checked = 0
        for number in range(arguments.models):
            name = "%s-%d-%d" % (kind, arguments.seed, number)
            draw = random.Random(name)
            model = drawn_one(draw)
            followers = 2 if len(joint_chain(Car(model).losses * 2)[0]) <= MOST_MODES else 1
            found = analysis_of(arguments.analyze, name, model, followers=followers, steps=STEPS, signals=",".join(SIGNALS))
            if found:
                print(name, "%.2g" % check_one(name, model, found, followers))
                checked += 1
        assert checked > arguments.models / 2, "%s: only %d of %d models are stable" % (kind, checked, arguments.models)
    print("%d models, %d of them string stable: largest difference %.2g, relative" % (arguments.models, stable, worst))
    assert 0 < stable < arguments.models, "both verdicts must occur"


if __name__ == "__main__":
    main()
