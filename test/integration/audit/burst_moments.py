"""Mean and variance of every tracking error of the first followers over links that lose in bursts: covariances of whole
trajectories, passed from vehicle to vehicle, with the recursion of loss_chains.py from step -1 on. All numbers are integers in
units of 2^-400."""

import numpy as np
from mpmath import mp, mpf

import link_reference
from audit.loops import loop_of
from audit.loss_chains import Link
from audit.receivers import inputs_of
from audit.second_moments import BITS, fixed, leader_positions


def integers(matrix):
    rows = matrix.tolist()
    result = np.zeros((len(rows), len(rows[0])), dtype=object)
    for i, row in enumerate(rows):
        result[i] = [fixed(x) for x in row]
    return result


def product(*factors):
    result = factors[0]
    for factor in factors[1:]:
        result = np.dot(result, factor) >> BITS
    return result


def toeplitz(response):
    """The matrix that convolves trajectories with a response."""
    size = len(response)
    return np.array([[response[i - j] if i >= j else 0 for j in range(size)] for i in range(size)], dtype=object)


def delayed(steps, delay):
    """The matrix of a delay whose line holds the position of step -1."""
    matrix = np.zeros((steps, steps), dtype=object)
    for k in range(steps):
        matrix[k, max(k - delay, 0)] = 1 << BITS
    return matrix


def coloured(link, steps):
    """The covariance of what a link adds: nothing at step -1."""
    numerator, denominator = link.colour
    response = []
    for k in range(steps):
        below = sum((a * response[k - i] for i, a in enumerate(denominator[1:], 1) if i <= k), mpf(0))
        lead = len(denominator) - len(numerator)
        response.append(((numerator[k - lead] if 0 <= k - lead < len(numerator) else mpf(0)) - below) / denominator[0])
    passed = toeplitz([fixed(x) for x in response])
    passed[:, 0] = 0
    covariance = product(passed, passed.T) * fixed(link.noise) >> BITS
    for k in range(1, steps):
        covariance[k, k] += fixed(link.dither)
    return covariance


def through_losses(link, mean, covariance):
    """The matrix of the mean effect on trajectories of this mean and covariance, and the covariance of the scattered signal."""
    steps, q = len(mean), fixed(link.q)
    one = np.eye(steps, dtype=object) * (1 << BITS)
    if not link.q:
        return one, 0
    link._chain()
    n = link.n
    a, jump = integers(link.a), integers(link.j)
    surprise = one.copy()
    for k in range(steps):
        for i, c in enumerate(link.c):
            surprise[k, max(k - i - 1, 0)] -= fixed(c)
    surprise[0] = 0
    u = product(surprise, covariance + (np.outer(mean, mean) >> BITS), surprise.T)
    # Powers A^j e, and the response of d to the drive.
    e = np.zeros((2 * n, 1), dtype=object)
    e[n, 0] = 1 << BITS
    powers, seen = [e], [np.zeros((1, 2 * n), dtype=object)]
    seen[0][0, 0] = seen[0][0, n] = 1 << BITS
    for _ in range(steps - 1):
        powers.append(product(a, powers[-1]))
        seen.append(product(seen[-1], a))
    passed = toeplitz([(row[0, n] * q) >> BITS for row in seen])
    # E[Z(k) u(k')], k = -1, 0, ...
    drawn = [toeplitz([(p[row, 0] * q) >> BITS for p in powers]) for row in range(2 * n)]
    with_u = np.array([product(matrix, u) for matrix in drawn])  # entry, k, k'
    maps, to_lost, spread = [integers(m) for m in link.maps], [fixed(x) for x in link.to_lost], [fixed(x) for x in link.spread]
    both, mu = fixed(link.p * link.q), [fixed(link.mu ** t) for t in range(steps)]
    drive = np.zeros((steps, 2 * n, steps, 2 * n), dtype=object)
    moments = [np.zeros((n, n), dtype=object) for _ in range(2)]
    for k in range(1, steps):
        for l in range(1, steps):
            drive[k, n, l, n] += (both * mu[abs(k - l)] >> BITS) * u[k, l] >> BITS
        for l in range(k, steps):
            before = sum(spread[mode] * with_u[mode * n:mode * n + n, k - 1, l] >> BITS for mode in (0, 1))
            cross = product(jump, before) * mu[l - k] >> BITS
            drive[k, :, l, n] += cross
            drive[l, n, k, :] += cross
        drive[k, :, k, :] += product(jump, sum(s * m >> BITS for s, m in zip(spread, moments)), jump.T)
        following = [np.zeros((n, n), dtype=object) for _ in range(2)]
        for mode in (0, 1):
            following[0] += ((1 << BITS) - to_lost[mode]) * product(maps[0], moments[mode], maps[0].T) >> BITS
            mixed = product(maps[1], with_u[mode * n:mode * n + n, k - 1, k].reshape(n, 1), e[n:].T)
            following[1] += to_lost[mode] * (product(maps[1], moments[mode], maps[1].T) + mixed + mixed.T) >> BITS
        following[1][0, 0] += q * u[k, k] >> BITS
        moments = following
    response = np.zeros((steps, steps, 2 * n), dtype=object)
    for k in range(steps):
        for l in range(k + 1):
            response[k, l] = seen[k - l][0]
    response = response.reshape(steps, -1)
    scattered = product(response, drive.reshape(2 * n * steps, -1), response.T)
    return one - product(passed, surprise), scattered


def moments(model, followers, steps):
    """Means and variances of zeta_i(k), i = 1, ..., followers, k = 0, ..., steps - 1, each as a list per follower."""
    size = steps + 1
    leader = leader_positions(model, loop_of(link_reference.merged(model, {})), steps)
    ahead = np.array([0] + [fixed(x) for x in leader], dtype=object)
    covariance, means, variances = np.zeros((size, size), dtype=object), [], []
    for vehicle in link_reference.vehicles_of(model, followers):
        loop, position = loop_of(vehicle), inputs_of(vehicle)[0]
        link = Link(position.get("channel", {}), position["noise_variance"])
        line = delayed(size, link.delay)
        sent, noise = product(line, ahead), product(line, coloured(link, size), line.T)
        received = product(line, covariance, line.T)
        effect, scattered = through_losses(link, sent, received + noise)
        response = [fixed(x) for x in loop.filtered([mpf(1)] + [mpf(0)] * (size - 1))]
        loops = toeplitz(response)
        # From its own initial position: 1 less the step response.
        free = np.array([(1 << BITS) - sum(response[:k + 1]) for k in range(size)], dtype=object)
        mean, variance = fixed(vehicle["initial_position"]["mean"]), fixed(vehicle["initial_position"]["variance"])
        moved = product(loops, effect, line)
        own = product(loops, effect, sent) + (mean * free >> BITS)
        added = product(loops, product(effect, noise, effect.T) + scattered, loops.T) + \
            (variance * (np.outer(free, free) >> BITS) >> BITS)
        following = product(moved, covariance, moved.T) + added
        headway = np.eye(size, dtype=object) * ((1 << BITS) + fixed(loop.h))
        for k in range(size):
            headway[k, max(k - 1, 0)] -= fixed(loop.h)
        error = np.eye(size, dtype=object) * (1 << BITS) - product(headway, moved)
        spread = product(error, covariance, error.T) + product(headway, added, headway.T)
        off = ahead - product(headway, own)
        means.append([mp.ldexp(mpf(int(x)), -BITS) for x in off[1:]])
        variances.append([mp.ldexp(mpf(int(spread[k, k])), -BITS) for k in range(1, size)])
        ahead, covariance = own, following
    return means, variances
