"""Cars with limits, computed directly in the time domain: matrix exponentials in extended precision and difference equations by powers
of 1/z. It shares no code and no formulas with the package."""

import numpy as np

LONG = np.longdouble


def exponential(matrix):
    """e^M by scaling, a Taylor series and repeated squaring."""
    halvings = max(0, int(np.ceil(np.log2(float(np.abs(matrix).sum()) + 1.0))) + 4)
    scaled = matrix / LONG(2) ** halvings
    term = total = np.eye(len(matrix), dtype=LONG)
    for k in range(1, 30):
        term = term @ scaled / LONG(k)
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


def held(lag, seconds):
    """Matrices of (y, v, a) <- Phi (y, v, a) + Gamma u over an interval of constant u; without a lag a = u."""
    system = np.zeros((4, 4), dtype=LONG)  # y, v, a, u
    system[0, 1] = 1
    if lag > 0.0:
        system[1, 2], system[2, 2], system[2, 3] = 1, -1 / LONG(lag), 1 / LONG(lag)
    else:
        system[1, 3] = 1
    moved = exponential(system * LONG(seconds))
    return moved[:3, :3], moved[:3, 3]


def sampled(controller, period):
    """Coefficients of N and D by powers of 1/z: sum D_j u(k - j) = sum N_j e(k - j), D_0 = 1."""
    if "numerator" in controller:
        n, d = (np.array(controller[key], dtype=LONG) for key in ("numerator", "denominator"))
        return np.concatenate([np.zeros(len(d) - len(n), dtype=LONG), n]) / d[0], d / d[0]
    kp, kd, ki = (LONG(controller.get(key, 0.0)) for key in ("kp", "kd", "ki"))
    t = LONG(period)
    if ki:  # (kp (1 - q) + kd (1 - q)^2 / T + ki T) / (1 - q)
        return np.array([kp + kd / t + ki * t, -kp - 2 * kd / t, kd / t]), np.array([1, -1], dtype=LONG)
    return np.array([kp + kd / t, -kd / t]), np.array([1], dtype=LONG)


def follow(car, period, place, speed, received, heard=None):
    """y(-1), y(0), ... and u(-1), u(0), ...: a car of a model file behind what it receives at steps -1, 0, ..., from steady motion at
    `speed` through `place`. Arrays may have further axes, one value per realization."""
    t, h = LONG(period), LONG(car["time_headway_seconds"]) / LONG(period)
    lag, delay = car["plant"]["actuator_lag"], car["plant"].get("input_delay", 0.0)
    whole = int(np.floor(delay / period + 1e-9))
    rest = max(LONG(delay) - whole * t, LONG(0))
    rest = LONG(0) if rest < 1e-12 else rest
    (early_phi, early_gamma), (late_phi, late_gamma) = held(lag, rest), held(lag, t - rest)
    n, d = sampled(car["controller"], period)
    filtered, gain = car["controller"].get("headway_filter", False), LONG(car.get("gain", 0.0))
    limits = car.get("limits", {})
    low, high = limits.get("input", [-np.inf, np.inf])
    slowest, fastest = limits.get("speed", [-np.inf, np.inf])
    shape = np.shape(received[0])
    zero = np.zeros(shape, dtype=LONG)
    state = [zero + place, zero + LONG(speed), zero]
    before = state[0] - t * LONG(speed)
    errors, outputs = [zero] * len(n), [zero] * len(d)  # e(k-1), ...; the controller's limited outputs
    inputs = [zero] * (whole + 2)                       # u(k-1), u(k-2), ...
    positions, used = [state[0]], []
    for k, position in enumerate(received):
        y, v, _ = state
        e = position - y - LONG(car["standstill_distance"]) - h * (y - before)
        errors = [e] + errors[:-1]
        c = sum(a * b for a, b in zip(n, errors)) - sum(a * b for a, b in zip(d[1:], outputs))
        fed = gain * heard[k] if heard is not None else zero
        u = (c + fed + h * inputs[0]) / (1 + h) if filtered else c + fed
        u = np.minimum(np.maximum(u, LONG(low)), LONG(high))
        outputs = [((1 + h) * u - h * inputs[0] if filtered else u) - fed] + outputs[:-1]
        inputs = [u] + inputs[:-1]
        moved = state
        for (phi, gamma), command in (((early_phi, early_gamma), inputs[whole + 1]), ((late_phi, late_gamma), inputs[whole])):
            moved = [sum(phi[i, j] * moved[j] for j in range(3)) + gamma[i] * command for i in range(3)]
        limited = np.minimum(np.maximum(moved[1], LONG(slowest)), LONG(fastest))
        clipped = y + t * (v + limited) / 2
        before = y
        state = [np.where(limited == moved[1], moved[0], clipped), limited, moved[2]]
        positions.append(state[0])
        used.append(u)
    return positions, used


def places(car, period, leader, speed, followers):
    """y_i(-1) in steady motion."""
    apart = LONG(car["standstill_distance"]) + LONG(speed) * (LONG(car["time_headway_seconds"]) + car.get("delay", 0) * LONG(period))
    return [leader - i * apart for i in range(1, followers + 1)]
