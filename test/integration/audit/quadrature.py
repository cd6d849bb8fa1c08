"""Means over the unit circle by Gauss-Legendre panels, graded towards nearby singularities and halved until they converge."""

import numpy as np

from audit.followers import LONG, Circle

PI = LONG("3.14159265358979323846264338327950288")
ORDER = 20


def _legendre(x):
    """P_20 and its derivative."""
    before, current = np.ones_like(x), x
    for n in range(1, ORDER):
        before, current = current, ((2 * n + 1) * x * current - n * before) / (n + 1)
    return current, ORDER * (x * current - before) / (x * x - 1)


NODES = np.asarray(np.polynomial.legendre.leggauss(ORDER)[0], LONG)
for _ in range(3):  # Newton's method, for the longer mantissa
    NODES = NODES - np.divide(*_legendre(NODES))
WEIGHTS = 2 / ((1 - NODES ** 2) * _legendre(NODES)[1] ** 2)


class Panels:
    """Nodes w and weights such that sum(weights f(w)) is the mean of f over the circle."""

    def __init__(self, edges):
        self.edges = edges = np.asarray(edges, LONG)
        middle, half = (edges[1:] + edges[:-1]) / 2, (edges[1:] - edges[:-1]) / 2
        self.circle = Circle((middle[:, None] + half[:, None] * NODES).ravel())
        self.weights = ((half[:, None] * WEIGHTS) / PI).ravel()

    def by_panel(self, values):
        return (self.weights * values).reshape(-1, len(NODES)).sum(axis=1)

    def mean(self, values):
        return (self.weights * values).sum()


def graded(singular):
    """Edges from 0 to pi, spaced in octaves around every complex frequency."""
    edges = [0.0, float(PI)]
    nearest = min([abs(w) for w in singular] + [1.0])
    centres = [(0.0, max(nearest / 4, 1e-9))] + [(abs(w.real), max(abs(w.imag), 1e-12)) for w in singular]
    for centre, width in centres:
        octave = width
        while octave < 4.0:
            edges += [centre - octave, centre + octave]
            octave *= 2
        edges.append(centre)
    edges = sorted(e for e in set(edges) if 0.0 <= e <= PI)
    kept = [edges[0]]
    for e in edges[1:]:  # without the short intervals that several singularities cause
        if e - kept[-1] > 0.2 * min([max(abs(e - w.real), abs(w.imag)) for w in singular] + [max(e, 1e-9)]):
            kept.append(e)
    kept[-1] = PI
    return kept


def halved(edges, chosen=slice(None)):
    """Edges of all panels, or of those that are chosen, cut into halves."""
    return np.sort(np.concatenate([edges, ((edges[1:] + edges[:-1]) / 2)[chosen]]))


def panels(singular, integrands, tolerance=1e-15):
    """Panels that resolve all arrays of the list integrands(circle), which must be positive."""
    edges = np.array(graded(singular), LONG)
    for _ in range(40):
        finer = halved(edges)
        coarse, fine = Panels(edges), Panels(finer)
        split = np.zeros(len(edges) - 1, bool)
        for one, other in zip(integrands(coarse.circle), integrands(fine.circle)):
            one, other = coarse.by_panel(one), fine.by_panel(other).reshape(-1, 2).sum(axis=1)
            split |= ~(np.abs(one - other) <= tolerance * np.abs(other).sum())
        if not split.any() or len(edges) > 20000:
            break
        edges = halved(edges, split)
    return Panels(finer)
