#!/usr/bin/python3
"""Tests of src/tools/plot on small files made here: every figure, every documented error."""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.dom.minidom
import zlib

import numpy as np
import stochastic_platoon as sp

sys.dont_write_bytecode = True
TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "src", "tools")

loader = importlib.machinery.SourceFileLoader("plot_program", os.path.join(TOOLS, "plot"))
plot = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot_program", loader))
loader.exec_module(plot)

HEADING = "vehicle,step,count,mean,variance,theoretical_mean,theoretical_variance"
COUNT = 101  # realizations: the relative standard error of a variance is sqrt(2 / 100)


def transfer(headway, gain=1.35):
    """T(z) of the paper's example, coefficients in descending powers."""
    denominator = (1.0 + headway) * np.polymul([1.0, 0.89], [1.0, -2.0, 1.0])
    return {"numerator": [gain, 0.0],
            "denominator": np.polyadd(denominator, gain * np.array([1.0 + headway, -headway])).tolist()}


class PlotTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.output = os.path.join(self.folder, "figure")

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, text, *names):
        with open(self.path(*names), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(*names)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def rows(self, followers=3, steps=4):
        return ["{},{},{},{},{},{},{}".format(i, k, COUNT, 0.1 * i * k, 1.0 + i + 0.1 * k, 0.1 * i * k, 1.0 + i)
                for i in range(1, followers + 1) for k in range(steps)]

    def make_run(self, name="run", rows=None, followers=3, steps=4, heading=HEADING, tables={}, **changes):
        """A folder with statistics.csv, further tables (name: text), and summary.json."""
        os.mkdir(self.path(name))
        for table, text in tables.items():
            self.write(text, name, table)
        rows = self.rows(followers, steps) if rows is None else rows
        self.write("\n".join([heading] + rows) + "\n", name, "statistics.csv")
        summary = {"complete": True, "followers": followers, "steps": steps, "time_average": False,
                   "realizations": COUNT, "seed": 7, "theory": {"spectral_radius": 0.5, "string_stable": True},
                   "standard_error_of_variance": [0.25 * i for i in range(1, followers + 1)]}
        summary.update(changes)
        return self.write_summary(name, summary)

    def write_summary(self, name, summary):
        """Writes the summary of the tables in a run's folder, with their checksums."""
        tables = {table[:-len(".csv")]: self.checksum(name, table) for table in os.listdir(self.path(name)) if table.endswith(".csv")}
        text = json.dumps(dict(summary, crc32=dict(tables, summary="00000000")), indent=2) + "\n"
        self.write(text, name, "summary.json")
        own = self.checksum(name, "summary.json")
        self.write(text.replace('"summary": "00000000"', '"summary": "{}"'.format(own)), name, "summary.json")
        return self.path(name)

    def checksum(self, *names):
        with open(self.path(*names), "rb") as file:
            return "{:08x}".format(zlib.crc32(file.read()))

    def make_average(self, name="average"):
        rows = ["{},5000,4800,0.01,{},0,{}".format(i, 1.0 + i, 1.1 + i) for i in (1, 2, 3)]
        return self.make_run(name, rows=rows, time_average=True, steps=0, realizations=1)

    def make_analysis(self, name="analysis.json", **changes):
        analysis = {"spectral_radius": 0.5, "mean_square_stable": True, "string_stable": True,
                    "stationary_variance": [2.0, 3.0, 3.5], "limit_variance": 4.0, "transfer": transfer(3.2),
                    "peak_gain": 1.0, "peak_frequency": 0.0,
                    "norms": {"mean_l2": [0.4, 0.7, 1.1], "variance_linf": [2.0, 3.0, 4.0],
                              "mean_bound": 1.5, "variance_bound": 4.5}}
        analysis.update(changes)
        return self.write(json.dumps(analysis), name)

    def make_map(self, radius=lambda headway, gain: gain / headway):
        rows = ["headway,gain,spectral_radius,peak_gain,string_stable"]
        for gain in (1.0, 1.35, 1.7, 2.5):
            for headway in (2.0, 2.4, 2.8, 3.2, 3.6):
                rows.append("{},{},{},{},{}".format(headway, gain, radius(headway, gain),
                                                    max(1.0, 3.0 - headway / gain), int(headway > 2.0 * gain)))
        return self.write("\n".join(rows) + "\n", "map.csv")

    def run_plot(self, *arguments):
        """Exit code, standard output and error message."""
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                plot.main(list(arguments))
        except SystemExit as stop:
            return (1, printed.getvalue(), stop.code) if isinstance(stop.code, str) else (stop.code, "", "")
        return 0, printed.getvalue(), ""

    def assert_draws(self, *arguments):
        code, printed, message = self.run_plot(*arguments, "--output", self.output)
        self.assertEqual(code, 0, message)
        self.assertEqual(printed.split(), [self.output + ".png", self.output + ".svg"])
        with open(self.output + ".png", "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        self.assertEqual(xml.dom.minidom.parse(self.output + ".svg").documentElement.tagName, "svg")
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith(".tmp")], [])

    def assert_refuses(self, *arguments, saying):
        before = sorted(os.listdir(self.folder))
        code, printed, message = self.run_plot(*arguments, "--output", self.output)
        self.assertEqual(code, 1)
        self.assertEqual(printed, "")
        for words in saying:
            self.assertIn(words, message)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def assert_run_refused(self, *saying, **run):
        path = self.make_run(**run)
        self.assert_refuses("errors", path, saying=(path,) + saying)


