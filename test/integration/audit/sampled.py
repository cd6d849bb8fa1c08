"""A car with a zero-order hold and its controller as functions of z, in 120 digits."""

from mpmath import mp, mpf


def pulse_transfer(period, lag, delay):
    """The pulse transfer function of a car, in 120 digits. A delay within rounding of whole samples counts as whole."""
    period, lag, delay = mpf(period), mpf(lag), mpf(delay)
    if abs(delay / period - mp.nint(delay / period)) <= mpf(2) ** -49 * (delay / period):
        delay = mp.nint(delay / period) * period
    exact = mp.exp(-period / lag) if lag else mpf(0)

    def of_step(t):  # position at time t after a step of the input
        settled = lag * lag * -mp.expm1(-t / lag) if lag else mpf(0)
        return t * t / 2 - lag * t + settled if t > 0 else mpf(0)
    # The step response times (z - 1)^2 (z - e^(-T/tau)) and (1 - 1/z) is finite: it is the numerator.
    denominator = [mpf(1), -2 - exact, 1 + 2 * exact, -exact]
    whole = int(mp.floor(delay / period))
    steps = [of_step(k * period - delay) for k in range(whole + 8)]
    jumps = [a - b for a, b in zip(steps, [mpf(0)] + steps)]
    product = [sum(denominator[i] * jumps[k - i] for i in range(min(k, 3) + 1)) for k in range(len(jumps))]
    least = mpf(10) ** -20 * max(abs(x) for x in product)
    size = max(k for k, x in enumerate(product) if abs(x) > least) + 1  # down to z^-(size - 1)
    first = next(k for k, x in enumerate(product) if abs(x) > least)
    return product[first:size], (denominator + [mpf(0)] * (size - 4))[:size]


def discrete_controller(controller, period):
    """K(z) = kp + kd (1 - 1/z) / T + ki T / (1 - 1/z) in 120 digits."""
    kp, kd, ki = (mpf(controller.get(gain, 0.0)) for gain in ("kp", "kd", "ki"))
    slope, rise = kd / mpf(period), ki * mpf(period)
    if ki == 0:
        return [kp + slope, -slope], [mpf(1), mpf(0)]
    return [kp + slope + rise, -kp - 2 * slope, slope], [mpf(1), mpf(-1), mpf(0)]
