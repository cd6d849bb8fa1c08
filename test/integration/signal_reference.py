"""Random platoons, and their responses and spectra computed from their definition, without code of the package.

Kinds: the paper's platoon, mixed strings with delays and coloured noise, cars with actuator lag behind radar and radio.
"""

import numpy as np
from scipy.signal import lfilter, lfiltic
from scipy.special import ndtr

import link_reference
import radio_reference as radio

LONG, COMPLEX = np.longdouble, np.clongdouble
FOLLOWERS, STEPS = 4, 50


def loop(draw):
    return {"plant": {"numerator": [1.0], "denominator": [1.0, -2.0, 1.0]},
            "controller": {"numerator": [draw.uniform(1.1, 1.5), 0.0], "denominator": [1.0, draw.uniform(0.7, 0.9)],
                           "divide_by_one_plus_headway": True},
            "time_headway": draw.uniform(2.6, 4.5), "standstill_distance": draw.uniform(0.5, 4.0),
            "vehicle_length": draw.uniform(0.0, 6.0), "noise_variance": draw.uniform(0.1, 1.0),
            "initial_position": {"mean": draw.uniform(-1, 1), "variance": draw.choice([0.0, draw.uniform(0, 1)])}}


def link(draw):
    pole = draw.uniform(-0.5, 0.8)
    colour = {"numerator": [draw.uniform(0.5, 1.0), draw.uniform(-0.5, 0.5)], "denominator": [1.0, -pole]}
    return dict({"delay": draw.choice([0, 1, 2, 5, 30])}, **({"noise_filter": colour} if draw.random() < 0.5 else {}))


def drawn(kind, draw):
    if kind == "radio":
        model = radio.drawn(draw)
        model["inputs"][1]["channel"].pop("loss", None)
        return dict(model, standstill_distance=draw.uniform(0.0, 2.0), vehicle_length=20.0 * model["time_headway_seconds"],
                    initial_position={"mean": 0.0, "variance": 0.0})
    model = dict(loop(draw), sample_period=0.1,
                 leader={"speed": [{"from_step": 0, "value": 20.0}, {"from_step": draw.randint(5, 30), "value": draw.uniform(10, 20)}]})
    if kind == "mixed":
        model.update(channel=link(draw), vehicle_types={"truck": dict(loop(draw), channel=link(draw)), "bus": {"channel": link(draw)}},
                     string=draw.choice([["truck", "default"], ["bus", "truck", "default"], ["truck"]]))
    return model


class LinkedPlatoon:
    """Strings of transfer functions: T, W and the delay of every follower."""

    def __init__(self, model):
        self.model = model
        self.pattern = len(model.get("string", [0]))
        self.vehicles = link_reference.vehicles_of(model, FOLLOWERS + 2 * self.pattern)

    def motion(self, vehicle, received, initial=0.0):
        """y from step -1 on, for the inputs received from step -1 on and the vehicle's position before the first input."""
        b, a = link_reference.polynomials_of(vehicle)
        b = np.concatenate([np.zeros(len(a) - len(b)), b])
        state = lfiltic(b, a, np.full(len(a), initial), np.full(len(a), initial)) if initial else np.zeros(len(a) - 1)
        return lfilter(b, a, received, zi=state)[0]

    def arriving(self, vehicle, sent):
        delay = vehicle.get("channel", {}).get("delay", 0)
        return np.concatenate([np.full(delay, sent[0]), sent])[:len(sent)]

    def downstream(self, first, own):
        rows = np.zeros((FOLLOWERS + 1, STEPS + 1))
        rows[first] = own
        for i in range(first + 1, FOLLOWERS + 1):
            rows[i] = self.motion(self.vehicles[i - 1], self.arriving(self.vehicles[i - 1], rows[i - 1]))
        return rows

    def responses(self):
        """The mean positions, and (variance, True for a noise, positions) for every source; rows 0 .. FOLLOWERS, from step -1 on."""
        speed = np.zeros(STEPS + 1)
        for change in self.model["leader"]["speed"]:
            speed[change["from_step"] + 2:] = change["value"]
        leader = self.motion(self.default_vehicle(), np.cumsum(speed) * self.model["sample_period"])
        mean, sources = self.downstream(0, leader), []
        for i, vehicle in enumerate(self.vehicles[:FOLLOWERS], 1):
            channel = vehicle.get("channel", {})
            w = channel.get("noise_filter", {"numerator": [1.0], "denominator": [1.0]})
            noise = lfilter(w["numerator"], w["denominator"], np.eye(STEPS + 1)[1])
            sources.append((vehicle["noise_variance"], True, self.downstream(i, self.motion(vehicle, self.arriving(vehicle, noise)))))
            free = self.downstream(i, self.motion(vehicle, np.zeros(STEPS + 1), 1.0))
            mean = mean + vehicle["initial_position"]["mean"] * free
            sources.append((vehicle["initial_position"]["variance"], False, free))
        return mean, sources

    def default_vehicle(self):
        return link_reference.vehicles_of({k: v for k, v in self.model.items() if k != "string"}, 1)[0]

    def spectra(self):
        """Weights, w, and for every vehicle T z^-m and the spectrum that its noise adds."""
        nodes, weights = np.polynomial.legendre.leggauss(32)
        edges = np.concatenate([[0.0], np.pi * 2.0 ** -np.arange(12.0, 3.0, -1.0), np.linspace(np.pi / 8, np.pi, 60)])
        half = (edges[1:] - edges[:-1]) / 2
        w = ((edges[1:] + edges[:-1])[:, None] / 2 + half[:, None] * nodes).ravel().astype(LONG)
        weight, found = (half[:, None] * weights / np.pi).ravel().astype(LONG), []
        z = np.exp(COMPLEX(1j) * w)
        for vehicle in self.vehicles:
            channel = vehicle.get("channel", {})
            colour = channel.get("noise_filter", {"numerator": [1.0], "denominator": [1.0]})
            ratio = lambda b, a: np.polyval(np.array(b, LONG), z) / np.polyval(np.array(a, LONG), z)
            extended = {key: {name: np.array(value, LONG) for name, value in vehicle[key].items()} for key in ("plant", "controller")}
            polynomials = link_reference.polynomials_of(dict(extended, time_headway=LONG(vehicle["time_headway"])))
            t = ratio(*polynomials) * z ** -channel.get("delay", 0)
            passed = abs(t * ratio(colour["numerator"], colour["denominator"]) * z ** (len(colour["numerator"]) - len(colour["denominator"]))) ** 2
            found.append((t, vehicle["noise_variance"] * passed))
        return weight, w, found

    def lag(self, i):
        return self.vehicles[i].get("channel", {}).get("delay", 0)