class Figures(PlotTest):
    def test_errors_of_two_runs_become_png_and_svg(self):
        self.assert_draws("errors", self.make_run("a"), self.make_run("b"), "--titles", "$h = 3.2$", "$h = 2.4$")

    def test_errors_of_one_follower_and_one_step_are_drawn(self):
        self.assert_draws("errors", self.make_run(followers=1, steps=1))

    def test_errors_of_many_followers_are_drawn(self):
        self.assert_draws("errors", self.make_run(followers=500, steps=3))

    def test_errors_of_time_averages_are_drawn_along_the_string(self):
        self.assert_draws("errors", self.make_average())

    def test_norms_of_runs_and_analyses_are_drawn(self):
        unbounded = {"mean_l2": [1.0, 2.0, 4.0], "variance_linf": [2.0, 3.0, 4.0],
                     "mean_bound": None, "variance_bound": None}
        self.assert_draws("norms", self.make_run("a"), self.make_run("b"), self.make_analysis("a.json"),
                          self.make_analysis("b.json", norms=unbounded, string_stable=False))

    def test_norms_of_a_run_alone_and_of_an_analysis_alone_are_drawn(self):
        self.assert_draws("norms", self.make_run())
        self.assert_draws("norms", self.make_analysis())

    def test_gain_is_drawn(self):
        self.assert_draws("gain", self.make_analysis("a.json"), self.make_analysis("b.json", transfer=transfer(2.4)))

    def test_string_is_drawn_with_and_without_a_limit_and_runs(self):
        self.assert_draws("string", self.make_analysis("a.json"))
        self.assert_draws("string", self.path("a.json"), self.make_analysis("b.json", limit_variance=None),
                          "--run", self.make_run(), self.make_average())

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

    def test_a_run_without_theory_is_drawn(self):
        rows = ["{},{},100,0.01,{},,".format(i, k, 1.0 + i) for i in (1, 2, 3) for k in range(3)]
        self.assert_draws("errors", self.make_run("bursts", rows=rows))

    def test_map_is_drawn(self):
        self.assert_draws("map", self.make_map())

    def test_values_of_an_unstable_loop_beyond_all_bounds_are_drawn(self):
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
        path = self.make_analysis(transfer=transfer(2.4), peak_gain=1.1588996213, peak_frequency=0.610896)
        figure = plot.gain.draw([sp.Analysis.load(path)], [])
        self.assertEqual(figure.axes[0].get_lines()[1].get_xydata().tolist(), [[0.610896, 1.1588996213]])
        # The curve has its maximum there, within the square of its grid width.
        curve = figure.axes[0].get_lines()[0]
        self.assertAlmostEqual(max(curve.get_ydata()), 1.1588996213, 6)

    def test_curves_hold_the_files_values(self):
        run = sp.Results.load(self.make_run(rows=list(reversed(self.rows()))))
        figure = plot.tracking_errors.draw([run], [])
        lines = figure.axes[0].get_lines()
        np.testing.assert_allclose(lines[4].get_xdata(), [0, 1, 2, 3])
        # The third follower's measured mean and theoretical variance.
        np.testing.assert_allclose(lines[4].get_ydata(), [0.0, 0.3, 0.6, 0.9])
        np.testing.assert_allclose(figure.axes[1].get_lines()[5].get_ydata(), [4.0] * 4)

    def test_the_title_says_name_verdict_realizations_and_seed(self):
        run = sp.Results.load(self.make_run("h24", complete=False, realizations=1000000,
                                                 theory={"spectral_radius": 0.6, "string_stable": False}))
        self.assertEqual(plot.tracking_errors.title(run, "h24"),
                         "h24, not string stable\n1\u2009000\u2009000 realizations, seed 7, incomplete run")

    def test_measured_norms_are_those_of_the_file(self):
        case, = plot.norms.cases_of([sp.Results.load(self.make_run())], [])
        variance = np.array([2.0, 2.1, 2.2, 2.3])
        square = (0.1 ** 2 + 0.2 ** 2 + 0.3 ** 2) - variance.sum() / COUNT  # without the bias from sampling
        self.assertAlmostEqual(case.mean.measured.value[0], np.sqrt(square))
        self.assertAlmostEqual(case.variance.measured.value[0], 2.3)
        # 2.4977: the normal quantile of 1 - 0.05 / (2 * 4), simultaneous for all four steps
        self.assertAlmostEqual(case.variance.measured.half_width[0], 2.4977 * 2.3 * np.sqrt(2.0 / (COUNT - 1)), 4)
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

    def test_the_border_of_the_map_keeps_its_ends_and_moves_less_than_a_cell(self):
        stairs = np.array([[k // 2 + k % 2, k // 2] for k in range(41)], dtype=float)
        line = plot.stability_map.smoothed(stairs)
        np.testing.assert_array_equal(line[[0, -1]], stairs[[0, -1]])
        self.assertLess(np.abs(line - stairs).max(), 1.0)


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

    def test_draws_a_curve_over_what_takes_the_most_values(self):
        self.assert_draws("sweep", self.grid())
        tails = plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv")))
        self.assertEqual(tails.over, "headway")
        self.assertEqual([curve.name for curve in tails.curves], ["loss = 0", "loss = 0.1"])
        self.assertEqual(list(tails.curves[1].at), [2.4, 3.2, 4.0])
        np.testing.assert_allclose(tails.curves[1].variance, [102.9, 112.9, 122.9])
        self.assertEqual(list(tails.curves[0].string_stable), [0, 1, 1])

    def test_draws_over_what_is_asked_for(self):
        self.grid()
        self.assertEqual(len(plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv")), "loss").curves), 3)
        self.assert_draws("sweep", self.path("sweep.csv"), "--over", "loss")

    def test_draws_what_has_no_theory_and_one_point(self):
        self.assert_draws("sweep", self.make_sweep(self.row(0, 0.1, 3.2, theory="", stable="")))

    def test_paired_axes_are_one_curve(self):
        self.make_sweep(*[self.row(i, 0.01 * i, 2.4 + 0.1 * i) for i in range(20)])
        self.assertEqual(len(plot.sweep.tails_of(sp.Sweep.load(self.path("sweep.csv"))).curves), 1)

    def test_names_curves_by_rounded_numbers(self):
        path = self.make_sweep(*[self.row(i, 0.09999999999999992, 2.4 + i) for i in range(3)])
        self.assertEqual([curve.name for curve in plot.sweep.tails_of(sp.Sweep.load(path)).curves], ["loss = 0.1"])

    def test_refuses_what_is_no_sweep(self):
        self.assert_refuses("sweep", self.path("none"), saying=["No such file"])
        self.assert_refuses("sweep", self.write("", "sweep.csv"), saying=["is empty"])
        row = self.row(0, 0, 3)
        self.assert_refuses("sweep", self.make_sweep(row, heading=SWEEP.replace("agrees", "x")), saying=["column agrees is missing"])
        self.assert_refuses("sweep", self.make_sweep(row.replace("0,0,3,", "0,"), heading=SWEEP.replace("loss,headway,", "")),
                            saying=["nothing varies in it"])
        self.assert_refuses("sweep", self.make_sweep(), saying=["holds no rows"])
        self.assert_refuses("sweep", self.make_sweep("1,2"), saying=["line 2 has 2 values instead of 14"])
        self.assert_refuses("sweep", self.make_sweep(self.row(0, 0, 3, variance="much")),
                            saying=["line 2: variance: much: must be a number"])
        self.assert_refuses("sweep", self.make_sweep(self.row(0, "a", "[1 2]")), saying=["no number varies in it: loss, headway"])
        self.assert_refuses("sweep", self.make_sweep(self.row(0, 0, 3, variance="nan")), saying=["variance is NaN everywhere"])
        self.assert_refuses("sweep", self.grid(), "--over", "delay", saying=["--over: delay: must be a varying parameter of", "loss, headway"])

    def test_refuses_more_curves_than_can_be_told_apart(self):
        rows = [self.row(2 * i + j, i, j) for i in range(8) for j in range(2)]
        self.assert_refuses("sweep", self.make_sweep(*rows), "--over", "headway", saying=["8 curves over headway: must be at most 7"])


class Errors(PlotTest):
    def test_a_run_folder_that_is_missing(self):
        self.assert_refuses("errors", self.path("none"), saying=[self.path("none"), "no such folder"])
        self.assert_refuses("norms", self.path("none"), saying=[self.path("none"), "No such file or directory"])

    def test_a_file_in_place_of_a_run_folder(self):
        self.assert_refuses("errors", self.make_analysis(), saying=["analysis.json", "must be a run's folder"])

    def test_a_folder_in_place_of_an_analysis(self):
        self.assert_refuses("gain", self.make_run(), saying=[self.path("run"), "not a folder"])

    def test_files_missing_in_the_run_folder(self):
        for name in ("statistics.csv", "summary.json"):
            run = self.make_run(name + "-less")
            os.remove(os.path.join(run, name))
            self.assert_refuses("errors", run, saying=[os.path.join(run, name), "No such file"])

    def test_a_missing_column(self):
        self.assert_run_refused("statistics.csv", "column theoretical_mean is missing",
                                heading=HEADING.replace("theoretical_mean", "other"))

    def test_an_empty_file(self):
        run = self.make_run()
        self.write("", "run", "statistics.csv")
        self.assert_refuses("errors", run, saying=[os.path.join(run, "statistics.csv"), "is not as it was written"])
        self.assert_refuses("map", self.write("", "map.csv"), saying=["map.csv: is empty"])

    def test_a_file_that_is_no_text(self):
        with open(self.path("map.csv"), "wb") as file:
            file.write(b"headway,gain,\xff\n1,2,3\n")
        self.assert_refuses("map", self.path("map.csv"), saying=["map.csv: must be text"])

    def test_a_file_without_rows(self):
        self.assert_run_refused("statistics.csv", "holds no rows", rows=[])

    def test_a_row_that_is_cut_off(self):
        self.assert_run_refused("statistics.csv", "line 13 has 3 values instead of 7",
                                rows=self.rows()[:-1] + ["3,3,1"])

    def test_a_value_that_is_no_number(self):
        self.assert_run_refused("statistics.csv", "line 3: count: much: must be a number",
                                rows=self.rows()[:1] + ["1,1,much,0,0,0,0"] + self.rows()[2:])

    def test_a_step_that_is_missing(self):
        self.assert_run_refused("statistics.csv", "rows are missing or double", rows=self.rows()[:-1])

    def test_a_step_that_is_double(self):
        self.assert_run_refused("statistics.csv", "rows are missing or double",
                                rows=self.rows()[:-1] + self.rows()[:1])

    def test_vehicles_that_do_not_begin_at_one(self):
        self.assert_run_refused("statistics.csv", "each vehicle 1..N", rows=self.rows(followers=4)[4:])

    def test_nan_everywhere(self):
        rows = ["{},0,0,nan,nan,0,1".format(i) for i in (1, 2, 3)]
        self.assert_run_refused("statistics.csv", "mean is NaN everywhere", rows=rows)

    def test_one_realization_has_no_variance(self):
        rows = ["{},0,1,0.5,nan,0,1".format(i) for i in (1, 2, 3)]
        self.assert_run_refused("statistics.csv", "variance is NaN everywhere", "two realizations", rows=rows)

    def test_a_summary_that_lacks_a_key(self):
        self.assert_run_refused("summary.json", "theory.string_stable is missing", theory={"spectral_radius": 0.5})

    def test_a_summary_of_another_string(self):
        self.assert_run_refused("summary.json", "followers is 3, but statistics.csv beside it has 2",
                                rows=self.rows(followers=2))

    def test_a_byte_that_was_changed_in_either_file(self):
        run = self.make_run(followers=2, steps=2)
        sp.Results.load(run)
        for name in ("statistics.csv", "summary.json"):
            written = self.read(os.path.join("run", name))
            for at in range(len(written)):
                damaged = bytearray(written)
                damaged[at] ^= 1 << at % 8
                with open(self.path("run", name), "wb") as file:
                    file.write(damaged)
                with self.assertRaises(ValueError, msg="{} byte {}".format(name, at)):
                    sp.Results.load(run)
            with open(self.path("run", name), "wb") as file:
                file.write(written)

    def test_a_summary_that_is_no_json(self):
        run = self.make_run()
        self.write('{"complete": tr', "run", "summary.json")
        self.assert_refuses("errors", run, saying=[os.path.join(run, "summary.json"), "not JSON"])

    def test_ensembles_and_time_averages_in_one_figure(self):
        self.assert_refuses("errors", self.make_run(), self.make_average(),
                            saying=[self.path("average"), "time averages"])
        self.assert_refuses("norms", self.path("average"), saying=[self.path("average"), "time averages"])

    def test_norms_of_an_unstable_loop(self):
        run = self.make_run(theory={"spectral_radius": 1.1, "string_stable": False})
        self.assert_refuses("norms", run, saying=[run, "unstable loop"])

    def test_titles_that_are_too_few_or_wrong(self):
        run = self.make_run()
        self.assert_refuses("errors", run, "--titles", "a", "b", saying=["--titles", "1 input"])
        self.assert_refuses("errors", run, "--titles", "$\\nonsense$", saying=["--titles", "$\\nonsense$"])

    def test_runs_and_analyses_that_do_not_pair(self):
        runs = self.make_run("a"), self.make_run("b")
        self.assert_refuses("norms", *runs, self.make_analysis(), saying=["analysis.json", "cannot be paired"])
        self.assert_refuses("string", self.path("analysis.json"), "--run", *runs, saying=["--run", "not 2"])

    def test_a_run_of_another_platoon_than_the_analysis(self):
        run = self.make_run()
        self.assert_refuses("norms", run, self.make_analysis(spectral_radius=0.6), saying=[run, "another platoon"])
        self.assert_refuses("string", self.make_analysis(stationary_variance=[1.0]), "--run", run,
                            saying=[run, "3 followers", "has 1"])

    def test_an_analysis_that_lacks_a_key(self):
        for figure, key in (("gain", "transfer.numerator"), ("norms", "norms.mean_l2")):
            path = self.make_analysis(**{key.split(".")[0]: {}})
            self.assert_refuses(figure, path, saying=[path, key + " is missing"])
        path = self.make_analysis(stationary_variance=2.0)
        self.assert_refuses("string", path, saying=[path, "stationary_variance must be a list of numbers"])

    def test_an_analysis_that_is_nested_without_end(self):
        path = self.write('{"transfer": ' + "[" * 100000 + "]" * 100000 + "}", "deep.json")
        self.assert_refuses("gain", path, saying=[path, "nested too deep"])

    def test_an_analysis_of_nothing_but_null(self):
        path = self.make_analysis(stationary_variance=[None, None, None])
        self.assert_refuses("string", path, saying=[path, "stationary_variance is NaN everywhere"])

    def test_a_denominator_of_zeros(self):
        path = self.make_analysis(transfer={"numerator": [1.0], "denominator": [0.0, 0.0]})
        self.assert_refuses("gain", path, saying=[path, "denominator"])

    def test_a_map_that_is_no_grid(self):
        path = self.make_map()
        with open(path) as file:
            lines = file.read().splitlines()
        self.write("\n".join(lines[:-1]), "map.csv")
        self.assert_refuses("map", path, saying=[path, "grid"])
        self.write("headway,gain\n1,2\n", "map.csv")
        self.assert_refuses("map", path, saying=[path, "column spectral_radius is missing"])

    def test_a_map_of_unstable_loops_alone_is_drawn(self):
        self.assert_draws("map", self.make_map(radius=lambda headway, gain: 2.0))

    def test_an_output_folder_that_is_missing(self):
        code, _, message = self.run_plot("errors", self.make_run(), "--output", self.path("none", "figure"))
        self.assertEqual(code, 1)
        self.assertIn(self.path("none") + ": no such folder", message)

    def test_a_folder_where_a_figure_should_go(self):
        os.mkdir(self.output + ".svg")
        self.assert_refuses("gain", self.make_analysis(), saying=[self.output + ".svg", "is a folder"])

    def test_an_error_leaves_the_figures_of_before(self):
        self.assert_draws("errors", self.make_run())
        before = self.read("figure.png")
        self.write("", "run", "statistics.csv")
        self.assert_refuses("errors", self.path("run"), saying=["is not as it was written"])
        self.assertEqual(self.read("figure.png"), before)

    def test_a_disk_that_is_full_leaves_the_figures_of_before(self):
        good, bad = self.path("a.png"), self.path("b" * 300)  # a name too long for the file system
        self.write("before", "a.png")
        with self.assertRaisesRegex(OSError, "cannot be written"):
            plot.style.write_all({good: b"after", bad: b"after"})
        self.assertEqual(self.read("a.png"), b"before")
        self.assertEqual(os.listdir(self.folder), ["a.png"])

    def test_without_the_environment_the_programs_name_what_to_do(self):
        bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        for name in ("plot", "watch", "dashboard", "recorded_drive"):
            done = subprocess.run([os.path.join(TOOLS, name), "--version"], env=bare, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  universal_newlines=True)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, "^{}: No module named 'stochastic_platoon': \\. devel/setup.bash first.*\n$".format(name))

    def test_the_program_ends_with_code_1_and_one_line(self):
        done = subprocess.run([os.path.join(TOOLS, "plot"), "errors", self.path("none")], cwd=self.folder,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr, "plot: {}: no such folder\n".format(self.path("none")))


if __name__ == "__main__":
    unittest.main()
