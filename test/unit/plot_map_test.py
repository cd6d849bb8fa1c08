#!/usr/bin/python3
"""Tests of `plot map` on small maps."""

import sys
import unittest

import numpy as np
import stochastic_platoon as sp
from matplotlib.backends.backend_agg import FigureCanvasAgg

sys.dont_write_bytecode = True
from plot_files import PlotTest, plot  # noqa: E402


def crossed(line, along, beside, low, high):
    """How often a line crosses the segment from `low` to `high` of the coordinate `along`, at `beside` of the other one."""
    before, after = line[:-1, 1 - along], line[1:, 1 - along]
    at = np.flatnonzero((before > beside) != (after > beside))
    where = line[at, along] + (beside - before[at]) / (after[at] - before[at]) * (line[at + 1, along] - line[at, along])
    return int(((low < where) & (where < high)).sum())


class Maps(PlotTest):
    def test_map_over_losses_is_drawn(self):
        rows = ["headway,gain,loss,spectral_radius,peak_gain,loss_gain,string_stable"]
        for loss in (0.0, 0.1, 0.3):
            for headway in (2.0, 2.6, 3.2):
                rows.append("{},1.35,{},0.5,{},{},{}".format(headway, loss, 1.0 + loss, "nan" if loss > 0.2 else loss,
                                                             int(loss < 0.2)))
        path = self.write("\n".join(rows) + "\n", "losses.csv")
        stability = sp.StabilityMap.load(path)
        self.assertEqual((stability.over, stability.up), ("headway", "loss"))
        self.assertEqual(stability.ys.tolist(), [0.0, 0.1, 0.3])
        self.assert_draws("map", path)

    def test_map_over_losses_and_bursts_is_drawn(self):
        rows = ["headway,gain,loss,mean_burst,spectral_radius,peak_gain,loss_gain,string_stable"]
        for loss in (0.1, 0.4, 0.6):
            for burst in (1.0, 1.5, 2.0, 4.0):
                exists = burst >= loss / (1.0 - loss)
                rows.append("3.2,1.35,{},{},{}".format(loss, burst, "0.5,1,{},{}".format(loss * burst, int(loss * burst < 1)) if exists else ",,,"))
        path = self.write("\n".join(rows) + "\n", "bursts.csv")
        stability = sp.StabilityMap.load(path)
        self.assertEqual((stability.over, stability.up), ("loss", "mean_burst"))
        self.assertEqual(stability.loss_gain[:, 0].tolist(), [0.1, 0.15000000000000002, 0.2, 0.4])
        self.assertTrue(np.isnan(stability.spectral_radius[0, 2]))
        self.assert_draws("map", path)

    def test_map_is_drawn(self):
        self.assert_draws("map", self.make_map())

    def test_the_legend_of_a_map_names_what_is_drawn(self):
        border = "string stability border, between grid points"
        for given, labels in (({}, [border, "the paper's example"]), ({"gains": (1.0, 1.2)}, [border]), ({"gains": (0.5, 0.6)}, [])):
            path = self.make_map(radius=lambda headway, gain: 0.6, **given)
            legend = plot.stability_map.draw(sp.StabilityMap.load(path)).axes[0].get_legend()
            self.assertEqual([text.get_text() for text in legend.get_texts()], labels)

    def test_the_legend_of_a_map_lies_in_the_figure_and_leaves_its_width_to_the_axes(self):
        rows = ["headway,gain,loss,mean_burst,spectral_radius,peak_gain,loss_gain,string_stable"]
        for loss in (0.1, 0.4, 0.6, 0.7):
            for burst in (1.0, 1.5, 2.0, 4.0):
                of_stable = "0.5,,,0" if loss * burst > 1.5 else "0.5,1,{},{}".format(loss * burst, int(loss * burst < 1))
                cells = ",,," if burst < loss / (1.0 - loss) else "1.1,9,,0" if loss == 0.7 else of_stable
                rows.append("3.2,1.35,{},{},{}".format(loss, burst, cells))
        losses = self.write("\n".join(rows) + "\n", "bursts.csv")
        self.addCleanup(plot.style.apply)
        for path, entries in ((self.make_map(radius=lambda headway, gain: 1.1 if gain > 2.0 else 0.6), 3), (losses, 4)):
            for width in (None, 88.0, 135.0):
                plot.style.apply(width)
                figure = plot.stability_map.draw(sp.StabilityMap.load(path))
                FigureCanvasAgg(figure).draw()
                legend, axes = figure.axes[0].get_legend(), figure.axes[0].get_position()
                box = legend.get_window_extent()
                self.assertEqual(len(legend.get_texts()), entries)
                self.assertTrue(box.x0 >= 0.0 and box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1, (width, box))
                legend.set_in_layout(False)
                FigureCanvasAgg(figure).draw()
                self.assertGreater(axes.width, 0.95 * figure.axes[0].get_position().width, (width, "with and without the legend"))

    def test_the_border_of_the_map_keeps_its_ends_and_moves_less_than_a_cell(self):
        stairs = np.array([[k // 2 + k % 2, k // 2] for k in range(41)], dtype=float)
        line = plot.stability_map.smoothed(stairs)
        np.testing.assert_array_equal(line[[0, -1]], stairs[[0, -1]])
        self.assertLess(np.abs(line - stairs).max(), 1.0)
        wave = [[k, np.floor(3.0 * np.sin(0.15 * k)) + 0.5] for k in range(41)]
        self.assertLess(np.abs(np.diff(plot.stability_map.smoothed(np.array(wave))[:, 1])).max(), 0.8)  # steps of 1 before

    def test_the_border_of_the_map_has_every_grid_point_on_its_side(self):
        draws = np.random.default_rng(1)
        for share in (0.2, 0.5, 0.9):
            xs, ys = (np.cumsum(draws.uniform(0.5, 2.0, size)) for size in (9, 7))
            verdicts = (draws.random((7, 9)) < share).astype(int)
            rows = ["headway,gain,spectral_radius,peak_gain,string_stable"]
            rows += ["{!r},{!r},0.5,1,{}".format(float(x), float(y), verdicts[j, i]) for j, y in enumerate(ys) for i, x in enumerate(xs)]
            lines = plot.stability_map.border_lines(sp.StabilityMap.load(self.write("\n".join(rows) + "\n", "random.csv")))
            for j in range(6):
                for i in range(8):  # the segments to the right and upwards of a point, just beside the line of the grid
                    for along, at, to, beside in ((0, (i, j), (i + 1, j), ys[j] + 1e-6), (1, (i, j), (i, j + 1), xs[i] + 1e-6)):
                        ends = (xs, ys)[along][at[along]], (xs, ys)[along][to[along]]
                        crossings = sum(crossed(line, along, beside, *ends) for line in lines)
                        self.assertEqual(crossings % 2, verdicts[at[1], at[0]] ^ verdicts[to[1], to[0]], (share, at, to))


if __name__ == "__main__":
    unittest.main()
