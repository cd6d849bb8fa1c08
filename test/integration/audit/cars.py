"""Random cars: an actuator lag with an input delay, e^(-d s) / (s^2 (tau s + 1)), with a zero-order hold, and a
proportional-derivative controller."""

import math

from mpmath import mp, mpf

from audit.paper_models import expanded, rest_of_model


def held(period, lag, delay):
    """The pulse transfer function of a car, with an exact double pole at z = 1 and the lag's pole rounded to 44 bits."""
    period, lag, delay = mpf(period), mpf(lag), mpf(delay)
    pole = round(float(mp.exp(-period / lag)) * 2 ** 44) / 2 ** 44
    if not 2.0 ** -8 < pole < 1.0:
        return None
    exact = mp.exp(-period / lag)

    def of_step(t):  # position at time t after a step of the input
        return mpf(0) if t <= 0 else t * t / 2 - lag * t + lag * lag * -mp.expm1(-t / lag)
    # The step response times (z - 1)^2 (z - e^(-T/tau)) and (1 - 1/z) is finite: it is the numerator.
    denominator = [mpf(1), -2 - exact, 1 + 2 * exact, -exact]
    whole = int(mp.floor(delay / period))
    steps = [of_step(k * period - delay) for k in range(whole + 8)]
    jumps = [a - b for a, b in zip(steps, [mpf(0)] + steps)]
    product = [sum(denominator[i] * jumps[k - i] for i in range(min(k, 3) + 1)) for k in range(len(jumps))]
    least = mpf(10) ** -20 * max(abs(x) for x in product)
    size = max(k for k, x in enumerate(product) if abs(x) > least) + 1  # down to z^-(size - 1)
    numerator = [float(x) for x in product[:size]]
    first = next(k for k, x in enumerate(product) if abs(x) > least)
    exact_denominator = expanded([1, -1], [1, -1], [1, -pole])
    return {"numerator": numerator[first:], "denominator": exact_denominator + [0.0] * (size - 4)}


def car_vehicle(draw, period):
    lag = draw.uniform(0.05, 0.5)
    most = 0.4 if draw.random() < 0.05 else min(0.4, 14.5 * period)  # a longer delay has more poles than analyze accepts
    samples = draw.uniform(0, most) / period
    delay = (round(samples) if draw.random() < 0.4 else samples) * period
    kp, kd = math.exp(draw.uniform(math.log(0.05), 0)), draw.uniform(0.3, 1.5)
    return {"time_headway": draw.uniform(0.4, 3.0) / period, "plant": held(period, lag, delay),
            "controller": {"numerator": [kp + kd / period, -kd / period], "denominator": [1.0, 0.0]}}


def car(draw):
    period = draw.choice([0.01, 0.02, 0.05, 0.1, draw.uniform(0.01, 0.1)])
    vehicle = car_vehicle(draw, period)
    return dict(rest_of_model(draw, period), **vehicle) if vehicle["plant"] else None
