#!/usr/bin/python3
"""analyze for losses in bursts, against dense computations without code of the package: first and second moments of the whole
string's state in every mode of its chains, and for verdicts the kernel of one link, summed over the lags of the chain."""

import unittest

import numpy as np
import scipy.fft
import scipy.sparse.linalg

import link_reference
from link_reference import chain_of
from link_models import COLOUR, LOOPS, AnalyzeTest, model_of

PREDICTORS = ("hold", "hold", "extrapolate", [1.2, -0.3, 0.1])


def registers_of(loss):
    """A_c of the registers r(k), r(k-1), ... in each mode of the chain."""
    c = np.array(link_reference.predictor_of(loss), float)
    arrived = np.eye(len(c), k=-1)
    lost = arrived.copy()
    lost[0] = c
    return [lost if is_lost else arrived for is_lost in chain_of(loss)[2]]


def blocks(p, a, of):
    """The block matrix of p_ij of(a_j), from mode i to mode j."""
    modes = range(len(p))
    return np.block([[p[i, j] * of(a[j]) for i in modes] for j in modes])


def growth(loss):
    """Spectral radius of the second moments of the registers."""
    return np.abs(np.linalg.eigvals(blocks(chain_of(loss)[0], registers_of(loss), lambda a: np.kron(a, a)))).max()


def random_loss(random):
    while True:
        q = random.choice([random.uniform(0.02, 0.3), random.uniform(0.3, 0.8)])
        least = max(1.0, q / (1.0 - q))
        loss = {"probability": q, "mean_burst": least * random.uniform(1.05, 3.0), "on_loss": PREDICTORS[random.integers(4)]}
        if growth(loss) < 0.9:
            return loss


def random_chain(random, states):
    while True:
        p = random.dirichlet(np.full(states, 0.7), states)
        loss = {"markov": {"transition": p.tolist(), "probability": random.uniform(0.0, 0.9, states).tolist()},
                "on_loss": PREDICTORS[random.integers(4)]}
        if growth(loss) < 0.9 and max(abs(np.linalg.eigvals(p) - 1.0)) > 0.0 and np.sort(abs(np.linalg.eigvals(p)))[-2] < 0.97:
            return loss


def random_link(random):
    link = {"loss": random_loss(random), "delay": int(random.integers(4))}
    if random.random() < 0.4:
        link["noise_filter"] = COLOUR
    if random.random() < 0.4:
        link["quantisation_step"] = 0.5
    return link


