"""Random cars: an actuator lag with an input delay, e^(-d s) / (s^2 (tau s + 1)), with a zero-order hold, and a
proportional-derivative controller; as G(z) and K(z), and described by lag, delay and gains."""

import math

from mpmath import mp, mpf

from audit.paper_models import expanded, rest_of_model
from audit.sampled import pulse_transfer


def held(period, lag, delay):
    """The pulse transfer function in doubles, with an exact double pole at z = 1 and the lag's pole rounded to 44 bits."""
    pole = round(float(mp.exp(-mpf(period) / mpf(lag))) * 2 ** 44) / 2 ** 44
    if not 2.0 ** -8 < pole < 1.0:
        return None
    numerator, denominator = pulse_transfer(period, lag, delay)
    exact_denominator = expanded([1, -1], [1, -1], [1, -pole])
    return {"numerator": [float(x) for x in numerator], "denominator": exact_denominator + [0.0] * (len(denominator) - 4)}


def car_vehicle(draw, period):
    lag = draw.uniform(0.05, 0.5)
    most = 0.4 if draw.random() < 0.05 else min(0.4, 14.5 * period)  # a longer delay has more poles than analyze accepts
    samples = draw.uniform(0, most) / period
    delay = (round(samples) if draw.random() < 0.4 else samples) * period
    kp, kd = math.exp(draw.uniform(math.log(0.05), 0)), draw.uniform(0.3, 1.5)
    return {"time_headway": draw.uniform(0.4, 3.0) / period, "plant": held(period, lag, delay),
            "controller": {"numerator": [kp + kd / period, -kd / period], "denominator": [1.0, 0.0]}}


def described_car(draw):
    """A car by lag, delay and gains: delays of up to 40 sample periods, with or without a headway filter."""
    period = draw.choice([0.01, 0.02, 0.05, 0.1, draw.uniform(0.01, 0.1)])
    samples = draw.uniform(0, 0.4) / period
    controller = {"kp": math.exp(draw.uniform(math.log(0.05), 0)), "kd": draw.uniform(0.3, 1.5)}
    if draw.random() < 0.2:
        controller["ki"] = controller["kp"] * draw.uniform(0.001, 0.02)
    controller["headway_filter"] = draw.random() < 0.7
    return dict(rest_of_model(draw, period), time_headway=draw.uniform(0.6, 2.0) * math.sqrt(2 / controller["kp"]) / period, controller=controller,
                plant={"actuator_lag": draw.choice([0.0, draw.uniform(0.05, 0.5)]),
                       "input_delay": (round(samples) if draw.random() < 0.5 else samples) * period})


def car(draw):
    period = draw.choice([0.01, 0.02, 0.05, 0.1, draw.uniform(0.01, 0.1)])
    vehicle = car_vehicle(draw, period)
    return dict(rest_of_model(draw, period), **vehicle) if vehicle["plant"] else None
