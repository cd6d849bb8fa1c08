"""Random platoons over links and mixed strings. All numbers are doubles; poles at z = 1 are exact."""

import functools
import math

import numpy as np
from mpmath import mpf

import link_reference
from audit.cars import car, car_vehicle, described_car
from audit.followers import made
from audit.paper_models import dyadic, expanded, plain


def predictor(draw):
    kind = draw.random()
    if kind < 0.4:
        return "hold"
    if kind < 0.7:
        return "extrapolate"
    c = [dyadic(draw.uniform(-1, 1.5)) for _ in range(draw.randrange(1, 4))]
    return [1.0 - sum(c)] + c


def channel(draw, most_losses=0.6):
    link = {}
    if draw.random() < 0.55:
        link["delay"] = draw.choice([1, 1, 2, 3, 5, 8, 20])
    if draw.random() < 0.65:
        rare = draw.random() < 0.5
        link["loss"] = {"probability": math.exp(draw.uniform(-7, -1)) if rare else draw.uniform(0, most_losses),
                        "on_loss": predictor(draw)}
    if draw.random() < 0.35:
        poles = [[1, -dyadic(draw.uniform(-0.7, 0.95))] for _ in range(draw.randrange(1, 3))]
        link["noise_filter"] = {"numerator": [dyadic(draw.uniform(-2, 2)) for _ in range(draw.randrange(1, 3))],
                                "denominator": expanded(*poles)}
    if draw.random() < 0.25:
        link["quantisation_step"] = dyadic(draw.uniform(0.01, 1))
    return link


def calm(draw):
    """A plain model with a headway that makes string stability likely."""
    model = plain(draw)
    if model is not None:
        model["time_headway"] = draw.uniform(2, 20)
        model["controller"]["numerator"] = [a * math.exp(draw.uniform(-2, 0)) for a in model["controller"]["numerator"]]
    return model


def linked(draw):
    model = calm(draw)
    return model and dict(model, channel=channel(draw))


def type_of(draw, base, lossy=True):
    """The keys of a vehicle type; it inherits all others."""
    own, other = {}, calm(draw)
    if other is None:
        return None
    if draw.random() < 0.5:
        own["time_headway"] = base["time_headway"] * math.exp(draw.uniform(-0.3, 0.7))
    if draw.random() < 0.3:
        own["noise_variance"] = other["noise_variance"]
    if draw.random() < 0.3:
        own["controller"] = dict(other["controller"], numerator=[
            a * math.exp(draw.uniform(-0.5, 0.5)) for a in base["controller"]["numerator"]],
            denominator=base["controller"]["denominator"])
    if draw.random() < 0.2:
        own.update({key: other[key] for key in ("plant", "controller", "time_headway")})
    if draw.random() < 0.2:
        own["initial_position"] = other["initial_position"]
    if draw.random() < 0.5:
        own["channel"] = channel(draw)
        inherits = "loss" in base.get("channel", {}) and "loss" in own["channel"]
        if inherits and draw.random() < 0.4:  # inherits the default vehicle's probability
            del own["channel"]["loss"]["probability"]
        if not lossy:
            own["channel"].pop("loss", None)
    return own


def string_of(draw, model, types, length):
    model["vehicle_types"] = {"type_%d" % i: own for i, own in enumerate(types)}
    names = ["default"] + list(model["vehicle_types"])
    model["string"] = [draw.choice(names) for _ in range(length)]
    return model


def mixed(draw):
    model = linked(draw) if draw.random() < 0.7 else calm(draw)
    if model is None:
        return None
    types = [type_of(draw, model) for _ in range(draw.randrange(1, 5))]
    return None if None in types else string_of(draw, model, types, draw.randrange(1, 7))


def long_pattern(draw):
    """A pattern of 8 to 30 vehicles: random types, or cars with occasional trucks."""
    model = calm(draw)
    if model is None:
        return None
    if draw.random() < 0.4:
        model["channel"] = channel(draw, 0.1)
    types = [type_of(draw, model, draw.random() < 0.3) for _ in range(draw.choice([1, 1, 2, 3, 10]))]
    if None in types:
        return None
    length = draw.randrange(8, 31)
    string_of(draw, model, types, length)
    if draw.random() < 0.5:
        model["string"] = ["default"] * (length - 1) + [draw.choice(list(model["vehicle_types"]))]
    return model


def car_behind_link(draw):
    model = car(draw)
    return model and dict(model, channel=channel(draw, 0.3))


def car_string(draw):
    """Cars and trucks with different lags, delays and gains, at one sample period."""
    model = car(draw)
    if model is None:
        return None
    if draw.random() < 0.5:
        model["channel"] = channel(draw, 0.2)
    types = []
    for _ in range(draw.randrange(1, 4)):
        own = car_vehicle(draw, model["sample_period"])
        if own["plant"] is None:
            return None
        if draw.random() < 0.3:
            own.pop("time_headway")
        if draw.random() < 0.4:
            own["channel"] = channel(draw, 0.2)
        types.append(own)
    return string_of(draw, model, types, draw.choice([2, 3, 4, 8, 12, 20]))


