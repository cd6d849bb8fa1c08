"""Random cars with radar and radio, and their theory, without code of the package: stationary values by Gamma at many frequencies in extended
precision, means and variances of every step by the second moments of the whole string."""

import numpy as np
from mpmath import mp

from audit.sampled import pulse_transfer
from link_reference import joint_chain, predictor_of

LONG, COMPLEX = np.longdouble, np.clongdouble
FOLLOWERS, STEPS = 20, 40


def drawn_chain(draw):
    """Losses in bursts, or by a chain of two to four states; of any predictor but zero."""
    on_loss = draw.choice(["hold", "hold", "extrapolate", [1.2, -0.2]])
    if draw.random() < 0.5:
        q = draw.uniform(0.02, 0.25)
        return {"probability": q, "mean_burst": draw.uniform(1.05, 4.0), "on_loss": on_loss}
    states = draw.randint(2, 4)
    rows = [[draw.gammavariate(0.7, 1.0) for _ in range(states)] for _ in range(states)]
    return {"markov": {"transition": [[x / sum(row) for x in row] for row in rows],
                       "probability": [draw.uniform(0.0, 0.4) for _ in range(states)]}, "on_loss": on_loss}


def drawn_with_chains(draw):
    """A car whose radio, and in half of all models whose radar, loses by a chain."""
    model = drawn(draw)
    for link in model["inputs"][draw.randrange(2):]:
        link.setdefault("channel", {})["loss"] = drawn_chain(draw)
    if draw.random() < 0.3:
        model["inputs"][1]["channel"]["loss"]["on_loss"] = "zero"
    return model


def drawn_quick(draw):
    """One whose start decays within 700 steps."""
    model = drawn_with_chains(draw)
    model["sample_period"] = 0.1
    model["plant"]["input_delay"] = 0.0
    model["controller"] = {"kp": draw.uniform(0.4, 0.5), "kd": draw.uniform(1.0, 1.2), "headway_filter": True}
    model["time_headway_seconds"] = draw.uniform(0.5, 1.0)
    model["leader"] = {"speed": [{"from_step": 0, "value": 0.0}]}
    return model


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
        self.losses = [link.get("channel", {}).get("loss") for link in model["inputs"]]
        self.predictors = [predictor_of(loss) if loss else [] for loss in self.losses]
        self.q, self.predictor = self.losses[1]["probability"] if self.losses[1] and "probability" in self.losses[1] else 0.0, self.predictors[1]


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


def congruence(a):
    """The map from a symmetric m to a m a', by the few entries of a that are not 0: NumPy's product of extended matrices is slow."""
    rows, columns = np.nonzero(a)
    values, (filled, starts) = a[rows, columns][:, None], np.unique(rows, return_index=True)

    def times(m):
        product = np.zeros_like(m)
        product[filled] = np.add.reduceat(values * m[columns], starts, axis=0)
        return product

    return lambda m: times(times(m).T)


