"""Means over the circle with a kernel 1 / (1 - mu e^{j (nu - w)}) that may be much narrower than the panels on which a function is
known: weights for its values at the nodes, exact for its interpolation on each panel."""

import numpy as np

from audit.followers import COMPLEX, LONG
from audit.quadrature import NODES, PI, WEIGHTS, Panels, halved

SIZE = len(NODES)
MOST = 6000  # nodes of a kernel's matrices, which take 4 GB


class Unresolved(Exception):
    """Spectra that need more nodes than the memory allows."""


BARYCENTRIC = np.array([1 / np.prod([a - b for b in NODES if b != a]) for a in NODES], LONG)


def interpolation(x):
    """Weights of the values at NODES for the values at x, in a further last dimension."""
    apart = x[..., None] - NODES
    hit = apart == 0
    apart[hit] = 1
    weights = BARYCENTRIC / apart
    weights = weights / weights.sum(axis=-1)[..., None]
    at_node = hit.any(axis=-1)
    weights[at_node] = hit[at_node]
    return weights


def interpolating(edges, functions, tolerance=1e-13):
    """Edges of panels whose nodes interpolate all arrays of the list functions(circle). A kernel narrower than a panel needs the values
    between the nodes, and on every panel, however little it adds to the mean; Gauss's nodes integrate twice the degree that they
    interpolate."""
    to_halves = interpolation(np.concatenate([NODES - 1, NODES + 1]) / 2).T
    while SIZE * len(edges) < MOST:
        coarse, fine = functions(Panels(edges).circle), functions(Panels(halved(edges)).circle)
        split = np.zeros(len(edges) - 1, bool)
        for known, wanted in zip(coarse, fine):
            wanted = wanted.reshape(-1, 2 * SIZE)
            missed = np.abs(known.reshape(-1, SIZE) @ to_halves - wanted).max(axis=1)
            split |= ~(missed <= tolerance * np.abs(wanted).max(axis=1))
        if not split.any():
            return edges
        edges = halved(edges, split)
    raise Unresolved("a kernel's spectra need more than %d nodes" % MOST)


def kernel(angle, apart, size):
    """1 / (1 - size e^{j angle}), size = 1 - apart."""
    sine, cosine = np.sin(angle / 2), np.cos(angle / 2)
    below = np.empty(angle.shape, COMPLEX)
    below.real, below.imag = apart + 2 * size * sine * sine, -2 * size * sine * cosine
    return 1 / below


def shifted(panels, apart, mu):
    """Matrices A, B with (1/2pi) int_0^pi f(nu) / (1 - mu e^{j (nu - w)}) dnu = A f, and B for e^{-j (nu + w)}; apart = 1 - mu."""
    edges, w = panels.edges, panels.circle.w
    if len(w) > MOST:
        raise Unresolved("a kernel's spectra need %d nodes" % len(w))
    turn = PI if mu < 0 else LONG(0)
    size, apart = abs(mu), 2 - apart if mu < 0 else apart
    octaves = apart * LONG(2) ** np.arange(-1, int(np.log2(float(8 / apart))) + 1)
    octaves = np.concatenate([-octaves, [LONG(0)], octaves])
    ahead, behind = np.zeros((2, len(w), len(w)), COMPLEX)
    for row, here in enumerate(w):
        centres = [here - turn, turn - here, here - turn + 2 * PI, turn - here + 2 * PI]
        cuts = np.concatenate([edges] + [centre + octaves for centre in centres])
        cuts = np.unique(cuts[(cuts >= 0) & (cuts <= PI)])
        low, high = cuts[:-1], cuts[1:]
        panel = np.searchsorted(edges, (low + high) / 2) - 1
        middle, half = (low + high) / 2, (high - low) / 2
        nodes, weights = half[:, None] * NODES, half[:, None] * WEIGHTS / (2 * PI)
        a, b = edges[panel], edges[panel + 1]
        rows = interpolation(((2 * middle - a - b)[:, None] + 2 * nodes) / (b - a)[:, None])
        for matrix, factor in ((ahead, kernel((middle - (here - turn))[:, None] + nodes, apart, size)),
                               (behind, kernel(-((middle + (here - turn))[:, None] + nodes), apart, size))):
            shares = np.einsum("kq,kqj->kj", factor * weights, rows)
            np.add.at(matrix[row].reshape(-1, SIZE), panel, shares)
    return ahead, behind
