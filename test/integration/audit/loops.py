"""The closed loop of one vehicle, T = N / D, from the numbers in a model file."""

from mpmath import mp, mpf

from audit.polynomials import plus, slope, squared_modulus, squared_norm, times, trimmed, value, without_factor, zeros, \
    zeros_of_margin
from audit.sampled import discrete_controller, pulse_transfer

UNDECIDED = 1e-11  # smallest |D|^2 - |N|^2, relative to the sum of its terms, that the digits of the coefficients determine


class Loop:
    """T = N / D at headway h, S = 1 - HT, with D's leading coefficient 1."""

    def __init__(self, n, d, h):
        d = trimmed(d)
        self.n, self.d = [a / d[0] for a in trimmed(n)], [a / d[0] for a in d]
        self.h = mpf(h)
        self.poles = zeros(self.d)
        self.rho = max(abs(z) for z in self.poles)
        self.hn = times([1 + self.h, -self.h], self.n)           # HT = hn / (z d)
        self.zd = self.d + [mpf(0)]
        self.s = plus(self.zd, [-a for a in self.hn])            # S = s / (z d)

    def margin(self):
        """(|D|^2 - |N|^2) / (1 - x) as a polynomial in x = cos w."""
        difference = plus(squared_modulus(self.d), [-a for a in squared_modulus(self.n)])
        return [-a for a in without_factor(difference, mpf(1))]

    def is_string_stable(self):
        """Whether the string is stable; None if double precision of the coefficients does not determine it."""
        if self.rho >= 1:
            return False
        margin = self.margin()
        points = [mpf(-1), mpf(1)]
        for x in zeros(slope(margin)):
            if abs(x.imag) < mpf(10) ** -40 and -1 < x.real < 1:
                points.append(x.real)
        least = mp.inf
        # The doubt: the change of the margin if each coefficient changes by its last digit and T(1) = 1 is kept.
        spread = sum(abs(a) * i * i for p in (self.n, self.d) for i, a in enumerate(p[::-1]))
        for x in points:
            z = x + mp.sqrt(x * x - 1 + 0j) if x < 1 else mpf(1)
            doubt = spread * (abs(value(self.d, z)) + abs(value(self.n, z)))
            least = min(least, value(margin, x) / doubt)
        if abs(least) < UNDECIDED:
            return None
        return least > 0

    def peak(self):
        """The largest |T| on the unit circle."""
        n, d = squared_modulus(self.n), squared_modulus(self.d)
        turns = plus(times(slope(n), d), [-a for a in times(n, slope(d))])
        largest = max(abs(a) for a in turns)
        turns = trimmed([a if abs(a) > mpf(10) ** -90 * largest else mpf(0) for a in turns])
        points = [mpf(-1), mpf(1)] + [x.real for x in zeros(turns) if abs(x.imag) < mpf(10) ** -40 and -1 < x.real < 1]
        return mp.sqrt(max(value(n, x) / value(d, x) for x in points))

    def filtered(self, u):
        """The response T u from zero state."""
        lead = len(self.d) - len(self.n)
        y = []
        for k in range(len(u)):
            total = mpf(0)
            for i, b in enumerate(self.n):
                if k - lead - i >= 0:
                    total += b * u[k - lead - i]
            for i, a in enumerate(self.d[1:], 1):
                if k - i >= 0 and a != 0:
                    total -= a * y[k - i]
            y.append(total)
        return y

    def with_headway(self, u):
        return [(1 + self.h) * a - self.h * b for a, b in zip(u, [mpf(0)] + u)]

    def integral_defect(self):
        """The deviation of T from double integral action, T(1) = 1 and dT/dz(1) = -h."""
        at_one = value(self.d, mpf(1))
        gain = value(self.n, mpf(1)) / at_one
        rise = (value(slope(self.n), mpf(1)) - gain * value(slope(self.d), mpf(1))) / at_one
        return abs(gain - 1) + abs(rise + self.h) / (1 + self.h)

    def limit(self):
        """||S/M||^2 - 1 with M M~ = 1 - T T~: the limit of the variance along the string over the noise variance."""
        margin = self.margin()
        factor = [mpf(1)]
        for x in zeros_of_margin(self.n, self.d, margin):
            z = x + mp.sqrt(x * x - 1)
            factor = times(factor, [mpf(1), -(z if abs(z) < 1 else 1 / z)])
        factor = [a.real for a in factor]
        # |D|^2 - |N|^2 = (1 - x) margin(x) and |z - 1|^2 = 2 (1 - x)
        scale = value(margin, mpf(1)) / 2 / value(factor, mpf(1)) ** 2
        s = without_factor(self.s, mpf(1))
        return squared_norm(s, times([mpf(1), mpf(0)], factor)) / scale - 1

    def undetermined_limit(self):
        """The relative part of the limit that T leaves undetermined where it violates T(1) = 1 and dT/dz(1) = -h: the larger of this
        defect and of the distance between the limits of two loops with T(1) = 1. One omits the remainder of |D|^2 - |N|^2 at
        w = 0, the other scales N. Their distance exceeds the defect where |T| stays near 1."""
        gain = value(self.n, mpf(1)) / value(self.d, mpf(1))
        scaled = Loop([a / gain for a in self.n], self.d, self.h)
        return max(self.integral_defect(), abs(scaled.limit() / self.limit() - 1))


