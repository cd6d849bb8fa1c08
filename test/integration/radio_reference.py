"""Random cars with radar and radio, and their theory, without code of the package: stationary values by Gamma at many frequencies in extended
precision, means and variances of every step by the second moments of the whole string."""

import itertools

import numpy as np
from mpmath import mp

from audit.sampled import pulse_transfer

LONG, COMPLEX = np.longdouble, np.clongdouble
FOLLOWERS, STEPS = 20, 40


def drawn(draw):
    period = draw.choice([0.01, 0.02, 0.05, draw.uniform(0.01, 0.1)])
    samples = draw.uniform(0, 12)
    radio = {"signal": "input", "from": "predecessor", "gain": draw.choice([1.0, 1.0, draw.uniform(0.5, 1.1)]),
             "noise_variance": draw.uniform(0.001, 0.1), "channel": {"delay": draw.randint(1, 8)}}
    if draw.random() < 0.5:
        radio["channel"]["loss"] = {"probability": draw.uniform(0.01, 0.3), "on_loss": draw.choice(["hold", "extrapolate", "zero"])}
    return {"plant": {"actuator_lag": draw.choice([0.0, draw.uniform(0.05, 0.5)]),
                      "input_delay": (round(samples) if draw.random() < 0.5 else samples) * period},
            "controller": {"kp": draw.uniform(0.1, 0.5), "kd": draw.uniform(0.5, 1.2), "headway_filter": draw.random() < 0.8},
            "time_headway_seconds": draw.uniform(0.3, 3.0), "standstill_distance": 0.0, "sample_period": period,
            "inputs": [{"signal": "position", "from": "predecessor", "noise_variance": draw.uniform(0.001, 0.1)}, radio],
            "leader": {"speed": [{"from_step": 0, "value": 20.0}]}, "initial_position": {"mean": 0.0, "variance": 0.0}}


class Car:
    """The numbers of a model: G = numerator / denominator by descending powers of z, and the radio."""

    def __init__(self, model):
        self.period = model["sample_period"]
        numerator, denominator = pulse_transfer(self.period, model["plant"]["actuator_lag"], model["plant"]["input_delay"])
        self.numerator = np.array([LONG(mp.nstr(x, 25)) for x in numerator])
        self.denominator = np.array([LONG(mp.nstr(x, 25)) for x in denominator])
        if model["plant"]["actuator_lag"] == 0.0:  # the reference has a further pole and zero at z = 0
            self.numerator, self.denominator = trimmed(self.numerator, self.denominator)
        self.lag_pole = LONG(mp.nstr(mp.exp(-mp.mpf(self.period) / mp.mpf(model["plant"]["actuator_lag"])), 25)) \
            if model["plant"]["actuator_lag"] else None
        controller = model["controller"]
        self.kp, self.kd, self.filtered = LONG(controller["kp"]), LONG(controller["kd"]), controller["headway_filter"]
        self.h = LONG(model["time_headway_seconds"]) / LONG(self.period)
        self.radar, self.radio = model["inputs"][0]["noise_variance"], model["inputs"][1]["noise_variance"]
        self.gain, channel = LONG(model["inputs"][1]["gain"]), model["inputs"][1]["channel"]
        self.delay = channel["delay"]
        loss = channel.get("loss", {"probability": 0.0, "on_loss": "hold"})
        self.q = loss["probability"]
        self.predictor = {"hold": [1.0], "extrapolate": [2.0, -1.0], "zero": []}[loss["on_loss"]]


def trimmed(numerator, denominator):
    while len(denominator) > 1 and denominator[-1] == 0 and numerator[-1] == 0:
        numerator, denominator = numerator[:-1], denominator[:-1]
    return numerator, denominator


