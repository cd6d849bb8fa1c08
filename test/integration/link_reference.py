"""Reference moments of a platoon over links, from their definition only and without code of the package.

Propagates mean and covariance of the whole string's state (every vehicle, every register of every link) step by step with numpy.
A model is the dictionary of the model file.
"""

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
    return {"hold": [1.0], "extrapolate": [2.0, -1.0]}.get(loss["on_loss"], loss["on_loss"]) if isinstance(
        loss["on_loss"], str) else loss["on_loss"]


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
        self.q, self.predictor = loss["probability"], np.array(predictor_of(loss), float)
        self.noise, self.dither = vehicle["noise_variance"], link.get("quantisation_step", 0.0) ** 2 / 12.0
        self.initial = vehicle["initial_position"]
        sizes = [len(self.b), len(self.wb), self.delay, len(self.predictor), 1]  # x, filter, delay, used, y(k-1)
        ends = start + np.cumsum(sizes)
        self.x, self.f, self.past, self.used, self.before = [np.arange(e - n, e) for e, n in zip(ends, sizes)]
        self.end = ends[-1]
        equilibrium = np.linalg.solve(np.eye(len(self.b)) - self.a, self.b)
        self.equilibrium = equilibrium / (self.c @ equilibrium)


def moments(model, followers, steps):
    """Mean and variance of zeta_i(k), shape (followers, steps) each, and the loop's covariance at the end of each step.

    X(k) holds everything before step k. With theta_i = p + (theta_i - p) every step is X' = M X + b y_0(k) + noises
    + sum_i (theta_i - p) G_i e_i, e_i = s_i - c r linear in X, y_0 and the noises of link i."""
    vehicles = vehicles_of(model, followers)
    parts, size = [], 0
    for vehicle in vehicles:
        parts.append(Part(vehicle, size))
        size = parts[-1].end
    leader = state_space(*polynomials_of(vehicles_of(dict(model, string=["default"]), 1)[0]))

    def r0(k):
        position, k0 = 0.0, 0
        changes = model["leader"]["speed"]
        for n in range(k0, k):
            speed = [change["value"] for change in changes if change["from_step"] <= n]
            position += model["sample_period"] * (speed[-1] if speed else 0.0)
        return position

    # Row vectors over [X, y_0, g_1, nu_1, g_2, nu_2, ...]: noises of unit variance.
    width = size + 1 + 2 * followers
    place = lambda index: np.eye(width)[index]
    m, gains, innovations = np.zeros((size, width)), [], []
    y, y_before, above = [], [], place(size)
    for i, part in enumerate(parts):
        g, nu = place(size + 1 + 2 * i), place(size + 2 + 2 * i)
        own = np.zeros(width)
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
        predicted = np.zeros(width)
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
        gains.append(gain)
        innovations.append(innovation)
        above = own
    error = [(y[i - 1] if i else place(size)) - y[i] - parts[i].h * (y[i] - y_before[i]) for i in range(followers)]

    # Step -1: all vehicles are at rest; links pass the position unchanged.
    y0_state = np.zeros(len(leader[1]))
    mean, covariance = np.zeros(size), np.zeros((size, size))
    position_mean, source = 0.0, None
    for i, part in enumerate(parts):
        own_mean, own_variance = part.initial["mean"], part.initial["variance"]
        column = np.zeros(size)  # response of the state after step -1 to this vehicle's own initial position
        column[part.x] = part.a @ part.equilibrium
        column[part.before] = 1.0
        if i + 1 < followers:
            behind = parts[i + 1]
            column[behind.x] += behind.b
            column[behind.past] = 1.0
            column[behind.used] = 1.0
        mean += own_mean * column
        covariance += own_variance * np.outer(column, column)
    y0_state = leader[0] @ y0_state + leader[1] * r0(-1)

    means, variances = np.zeros((followers, steps)), np.zeros((followers, steps))
    for k in range(steps):
        y0 = leader[2] @ y0_state
        y0_state = leader[0] @ y0_state + leader[1] * r0(k)
        whole_mean = np.concatenate([mean, [y0], np.zeros(2 * followers)])
        whole = np.zeros((width, width))
        whole[:size, :size] = covariance
        whole[size + 1:, size + 1:] = np.eye(2 * followers)
        for i in range(followers):
            means[i, k] = error[i] @ whole_mean
            variances[i, k] = error[i] @ whole @ error[i]
        mean = m @ whole_mean
        covariance = m @ whole @ m.T
        for part, gain, innovation in zip(parts, gains, innovations):
            if part.q > 0.0:
                second = innovation @ whole @ innovation + (innovation @ whole_mean) ** 2
                covariance += part.q * (1.0 - part.q) * second * np.outer(gain, gain)
    return means, variances
