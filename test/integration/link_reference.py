"""Reference moments of a platoon over links, from their definition only and without code of the package.

Propagates mean and covariance of the whole string's state (every vehicle, every register of every link) step by step with numpy.
A model is the dictionary of the model file.
"""

import itertools
import math

import numpy as np


def polynomials_of(vehicle):
    """N and D of T = K G / (1 + K G H) by descending powers of z, D monic."""
    plant, controller, h = vehicle["plant"], vehicle["controller"], vehicle["time_headway"]
    gain = 1.0 / (1.0 + h) if controller.get("divide_by_one_plus_headway") else 1.0
    n = gain * np.polymul(plant["numerator"], controller["numerator"])
    d = np.polymul(plant["denominator"], controller["denominator"])
    # T = (n/d) / (1 + (n/d) ((1+h) z - h)/z) = n z / (d z + n ((1+h) z - h))
    numerator, denominator = np.polymul(n, [1.0, 0.0]), np.polyadd(np.polymul(d, [1.0, 0.0]), np.polymul(n, [1.0 + h, -h]))
    return np.atleast_1d(numerator) / denominator[0], denominator / denominator[0]


def state_space(numerator, denominator):
    """A, B, C, D in controllable canonical form (the package uses the observable one)."""
    n = len(denominator) - 1
    b = np.concatenate([np.zeros(n + 1 - len(numerator)), numerator])
    feed = b[0]
    a_matrix = np.zeros((n, n))
    if n:
        a_matrix[0, :] = -np.asarray(denominator[1:])
        a_matrix[1:, :-1] += np.eye(n - 1)
    b_vector = np.zeros(n)
    if n:
        b_vector[0] = 1.0
    return a_matrix, b_vector, b[1:] - np.asarray(denominator[1:]) * feed, feed


def merged(base, own):
    """A vehicle type with missing keys filled from the default vehicle; links are merged key by key."""
    result = {key: value for key, value in base.items() if key not in ("vehicle_types", "string")}
    for key, value in own.items():
        result[key] = merged(base.get(key, {}), value) if key in ("channel", "loss") else value
    return result


def vehicles_of(model, followers):
    types = {"default": merged(model, {})}
    types.update({name: merged(model, own) for name, own in model.get("vehicle_types", {}).items()})
    names = model.get("string", ["default"])
    return [types[names[i % len(names)]] for i in range(followers)]


def predictor_of(loss):
    return {"hold": [1.0], "extrapolate": [2.0, -1.0], "zero": []}.get(loss["on_loss"], loss["on_loss"]) if isinstance(
        loss["on_loss"], str) else loss["on_loss"]


def stationary(transition):
    """The stationary probabilities of a chain: pi P = pi."""
    p = np.array(transition, float)
    system = np.vstack([p.T - np.eye(len(p)), np.ones(len(p))])
    return np.linalg.lstsq(system, np.append(np.zeros(len(p)), 1.0), rcond=None)[0]


def loss_probability(loss):
    if "markov" not in loss:
        return loss["probability"]
    return float(stationary(loss["markov"]["transition"]) @ np.array(loss["markov"]["probability"]))


def chain_of(loss):
    """Transitions from the row's mode to the column's, the stationary probabilities, and which modes are lost: those of a
    chain of states are arrived in each state and lost in each."""
    if "markov" in loss:
        p, lost = np.array(loss["markov"]["transition"], float), np.array(loss["markov"]["probability"], float)
        pi = stationary(p)
        return (np.vstack([np.hstack([p * (1.0 - lost), p * lost])] * 2), np.concatenate([pi * (1.0 - lost), pi * lost]),
                np.repeat([False, True], len(p)))
    q = loss["probability"]
    b = loss.get("mean_burst", 1.0 / (1.0 - q))
    return (np.array([[1.0 - q / (1.0 - q) / b, q / (1.0 - q) / b], [1.0 / b, 1.0 - 1.0 / b]]), np.array([1.0 - q, q]),
            np.array([False, True]))


def joint_chain(losses, number=float):
    """The modes of several links together: one tuple of modes per joint mode, its stationary probability, the transitions, and
    per joint mode which links lose."""
    chains = [chain_of(loss) if loss else (np.ones((1, 1)), np.ones(1), [False]) for loss in losses]
    modes = list(itertools.product(*(range(len(pi)) for _, pi, _ in chains)))
    stationary = np.array([math.prod(number(pi[c]) for (_, pi, _), c in zip(chains, mode)) for mode in modes])
    step = np.array([[math.prod(number(p[a, c]) for (p, _, _), a, c in zip(chains, before, after)) for after in modes] for before in modes])
    return modes, stationary, step, [[bool(lost[c]) for (_, _, lost), c in zip(chains, mode)] for mode in modes]


class Part:
    """One follower and its link: indices into the state, and matrices."""

    def __init__(self, vehicle, start):
        link = vehicle.get("channel", {})
        self.h = vehicle["time_headway"]
        self.a, self.b, self.c, _ = state_space(*polynomials_of(vehicle))
        wanted = link.get("noise_filter", {"numerator": [1.0], "denominator": [1.0]})
        numerator, denominator = np.array(wanted["numerator"], float), np.array(wanted["denominator"], float)
        self.wa, self.wb, self.wc, self.wd = state_space(numerator / denominator[0], denominator / denominator[0])
        self.delay = link.get("delay", 0)
        loss = link.get("loss", {"probability": 0.0, "on_loss": [1.0]})
        self.q, self.predictor = loss_probability(loss), np.array(predictor_of(loss), float)
        self.noise, self.dither = vehicle["noise_variance"], link.get("quantisation_step", 0.0) ** 2 / 12.0
        self.initial = vehicle["initial_position"]
        sizes = [len(self.b), len(self.wb), self.delay, len(self.predictor), 1]  # x, filter, delay, used, y(k-1)
        ends = start + np.cumsum(sizes)
        self.x, self.f, self.past, self.used, self.before = [np.arange(e - n, e) for e, n in zip(ends, sizes)]
        self.end = ends[-1]
        equilibrium = np.linalg.solve(np.eye(len(self.b)) - self.a, self.b)
        self.equilibrium = equilibrium / (self.c @ equilibrium)