def flat(draw):
    """A model with 1 - |T^|^2 = O(w^4) or smaller at w = 0, to double precision: T is a finite impulse response, symmetric except
    for terms that compensate the slope of the losses."""
    model = calm(draw)
    if model is None:
        return None
    for key in ("plant", "controller"):
        del model[key]
    model["channel"] = {"delay": draw.choice([0, 0, 1])}
    if draw.random() < 0.2:
        model["channel"]["noise_filter"] = {"numerator": [1.0, -1.0], "denominator": [1.0, -0.5]}
    if draw.random() < 0.5:  # z^-(n + 1) (1 - c (1 - cos w)^n)
        power, c = draw.choice([2, 3]), dyadic(draw.uniform(0.01, 0.24))
        curve = [1.0]
        for _ in range(power):
            curve = np.convolve(curve, [-0.5, 1.0, -0.5])
        if power == 3:  # if the noise has no power at w = 0, a limit exists but needs more digits than this audit has
            model["channel"].pop("noise_filter", None)
        response = -c * curve
        response[power] += 1
    else:
        q, on_loss = dyadic(draw.uniform(0.01, 0.12)), draw.choice(["hold", "extrapolate", "extrapolate"])
        model["channel"]["loss"] = {"probability": q, "on_loss": on_loss}
        # |p F|^2 = 1 + bend w^2 + ..., the variance of the response about its mean.
        bend = -q / (1 - q) ** 2 if on_loss == "hold" else 2 * q / (1 - q)
        power, a = 2, -dyadic(draw.uniform(0.005, 0.1))
        b = (bend - 8 * a) / 2
        response = [a, b, 1 - 2 * a - 2 * b, b, a]
    size = 2 * power + 1
    return dict(model, time_headway=power + 1.0, closed_loop={
        "A": [[1.0 if j == i + 1 else 0.0 for j in range(size)] for i in range(size)],
        "B": [float(x) for x in response], "C": [1.0] + [0.0] * (size - 1)})


def admissible(model):
    """Whether every vehicle and every link is stable, with all loss probabilities given."""
    names = ["default"] + list(model.get("vehicle_types", {}))
    for vehicle in {id(v): v for v in link_reference.vehicles_of(dict(model, string=names), len(names))}.values():
        if link_needs(vehicle) or not settles(vehicle):
            return False
    return True


def link_needs(vehicle):
    """Whether a loss probability is missing."""
    return "probability" not in vehicle.get("channel", {}).get("loss", {"probability": 0})


def settles(vehicle):
    follower = made(vehicle)
    return follower.loop.rho < 1 - mpf(10) ** -7 and follower.feedback < 1 - mpf(10) ** -7


def seems_stable(model):
    """Whether |T^| of the pattern stays below 1 on a coarse grid in double precision, which suffices for drawing models."""
    w = np.geomspace(1e-3, np.pi, 400)
    z, log = np.exp(1j * w), 0
    names = model.get("string", ["default"])
    vehicles = link_reference.vehicles_of(model, len(names))
    for vehicle in {id(v): v for v in vehicles}.values():
        n, d = link_reference.polynomials_of(vehicle)
        if abs(np.roots(d)).max() >= 1:
            return False
        loss = vehicle.get("channel", {}).get("loss", {"probability": 0.0, "on_loss": "hold"})
        f = 1 / (1 - loss["probability"] * sum(c * z ** -(j + 1.0) for j, c in enumerate(link_reference.predictor_of(loss))))
        gain = abs(np.polyval(n, z) / np.polyval(d, z) * f * (1 - loss["probability"]))
        log = log + np.log(gain) * sum(v is vehicle for v in vehicles)
    return log.max() < 1e-9


def lengthened(draw, model, seems=seems_stable):
    """The model, in most cases with headways increased until it seems stable, times a factor of 0.9 to 2."""
    if model is None or "plant" not in model or draw.random() < 0.2 or any(
            link_needs(vehicle) for vehicle in link_reference.vehicles_of(model, 30)):
        return model
    for _ in range(12):
        if seems(model):
            break
        model = with_headways(model, 1.3)
    return with_headways(model, draw.choice([draw.uniform(0.9, 1.0), draw.uniform(1, 1.1), draw.uniform(1, 2)]))


def with_headways(model, factor):
    types = {name: dict(own, time_headway=own["time_headway"] * factor) if "time_headway" in own else own
             for name, own in model.get("vehicle_types", {}).items()}
    return dict(model, time_headway=model["time_headway"] * factor, **({"vehicle_types": types} if types else {}))


def mostly_stable(kind):
    @functools.wraps(kind)
    def drawn(draw):
        return lengthened(draw, kind(draw))
    return drawn


KINDS = [described_car] + [mostly_stable(kind) for kind in (car, linked, mixed, long_pattern, car_behind_link, car_string, flat)]
