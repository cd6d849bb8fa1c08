"""Random strings of unlike cars that receive positions by radar and inputs by radio. All numbers are doubles."""

import math

from audit.burst_models import seems_stable
from audit.cars import described_car
from audit.string_models import calm, channel, lengthened, string_of


def radio_channel(draw):
    link = {"delay": draw.choice([1, 1, 2, 3, draw.randint(1, 20)])}
    if draw.random() < 0.5:
        link["loss"] = {"probability": math.exp(draw.uniform(-7, -0.7)), "on_loss": draw.choice(["hold", "extrapolate", "zero"])}
    if draw.random() < 0.2:
        link.update({key: value for key, value in channel(draw).items() if key in ("noise_filter", "quantisation_step")})
    return link


def inputs(draw, radio):
    radar = {"signal": "position", "from": "predecessor", "noise_variance": math.exp(draw.uniform(-7, -1))}
    if draw.random() < 0.4:
        radar["channel"] = channel(draw, 0.2)
    entry = {"signal": "input", "from": "predecessor", "gain": draw.choice([1.0, 1.0, draw.uniform(-0.3, 1.2)]),
             "noise_variance": math.exp(draw.uniform(-7, -1)), "channel": radio_channel(draw)}
    return [radar, entry] if radio else [radar]


def driven(draw, period):
    """Plant, controller and headway of a car at a sample period."""
    car = described_car(draw)
    delay = min(car["plant"]["input_delay"], 14 * period)
    if draw.random() < 0.5:
        delay = round(delay / period) * period
    return {"plant": dict(car["plant"], input_delay=delay), "controller": car["controller"],
            "time_headway": car["time_headway"] * car["sample_period"] / period}


def with_inputs(draw, base):
    return dict({key: value for key, value in base.items() if key != "noise_variance"}, inputs=inputs(draw, True))


def radio_string(draw):
    """Cars and trucks of unlike lags, delays, gains and headways; most receive inputs, some only positions."""
    base = described_car(draw)
    period = base["sample_period"] = draw.choice([0.02, 0.05, 0.1, draw.uniform(0.02, 0.1)])
    model, types = dict(with_inputs(draw, base), **driven(draw, period)), []
    for _ in range(draw.randrange(1, 4)):
        own = driven(draw, period)
        if draw.random() < 0.25:
            own = {key: own[key] for key in draw.sample(sorted(own), draw.randrange(1, 3))}
        if draw.random() < 0.75:
            own["inputs"] = inputs(draw, draw.random() < 0.7)
        types.append(own)
    return lengthened(draw, string_of(draw, model, types, draw.choice([2, 2, 3, 4, 7])), seems_stable)


def given_radio_string(draw):
    """The same for plants and controllers given as functions of z, of the paper's kind."""
    base = calm(draw)
    others = [calm(draw) for _ in range(draw.randrange(1, 3))]
    if base is None or None in others:
        return None
    model, types = dict(with_inputs(draw, base), time_headway=draw.uniform(2, 20)), []
    for other in others:
        own = dict({key: other[key] for key in ("plant", "controller")}, time_headway=draw.uniform(2, 20))
        if draw.random() < 0.7:
            own["inputs"] = inputs(draw, draw.random() < 0.7)
        types.append(own)
    return lengthened(draw, string_of(draw, model, types, draw.choice([2, 3, 4])), seems_stable)


KINDS = [radio_string, given_radio_string]
