"""Random cars that hear any vehicles ahead, and the second moments of the whole string, without code of the package."""

import numpy as np
from mpmath import mp

from audit.sampled import pulse_transfer
from link_reference import joint_chain, predictor_of
from radio_reference import drawn_chain, trimmed

ORDER = {"position": 0, "speed": 1, "acceleration": 2}


def drawn(draw, lossy=False):
    """A car with up to three positions, four other signals and, if lossy, losses of one packet on two of five vehicles."""
    constant = draw.random() < 0.4
    far = [1, 2, 3, 4] + (["leader"] if constant else [])
    positions = draw.sample(far, draw.randint(1, 3))
    weights = [draw.uniform(0.2, 1.0) for _ in positions]
    inputs = [{"signal": "position", "from": source, "weight": weight / sum(weights), "noise_variance": draw.uniform(0.01, 0.1),
               "channel": {"delay": draw.choice([0, 0, 1, 2])}} for source, weight in zip(positions, weights)]
    inputs[-1]["weight"] += 1.0 - sum(of["weight"] for of in inputs)
    for _ in range(draw.randint(0, 4)):
        signal = draw.choice(["speed", "acceleration", "input"])
        gain = draw.uniform(0.05, 0.4) if signal == "speed" else draw.uniform(0.05, 0.25)
        inputs.append({"signal": signal, "from": draw.choice([1, 2, 3, 4, "leader"]), "gain": gain, "noise_variance": draw.uniform(0.01, 0.1),
                       "channel": {"delay": draw.randint(1 if signal == "input" else 0, 3)}})
    period = draw.choice([0.05, 0.1])
    model = {"sample_period": period, "plant": {"actuator_lag": draw.choice([0.0, draw.uniform(0.1, 0.5)]), "input_delay": draw.choice([0, 0, 1]) * period},
             "controller": {"kp": draw.uniform(0.2, 0.5), "kd": draw.uniform(0.6, 1.2), "headway_filter": not constant and draw.random() < 0.5},
             "standstill_distance": 4.0, "inputs": inputs, "own_acceleration": draw.choice([0.0, draw.uniform(-0.2, 0.0)]),
             "initial_position": {"mean": draw.choice([0.0, 0.4]), "variance": draw.choice([0.0, 0.001])},
             "leader": {"speed": [{"from_step": 0, "value": 20.0}]}}
    model.update({"spacing": "constant"} if constant else {"time_headway": draw.uniform(3.0, 15.0)})
    if lossy:
        lose(draw, model)
    return model


def lose(draw, model):
    """The default type loses; four of five vehicles are of a type that does not."""
    source = draw.choice([of["from"] for of in model["inputs"]])
    packet = [of for of in model["inputs"] if of["from"] == source]
    loss = drawn_chain(draw)
    if all(of["signal"] == "input" for of in packet) and draw.random() < 0.5:
        loss["on_loss"] = "zero"
    model["vehicle_types"] = {"other": {"inputs": [dict(of, channel=dict(of["channel"])) for of in model["inputs"]]}}
    for of in packet:
        of["channel"]["packet"] = "lost together"
    packet[0]["channel"]["loss"] = loss
    string = draw.choice([["default", "other", "default", "other", "other"], ["other", "default", "other", "default", "other"],
                          ["other", "other", "other", "other", "default"]])
    model["string"] = string


