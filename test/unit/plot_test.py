#!/usr/bin/python3
"""Tests of src/tools/plot on small files: figures but those that have tests of their own, and their numbers."""

import json
import os
import shutil
import subprocess
import sys
import unittest

import numpy as np
import stochastic_platoon as sp
from matplotlib.backends.backend_agg import FigureCanvasAgg

sys.dont_write_bytecode = True
from plot_files import COUNT, PlotTest, TOOLS, gain_along_string, plot  # noqa: E402
from plotting import following, tracking_errors  # noqa: E402
from watching_messages import endless  # noqa: E402


class Figures(PlotTest):
    def test_errors_of_two_runs_become_png_and_svg(self):
        self.assert_draws("errors", self.make_run("a"), self.make_run("b"), "--titles", "$h = 3.2$", "$h = 2.4$")

    def test_errors_of_one_follower_and_one_step_are_drawn(self):
        self.assert_draws("errors", self.make_run(followers=1, steps=1))

    def test_errors_of_many_followers_are_drawn(self):
        self.assert_draws("errors", self.make_run(followers=500, steps=3))

    def test_errors_of_time_averages_are_drawn_along_the_string(self):
        self.assert_draws("errors", self.make_average())

    def test_titles_name_the_step_up_to_which_averages_over_time_reach(self):
        shown = dict(sample_period=0.1, spacing="h", followers=3, seed=1)
        for run, words in ((sp.Results.load(self.make_average("a", 500)), "average over time up to step 500,"),
                           (sp.Results.load(self.make_average("b", -1)), "average over time (paused),"),
                           (following.results_of(shown, endless(3, 700, counted_from=700)), "average over time up to 70 s (step 700),"),
                           (following.results_of(shown, endless(3, 699, counted_from=700)), "average over time (paused),")):
            self.assertIn(words, tracking_errors.title(run, "run"))

    def test_norms_of_runs_and_analyses_are_drawn(self):
        unbounded = {"mean_l2": [1.0, 2.0, 4.0], "variance_linf": [2.0, 3.0, 4.0],
                     "mean_bound": None, "variance_bound": None}
        self.assert_draws("norms", self.make_run("a"), self.make_run("b"), self.make_analysis("a.json"),
                          self.make_analysis("b.json", norms=unbounded, string_stable=False))

    def test_norms_of_a_run_alone_and_of_an_analysis_alone_are_drawn(self):
        self.assert_draws("norms", self.make_run())
        self.assert_draws("norms", self.make_analysis())

    def test_gain_is_drawn(self):
        self.assert_draws("gain", self.make_analysis("a.json"), self.make_analysis("b.json", gain_along_string=gain_along_string(2.4)))
        axes = plot.gain.draw([sp.Analysis.load(self.path("a.json"))], []).axes[0]
        left, right = axes.get_xlim()
        self.assertEqual((axes.get_xscale(), left, right), ("log", 0.01, np.pi / 0.1))
        self.assertEqual(axes.lines[1].get_xdata().tolist(), [left])  # a peak at frequency 0

    def test_the_legend_of_gains_does_not_lie_on_the_words_above_the_limit(self):
        for peaks in ([1.0], [1.0, 1.6], [1.0, 1.6, 90.0]):
            curves = [{"frequency": [1e-4, 0.0043, 0.006, 3.0], "gain": [1.0, peak, 0.9, 1e-3]} for peak in peaks]
            paths = [self.make_analysis("acc_{}.json".format(at), gain_along_string=curve, sample_period=0.01) for at, curve in enumerate(curves)]
            figure = plot.gain.draw([sp.Analysis.load(path) for path in paths], [])
            FigureCanvasAgg(figure).draw()
            words, legend = figure.axes[0].texts[0].get_window_extent(), figure.axes[0].get_legend().get_window_extent()
            self.assertFalse(words.overlaps(legend), (words, legend))
            self.assertTrue(legend.y0 >= 0.0 and legend.y1 <= figure.axes[0].xaxis.label.get_window_extent().y0, legend)

    def test_string_is_drawn_with_and_without_a_limit_and_runs(self):
        self.assert_draws("string", self.make_analysis("a.json"))
        self.assert_draws("string", self.path("a.json"), self.make_analysis("b.json", limit_variance=None),
                          "--run", self.make_run(), self.make_average())

    def test_gain_and_string_of_cars_with_limits_are_those_of_the_same_cars_without_them(self):
        with open(self.make_analysis()) as file:
            linear = json.load(file)
        path = self.write(json.dumps({"theory": "none", "reason": "none, as vehicles have limits", "linear": linear}), "limits.json")
        self.assert_draws("gain", path)
        self.assert_draws("string", path)
        axes = plot.string_variance.draw(plot.linear_analyses_of([path]), [], []).axes[0]
        self.assertEqual([text.get_text().split(": ")[0] for text in axes.get_legend().get_texts()], 2 * ["limits, the same cars without limits"])
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), linear["stationary_variance"])
        self.assert_rejects("string", path, "--run", self.make_run(), saying=["stationary_variance is missing; theory: none"])

    def test_a_run_without_theory_is_drawn(self):
        rows = ["{},{},100,0.01,{},,".format(i, k, 1.0 + i) for i in (1, 2, 3) for k in range(3)]
        run = self.make_run("bursts", rows=rows)
        self.assert_draws("errors", run)
        for path, labels in ((run, ["measured"]), (self.make_run(), ["measured", "theory"])):
            legend = plot.tracking_errors.draw([sp.Results.load(path)], []).axes[1].get_legend()
            self.assertEqual([text.get_text() for text in legend.get_texts()], labels)

    def test_huge_and_infinite_values_are_drawn(self):
        rows = ["1,{0},{1},1e{2},1e{2},1e{2},1e{2}".format(k, COUNT, 77 * k) for k in range(5)]
        rows.append("1,5,9,inf,nan,-inf,-nan")
        self.assert_draws("errors", self.make_run(rows=rows, followers=1, steps=6,
                                                  theory={"spectral_radius": 1.2, "string_stable": False}))

    def test_equal_input_gives_equal_files(self):
        run = self.make_run()
        contents = []
        for _ in range(2):
            self.assert_draws("errors", run)
            contents.append([self.read("figure.png"), self.read("figure.svg")])
        self.assertEqual(contents[0], contents[1])

    def test_an_extension_in_the_output_is_not_doubled(self):
        code, printed, _ = self.run_plot("gain", self.make_analysis(), "--output", self.output + ".png")
        self.assertEqual((code, printed.split()[0]), (0, self.output + ".png"))

    def test_an_output_that_ends_in_pdf_is_one_pdf(self):
        self.assertEqual(self.run_plot("errors", self.make_run(), "--output", self.path("x.pdf")), (0, self.path("x.pdf") + "\n", ""))
        self.assertEqual(self.read("x.pdf")[:5], b"%PDF-")
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("x")], ["x.pdf"])

    def test_a_chosen_width_is_that_of_the_figure_and_narrow_figures_have_their_panels_below_each_other(self):
        self.addCleanup(plot.style.apply)
        runs = [sp.Results.load(self.make_run(name)) for name in "ab"]
        for width, columns in ((180.0, 2), (88.0, 1)):
            plot.style.apply(width)
            figure = plot.tracking_errors.draw(runs, [])
            self.assertAlmostEqual(25.4 * figure.get_figwidth(), width)
            figure.canvas.draw()
            self.assertEqual(len({round(axes.get_position().x0, 3) for axes in figure.axes[:4]}), columns)
        self.assert_rejects("errors", self.path("a"), "--width", "3.5", saying=["--width: 3.5: must be from 40 to 400 mm"])
        self.assert_rejects("norms", self.path("a"), "--width", "40", saying=["--width: 40: must be larger, as the panels of this figure"])

    def test_curves_are_over_seconds_if_the_run_has_a_sample_period(self):
        run = self.make_run(configuration={"model": {"sample_period": 0.1}})
        axes = plot.tracking_errors.draw([sp.Results.load(run)], []).axes[1]
        self.assertEqual(axes.get_xlabel(), "time [s]")
        np.testing.assert_allclose(axes.lines[0].get_xdata(), 0.1 * np.arange(4))
        self.assertEqual(plot.tracking_errors.draw([sp.Results.load(self.make_run("other"))], []).axes[1].get_xlabel(), "step $k$")

    def test_a_point_in_the_output_is_no_extension(self):
        _, printed, _ = self.run_plot("gain", self.make_analysis(), "--output", self.output + "-h3.2")
        self.assertEqual(printed.split()[0], self.output + "-h3.2.png")

    def test_the_program_runs_where_it_is_installed_through_a_link_and_a_relay(self):
        shutil.copy(os.path.join(TOOLS, "plot"), self.folder)
        shutil.copytree(os.path.join(TOOLS, "plotting"), self.path("plotting"))
        os.mkdir(self.path("elsewhere"))
        os.symlink(self.path("plot"), self.path("elsewhere", "plot"))
        # A relay as in catkin's devel space: a script that runs the program.
        self.write("path = {!r}\nexec(compile(open(path).read(), path, 'exec'), {{'__file__': path, '__name__': "
                   "'__main__'}})\n".format(self.path("elsewhere", "plot")), "elsewhere", "relay")
        for command in ([self.path("elsewhere", "plot")], [sys.executable, self.path("elsewhere", "relay")]):
            os.mkdir(self.path("here"))
            done = subprocess.run(command + ["gain", self.make_analysis()], cwd=self.path("here"),
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "gain.png\ngain.svg\n", ""))
            self.assertEqual(sorted(os.listdir(self.path("here"))), ["gain.png", "gain.svg"])
            shutil.rmtree(self.path("here"))