class System:
    """The whole string: every step is X' = M [X, y_0, noises] + sum_i (theta_i - p_i) G_i e_i, where X(k) holds everything before
    step k, theta_i is 1 for an arrival, and e_i = s_i - c r is linear in X, y_0 and the noises of link i.

    Row vectors are over [X, y_0, g_1, nu_1, g_2, nu_2, ...], with noises of unit variance."""

    def __init__(self, model, followers):
        self.parts, size = [], 0
        for vehicle in vehicles_of(model, followers):
            self.parts.append(Part(vehicle, size))
            size = self.parts[-1].end
        self.model, self.size, self.width = model, size, size + 1 + 2 * followers
        place = lambda index: np.eye(self.width)[index]
        m, self.gains, self.innovations = np.zeros((size, self.width)), [], []
        y, y_before, above = [], [], place(size)
        for i, part in enumerate(self.parts):
            g, nu = place(size + 1 + 2 * i), place(size + 2 + 2 * i)
            own = np.zeros(self.width)
            own[part.x] = part.c
            y.append(own)
            y_before.append(place(part.before[0]))
            noise = part.wd * g
            noise[part.f] += part.wc
            sent = above + np.sqrt(part.dither) * nu + np.sqrt(part.noise) * noise
            if len(part.f):
                m[part.f[:, None], part.f] += part.wa
                m[part.f] += np.outer(part.wb, g)
            arriving = sent
            if part.delay:
                arriving = place(part.past[-1])
                m[part.past[0]] = sent
                for j in range(1, part.delay):
                    m[part.past[j], part.past[j - 1]] = 1.0
            predicted = np.zeros(self.width)
            predicted[part.used] = part.predictor
            innovation = arriving - predicted
            received = predicted + (1.0 - part.q) * innovation
            gain = np.zeros(size)
            for j in range(1, len(part.predictor)):
                m[part.used[j], part.used[j - 1]] = 1.0
            m[part.used[0]] = received
            gain[part.used[0]] = 1.0
            m[part.x[:, None], part.x] += part.a
            m[part.x] += np.outer(part.b, received)
            gain[part.x] += part.b
            m[part.before[0]] = own
            self.gains.append(gain)
            self.innovations.append(innovation)
            above = own
        self.m = m
        self.error = [(y[i - 1] if i else place(size)) - y[i] - part.h * (y[i] - y_before[i]) for i, part in enumerate(self.parts)]

    def start(self):
        """Mean and covariance after step -1: all vehicles are at rest; links pass the position unchanged."""
        mean, covariance = np.zeros(self.size), np.zeros((self.size, self.size))
        for i, part in enumerate(self.parts):
            column = np.zeros(self.size)  # response of the state after step -1 to this vehicle's own initial position
            column[part.x] = part.a @ part.equilibrium
            column[part.before] = 1.0
            if i + 1 < len(self.parts):
                behind = self.parts[i + 1]
                column[behind.x] += behind.b
                column[behind.past] = 1.0
                column[behind.used] = 1.0
            mean += part.initial["mean"] * column
            covariance += part.initial["variance"] * np.outer(column, column)
        return mean, covariance

    def leader(self, steps):
        """y_0(0), y_0(1), ..., y_0(steps - 1)."""
        a, b, c, _ = state_space(*polynomials_of(vehicles_of(dict(self.model, string=["default"]), 1)[0]))
        state, position, positions = b * 0.0, 0.0, []
        for k in range(steps):
            positions.append(c @ state)
            state = a @ state + b * position
            speed = [change["value"] for change in self.model["leader"]["speed"] if change["from_step"] <= k]
            position += self.model["sample_period"] * (speed[-1] if speed else 0.0)
        return positions


def moments(model, followers, steps):
    """Mean and variance of zeta_i(k), shape (followers, steps) each, over links with independent losses."""
    system = System(model, followers)
    mean, covariance = system.start()
    means, variances = np.zeros((followers, steps)), np.zeros((followers, steps))
    for k, y0 in enumerate(system.leader(steps)):
        whole_mean = np.concatenate([mean, [y0], np.zeros(2 * followers)])
        whole = np.zeros((system.width, system.width))
        whole[:system.size, :system.size] = covariance
        whole[system.size + 1:, system.size + 1:] = np.eye(2 * followers)
        for i, error in enumerate(system.error):
            means[i, k] = error @ whole_mean
            variances[i, k] = error @ whole @ error
        mean = system.m @ whole_mean
        covariance = system.m @ whole @ system.m.T
        for part, gain, innovation in zip(system.parts, system.gains, system.innovations):
            if part.q > 0.0:
                second = innovation @ whole @ innovation + (innovation @ whole_mean) ** 2
                covariance += part.q * (1.0 - part.q) * second * np.outer(gain, gain)
    return means, variances