class Spectra:
    """Gamma, the gains of both noises and of lost inputs, and 1/|G|^2, at the nodes of a quadrature in [0, pi]."""

    def __init__(self, car, cuts):
        nodes, weights = np.polynomial.legendre.leggauss(32)
        edges = [np.pi * 2.0 ** -j for j in range(36)] + [0.0]
        w, weight = [], []
        for high, low in zip(edges, edges[1:]):
            for part in range(cuts):
                a, b = low + (high - low) * part / cuts, low + (high - low) * (part + 1) / cuts
                w.extend((a + b) / 2 + (b - a) / 2 * nodes)
                weight.extend((b - a) / 2 * weights / np.pi)
        w, self.weight = np.array(w, LONG), np.array(weight, LONG)
        self.w = w
        sine, cosine = np.sin(w / 2), np.cos(w / 2)
        s = -2 * sine * sine + COMPLEX(1j) * 2 * sine * cosine  # z - 1
        z, back = 1 + s, 1 / (1 + s)
        top = sum(c * z ** (len(car.numerator) - 1 - j) for j, c in enumerate(car.numerator))
        zeros = len(car.denominator) - 1 - (3 if car.lag_pole is not None else 2)
        bottom = s * s * z ** zeros * ((z - car.lag_pole) if car.lag_pole is not None else 1)
        inverse = bottom / top  # 1 / G
        k = car.kp + car.kd * s * back / LONG(car.period)
        policy = 1 + car.h * s * back
        h = policy if car.filtered else 1
        closed = inverse * h + (k * policy if not car.filtered else k * h)  # (1 + G K) H / G, or (1 + G K H) / G
        lost = LONG(car.q)
        prediction = sum((LONG(c) * back ** (j + 1) for j, c in enumerate(car.predictor)), 0 * z)
        used = 1 / (1 - lost * prediction)  # F
        of_radar, of_radio = k / closed, car.gain / closed
        self.gamma = of_radar + of_radio * (1 - lost) * used * back ** car.delay * inverse
        self.radar, self.radio = abs(of_radar) ** 2, abs(of_radio * used) ** 2
        self.complement, self.headway = abs(1 - policy * self.gamma) ** 2, abs(policy) ** 2
        self.innovation, self.sent = abs((1 - prediction) * used) ** 2, abs(inverse) ** 2
        feedback = self.mean(abs(prediction * used) ** 2) * lost * (1 - lost)
        self.kappa = lost * (1 - lost) / (1 - feedback)

    def mean(self, values):
        return np.sum(self.weight * values)


def stationary(car, cuts):
    """Variances, shares, and the limit if the string is stable."""
    x = Spectra(car, cuts)
    gain = abs(x.gamma) ** 2
    arriving = LONG(1 - car.q) ** 2
    spectrum, parts, rows = 0 * gain, [0 * gain, 0 * gain], []
    for _ in range(FOLLOWERS):
        sigma = x.kappa * x.mean(x.innovation * (x.sent * spectrum + car.radio))
        added = [x.radar * car.radar, x.radio * (arriving * car.radio + sigma)]
        rows.append([x.mean(x.complement * part + x.headway * own) for part, own in zip(parts, added)])
        parts = [gain * part + own for part, own in zip(parts, added)]
        spectrum = parts[0] + parts[1]
    excess = np.max(gain[x.w > 1e-4]) - 1
    limit = loss_gain = None
    if excess < 0:
        # At w = 0 numerators vanish like w^4, and 1 - gain like w^2.
        over = np.where(1 - gain > 1e-15, 1 / np.where(gain < 1, 1 - gain, 1), 0)
        loss_gain = x.kappa * x.mean(x.innovation * x.sent * x.radio * over)
        if loss_gain < 1:
            noise = x.radar * car.radar + x.radio * arriving * car.radio
            sigma = x.kappa * x.mean(x.innovation * (x.sent * noise * over + car.radio)) / (1 - loss_gain)
            added = noise + x.radio * sigma
            limit = x.mean(x.complement * added * over + x.headway * added)
    return np.array(rows), excess, loss_gain, limit


