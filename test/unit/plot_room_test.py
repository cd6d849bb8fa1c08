#!/usr/bin/python3
"""Tests that titles, legends and numbers of the axes of src/tools/plot have room."""

import sys
import unittest

import stochastic_platoon as sp
from matplotlib.backends.backend_agg import FigureCanvasAgg

sys.dont_write_bytecode = True
from plot_amplification_test import AmplificationTest  # noqa: E402
from plot_files import PlotTest, plot  # noqa: E402
from plot_gaps_test import GapTest  # noqa: E402

LONG = "cars_and_trucks, the same cars without limits"


class Boxes(unittest.TestCase):
    def boxes(self, figure, texts):
        """The rectangles of the texts in the drawn figure, within it and apart from each other."""
        FigureCanvasAgg(figure).draw()
        boxes = [text.get_window_extent() for text in texts]
        for at, box in enumerate(boxes):
            self.assertTrue(box.x0 >= 0.0 and box.y0 >= 0.0 and box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1, (texts[at], box))
            self.assertFalse(any(box.overlaps(other) for other in boxes[:at]), texts[at])
        return boxes


class Room(PlotTest, Boxes):
    def gains(self, count):
        return plot.gain.draw(count * [sp.Analysis.load(self.make_analysis())], [LONG] * count)

    def test_titles_of_many_gains_do_not_touch(self):
        self.addCleanup(plot.style.apply)
        for width in (None, 88.0, 180.0):
            plot.style.apply(width)
            for count in (5, 6):
                figure = self.gains(count)
                self.boxes(figure, [panel.title for panel in figure.axes])
                self.assertEqual(figure.axes[0].get_title().replace("\n", " "), LONG + " string stable")

    def test_the_axis_of_a_gain_above_an_unused_panel_has_numbers(self):
        figure = self.gains(7)
        FigureCanvasAgg(figure).draw()
        # Matplotlib 3.3 adds invisible panels in place of the unused ones.
        shown = [any(tick.label1.get_visible() for tick in panel.xaxis.get_major_ticks()) for panel in figure.axes if panel.get_visible()]
        self.assertEqual(shown, 2 * [False] + 5 * [True])

    def test_the_legend_of_a_string_lies_on_no_curve(self):
        self.addCleanup(plot.style.apply)
        for scale, sweep in ((1.0, False), (1e4, False), (1e4, True)):
            points = {"sweep": [{"headway": 20.0, "limit_variance": 5.0}, {"headway": 30.0, "limit_variance": 4.0}]} if sweep else {}
            paths = [self.make_analysis("{}.json".format(at), stationary_variance=[2.0 * scale ** at, 3.0, 3.5], **points) for at in (0, 1)]
            for width in (None, 88.0):
                plot.style.apply(width)
                figure = plot.string_variance.draw([sp.Analysis.load(path) for path in 3 * paths], [], [])
                legends = self.boxes(figure, [axes.get_legend() for axes in figure.axes])
                self.assertEqual(len(legends), 1 + sweep)
                for axes in figure.axes:
                    self.assertFalse(any(legend.overlaps(axes.get_window_extent()) for legend in legends), (scale, sweep, width))
                    self.assertGreater(axes.get_window_extent().height, 90.0)

    def test_formulas_stay_whole_where_a_line_breaks(self):
        self.assertEqual(plot.style.wrapped("a run with $h = 3.2$ and a price of 5\\$", 14), "a run with\n$h = 3.2$ and\na price of 5\\$")
        self.assertEqual(plot.style.wrapped("$h = 3.2, k = 1.35$, far-off", 10), "$h = 3.2, k = 1.35$,\nfar-off")


class Trajectories(GapTest):
    def test_the_title_of_a_narrow_figure_lies_in_it_and_its_panels_are_over_the_same_time(self):
        self.addCleanup(plot.style.apply)
        realization = sp.Trajectories.load(self.make_trajectories(steps=200))
        for width in (None, 88.0, 135.0, 180.0):
            plot.style.apply(width)
            for titles, step in (([], None), (["the paper's example behind a long name, $h = 3.2$"], 150)):
                figure = plot.trajectories.draw(realization, titles, step)
                FigureCanvasAgg(figure).draw()
                box = figure._suptitle.get_window_extent()
                self.assertTrue(box.x0 >= 0.0 and box.x1 <= figure.bbox.x1, (width, titles, box))
                self.assertEqual(len({axes.get_xlim() for axes in figure.axes[:4]}), 1)
                self.assertEqual({axes.yaxis.get_offset_text().get_text() for axes in figure.axes[:4]}, {""})
                self.assertTrue(plot.files.content(figure, "svg"))  # with room for the panels


class Amplification(AmplificationTest, Boxes):
    def test_titles_and_labels_have_room_side_by_side(self):
        self.addCleanup(plot.style.apply)
        run = sp.Results.load(self.make_amplification())
        for width in (None, 88.0, 135.0, 180.0):
            plot.style.apply(width)
            figure = plot.amplification.draw([run], [])
            self.boxes(figure, [axes.title for axes in figure.axes])
            self.boxes(figure, [axes.yaxis.label for axes in figure.axes])
            self.boxes(figure, [axes.get_legend() for axes in figure.axes])
            self.assertTrue(figure.axes[0].get_legend().get_texts()[0].get_text().count("\n"))  # a run has two lines

    def test_the_first_follower_has_a_number_where_the_leader_leaves_room(self):
        for followers, numbers in ((3, [0, 1, 2, 3]), (6, [0, 1, 2, 3, 4, 5, 6]), (100, [0, 20, 40, 60, 80, 100])):
            run = sp.Results.load(self.make_amplification(str(followers), followers=followers))
            self.assertEqual(plot.amplification.draw([run], []).axes[2].get_xticks().tolist(), numbers)


if __name__ == "__main__":
    unittest.main()
