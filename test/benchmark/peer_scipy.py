#!/usr/bin/python3
"""The paper's Monte Carlo with SciPy's lfilter, one call per vehicle and chunk of realizations. Prints JSON.

Usage: peer_scipy.py REALIZATIONS CHUNK
"""

import json
import sys
import time

import numpy as np
from scipy.signal import lfilter

FOLLOWERS, STEPS, HEADWAY, NOISE, SPEED, PERIOD = 20, 100, 3.2, 0.6, 20.0, 0.1


def run(realizations, chunk):
    gain = 1.35 / (1 + HEADWAY)
    denominator = np.polymul([1, 0.89], [1, -2, 1]) + np.array([0, 0, gain * (1 + HEADWAY), -gain * HEADWAY])
    numerator = [0.0, 0.0, gain]
    y0 = lfilter(numerator, denominator, np.maximum(np.arange(-1, STEPS), 0) * PERIOD * SPEED)
    random = np.random.Generator(np.random.SFC64(1))
    total = np.zeros((FOLLOWERS, STEPS))
    squares = np.zeros((FOLLOWERS, STEPS))
    noise = np.empty((chunk, STEPS))
    received = np.empty((chunk, STEPS + 1))
    zeta = np.empty((chunk, STEPS))
    done = 0
    while done < realizations:
        ahead = np.broadcast_to(y0, (chunk, STEPS + 1))
        for i in range(FOLLOWERS):
            random.standard_normal(out=noise)
            noise *= np.sqrt(NOISE)
            received[:] = ahead
            received[:, 1:] += noise
            own = lfilter(numerator, denominator, received, axis=1)
            np.multiply(own[:, 1:], -(1 + HEADWAY), out=zeta)
            zeta += ahead[:, 1:]
            zeta += HEADWAY * own[:, :-1]
            total[i] += zeta.sum(axis=0)
            squares[i] += np.einsum("ij,ij->j", zeta, zeta)
            ahead = own
        done += chunk
    mean = total / done
    return (squares - done * mean ** 2) / (done - 1), done


def main():
    began = time.perf_counter()
    variance, done = run(int(sys.argv[1]), int(sys.argv[2]))
    seconds = time.perf_counter() - began
    print(json.dumps({"vehicle_steps_per_second": FOLLOWERS * STEPS * done / seconds, "seconds": seconds,
                      "last_variance": variance[-1, -1]}))


if __name__ == "__main__":
    main()
