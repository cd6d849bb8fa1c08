"""Random platoons over links that lose positions in bursts, over the whole range of probabilities and mean bursts."""

import math

from audit.loss_chains import Link
from audit.received_strings import String
from audit.string_models import calm, channel, lengthened, predictor, string_of, type_of

MOST_BURST = 1e6


def burst_loss(draw):
    while True:
        q = draw.choice([math.exp(draw.uniform(math.log(1e-16), math.log(1e-3))), draw.uniform(0.02, 0.5), draw.uniform(0.5, 0.9),
                         math.exp(draw.uniform(math.log(1e-3), math.log(0.5)))])
        least = max(1.0, q / (1 - q))
        most = draw.choice([3 * least, 30 * least, 3000.0, 3000.0, MOST_BURST])
        loss = {"probability": q, "mean_burst": least * math.exp(draw.uniform(0.001, math.log(most / least))),
                "on_loss": draw.choice(["hold", predictor(draw)])}
        if Link({"loss": dict(loss, mean_burst=1.1 * loss["mean_burst"])}, 0).settles():
            return loss


def burst_channel(draw):
    return dict(channel(draw), loss=burst_loss(draw))


def seems_stable(model):
    string = String(model)
    return not string.mean_square_stable() or string.attenuates()


def burst(draw):
    model = calm(draw)
    return model and lengthened(draw, dict(model, channel=burst_channel(draw)), seems_stable)


def burst_string(draw):
    """Vehicles whose links lose in bursts, independently or not at all."""
    model = calm(draw)
    if model is None:
        return None
    model["channel"], types = burst_channel(draw), []
    for _ in range(draw.randrange(1, 3)):
        own = type_of(draw, dict(model, channel={}), False)
        if own is None:
            return None
        q = draw.uniform(0.01, 0.5)
        own["channel"] = draw.choice([burst_channel(draw), burst_channel(draw), {"loss": {"probability": 0.0}},
                                      {"loss": {"probability": q, "mean_burst": 1 / (1 - q), "on_loss": "hold"}}])
        types.append(own)
    return lengthened(draw, string_of(draw, model, types, draw.choice([1, 2, 2, 3])), seems_stable)


def burst_extrapolated(draw):
    """Rare long bursts in which predictions grow steadily: powers of the mean burst, not to be lost as differences of larger ones."""
    model = calm(draw)
    while model:
        loss = {"probability": math.exp(draw.uniform(math.log(1e-16), math.log(1e-9))),
                "mean_burst": math.exp(draw.uniform(math.log(300), math.log(30000))), "on_loss": "extrapolate"}
        if Link({"loss": dict(loss, mean_burst=1.1 * loss["mean_burst"])}, 0).settles():
            return lengthened(draw, dict(model, channel=dict(channel(draw), loss=loss)), seems_stable)
    return None


KINDS = [burst, burst_string, burst_extrapolated]
