#!/usr/bin/python3
"""The paper's Monte Carlo in NumPy, as an experienced user would write it. Prints JSON.

Arrays over vehicles and a chunk of realizations; the only Python loops run over steps and chunks. A step advances
the states of all vehicles at once, in place, without allocations in the loop.
"""

import json
import sys
import time

import numpy as np

FOLLOWERS, STEPS, HEADWAY, NOISE, SPEED, PERIOD = 20, 100, 3.2, 0.6, 20.0, 0.1


def closed_loop(h):
    """T = N/D in observable canonical form."""
    gain = 1.35 / (1 + h)
    d = np.polymul([1, 0.89], [1, -2, 1]) + np.array([0, 0, gain * (1 + h), -gain * h])
    return -d[1:], np.array([0.0, gain, 0.0])


def leader(a, b):
    x, y = np.zeros(3), [0.0]
    for k in range(-1, STEPS - 1):
        x = a * x[0] + np.append(x[1:], 0.0) + b * max(k, 0) * PERIOD * SPEED
        y.append(x[0])
    return y


def run(realizations, chunk):
    a, b = closed_loop(HEADWAY)
    y0 = leader(a, b)
    random = np.random.Generator(np.random.SFC64(1))
    deviation = np.sqrt(NOISE)
    total = np.zeros((FOLLOWERS, STEPS))
    squares = np.zeros((FOLLOWERS, STEPS))
    shape = (FOLLOWERS, chunk)
    x0, x1, x2, new0, new1, received, zeta = (np.empty(shape) for _ in range(7))
    done = 0
    while done < realizations:
        x0[:] = x1[:] = x2[:] = 0.0
        for k in range(STEPS):
            if k > 0:
                random.standard_normal(out=received)
                received *= deviation
            else:
                received[:] = 0.0
            received[0] += y0[k]
            received[1:] += x0[:-1]
            np.multiply(x0, a[0], out=new0)
            new0 += x1
            np.multiply(received, b[1], out=new1)
            new1 += x2
            np.multiply(x0, a[1], out=zeta)
            new1 += zeta
            np.multiply(x0, a[2], out=x2)
            x1, new1 = new1, x1
            # zeta_i(k) = y_{i-1}(k) - y_i(k) - h (y_i(k) - y_i(k-1)), with y = new0 and y(k-1) = x0
            np.multiply(x0, HEADWAY, out=zeta)
            np.multiply(new0, 1 + HEADWAY, out=new1)
            zeta -= new1
            zeta[0] += y0[k + 1]
            zeta[1:] += new0[:-1]
            x0, new0 = new0, x0
            total[:, k] += zeta.sum(axis=1)
            squares[:, k] += np.einsum("ij,ij->i", zeta, zeta)
        done += chunk
    mean = total / done
    return mean, (squares - done * mean ** 2) / (done - 1), done


def main():
    realizations = int(sys.argv[1])
    chunk = int(sys.argv[2]) if len(sys.argv) > 2 else 1024
    began = time.perf_counter()
    mean, variance, done = run(realizations, chunk)
    seconds = time.perf_counter() - began
    print(json.dumps({"vehicle_steps_per_second": FOLLOWERS * STEPS * done / seconds, "seconds": seconds,
                      "last_variance": variance[-1, -1]}))


def normals():
    random = np.random.default_rng(1)
    buffer = np.empty(8192)
    random.standard_normal(out=buffer)
    began = time.perf_counter()
    for _ in range(4000):
        random.standard_normal(out=buffer)
    print(json.dumps({"normals_per_second": 4000 * buffer.size / (time.perf_counter() - began)}))


if __name__ == "__main__":
    normals() if sys.argv[1] == "normals" else main()
