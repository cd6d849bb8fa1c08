"""Vehicles that receive positions and control inputs, each over a link of its own, behind vehicles of another type.

With P = (z - 1)^2 G / P_1, P_1 the limit of (z - 1)^2 G at z = 1, every vehicle is described by psi: y = P psi and
u = (z - 1)^2 psi / P_1, which has neither the poles of G at z = 1 nor its zeros, wherever these are. From

    H' u = K (r - H y) + F v,   H' = H with a headway filter, else 1,

with r received for y and v for u of the predecessor, psi = (P_1 K r + P_1 F v) / (H' (z - 1)^2 + P_1 K H P).
"""

import numpy as np
from mpmath import mpf

from audit.followers import long
from audit.integers import quotient
from audit.loops import at_one
from audit.loss_chains import Link
from audit.polynomials import plus, taylor_about_one, times, value, without_factor, zeros
from audit.sampled import discrete_controller, pulse_transfer

SQUARE = [mpf(1), mpf(-2), mpf(1)]  # (z - 1)^2


def inputs_of(vehicle):
    """The position that a vehicle receives, and the input or None."""
    given = {entry["signal"]: entry for entry in vehicle.get("inputs", [])}
    position = given.get("position", {"channel": vehicle.get("channel", {})})
    return dict({"noise_variance": vehicle.get("noise_variance")}, **position), given.get("input")


def plant_of(vehicle):
    """(z - 1)^2 G."""
    plant = vehicle["plant"]
    if "actuator_lag" in plant:
        n, d = pulse_transfer(vehicle["sample_period"], plant["actuator_lag"], plant["input_delay"])
    else:
        n, d = ([mpf(a) for a in plant[part]] for part in ("numerator", "denominator"))
        d = at_one(d)
    d = without_factor(without_factor(d, mpf(1)), mpf(1))
    while len(d) > 1 and n[-1] == 0 and d[-1] == 0:
        n, d = n[:-1], d[:-1]
    return n, d


def controller_of(vehicle):
    controller, h = vehicle["controller"], mpf(vehicle["time_headway"])
    if "kp" in controller:
        return discrete_controller(controller, vehicle["sample_period"])
    n, d = ([mpf(a) for a in controller[part]] for part in ("numerator", "denominator"))
    return n, [a * (1 + h) for a in d] if controller.get("divide_by_one_plus_headway") else d


class Receiver:
    def __init__(self, vehicle):
        n, self.plant = plant_of(vehicle)
        self.rise = value(n, mpf(1)) / value(self.plant, mpf(1))  # P_1
        self.motion, self.h = [a / self.rise for a in n], mpf(vehicle["time_headway"])  # P = motion / plant
        above, below = ([self.rise * a for a in controller_of(vehicle)[0]], controller_of(vehicle)[1])
        self.policy, z = [1 + self.h, -self.h], [mpf(1), mpf(0)]
        self.policy_below = z
        filtered = vehicle["controller"].get("headway_filter", False)
        # All times z, the controller's and the plant's denominator.
        self.loop = plus(times(times(SQUARE, self.policy if filtered else z), times(below, self.plant)),
                         times(times(self.motion, self.policy), above))
        self.of_position = times(times(above, self.plant), z)
        position, radio = inputs_of(vehicle)
        self.links = [Link(position.get("channel", {}), position["noise_variance"])]
        self.of_radio = [mpf(0)]
        if radio:
            self.links.append(Link(radio["channel"], radio["noise_variance"]))
            self.of_radio = [self.rise * mpf(radio.get("gain", 1.0)) * a for a in times(times(below, self.plant), z)]
        self.poles = zeros(self.loop)
        self.rho = max(abs(z) for z in self.poles)

    def settles(self):
        return self.rho < 1 and all(link.settles() for link in self.links)

    def singular(self):
        """Zeros near the unit circle of all denominators, and of 1 - mu / z."""
        chains = [link.mu for link in self.links if link.q and not link.white]
        return [z for z in self.poles + sum((link.poles for link in self.links), []) + chains if abs(z) > mpf(10) ** -3]


class Pair:
    """A follower behind a vehicle of another type: psi = factor psi_ahead + what its links add."""

    def __init__(self, own, ahead):
        self.own, self.ahead = own, ahead
        # What it receives per psi ahead: P of the position, (z - 1)^2 / P_1 of the input.
        self.sent = [(ahead.motion, ahead.plant), ([a / ahead.rise for a in SQUARE], [mpf(1)])]
        self.n, self.d = [mpf(0)], [mpf(1)]
        for link, (above, below), of in zip(own.links, self.sent, (own.of_position, own.of_radio)):
            arrives, over = link.response()
            above, below = times(times(of, above), arrives), times(below, over + [mpf(0)] * link.delay)
            self.n, self.d = plus(times(self.n, below), times(above, self.d)), times(self.d, below)
        self.d = times(self.d, own.loop)
        # The tracking error is P_ahead psi_ahead - H P psi.
        own_below = times(own.plant, own.policy_below)
        self.error = plus(times(times(ahead.motion, own_below), self.d),
                          [-a for a in times(times(times(own.motion, own.policy), self.n), ahead.plant)])
        self.error_below = times(times(ahead.plant, own_below), self.d)

    def slope_at_zero(self):
        """The limit of -log |factor|^2 / (1 - cos w) for w -> 0."""
        n, d = (taylor_about_one(p, 3) + [mpf(0)] * 2 for p in (self.n, self.d))
        # log p(e^{jw}) = log a + (b/a) (jw - w^2/2) - (c/a) w^2 + (b/a)^2 w^2/2; the factor is 1 at z = 1.
        bend = [-p[1] / p[0] / 2 - p[2] / p[0] + (p[1] / p[0]) ** 2 / 2 for p in (n, d)]
        return -4 * (bend[0] - bend[1])

    def log_at(self, points):
        """|factor|^2 and its logarithm."""
        above, below = points.square(self.n), points.square(self.d)
        gain, change = quotient(above, below), quotient(above - below, below)
        with np.errstate(divide="ignore"):
            return gain, np.where(np.abs(change) < 0.5, np.log1p(np.where(np.abs(change) < 0.5, change, 0)), np.log(gain))

    def at(self, points):
        own = self.own
        gain, log = self.log_at(points)
        loop = points.square(own.loop)
        links = []
        for link, sent, of in zip(own.links, self.sent, (own.of_position, own.of_radio)):
            passed = points.gain(*link.response())
            noise = points.gain(*link.colour) * long(link.noise) + long(link.dither)
            links.append({"enters": quotient(points.square(of), loop), "passed": passed, "noise": noise, "sent": points.gain(*sent),
                          "innovation": link.innovation(points) if link.q else 0, "scatters": points.gain(*of_scatter(link))})
        return {"gain": gain, "log": log, "complement": points.gain(self.error, self.error_below), "links": links,
                "headway": points.gain(times(own.motion, own.policy), times(own.plant, own.policy_below))}


def of_scatter(link):
    """A function with the poles of the scattered spectrum, for the choice of nodes."""
    if not link.q:
        return [mpf(0)], [mpf(1)]
    if link.white:
        return [mpf(1)], link.registers
    return [link.q] + [mpf(0)] * (len(link.determinant) - 1), link.determinant