class RadioPlatoon(LinkedPlatoon):
    """Cars behind radar and radio, with the spectra and the step of radio_reference."""

    def __init__(self, model):
        self.model, self.pattern, self.car = model, 1, radio.Car(model)
        self.vehicles = [dict(model, time_headway=model["time_headway_seconds"] / model["sample_period"])] * (FOLLOWERS + 2)

    def responses(self):
        dense, sources = radio.Dense(self.car, FOLLOWERS), 2 * FOLLOWERS
        state, rows = np.zeros((dense.count, sources + 1), LONG), np.zeros((FOLLOWERS + 1, STEPS + 1, sources + 1))
        for k in range(-1, STEPS - 1):
            received, noise = np.zeros(sources + 1, LONG), np.zeros((sources, sources + 1), LONG)
            received[-1] = max(k, 0) * 20.0 * self.model["sample_period"]
            if k == 0:
                noise[:, :-1] = np.eye(sources)
            state = dense.step(state, received, noise, [(False, False)] * FOLLOWERS)
            rows[:, k + 2] = [state[dense.places[i, "y"]][0] for i in range(FOLLOWERS + 1)]
        return rows[:, :, -1], [([self.car.radar, self.car.radio][j % 2], True, rows[:, :, j]) for j in range(sources)]

    def spectra(self):
        x = radio.Spectra(self.car, 12)
        return x.weight, x.w, [(x.gamma, x.radar * self.car.radar + x.radio * self.car.radio)] * (FOLLOWERS + 2)


def signals_of(rows, period):
    """Gap (without distances), speed, acceleration, jerk and relative speed, shape (5, FOLLOWERS, STEPS + 1), from step -1 on."""
    padded = np.concatenate([np.repeat(rows[:, :1], 3, axis=1), rows], axis=1)
    moved = [(np.diff(padded, n, axis=1) / period ** n)[:, 3 - n:] for n in (1, 2, 3)]
    return np.array([rows[:-1] - rows[1:]] + [motion[1:] for motion in moved] + [moved[0][:-1] - moved[0][1:]])


def crossing(m1, v1, m2, v2, c):
    """P(x >= 0, y < 0) as an integral over the density of x."""
    if v1 < 1e-20 or v2 < 1e-20:
        below = lambda m, v: float(m < 0) if v < 1e-20 else ndtr(-m / np.sqrt(v))
        return (1 - below(m1, v1)) * below(m2, v2)
    deviation, slope, rest = np.sqrt(v1), c / v1, np.sqrt(max(v2 - c * c / v1, 1e-30))
    turn = m1 - m2 / slope if slope else m1
    cuts = np.concatenate([m1 + deviation * np.linspace(-12, 12, 97), turn + rest / max(abs(slope), 1e-9) * np.linspace(-10, 10, 41)])
    edges = np.unique(np.concatenate([[0.0], cuts[(cuts > 0) & (abs(cuts - m1) < 12.01 * deviation)]]))
    nodes, weights = np.polynomial.legendre.leggauss(20)
    half = np.diff(edges)[:, None] / 2
    u = edges[:-1, None] + half * (1 + nodes)
    density = np.exp(-0.5 * ((u - m1) / deviation) ** 2) / (deviation * np.sqrt(2 * np.pi))
    return np.sum(half * weights * density * ndtr(-(m2 + slope * (u - m1)) / rest))
