#!/usr/bin/python3
"""Tests of `plot amplification` on files made here: figures, every documented error."""

import sys
import unittest

import numpy as np
import stochastic_platoon as sp

sys.dont_write_bytecode = True
from plot_files import PlotTest, plot, transfer  # noqa: E402

FIGURES = list(sp.Amplification.FIGURES)


def gain(headway):
    """|T| of the paper's example at a period of 10 steps."""
    loop, z = transfer(headway), np.exp(0.2j * np.pi)
    return abs(np.polyval(loop["numerator"], z) / np.polyval(loop["denominator"], z))


def table(followers=3, headway=3.2, theory=True, noise=0.5):
    """Rows of amplification.csv for a sinusoidal leader, with measurements 1 % above the theory."""
    t, lines = gain(headway), ["vehicle," + ",".join(FIGURES + ["theoretical_" + name for name in FIGURES] + ["rms_jerk"])]
    for i in range(followers + 1):
        ratios = [t, t, t ** i, t ** i] if i else [""] * 4
        values = ratios + [0.7 * t ** i, np.hypot(4.4 * t ** i, noise * np.sqrt(i)), 4.4 * t ** i]
        measured = [value if value == "" else 1.01 * value for value in values]
        lines.append(",".join(str(value) for value in [i] + measured + (values if theory else [""] * len(values)) + [""]))
    return "\n".join(lines) + "\n"


class AmplificationTest(PlotTest):
    def make_amplification(self, name="run", text=None, followers=3, **options):
        text = table(followers, **options) if text is None else text
        return self.make_run(name, self.rows(followers), followers, steps=400, realizations=1000, tables={"amplification.csv": text},
                             configuration={"run": {"burn_in": 200}, "model": {"sample_period": 0.1}})


class Amplification(AmplificationTest):
    def test_one_run_several_and_long_strings_are_drawn(self):
        run, other = self.make_amplification("a", followers=20), self.make_amplification("b", headway=2.4)
        self.assert_draws("amplification", run)
        self.assert_draws("amplification", run, other, "--titles", "$h = 3.2$", "$h = 2.4$")
        self.assert_draws("amplification", self.make_amplification("c", followers=1), self.make_amplification("d", followers=300))

    def test_a_run_without_theory_is_drawn_and_its_legend_names_none(self):
        self.assert_draws("amplification", self.make_amplification(theory=False))
        for theory in (False, True):
            run = sp.Results.load(self.make_amplification(str(theory), theory=theory))
            for axes in plot.amplification.draw([run], []).axes[1:]:
                labels = [text.get_text() for text in axes.get_legend().get_texts()]
                self.assertEqual([any(end in label for label in labels) for end in (", measured", ", theory")], [True, theory])

    def test_the_acceleration_has_a_panel_if_it_was_measured(self):
        run = sp.Results.load(self.make_amplification())
        self.assertEqual(len(plot.amplification.draw([run], []).axes), 3)
        for name in ("rms_acceleration", "rms_mean_acceleration"):
            run.amplification.measured[name][:], run.amplification.theory[name][:] = np.nan, np.nan
        self.assertEqual(len(plot.amplification.draw([run], []).axes), 2)

    def test_curves_are_the_figures_of_the_file(self):
        run = sp.Results.load(self.make_amplification())
        ratio, tail, acceleration = plot.amplification.draw([run], []).axes
        drawn = [line.get_xydata().tolist() for line in ratio.lines]
        self.assertIn([[i, gain(3.2)] for i in (1, 2, 3)], drawn)
        np.testing.assert_allclose(tail.lines[0].get_ydata(), gain(3.2) ** np.arange(1, 4))
        np.testing.assert_allclose(tail.lines[1].get_ydata(), 1.01 * gain(3.2) ** np.arange(1, 4))
        self.assertEqual(acceleration.lines[0].get_xdata().tolist(), [0, 1, 2, 3])
        self.assertEqual(run.amplification.seconds, (20.0, 40.0))


class AmplificationErrors(AmplificationTest):
    def test_a_run_without_amplification(self):
        self.assert_rejects("amplification", self.make_run(), saying=["amplification.csv: no such file: run with signals:=speed"])
        self.assert_rejects("amplification", self.path("none"), saying=["none: no such folder"])

    def test_a_run_of_one_step_or_one_realization(self):
        for steps, reason in ((1, "amplification.csv: no such file: run with at least 2 steps"),
                              (2, "all ratios are empty, as one realization does not separate the motion from the noise")):
            run = self.path(str(steps))
            sp.monte_carlo(sp.Model.load(), followers=2, steps=steps, realizations=1, signals=["speed", "acceleration"], output=run)
            self.assert_rejects("amplification", run, saying=[reason])

    def test_a_byte_that_was_changed(self):
        run = self.make_amplification()
        written = self.read("run", "amplification.csv")
        self.write_bytes(written[:-20] + b"7" + written[-19:], "run", "amplification.csv")
        self.assert_rejects("amplification", run, saying=["is not as it was written"])

    def test_rows_and_columns_that_are_missing(self):
        heading, leader, *rows = table().splitlines()
        for name, lines, words in (("a", [heading] + rows, "each vehicle 0..N"), ("b", [heading, leader], "each vehicle 0..N"),
                                   ("c", [heading.replace("rms_mean_speed", "x"), leader] + rows, "column rms_mean_speed is missing")):
            self.assert_rejects("amplification", self.make_amplification(name, "\n".join(lines) + "\n"), saying=[words])

    def test_a_summary_of_another_string(self):
        run = self.make_amplification(text=table(4))
        self.assert_rejects("amplification", run, saying=["followers is 3, but amplification.csv beside it has 4"])

    def test_a_leader_at_constant_speed(self):
        empty = "\n".join([table().splitlines()[0]] + ["{},,,,,0,1,0,,,,,0,1,0,".format(i) for i in range(4)]) + "\n"
        self.assert_rejects("amplification", self.make_amplification("a", empty), saying=["the leader drives at constant speed"])
        hidden = empty.replace(",,,,,0,1", ",,,,,0.5,1", 1)
        self.assert_rejects("amplification", self.make_amplification("b", hidden), saying=["noise hides the motion"])


if __name__ == "__main__":
    unittest.main()