class String:
    """Every step is state' = A_c state + B_c noise + e_c y_0(k + 1) in the mode c of all chains of losses. State: for each vehicle the
    last y and u, and e; for each input the delayed values, and those used before. Relative to the places in formation."""

    def __init__(self, model, followers):
        self.model, self.followers, self.period = model, followers, model["sample_period"]
        numerator, denominator = pulse_transfer(self.period, model["plant"]["actuator_lag"], model["plant"]["input_delay"])
        self.top, self.bottom = np.array([float(mp.mpf(x)) for x in numerator]), np.array([float(mp.mpf(x)) for x in denominator])
        if model["plant"]["actuator_lag"] == 0.0:
            self.top, self.bottom = trimmed(self.top, self.bottom)
        self.h = model.get("time_headway", 0.0)
        string, types = model.get("string", ["default"]), dict(model.get("vehicle_types", {}), default=model)
        self.inputs = [[]] + [types[string[i % len(string)]]["inputs"] for i in range(followers)]
        self.packets = [(i, n) for i in range(1, followers + 1) for n, of in enumerate(self.inputs[i]) if "loss" in of["channel"]]
        self.modes, self.stationary, self.transition, self.lost = joint_chain([self.inputs[i][n]["channel"]["loss"] for i, n in self.packets])
        long = max(len(self.bottom), len(self.top)) + 2
        self.places, count = {}, 0
        for i in range(followers + 1):
            sizes = [("y", long), ("u", long), ("e", 1)] + [(("line", n), 3) for n in range(len(self.inputs[i]))] + \
                [(("used", n), 2) for n in range(len(self.inputs[i]))]
            for name, size in sizes:
                self.places[i, name] = slice(count, count + size)
                count += size
        self.count, self.noises = count, [of["noise_variance"] for i in range(1, followers + 1) for of in self.inputs[i]]
        everything = np.eye(count + len(self.noises) + 1)
        self.maps = [self.step(everything[:count], everything[count:-1], everything[-1], lost) for lost in self.lost]

    def source(self, i, of):
        return 0 if of["from"] == "leader" else max(i - of["from"], 0)

    def sent(self, state, i, of):
        """What the source of an input sends at step k."""
        source = self.source(i, of)
        y = state[self.places[source, "y"]]
        if of["signal"] != "input":
            return [y[0], (y[0] - y[1]) / self.period, (y[0] - 2 * y[1] + y[2]) / self.period ** 2][ORDER[of["signal"]]]
        return state[self.places[source, "u"]][0] if source else (y[0] - 2 * y[1] + y[2]) / self.period ** 2

    def step(self, state, noise, leader, lost):
        """States (columns) at step k + 1, given y_0(k + 1), and which packets are lost at step k."""
        now, after, number = self.places, state.copy(), 0
        y = state[now[0, "y"]]
        after[now[0, "y"]] = np.vstack([[leader], y[:-1]])
        kp, kd, filtered = (self.model["controller"][key] for key in ("kp", "kd", "headway_filter"))
        lag = len(self.bottom) - len(self.top)
        for i in range(1, self.followers + 1):
            y, u = state[now[i, "y"]], state[now[i, "u"]]
            e, command, moved = 0.0 * y[0], 0.0 * y[0], y[0] - y[1]
            for n, of in enumerate(self.inputs[i]):
                value = self.used(state, after, i, n, self.sent(state, i, of) + noise[number], lost)
                number += 1
                if of["signal"] == "position":
                    e = e + of["weight"] * (value - y[0] - (i - self.source(i, of)) * self.h * moved)
                else:
                    command = command + of["gain"] * (value - (moved / self.period if of["signal"] == "speed" else 0.0))
            command = command + kp * e + kd * (e - state[now[i, "e"]][0]) / self.period
            command = command + self.model["own_acceleration"] * (y[0] - 2 * y[1] + y[2]) / self.period ** 2
            own = (command + self.h * u[0]) / (1 + self.h) if filtered else command
            inputs = np.vstack([[own], u])
            following = sum(b * inputs[lag - 1 + j] for j, b in enumerate(self.top)) - sum(a * y[j] for j, a in enumerate(self.bottom[1:]))
            after[now[i, "y"]], after[now[i, "u"]], after[now[i, "e"]] = np.vstack([[following], y[:-1]]), inputs[:-1], e
        return after

    def used(self, state, after, i, n, sent, lost):
        of = self.inputs[i][n]
        delay = of["channel"]["delay"] - (of["signal"] == "input")
        line, before = state[self.places[i, ("line", n)]], state[self.places[i, ("used", n)]]
        after[self.places[i, ("line", n)]] = np.vstack([[sent], line[:-1]])
        value, name = line[delay - 1] if delay else sent, of["channel"].get("packet")
        shared = [at for at, (j, m) in enumerate(self.packets) if j == i and (m == n or name and self.inputs[j][m]["channel"].get("packet") == name)]
        if shared and lost[shared[0]]:
            value = sum((c * before[j] for j, c in enumerate(predictor_of(self.inputs[i][self.packets[shared[0]][1]]["channel"]["loss"]))), 0.0 * value)
        after[self.places[i, ("used", n)]] = np.vstack([[value], before[:-1]])
        return value

    def start(self):
        """The state at step -1 (columns) by the initial positions of the followers."""
        state, own = np.zeros((self.count, self.followers)), np.eye(self.followers)
        for i in range(1, self.followers + 1):
            state[self.places[i, "y"]] = own[i - 1]
            for n, of in enumerate(self.inputs[i]):
                if of["signal"] == "position" and self.source(i, of):
                    state[self.places[i, ("line", n)]] = state[self.places[i, ("used", n)]] = own[self.source(i, of) - 1]
        return state

    def errors(self):
        """Rows: the tracking errors by the state."""
        rows = np.zeros((self.followers, self.count))
        for i in range(1, self.followers + 1):
            at, ahead = self.places[i, "y"].start, self.places[i - 1, "y"].start
            rows[i - 1, [ahead, at, at + 1]] = [1.0, -1.0 - self.h, self.h]
        return rows

    def tables(self, speed, steps):
        """Mean and variance of the tracking errors at steps 0, 1, ... The moments are relative to the motion without noise and losses."""
        initial, start, c = self.model["initial_position"], self.start(), self.count
        everything = np.eye(c + len(self.noises) + 1)
        arrived = self.step(everything[:c], everything[c:-1], everything[-1], [False] * len(self.packets))
        quiet = arrived[:, :c] @ (start @ np.full(self.followers, initial["mean"]))
        second = arrived[:, :c] @ start
        of_mode = [0.0 * quiet for _ in self.maps], [pi * initial["variance"] * second @ second.T for pi in self.stationary]
        noise, rows, found = np.diag(self.noises), self.errors(), []
        for k in range(steps):
            means, seconds = (sum(values) for values in of_mode)
            of_error = rows @ means
            found.append([rows @ quiet + of_error, np.einsum("ij,jk,ik->i", rows, seconds, rows) - of_error ** 2])
            following = arrived[:, :c] @ quiet + arrived[:, -1] * speed * self.period * (k + 1)
            lacking = [(matrix[:, :c] - arrived[:, :c]) @ quiet for matrix in self.maps]
            of_mode, quiet = self.moved(of_mode, noise, lacking), following
        return np.array(found).transpose(1, 2, 0)

    def moved(self, of_mode, noise, lacking):
        """The moments in each mode one step later; `lacking`: what its losses keep from the motion without them."""
        c, next_means, next_seconds = self.count, [], []
        for mode, (matrix, d) in enumerate(zip(self.maps, lacking)):
            into, pi = self.transition[:, mode], self.stationary[mode]
            mean = sum(p * of for p, of in zip(into, of_mode[0]))
            second = sum(p * of for p, of in zip(into, of_mode[1]))
            a, b = matrix[:, :c], matrix[:, c:-1]
            own = a @ mean
            next_means.append(own + pi * d)
            next_seconds.append(a @ second @ a.T + pi * (b @ noise @ b.T) + np.outer(own, d) + np.outer(d, own) + pi * np.outer(d, d))
        return next_means, next_seconds

    def settled(self):
        """Stationary variances of the tracking errors of a string that does not lose: X = A X A' + B B', by doubling."""
        power, noise = self.maps[0][:, :self.count], self.maps[0][:, self.count:-1]
        covariance = noise @ np.diag(self.noises) @ noise.T
        for _ in range(16):
            covariance, power = covariance + power @ covariance @ power.T, power @ power
        rows = self.errors()
        return np.einsum("ij,jk,ik->i", rows, covariance, rows)