class Numbers(PlotTest):
    def test_the_peak_of_the_gain_is_where_the_analysis_has_it(self):
        path = self.make_analysis(gain_along_string=gain_along_string(2.4), peak_gain=1.1588996213, peak_frequency=0.610896)
        figure = plot.gain.draw([sp.Analysis.load(path)], [])
        self.assertEqual(figure.axes[0].get_lines()[1].get_xydata().tolist(), [[6.10896, 1.1588996213]])
        # The curve has its maximum there, within the square of its grid width.
        curve = figure.axes[0].get_lines()[0]
        self.assertAlmostEqual(max(curve.get_ydata()), 1.1588996213, 5)

    def test_more_than_three_gains_have_a_panel_each_with_their_verdict(self):
        stable = sp.Analysis.load(self.make_analysis("a.json"))
        unstable = sp.Analysis.load(self.make_analysis("b.json", gain_along_string=gain_along_string(2.4), peak_gain=1.1588996213,
                                                       peak_frequency=0.610896, string_stable=False))
        axes = plot.gain.draw([stable] * 5 + [unstable], ["one", "two", "three", "four", "five", "six"]).axes
        self.assertEqual([panel.get_title() for panel in axes[::5]], ["one\nstring stable", "six\nnot string stable, peak 1.159"])
        self.assertEqual(len(axes), 6)
        curve = axes[5].get_lines()[1]
        self.assertAlmostEqual(curve.get_xdata()[int(np.argmax(curve.get_ydata()))] * 0.1, 0.610896, 2)  # in rad/s

    def test_curves_have_the_values_of_the_file(self):
        run = sp.Results.load(self.make_run(rows=list(reversed(self.rows()))))
        figure = plot.tracking_errors.draw([run], [])
        lines = figure.axes[0].get_lines()
        np.testing.assert_allclose(lines[4].get_xdata(), [0, 1, 2, 3])
        # The third follower's measured mean and theoretical variance.
        np.testing.assert_allclose(lines[4].get_ydata(), [0.0, 0.3, 0.6, 0.9])
        np.testing.assert_allclose(figure.axes[1].get_lines()[5].get_ydata(), [4.0] * 4)

    def test_the_title_has_name_verdict_realizations_and_seed(self):
        run = sp.Results.load(self.make_run("h24", complete=False, realizations=1000000,
                                                 theory={"spectral_radius": 0.6, "string_stable": False}))
        self.assertEqual(plot.tracking_errors.title(run, "h24"),
                         "h24, not string stable\n1\u2009000\u2009000 realizations, seed 7, incomplete run")

    def test_measured_norms_are_those_of_the_file(self):
        case, = plot.norms.cases_of([sp.Results.load(self.make_run())], [])
        variance = np.array([2.0, 2.1, 2.2, 2.3])
        square = (0.1 ** 2 + 0.2 ** 2 + 0.3 ** 2) - variance.sum() / COUNT  # without the bias from sampling
        self.assertAlmostEqual(case.mean.measured[0], np.sqrt(square))
        self.assertAlmostEqual(case.variance.measured[0], 2.3)
        # 2.4977: the normal quantile of 1 - 0.05 / (2 * 4), simultaneous for all four steps
        for i in (1, 2, 3):
            self.assertAlmostEqual(case.variance.half_width[i - 1], 2.4977 * 0.5 * i, 4)
        self.assertAlmostEqual(case.mean.own[0], np.sqrt(0.14))

    def test_error_bars_of_the_string_are_two_standard_errors(self):
        analysis = sp.Analysis.load(self.make_analysis())
        run = sp.Results.load(self.make_run())
        figure = plot.string_variance.draw([analysis], [run], [])
        for i, bar in enumerate(figure.axes[0].containers[0].lines[2][0].get_segments(), 1):
            self.assertAlmostEqual(bar[1][1] - bar[0][1], 4.0 * 0.25 * i)

    def test_the_string_has_its_limits_over_the_headway_beside_it(self):
        points = [{"headway": 20.0, "limit_variance": None}, {"headway": 30.0, "limit_variance": 5.0}, {"headway": 40.0, "limit_variance": 4.0}]
        swept = sp.Analysis.load(self.make_analysis("a.json", sweep=points, sample_period=0.01))
        plain = sp.Analysis.load(self.make_analysis("b.json"))
        figure = plot.string_variance.draw([swept, plain], [], [])
        self.assertEqual(len(figure.axes), 2)
        line, = figure.axes[1].lines
        np.testing.assert_allclose(line.get_xdata(), [0.2, 0.3, 0.4])
        np.testing.assert_array_equal(line.get_ydata(), [np.nan, 5.0, 4.0])

    def make_rare(self, name, distance, run=None, **changes):
        """An estimation for two followers, each less likely by a factor of ten per metre."""
        row = dict(dict.fromkeys(sp.Rare.FIGURES, 0.0), log10_probability=-distance, relative_error=0.1)
        model = dict({"standstill_distance": distance, "time_headway": 3.2}, **changes.pop("model", {}))
        run = dict({"followers": 2, "steps": 60, "seed": len(name), "output": name, "launch_id": name}, **(run or {}))
        return sp.Rare(dict({"rows": 3 * [row], "below": 0.0, "burn_in": 0, "method": "condition", "samples": 500,
                             "configuration": {"model": model, "run": run}}, **changes), name)

    def test_estimations_of_other_events_are_not_on_one_line_over_the_standstill_distance(self):
        near, far = self.make_rare("near", 2.0), self.make_rare("farther", 3.0, model={"safe_gap": 1.0})
        for of_another in ({"below": 0.5}, {"burn_in": 20}, {"run": {"steps": 80}}, {"model": {"time_headway": 3.0}}):
            figure = plot.rare.draw([near, self.make_rare("other", 3.0, **of_another)], [])
            self.assertEqual(len(figure.axes), 1, of_another)
            figure = plot.rare.draw([far, self.make_rare("other", 2.5, **of_another), near], [])
            lines = [list(line.lines[0].get_xdata()) for line in figure.axes[1].containers]
            self.assertEqual(lines, 2 * [[2.0, 3.0]], of_another)
            self.assertEqual(figure.axes[1].get_legend_handles_labels()[1], ["follower 2", "any follower"])

    def test_several_lines_over_the_standstill_distance_have_the_names_of_their_estimations(self):
        runs = [self.make_rare("{}_{}".format(steps, distance), distance, run={"steps": steps}) for distance in (2.0, 3.0) for steps in (80, 60)]
        axes = plot.rare.draw(runs, []).axes[1]
        self.assertEqual(axes.get_legend_handles_labels()[1], ["follower 2: 80_2.0, 80_3.0", "any follower: 80_2.0, 80_3.0",
                                                               "follower 2: 60_2.0, 60_3.0", "any follower: 60_2.0, 60_3.0"])
        self.assertEqual([list(line.lines[0].get_xdata()) for line in axes.containers], 4 * [[2.0, 3.0]])

    def make_front(self, values, over="limit_variance", against="delay_margin"):
        points = [{"over": value, "against": 1.0 + k, "variables": {"controller/kp": 0.1 + k}} for k, value in enumerate(values)]
        return self.write(json.dumps({"pareto": {"over": over, "against": against, "points": points}}), "tune.json")

    def test_a_front_of_a_wide_range_has_a_logarithmic_axis_and_all_have_units(self):
        for largest, scale in ((1.0, "log"), (2e-4, "linear")):
            figure = plot.pareto.draw([plot.pareto.load(self.make_front([1e-4, 1.5e-4, largest]))])
            self.assertEqual([axes.get_yscale() for axes in figure.axes], [scale, "linear"])
            self.assertEqual(figure.axes[0].get_ylabel(), "least limit_variance [m$^2$]")
            self.assertEqual(figure.axes[1].get_xlabel(), "delay_margin [s]")
        front = plot.pareto.load(self.make_front([60.0, 1.0], over="phase_margin", against="signals/speed/limit_variance"))
        labels = plot.pareto.draw([front]).axes
        self.assertEqual((labels[0].get_ylabel(), labels[1].get_xlabel()),
                         ("greatest phase_margin [deg]", "signals/speed/limit_variance [(m/s)$^2$]"))
        self.assert_draws("pareto", self.path("tune.json"))

    def test_a_flipped_bit_in_a_front_is_found(self):
        result = sp.Tuning(sp.Model.load(), "limit_variance", {}, 1.0, {}, [], {}, {}, None, "its time is 0 s", 1)
        result.front, result.axes = [{"over": 1.0, "against": 2.0, "variables": {"controller/kp": 0.5}}], ("limit_variance", "delay_margin")
        result.save(self.path("tuned"))
        self.assertEqual(plot.pareto.load(self.path("tuned")).over.tolist(), [1.0])
        self.assert_rejects_every_damage("tuned", "tune.json", load=plot.pareto.load)


if __name__ == "__main__":
    unittest.main()
