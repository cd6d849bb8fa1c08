#!/usr/bin/python3
"""Tests of src/tools/plot on small files: sweeps."""

import sys
import unittest

import numpy as np
import stochastic_platoon as sp
from matplotlib.backends.backend_agg import FigureCanvasAgg

sys.dont_write_bytecode = True
from plot_files import PlotTest, plot  # noqa: E402


SWEEP = ("point,loss,headway,vehicle,step,count,mean,mean_standard_error,variance,variance_standard_error,"
         "theoretical_mean,theoretical_variance,string_stable,agrees")


class Sweeps(PlotTest):
    def make_sweep(self, *rows, heading=SWEEP):
        return self.write("\n".join((heading,) + rows) + "\n", "sweep.csv")

    def row(self, point, loss, headway, vehicle=2, step=9, variance=1.5, theory="1.4", stable="1"):
        return "{},{},{},{},{},100,0.1,0.01,{},0.2,0,{},{},1".format(point, loss, headway, vehicle, step, variance, theory, stable)

    def grid(self):
        return self.make_sweep(*[self.row(3 * i + j, loss, headway, vehicle, step, variance=100 * i + 10 * j + vehicle + 0.1 * step,
                                          stable="01"[j > 0])
                                 for i, loss in enumerate((0, 0.1)) for j, headway in enumerate((2.4, 3.2, 4))
                                 for vehicle in (1, 2) for step in (8, 9)])

    def test_draws_curves_over_the_parameter_with_most_values(self):
        self.assert_draws("sweep", self.grid())
        tails = plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv")))
        self.assertEqual(tails.over, "headway")
        self.assertEqual([curve.name for curve in tails.curves], ["loss = 0", "loss = 0.1"])
        self.assertEqual(list(tails.curves[1].at), [2.4, 3.2, 4.0])
        np.testing.assert_allclose(tails.curves[1].variance, [102.9, 112.9, 122.9])
        self.assertEqual(list(tails.curves[0].string_stable), [0, 1, 1])

    def test_draws_curves_over_a_requested_parameter(self):
        self.grid()
        self.assertEqual(len(plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv")), "loss").curves), 3)
        self.assert_draws("sweep", self.path("sweep.csv"), "--over", "loss")

    def test_draws_one_point_without_theory(self):
        self.assert_draws("sweep", self.make_sweep(self.row(0, 0.1, 3.2, theory="", stable="")))

    def test_points_look_as_their_verdict_and_none_is_a_third_one(self):
        self.make_sweep(*[self.row(at, 0.1, 3 + at, stable=stable) for at, stable in enumerate(("1", "0", ""))])
        axes = plot.sweep.draw(plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv")))).axes[0]
        faces = {bar[0].get_xdata()[0]: bar[0].get_markerfacecolor() for bar in axes.containers}
        self.assertEqual((sorted(faces), len(set(faces.values())), faces[3.0]), ([3.0, 4.0, 5.0], 3, "white"))
        entries = {text.get_text() for text in axes.get_legend().get_texts()}
        self.assertGreaterEqual(entries, {"string stable", "not string stable", "no verdict"})
        self.grid()
        axes = plot.sweep.draw(plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv")))).axes[0]
        self.assertNotIn("no verdict", {text.get_text() for text in axes.get_legend().get_texts()})

    def test_the_legend_of_curves_with_long_names_is_within_the_figure_and_below_the_axes(self):
        self.addCleanup(plot.style.apply)
        names = ["{loss: {probability: 0.1 on_loss: hold}}", "{loss: {by_distance: [[0 0.1] [100 0.12] [200 0.3] [400 0.5]] on_loss: hold}}"]
        self.make_sweep(*[self.row(2 * i + j, name, 3 + j) for i, name in enumerate(names) for j in range(2)])
        for width in (None, 80.0, 180.0):
            plot.style.apply(width)
            figure = plot.sweep.draw(plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv"))))
            FigureCanvasAgg(figure).draw()
            box, label = figure.axes[0].get_legend().get_window_extent(), figure.axes[0].xaxis.label.get_window_extent()
            self.assertTrue(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 and figure.bbox.y0 <= box.y0, (width, box))
            self.assertLess(box.y1, label.y0)

    def test_paired_axes_are_one_curve(self):
        self.make_sweep(*[self.row(i, 0.01 * i, 2.4 + 0.1 * i) for i in range(20)])
        self.assertEqual(len(plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv"))).curves), 1)

    def test_names_curves_by_rounded_numbers(self):
        path = self.make_sweep(*[self.row(i, 0.09999999999999992, 2.4 + i) for i in range(3)])
        self.assertEqual([curve.name for curve in plot.sweep.tails_of(sp.Sweep.load(path)).curves], ["loss = 0.1"])

    def test_rejects_an_invalid_sweep(self):
        self.assert_rejects("sweep", self.path("none"), saying=["No such file"])
        self.assert_rejects("sweep", self.write("", "sweep.csv"), saying=["is empty"])
        row = self.row(0, 0, 3)
        self.assert_rejects("sweep", self.make_sweep(row, heading=SWEEP.replace("agrees", "x")), saying=["column agrees is missing"])
        self.assert_rejects("sweep", self.make_sweep(row.replace("0,0,3,", "0,"), heading=SWEEP.replace("loss,headway,", "")),
                            saying=["nothing varies in it"])
        self.assert_rejects("sweep", self.make_sweep(), saying=["holds no rows"])
        self.assert_rejects("sweep", self.make_sweep("1,2"), saying=["line 2 has 2 values instead of 14"])
        self.assert_rejects("sweep", self.make_sweep(self.row(0, 0, 3, variance="much")),
                            saying=["line 2: variance: much: must be a number"])
        self.assert_rejects("sweep", self.make_sweep(self.row(0, "a", "[1 2]")), saying=["no number varies in it: loss, headway"])
        self.assert_rejects("sweep", self.make_sweep(self.row(0, 0, 3, variance="nan")), saying=["variance is NaN everywhere"])
        self.assert_rejects("sweep", self.grid(), "--over", "delay", saying=["--over: delay: must be a varying parameter of", "loss, headway"])

    def test_rejects_too_many_curves(self):
        rows = [self.row(2 * i + j, i, j) for i in range(8) for j in range(2)]
        self.assert_rejects("sweep", self.make_sweep(*rows), "--over", "headway", saying=["8 curves over headway: must be at most 7"])


if __name__ == "__main__":
    unittest.main()
