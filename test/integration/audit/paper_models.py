"""Random models of the paper's platoon, of kinds that revealed errors before. All numbers are doubles."""

import math

from mpmath import mp, mpf

from audit.loops import design_loop
from audit.polynomials import slope, times, value


def dyadic(x, bits=12):
    return round(x * 2 ** bits) / 2 ** bits


def expanded(*factors):
    """The product of factors with double coefficients; None if the product is not exact in double."""
    product = [mpf(1)]
    for factor in factors:
        product = times(product, [mpf(a) for a in factor])
    result = [float(a) for a in product]
    return result if all(mpf(a) == b for a, b in zip(result, product)) else None


def rest_of_model(draw, period):
    speeds = [{"from_step": 0, "value": dyadic(draw.uniform(-30, 30), 3)}]
    if draw.random() < 0.5:
        speeds.append({"from_step": draw.randrange(1, 30), "value": dyadic(draw.uniform(-30, 30), 3)})
    placed = draw.random() < 0.5
    return {"standstill_distance": draw.choice([0.0, 3.5]), "sample_period": period,
            "noise_variance": dyadic(draw.uniform(0.1, 5)), "leader": {"speed": speeds},
            "initial_position": {"mean": dyadic(draw.uniform(-2, 2)) if placed else 0.0,
                                 "variance": dyadic(draw.uniform(0, 2)) if placed else 0.0}}


def plain(draw):
    extra = [[1, -dyadic(draw.uniform(-0.8, 0.9))] for _ in range(draw.randrange(0, 3))]
    lead = [1, -dyadic(draw.uniform(0.3, 0.97))]
    poles = [[1, -dyadic(draw.uniform(-0.9, 0.6))] for _ in range(draw.randrange(1, 3))]
    plant = expanded([1, -1], [1, -1], *extra)
    if plant is None:
        return None
    return dict(rest_of_model(draw, 0.125), time_headway=draw.uniform(0.5, 12),
                plant={"numerator": [1.0], "denominator": plant},
                controller={"numerator": [math.exp(draw.uniform(-6, 0)) * a for a in lead],
                            "denominator": expanded(*poles),
                            "divide_by_one_plus_headway": draw.random() < 0.5})


def sampled_fast(draw):
    """A vehicle with engine lag and controller gains in SI units, sampled at a kilohertz."""
    period, lag = 0.001, draw.uniform(0.1, 1.0)
    pole = dyadic(math.exp(-period / lag), 20)
    gain = dyadic((1 - pole) * period ** 2 / 2 * 2 ** 30, 20) / 2 ** 30
    k_v, k_p = draw.uniform(0.3, 3), draw.uniform(0.05, 1)
    filtered = dyadic(draw.uniform(-0.5, 0.95))
    damping = k_v / period
    return dict(rest_of_model(draw, period), time_headway=float(draw.randrange(300, 3000)),
                plant={"numerator": [gain, gain], "denominator": expanded([1, -1], [1, -1], [1, -pole])},
                controller={"numerator": [damping + k_p, -damping], "denominator": [1.0, -filtered]})


def long_headway(draw):
    model = plain(draw)
    if model is None:
        return None
    h = math.exp(draw.uniform(math.log(20), math.log(3000)))
    model["time_headway"] = h
    model["controller"]["divide_by_one_plus_headway"] = True
    return model


def near_border(draw):
    model = plain(draw)
    if model is None:
        return None
    low, high = 0.05, 60.0
    if design_loop(model, low).is_string_stable() or not design_loop(model, high).is_string_stable():
        return None
    for _ in range(44):
        middle = (low + high) / 2
        low, high = (low, middle) if design_loop(model, middle).is_string_stable() else (middle, high)
    model["time_headway"] = high * (1 + draw.choice([-1, 1]) * 10 ** draw.uniform(-9, -3))
    return model


def near_cancellation(draw):
    model = plain(draw)
    if model is None:
        return None
    pole = dyadic(draw.uniform(-0.8, 0.9), 8)
    apart = round(10 ** draw.uniform(-10, -3) * 2 ** 40) / 2 ** 40
    denominator = expanded(model["plant"]["denominator"], [1, -pole])
    if denominator is None:
        return None
    model["plant"]["denominator"] = denominator
    model["controller"]["numerator"] = [
        float(a) for a in times([mpf(a) for a in model["controller"]["numerator"]], [1, -mpf(pole) - mpf(apart)])]
    if len(model["controller"]["numerator"]) > len(model["controller"]["denominator"]):
        model["controller"]["denominator"] += [0.0]
    return model


def turning(draw, size):
    if size == 1:
        return mp.eye(1)
    return mp.qr(mp.matrix([[draw.gauss(0, 1) for _ in range(size)] for _ in range(size)]))[0]


def skewed(draw):
    """T = N / D with double integral action by choice of N, in coordinates with a random condition number."""
    h = draw.uniform(0.5, 10)
    poles, size = [], draw.randrange(1, 9)
    while size - len(poles) > 1 and draw.random() < 0.5:
        z = mp.expj(draw.uniform(0.05, 3)) * draw.uniform(0.1, 0.95)
        poles += [z, z.conjugate()]
    while len(poles) < size:
        poles.append(mpf(draw.uniform(-0.5, 0.95)))
    d = [mpf(1)]
    for z in poles:
        d = times(d, [mpf(1), -z])
    d = [a.real for a in d]
    at_one, rise = value(d, mpf(1)), value(slope(d), mpf(1))
    if size == 1:
        h = float(rise / at_one)
        n = [at_one]
    else:
        n = [rise - h * at_one, at_one - (rise - h * at_one)]
    canonical = mp.zeros(size)
    for i in range(size):
        canonical[i, 0] = -d[i + 1]
        if i + 1 < size:
            canonical[i, i + 1] = 1
    column = [mpf(0)] * (size - len(n)) + n
    turn = [turning(draw, size) for _ in range(2)]
    condition = 10 ** draw.uniform(0, 8)
    stretch = mp.diag([mpf(condition) ** (mpf(i) / max(size - 1, 1)) for i in range(size)])
    basis = turn[0] * stretch * turn[1]
    inverse = basis ** -1
    a, b, c = basis * canonical * inverse, basis * mp.matrix(column), inverse[0, :]
    return dict(rest_of_model(draw, 0.125), time_headway=h,
                closed_loop={"A": [[float(a[i, j]) for j in range(size)] for i in range(size)],
                             "B": [float(x) for x in b], "C": [float(x) for x in c]})


KINDS = [plain, sampled_fast, long_headway, near_border, near_cancellation, skewed]