class Dense:
    """Means and second moments of a string behind its leader. State: for each vehicle the last y and u, e and h y; for each radio
    the delayed inputs and the values used before."""

    def __init__(self, car, followers):
        self.car, self.followers, order = car, followers, len(car.denominator) - 1
        self.places, count = {}, 0
        for i in range(self.followers + 1):
            for name, size in [("y", order + 1), ("u", order + 1), ("e", 1), ("line", car.delay), ("used", 2)]:
                self.places[i, name] = slice(count, count + size)
                count += size
        self.count = count

    def step(self, state, received, noise, lost):
        """States (columns) at step k + 1; `received`: the virtual leader's position at step k."""
        car, now, after = self.car, self.places, state.copy()
        ratio = (len(car.denominator) - len(car.numerator))
        for i in range(self.followers + 1):
            y, u = state[now[i, "y"]], state[now[i, "u"]]  # y(k), y(k-1), ...; u(k-1), u(k-2), ...
            position = received if i == 0 else state[now[i - 1, "y"]][0] + noise[2 * i - 2]
            e = position - y[0] - car.h * (y[0] - y[1])
            command = car.kp * e + car.kd * (e - state[now[i, "e"]][0]) / LONG(car.period)
            if i > 0:
                line = np.concatenate([[state[now[i - 1, "u"]][0] + noise[2 * i - 1]], state[now[i, "line"]][:-1]])
                used = state[now[i, "used"]]
                predicted = sum((LONG(c) * used[j] for j, c in enumerate(car.predictor)), 0 * e)
                value = predicted if lost[i - 1] else line[car.delay - 1]
                command = command + car.gain * value
                after[now[i, "line"]], after[now[i, "used"]] = line, np.concatenate([[value], used[:-1]])
            own = (command + car.h * u[0]) / (1 + car.h) if car.filtered else command
            inputs = np.concatenate([[own], u])
            # y(k+1) = -a_1 y(k) - ... + b_j u(k + 1 - ratio - j)
            following = -sum(a * y[j] for j, a in enumerate(car.denominator[1:]))
            following = following + sum(b * inputs[ratio - 1 + j] for j, b in enumerate(car.numerator))
            after[now[i, "y"]] = np.concatenate([[following], y[:-1]])
            after[now[i, "u"]], after[now[i, "e"]] = inputs[:-1], e
        return after

    def error(self, i):
        """The row that gives zeta_i."""
        row = np.zeros(self.count, LONG)
        row[self.places[i - 1, "y"].start] += 1
        row[self.places[i, "y"].start] -= 1 + self.car.h
        row[self.places[i, "y"].start + 1] += self.car.h
        return row

    def matrices(self):
        """For every pattern of losses: its probability, and one step as matrix, leader's column and noises' columns."""
        zero, sources = np.zeros(2 * self.followers, LONG), 2 * self.followers
        for lost in itertools.product([False, True] if self.car.q > 0 else [False], repeat=self.followers):
            a = self.step(np.eye(self.count, dtype=LONG), np.zeros(self.count, LONG), np.zeros((sources, self.count), LONG), lost)
            b = np.column_stack([self.step(np.zeros((self.count, 1), LONG), np.zeros(1, LONG), column[:, None], lost)
                                 for column in np.eye(sources, dtype=LONG)])
            r = self.step(np.zeros((self.count, 1), LONG), np.ones(1, LONG), zero[:, None], lost)
            probability = np.prod([self.car.q if x else 1 - self.car.q for x in lost])
            yield LONG(probability), a, b, r[:, 0]

    def tables(self, speed):
        car, matrices = self.car, list(self.matrices())
        noise = np.diag(np.array([car.radar, car.radio] * self.followers, LONG))
        mean, second = np.zeros(self.count, LONG), np.zeros((self.count, self.count), LONG)
        means, variances = np.zeros((self.followers, STEPS)), np.zeros((self.followers, STEPS))
        for k in range(-1, STEPS - 1):
            position = LONG(max(k, 0) * speed * car.period)
            step_mean, step_second = 0 * mean, 0 * second
            for probability, a, b, r in matrices if k >= 0 else matrices[:1]:  # at step -1 nothing is lost
                weight = probability if k >= 0 else LONG(1)
                moved = a @ mean + r * position
                covariance = a @ (second - np.outer(mean, mean)) @ a.T + (b @ noise @ b.T if k >= 0 else 0)
                step_mean = step_mean + weight * moved
                step_second = step_second + weight * (covariance + np.outer(moved, moved))
            mean, second = step_mean, step_second
            for i in range(1, self.followers + 1):
                row = self.error(i)
                means[i - 1, k + 1] = row @ mean
                variances[i - 1, k + 1] = row @ second @ row - (row @ mean) ** 2
        return means, variances
