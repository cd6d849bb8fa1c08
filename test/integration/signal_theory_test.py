#!/usr/bin/python3
"""Compares gap, speed, acceleration, jerk, relative speed and collisions of analyze with independent computations for random
platoons: mean and variance of every step with the responses of the whole string to each of its noises, stationary values and limits
with the spectra at many frequencies in extended precision, and collisions with integrals over the density of one gap.

signal_theory_test.py [ANALYZE] [--models M] [--seed SEED]
"""

import random

import numpy as np
from scipy.special import ndtr, ndtri, owens_t

from random_models import analysis_of, parsed
from signal_reference import FOLLOWERS, STEPS, LinkedPlatoon, RadioPlatoon, crossing, drawn, signals_of

CLOSE = 1e-9
SIGNALS, ORDERS = ["gap", "speed", "acceleration", "jerk", "relative_speed"], [0, 1, 2, 3, 1]


def check(model_name, platoon, found, wanted):
    model, vehicles, period = platoon.model, platoon.vehicles, platoon.model["sample_period"]
    before = [platoon.default_vehicle()] + vehicles
    worst = {}

    def compare(name, value, reference, scale=None):
        value, reference = np.array(value, float), np.array(reference, float)
        worst[name] = np.max(abs(value - reference) / (abs(reference) if scale is None else scale))

    def conditioned(values):
        """The scale of risks exp(-a^2 / 2): their relative error is a^2 times that of the variance."""
        return np.maximum(values, 1e-30) * np.maximum(1.0, -2.0 * np.log(np.maximum(values, 1e-30)))

    # Every step.
    mean, sources = platoon.responses()
    means, sums, covariance = signals_of(mean, period), 0.0, 0.0
    distance = np.array([own["standstill_distance"] - front["vehicle_length"] for own, front in zip(vehicles, before)])
    means[0] += distance[:FOLLOWERS, None]
    for variance, is_noise, rows in sources:
        s = signals_of(rows, period)
        square, product = s[:, :, 1:] ** 2, s[0, :, 1:] * s[0, :, :-1]
        sums = sums + variance * (np.cumsum(square, axis=2) if is_noise else square)
        covariance = covariance + variance * (np.cumsum(product, axis=1) if is_noise else product)
    for n, name in enumerate(SIGNALS):
        compare(name + " mean", found["signals"][name]["mean"], means[n, :, 1:], np.max(abs(mean)) / period ** ORDERS[n])
        positive = sums[n] > 1e-10 * np.max(sums[n])
        compare(name + " variance", np.array(found["signals"][name]["variance"])[positive], sums[n][positive])
    below = ndtr(-means[0, :, 1] / np.sqrt(np.maximum(sums[0, :, 0], 1e-300)))
    bound = [min(1.0, below[i] + sum(crossing(means[0, i, k], sums[0, i, k - 1], means[0, i, k + 1], sums[0, i, k], covariance[i, k])
                                     for k in range(1, STEPS))) for i in range(FOLLOWERS)]
    compare("bound", found["collision"]["bound"], bound, np.maximum(bound, 1e-12))

    # Stationary values of the followers, and of an endless string.
    weight, w, spectra = platoon.spectra()
    square = (2 * np.sin(w / 2)) ** 2
    v = model["leader"]["speed"][-1]["value"] * period

    def stationary(i, spectrum):
        t, added = spectra[i]
        own = abs(t) ** 2 * spectrum + added
        gap = abs(1 - t) ** 2 * spectrum + added
        moved = square / period ** 2
        variances = [float(np.sum(weight * s)) for s in [gap] + [own * moved ** n for n in (1, 2, 3)] + [gap * moved]]
        from_one = float(np.sum(weight * square * gap)) / 2 / variances[0]
        centre = distance[i] + (vehicles[i]["time_headway"] + platoon.lag(i)) * v
        a = centre / np.sqrt(variances[0])
        needed = max(0.0, vehicles[i]["standstill_distance"] - centre - ndtri(wanted) * np.sqrt(variances[0]))
        return own, variances, centre, [ndtr(-a), 2 * owens_t(a, np.sqrt(from_one / (2 - from_one))), needed]

    spectrum, table, centres, risks = 0 * weight, [], [], []
    for i in range(FOLLOWERS):
        spectrum, variances, centre, risk = stationary(i, spectrum)
        table.append(variances), centres.append(centre), risks.append(risk)
    for n, name in enumerate(SIGNALS):
        compare(name + " stationary", found["signals"][name]["stationary_variance"], np.array(table)[:, n])
    compare("stationary mean", found["signals"]["gap"]["stationary_mean"], centres)
    compare("stationary speed", found["signals"]["speed"]["stationary_mean"], [v / period] * FOLLOWERS)
    keys = ["probability", "rate", "required_standstill_distances"]
    for key, values in zip(keys, np.array(risks).T):
        compare(key, found["collision"][key], values, conditioned(values))
    limits = [found["signals"][name]["limit_variance"] for name in SIGNALS]
    if found["string_stable"]:
        first, pattern = platoon.pattern, range(platoon.pattern)  # behind a full pattern, not the leader
        once, gain = 0 * weight, 1
        for i in pattern:
            once, gain = abs(spectra[first + i][0]) ** 2 * once + spectra[first + i][1], gain * abs(spectra[first + i][0]) ** 2
        margin = 1 - gain  # c w^2 where it cancels
        known = np.argmin(np.where(margin > 1e-13, w, 10))
        margin = np.where(w < w[known], margin[known] * (w / w[known]) ** 2, margin)
        spectrum, endless, risks = once / margin, [], []
        for i in pattern:
            spectrum, variances, _, risk = stationary(first + i, spectrum)
            endless.append(variances), risks.append(risk)
        compare("limits", limits, np.max(endless, axis=0))
        values = np.max(risks, axis=0)
        keys = ["limit_probability", "limit_rate", "required_standstill_distance"]
        compare("limit risks", [found["collision"][key] for key in keys], values, conditioned(values))
    else:
        assert limits == [None] * len(SIGNALS) and found["collision"]["limit_rate"] is None
    apart = ["%s differs by %.2g, relative" % one for one in worst.items() if not one[1] <= CLOSE]  # also by NaN: of no figure
    assert not apart, "%s: %s" % (model_name, "; ".join(apart))
    return max(worst.values())


def main():
    arguments = parsed(__doc__, 5)
    worst, stable, number = 0.0, 0, 0
    for kind, platoon in (("paper", LinkedPlatoon), ("mixed", LinkedPlatoon), ("radio", RadioPlatoon)):
        for model_number in range(arguments.models):
            name = "signals-%s-%d-%d" % (kind, arguments.seed, model_number)
            draw = random.Random(name)
            model, wanted = drawn(kind, draw), 10 ** draw.uniform(-9, -0.5)
            found = analysis_of(arguments.analyze, name, model, followers=FOLLOWERS, steps=STEPS, signals=",".join(SIGNALS),
                                collision_probability=repr(wanted))
            if found:
                worst = max(worst, check(name, platoon(model), found, wanted))
                stable, number = stable + bool(found["string_stable"]), number + 1
    print("%d models, %d of them string stable: largest difference %.2g, relative" % (number, stable, worst))
    assert 0 < stable < number, "both verdicts must occur"


if __name__ == "__main__":
    main()