def random_model(seed):
    random = np.random.default_rng(seed)
    model = model_of(int(random.integers(2, 6)), random_link(random), time_headway=random.uniform(2.6, 4.0))
    if seed % 2:
        model["vehicle_types"] = {
            "truck": dict(LOOPS[int(random.integers(2, 6))], time_headway=4.0, channel=random_link(random),
                          initial_position={"mean": -1.0, "variance": 2.0}),
            "independent": {"channel": {"loss": {"probability": 0.2, "mean_burst": 1.25, "on_loss": "hold"}}}}
        model["string"] = [["truck", "default"], ["default", "truck", "independent"]][seed // 2 % 2]
    return model


def dense_moments(model, followers, steps):
    """As link_reference.moments(), in every mode of the chains. Relative to the run without losses and noise, to keep the
    numbers small."""
    system = link_reference.System(model, followers)
    modes, stationary, step, lost = link_reference.joint_chain(
        [vehicle["channel"]["loss"] for vehicle in link_reference.vehicles_of(model, followers)])
    maps = []
    for of_mode in lost:
        m = system.m.copy()
        for is_lost, part, gain, innovation in zip(of_mode, system.parts, system.gains, system.innovations):
            m += ((0.0 if is_lost else 1.0) - (1.0 - part.q)) * np.outer(gain, innovation)
        maps.append(m)
    without_losses = system.m + sum(part.q * np.outer(gain, innovation)
                                    for part, gain, innovation in zip(system.parts, system.gains, system.innovations))
    n = system.size
    path, covariance = system.start()
    first = np.zeros((len(modes), n))
    second = stationary[:, None, None] * covariance
    means, variances = np.zeros((followers, steps)), np.zeros((followers, steps))
    for k, y0 in enumerate(system.leader(steps)):
        whole = np.concatenate([path, [y0], np.zeros(2 * followers)])
        mean = first.sum(axis=0)
        spread = second.sum(axis=0) - np.outer(mean, mean)
        for i, error in enumerate(system.error):
            means[i, k] = error @ whole + error[:n] @ mean
            variances[i, k] = error[:n] @ spread @ error[:n]
        before, squares = step.T @ first, np.einsum("ac,aij->cij", step, second)
        for c, (m, probability) in enumerate(zip(maps, stationary)):
            drive = (m - without_losses) @ whole
            cross = np.outer(m[:, :n] @ before[c], drive)
            second[c] = m[:, :n] @ squares[c] @ m[:, :n].T + cross + cross.T + probability * (
                np.outer(drive, drive) + m[:, n + 1:] @ m[:, n + 1:].T)
            first[c] = m[:, :n] @ before[c] + probability * drive
        path = without_losses @ whole
    return means, variances


def kernel(loss, points):
    """T_L at the points w of a grid, and g(w, nu) for all pairs: registers driven by e^{j nu k}, divided by it."""
    w = 2.0 * np.pi * (np.arange(points) + 0.5) / points
    p, pi, lost = chain_of(loss)
    a = registers_of(loss)
    n, count = len(a[0]), len(p)
    e, entering = np.eye(n)[0], np.where(lost, 0.0, pi)
    second = np.eye(count * n * n) - blocks(p, a, lambda a: np.kron(a, a))
    both = blocks(p, a, lambda a: a)
    output = np.tile(e, count)
    passed, g = np.zeros(points, complex), np.zeros((points, points))
    for column, nu in enumerate(w):
        back = np.exp(-1j * nu)
        mean = np.linalg.solve(np.eye(count * n) - back * both, np.kron(entering, e))
        q = mean.reshape(count, n)
        drive = np.zeros((count, n, n), complex)
        for c in np.flatnonzero(~lost):
            cross = back * np.outer(a[c] @ (p[:, c] @ q), e)
            drive[c] = cross + cross.conj().T + pi[c] * np.outer(e, e)
        squares = np.linalg.solve(second, drive.reshape(-1)).reshape(count, n, n)
        t = output @ mean
        v = (squares[:, :, 0] - q * np.conj(t)).reshape(-1)
        modes = np.conj(q[:, 0]) - pi * np.conj(t)  # E[1{mode c} conj(r - E r)]
        g[:, column] = -(output @ v).real
        for lag in range(100000):
            g[:, column] += 2.0 * (np.exp(1j * (nu - w) * lag) * (output @ v)).real
            modes = modes @ p
            v = back * (both @ v) + np.kron(np.where(lost, 0.0, modes), e)
            if np.abs(v).max() < 1e-15 and np.abs(modes).max() < 1e-15:
                break
        passed[column] = t
    return w, passed, g


def loss_gain(model, points):
    """Of a homogeneous string without delay."""
    w, passed, g = kernel(model["channel"]["loss"], points)
    numerator, denominator = link_reference.polynomials_of(model)
    t = np.abs(np.polyval(numerator, np.exp(1j * w)) / np.polyval(denominator, np.exp(1j * w))) ** 2
    gain = t * np.abs(passed) ** 2
    operator = (g / points) * (t / (1.0 - gain))[None, :]
    return gain.max() < 1.0, np.abs(np.linalg.eigvals(operator)).max()


# Panels that resolve every mean over the circle miss this loss gain by 2e-9: their nodes interpolate too coarsely.
LONG_BURSTS = {"time_headway": 15.9166, "plant": {"numerator": [1.0], "denominator": [1.0, -2.0, 1.0]},
               "controller": {"numerator": [0.00206859, -0.00051614], "denominator": [1.0, 0.890381],
                              "divide_by_one_plus_headway": False},
               "channel": {"loss": {"probability": 0.594447, "mean_burst": 52870.5, "on_loss": "hold"}}}


def loss_gain_by_lags(model, lags):
    """Of a homogeneous string of G = 1 / (z - 1)^2 that holds a lost position for any mean burst b: the deviation d = s - r is
    d(k) = (1 - theta(k)) (d(k - 1) + u(k)), u(k) = s(k) - s(k - 1), its mean response q u / (1 - (1 - 1/b) / z). All lags of the
    autocovariances, by cosine and sine transforms of `lags` values, at least 10 b: no panels, no weights."""
    loss, h = model["channel"]["loss"], model["time_headway"]
    q, burst = loss["probability"], loss["mean_burst"]
    stay, memory = 1 - 1 / burst, 1 - 1 / ((1 - q) * burst)
    w = np.pi * (np.arange(lags) + 0.5) / lags
    z, sine = np.exp(1j * w), np.sin(w / 2)
    controller, apart, below = model["controller"], 2j * sine * np.exp(0.5j * w), 1 / burst + 2j * stay * sine * np.exp(-0.5j * w)
    k = np.polyval(controller["numerator"], z) / np.polyval(controller["denominator"], z)
    t = np.abs(k / (apart ** 2 + k * (1 + h * apart / z))) ** 2
    mean = q / below
    surprise, margin = np.abs(apart) ** 2, 1 - t * np.abs(1 - apart / z * mean) ** 2
    powers, spread = memory ** np.arange(lags), stay / burst

    def caused(drive):
        """The drives at a place of the string that this drive's losses cause in all followers ahead of it."""
        own = scipy.fft.dct(drive) / (2 * lags)
        even, odd = scipy.fft.dct(mean.real * drive) / (2 * lags), scipy.fft.dst(mean.imag * drive) / (2 * lags)
        cross = np.append(even[1:], 0.0) + odd  # E d(k) u(k + t), t = 1, 2, ...
        scattered = powers * (q * (1 - q) * own + spread * cross)
        scattered[0] += spread * ((2 * stay * cross[0] + q * own[0]) * burst + cross[0])
        return surprise * t / margin * scipy.fft.dct(scattered, type=3) / np.abs(below) ** 2
    operator = scipy.sparse.linalg.LinearOperator((lags, lags), matvec=lambda x: caused(x.ravel()), dtype=float)
    return scipy.sparse.linalg.eigs(operator, k=1, which="LR", v0=surprise, ncv=12, tol=1e-12, return_eigenvectors=False)[0].real


class Analyze(AnalyzeTest):
    def test_means_and_variances_of_every_step_are_those_of_the_whole_state(self):
        for seed in range(10):
            model = random_model(seed)
            with self.subTest(seed=seed, model=model):
                theory = self.analyze(model, 3, 50)
                means, variances = dense_moments(model, 3, 50)
                np.testing.assert_allclose(theory["mean"], means, rtol=1e-10, atol=1e-10)
                np.testing.assert_allclose(theory["variance"], variances, rtol=1e-10, atol=1e-13 * variances.max())
                self.assertEqual(theory["theory"], "exact")

    def test_stationary_values_are_those_of_a_long_recursion(self):
        for seed in range(10, 16):
            model = random_model(seed)
            with self.subTest(seed=seed, model=model):
                means, variances = dense_moments(model, 3, 600)
                theory = self.analyze(model, 3, 2)
                np.testing.assert_allclose(theory["stationary_variance"], variances[:, -1], rtol=1e-10)
                np.testing.assert_allclose(theory["stationary_mean"], means[:, -1], rtol=1e-10, atol=1e-9)

    def test_chains_of_states_are_those_of_the_whole_state(self):
        for seed in range(8):
            random = np.random.default_rng(100 + seed)
            model = model_of(int(random.integers(2, 4)), {"loss": random_chain(random, 2 + seed % 4), "delay": int(random.integers(3))},
                             time_headway=random.uniform(2.6, 4.0))
            with self.subTest(seed=seed, model=model):
                followers = 2 if seed % 4 < 2 else 1
                theory = self.analyze(model, followers, 300)
                means, variances = dense_moments(model, followers, 300)
                np.testing.assert_allclose(theory["mean"], means, rtol=1e-10, atol=1e-10)
                np.testing.assert_allclose(theory["variance"], variances, rtol=1e-10, atol=1e-13 * variances.max())
                np.testing.assert_allclose(theory["stationary_variance"], variances[:, -1], rtol=1e-10)

    def test_loss_gain_is_that_of_the_dense_operator(self):
        for loss in ({"probability": 0.2, "mean_burst": 3.0, "on_loss": "hold"},
                     {"probability": 0.6, "mean_burst": 1.7, "on_loss": "hold"},
                     {"probability": 0.1, "mean_burst": 1.5, "on_loss": "extrapolate"},
                     {"markov": {"transition": [[0.9, 0.1], [0.3, 0.7]], "probability": [0.02, 0.7]}, "on_loss": "hold"},
                     {"markov": {"transition": [[0.2, 0.7, 0.1], [0.1, 0.2, 0.7], [0.7, 0.2, 0.1]], "probability": [0.0, 0.5, 1.0]},
                      "on_loss": "hold"}):
            model = model_of(3, {"loss": loss})
            self.assertAlmostEqual(self.analyze(model, 1, 2)["loss_gain"] / loss_gain(model, 128)[1], 1.0, delta=1e-10)

    def test_loss_gain_of_long_bursts_is_that_of_all_lags(self):
        model = model_of(3, **LONG_BURSTS)
        self.assertAlmostEqual(self.analyze(model, 1, 2)["loss_gain"] / loss_gain_by_lags(model, 1 << 19), 1.0, delta=2e-11)

    def test_decides_right_on_both_sides_of_the_critical_mean_burst(self):
        at = lambda b: model_of(3, {"loss": {"probability": 0.1, "mean_burst": b, "on_loss": "extrapolate"}})
        critical = self.analyze(at(1.5), 1, 2)["critical_mean_burst"]
        for burst, stable in ((critical * (1.0 - 1e-5), True), (critical * (1.0 + 1e-5), False)):
            below_one, gain = loss_gain(at(burst), 128)
            self.assertTrue(below_one)
            self.assertEqual(gain < 1.0, stable)
            self.assertEqual(self.analyze(at(1.5), 1, 2, "--mean-burst", repr(burst))["string_stable"], stable)
        # Along a string, the variance settles below the critical burst and grows above it.
        settles, grows = (self.analyze(at(factor * critical), 800, 1)["stationary_variance"] for factor in (0.9, 1.1))
        self.assertLess(settles[-1], 1.01 * settles[400])
        self.assertGreater(grows[-1], 2.0 * grows[400])

    def test_sweeps_over_mean_bursts_and_probabilities(self):
        file = self.path("sweep.csv")
        model = model_of(3, {"loss": {"probability": 0.1, "mean_burst": 1.5, "on_loss": "extrapolate"}})
        points = self.analyze(model, 1, 2, "--sweep-burst", "1:3:3", "--sweep-loss", "0.1:0.7:2", "--csv", file)["sweep"]
        with open(file) as stream:
            self.assertEqual(stream.readline(), "headway,gain,loss,mean_burst,spectral_radius,peak_gain,loss_gain,string_stable\n")
        self.assertEqual([point["mean_burst"] for point in points], [1.0, 2.0, 3.0] * 2)
        self.assertEqual([point["string_stable"] for point in points], [True, True, False, None, None, False])


if __name__ == "__main__":
    unittest.main()