def at_one(p):
    """p with an exact double pole at z = 1 if it has one up to the rounding of its coefficients."""
    quotient = without_factor(without_factor(p, mpf(1)), mpf(1))
    exact = times(quotient, [mpf(1), mpf(-2), mpf(1)])
    close = sum(abs(a - b) for a, b in zip(p, exact)) <= mpf(10) ** -14 * sum(abs(a) for a in p)
    return exact if len(p) > 2 and close else p


def design_loop(vehicle, h=None):
    h = mpf(vehicle["time_headway"] if h is None else h)
    plant, controller = vehicle["plant"], vehicle["controller"]
    if "actuator_lag" in plant:
        plant_n, plant_d = pulse_transfer(vehicle["sample_period"], plant["actuator_lag"], plant["input_delay"])
    else:
        plant_n, plant_d = ([mpf(a) for a in plant[part]] for part in ("numerator", "denominator"))
        plant_d = at_one(plant_d)
    if "kp" in controller:
        controller_n, controller_d = discrete_controller(controller, vehicle["sample_period"])
    else:
        controller_n, controller_d = ([mpf(a) for a in controller[part]] for part in ("numerator", "denominator"))
    n, d = times(plant_n, controller_n), times(plant_d, controller_d)
    if controller.get("divide_by_one_plus_headway", False):
        d = [a * (1 + h) for a in d]
    if controller.get("headway_filter", False):
        numerator, denominator = times(n, [1, 0]), times([1 + h, -h], plus(d, n))
    else:
        numerator, denominator = times(n, [1, 0]), plus(times(d, [1, 0]), times(n, [1 + h, -h]))
    while numerator[-1] == 0 and denominator[-1] == 0:
        numerator, denominator = numerator[:-1], denominator[:-1]
    return Loop(numerator, denominator, h)


def given_loop(vehicle):
    given = vehicle["closed_loop"]
    a = mp.matrix([[mpf(x) for x in row] for row in given["A"]])
    b, c = [mpf(x) for x in given["B"]], [mpf(x) for x in given["C"]]
    size = a.rows
    # N(z) and D(z) from their values at size + 1 points: D = det(zI - A), N = D C (zI - A)^-1 B.
    points = [mpf(2 + i) for i in range(size + 1)]
    n_values, d_values = [], []
    scale = 1 + max(abs(x) for x in a)
    with mp.workdps(400):
        for z in points:
            shifted = mp.eye(size) * z * scale - a
            d = mp.det(shifted)
            x = mp.lu_solve(shifted, mp.matrix(b))
            d_values.append(d)
            n_values.append(d * sum(c[i] * x[i] for i in range(size)))
        vandermonde = mp.matrix([[(z * scale) ** (size - i) for i in range(size + 1)] for z in points])
        n = list(mp.lu_solve(vandermonde, mp.matrix(n_values)))
        d = list(mp.lu_solve(vandermonde, mp.matrix(d_values)))

    def cleaned(p):
        return [x if abs(x) > mpf(10) ** -100 * max(abs(y) for y in p) else mpf(0) for x in p]
    return Loop(cleaned(n), cleaned(d), vehicle["time_headway"])


def roundings_decide(vehicle, draw, draws=20, size=100):
    """Whether A, B and C with other roundings, `size` times as large as those to double, have another verdict."""
    def moved(x):
        return [moved(y) for y in x] if isinstance(x, list) else mpf(x) * (1 + size * draw.uniform(-1, 1) * mpf(2) ** -53)
    verdicts = {given_loop(dict(vehicle, closed_loop={key: moved(x) for key, x in vehicle["closed_loop"].items()}))
                .is_string_stable() for _ in range(draws)}
    return len(verdicts) > 1


def loop_of(vehicle):
    return given_loop(vehicle) if "closed_loop" in vehicle else design_loop(vehicle)