class Dense:
    """Means and second moments of a string behind its leader. State: for each vehicle the last y and u, e and h y; for each radio
    the delayed inputs; for each link the values used before. In every mode of the chains of losses."""

    def __init__(self, car, followers):
        self.car, self.followers, order = car, followers, len(car.denominator) - 1
        self.places, count = {}, 0
        for i in range(self.followers + 1):
            for name, size in [("y", max(order + 1, 4)), ("u", order + 1), ("e", 1), ("line", car.delay), (("used", 0), 2), (("used", 1), 2)]:
                self.places[i, name] = slice(count, count + size)
                count += size
        self.count = count

    def step(self, state, received, noise, lost):
        """States (columns) at step k + 1; `received`: the virtual leader's position at step k; `lost`: per follower and link."""
        car, now, after = self.car, self.places, state.copy()
        ratio = (len(car.denominator) - len(car.numerator))
        for i in range(self.followers + 1):
            y, u = state[now[i, "y"]], state[now[i, "u"]]  # y(k), y(k-1), ...; u(k-1), u(k-2), ...
            position = received if i == 0 else self.used(state, after, i, 0, state[now[i - 1, "y"]][0] + noise[2 * i - 2], lost)
            e = position - y[0] - car.h * (y[0] - y[1])
            command = car.kp * e + car.kd * (e - state[now[i, "e"]][0]) / LONG(car.period)
            if i > 0:
                line = np.concatenate([[state[now[i - 1, "u"]][0] + noise[2 * i - 1]], state[now[i, "line"]][:-1]])
                command = command + car.gain * self.used(state, after, i, 1, line[car.delay - 1], lost)
                after[now[i, "line"]] = line
            own = (command + car.h * u[0]) / (1 + car.h) if car.filtered else command
            inputs = np.concatenate([[own], u])
            # y(k+1) = -a_1 y(k) - ... + b_j u(k + 1 - ratio - j)
            following = -sum(a * y[j] for j, a in enumerate(car.denominator[1:]))
            following = following + sum(b * inputs[ratio - 1 + j] for j, b in enumerate(car.numerator))
            after[now[i, "y"]] = np.concatenate([[following], y[:-1]])
            after[now[i, "u"]], after[now[i, "e"]] = inputs[:-1], e
        return after

    def used(self, state, after, i, link, arriving, lost):
        """What follower i uses of a link; its registers move on."""
        place = self.places[i, ("used", link)]
        before = state[place]
        value = sum((LONG(c) * before[j] for j, c in enumerate(self.car.predictors[link])), 0 * arriving) \
            if lost[i - 1][link] else arriving
        after[place] = np.concatenate([[value], before[:-1]])
        return value

    def row(self, name, i):
        """The row that gives a signal of follower i, apart from a constant."""
        ahead, own = self.places[i - 1, "y"].start, self.places[i, "y"].start
        period, h = LONG(self.car.period), self.car.h
        entries = {"error": {ahead: 1, own: -1 - h, own + 1: h}, "gap": {ahead: 1, own: -1}, "input": {self.places[i, "u"].start: 1},
                   "relative_speed": {ahead: 1 / period, ahead + 1: -1 / period, own: -1 / period, own + 1: 1 / period},
                   "speed": {own: 1 / period, own + 1: -1 / period},
                   "acceleration": {own + j: c / period ** 2 for j, c in enumerate((1, -2, 1))},
                   "jerk": {own + j: c / period ** 3 for j, c in enumerate((1, -3, 3, -1))}}[name]
        row = np.zeros(self.count, LONG)
        for place, value in entries.items():
            row[place] = value
        return row

    def matrices(self, lost):
        """One step: matrix, noises' columns, leader's column."""
        zero, sources = np.zeros(2 * self.followers, LONG), 2 * self.followers
        a = self.step(np.eye(self.count, dtype=LONG), np.zeros(self.count, LONG), np.zeros((sources, self.count), LONG), lost)
        b = np.column_stack([self.step(np.zeros((self.count, 1), LONG), np.zeros(1, LONG), column[:, None], lost)
                             for column in np.eye(sources, dtype=LONG)])
        r = self.step(np.zeros((self.count, 1), LONG), np.ones(1, LONG), zero[:, None], lost)
        return a, b, r[:, 0]

    def tables(self, speed, steps=STEPS, names=("error",)):
        """Mean and variance of every signal, apart from constants: one after the other."""
        car = self.car
        _, stationary, step, links = joint_chain(car.losses * self.followers, LONG)
        lost = [tuple(zip(of[::2], of[1::2])) for of in links]  # per follower and link
        noise = np.diag(np.array([car.radar, car.radio] * self.followers, LONG))
        known = {}
        for of in set(lost) | {((False, False),) * self.followers}:
            a, b, r = self.matrices(of)
            known[of] = a, congruence(a), b @ noise @ b.T, r
        first, second = np.zeros((len(lost), self.count), LONG), np.zeros((len(lost), self.count, self.count), LONG)
        means, variances = np.zeros((2, len(names), self.followers, steps))
        for k in range(-1, steps - 1):
            position = LONG(max(k, 0) * speed * car.period)
            if k >= 0:  # at step -1 nothing is lost, and nothing disturbs
                first = step.T @ first
                second = (step.T @ second.reshape(len(lost), -1)).reshape(second.shape)
            for c, of in enumerate(lost):
                a, congruent, noises, r = known[of if k >= 0 else ((False, False),) * self.followers]
                drive, moved = r * position, a @ first[c]
                cross = np.outer(moved, drive)
                second[c] = congruent(second[c]) + cross + cross.T + stationary[c] * (np.outer(drive, drive) + (noises if k >= 0 else 0))
                first[c] = moved + stationary[c] * drive
            mean, whole = first.sum(axis=0), second.sum(axis=0)
            for s, name in enumerate(names):
                for i in range(1, self.followers + 1):
                    row = self.row(name, i)
                    means[s, i - 1, k + 1] = row @ mean
                    variances[s, i - 1, k + 1] = row @ whole @ row - (row @ mean) ** 2
        return means, variances
