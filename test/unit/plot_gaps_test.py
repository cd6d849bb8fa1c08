#!/usr/bin/python3
"""Tests of `plot gaps` and `plot trajectories` on small simulations of the paper's platoon: numbers, figures, every documented error."""

import json
import sys
import unittest
from statistics import NormalDist

import numpy as np
import stochastic_platoon as sp

sys.dont_write_bytecode = True
from plot_files import PlotTest, plot  # noqa: E402
from plotting import gaps  # noqa: E402

HEADWAY, GAIN, NOISE, STANDSTILL, PERIOD = 3.2, 1.35, 0.6, 2.0, 0.1
SIGMA = np.sqrt(0.169296)  # [m] of follower 1's gap in the steady state
WIDTH = 0.1  # [m] width of a bin


def positions(followers, steps, realizations, seed=1, standstill=STANDSTILL):
    """Yields (step, positions (vehicles, realizations), received positions) of the paper's platoon behind a leader at rest."""
    draws = np.random.default_rng(seed)
    shape = (followers, realizations)
    y = -standstill * np.arange(followers + 1.0)[:, np.newaxis] * np.ones(realizations)
    before, speed, filtered = y.copy(), np.zeros(shape), np.zeros(shape)
    for step in range(-1, steps):
        noise = 0.0 if step < 0 else np.sqrt(NOISE) * draws.standard_normal(shape)
        received = y[:-1] + noise
        yield step, y.copy(), received
        error = received - y[1:] - standstill - HEADWAY * (y[1:] - before[1:])
        filtered = -0.89 * filtered + GAIN / (1.0 + HEADWAY) * error
        before = y.copy()
        y[1:] += speed
        speed = speed + filtered


def smallest_gaps(followers, steps, realizations, **options):
    """Smallest gap and its step, arrays (followers, realizations)."""
    smallest, steps_of = np.full((followers, realizations), np.inf), np.zeros((followers, realizations))
    for step, y, _ in positions(followers, steps, realizations, **options):
        gap = y[:-1] - y[1:]
        if step >= 0:
            steps_of = np.where(gap < smallest, step, steps_of)
            smallest = np.minimum(gap, smallest)
    return smallest, steps_of


class Distances(unittest.TestCase):
    def test_bins_that_are_empty_do_not_widen_the_others(self):
        self.assertAlmostEqual(gaps.bin_width(np.array([0.9, 1.2])), 0.1)
        self.assertAlmostEqual(gaps.bin_width(np.array([-0.4, 0.0, 0.2, 1.0])), 0.2)
        self.assertEqual(gaps.bin_width(np.array([90.48])), 0.0)

    def test_of_r157_and_rss(self):
        self.assertAlmostEqual(gaps.regulation_distance(25.0), 47.5, 12)  # 1.9 s
        self.assertAlmostEqual(gaps.regulation_distance(1.0), 2.0, 12)
        # 25 m and 1.75 m during the response, then 28.5 m/s to rest at 4 m/s^2, behind 25 m/s to rest at 8 m/s^2.
        self.assertAlmostEqual(gaps.responsibility_distance(25.0), 26.75 + 28.5 ** 2 / 8.0 - 625.0 / 16.0, 12)


class GapTest(PlotTest):
    def gap_table(self, smallest, steps_of, bounds=None, safe_gap=None):
        bins = np.floor(smallest / WIDTH).astype(int)
        numbers = np.unique(bins)
        lines = ["vehicle,count,smallest_gap,realization,step,collisions,below_safe_gap,theoretical_collision_bound," +
                 ",".join("bin_{:.10g}".format(number * WIDTH) for number in numbers)]
        for row, gaps in enumerate(smallest):
            worst = int(np.argmin(gaps))
            lines.append(",".join(str(value) for value in [
                row + 1, gaps.size, gaps[worst], worst, int(steps_of[row, worst]), (gaps < 0).sum(),
                "" if safe_gap is None else (gaps < safe_gap).sum(), "" if bounds is None else bounds[row]] +
                [(bins[row] == number).sum() for number in numbers]))
        return "\n".join(lines) + "\n"

    def make_gaps(self, name="gaps", text=None, followers=3, realizations=200, safe_gap=None, bounds=None, summary_followers=None, model=None,
                  **options):
        if text is None:
            text = self.gap_table(*smallest_gaps(followers, 30, realizations, **options), bounds=bounds, safe_gap=safe_gap)
        return self.make_run(name, followers=summary_followers or followers, realizations=realizations, tables={"gaps.csv": text},
                             configuration={"model": dict(model or {}, **({} if safe_gap is None else {"safe_gap": safe_gap}))})

    def make_collisions(self, followers=3, name="analysis.json", **changes):
        probability = [NormalDist().cdf(-STANDSTILL / SIGMA / np.sqrt(1.0 + 4.2 * i / (i + 1))) for i in range(followers)]
        collision = dict({"probability": probability, "limit_probability": 0.0259496}, **changes)
        return self.write(json.dumps({"spectral_radius": 0.5, "collision": collision}), name)

    def make_trajectories(self, followers=3, steps=30, name="trajectories.csv", **options):
        table, before, slower = [], None, None
        for step, y, received in positions(followers, steps, 1, **options):
            y, received = y[:, 0], received[:, 0]
            speed = None if before is None else (y - before) / PERIOD
            acceleration = None if slower is None else (speed - slower) / PERIOD
            for i in range(followers + 1):
                gap = y[i - 1] - y[i] if i and step >= 0 else ""
                error = "" if gap == "" else gap - STANDSTILL - HEADWAY * PERIOD * speed[i]
                table.append("{},{},{:.10g},{},{},,,{},{},{},{},,".format(
                    i, step, PERIOD * step, y[i], received[i - 1] if i else "", error, gap,
                    "" if speed is None else speed[i], "" if acceleration is None else acceleration[i]))
            before, slower = y, speed
        heading = "vehicle,step,seconds,position,received_position,input,received_input,tracking_error,gap,speed,acceleration,jerk,relative_speed"
        return self.write("\n".join([heading] + sorted(table, key=lambda row: int(row.split(",")[0]))) + "\n", name)


class Simulation(unittest.TestCase):
    def test_the_gap_of_the_first_follower_has_the_variance_of_the_theory(self):
        gaps = np.array([y[0] - y[1] for step, y, _ in positions(1, 60, 20000) if step >= 40])
        # 20 correlated steps of 20000 realizations: at most the error of 20000.
        self.assertAlmostEqual(gaps.var(), SIGMA ** 2, delta=4.0 * SIGMA ** 2 * np.sqrt(2.0 / 20000))


class Gaps(GapTest):
    def test_gaps_are_drawn_with_and_without_an_analysis(self):
        run = self.make_gaps(bounds=[1e-5, 0.01, 0.2], safe_gap=1.0)
        self.assert_draws("gaps", run)
        self.assert_draws("gaps", run, "--analysis", self.make_collisions(), "--titles", "$h = 3.2$")

    def test_several_runs_are_drawn_beside_each_other_on_one_axis(self):
        paths = [self.make_gaps("near", bounds=[1e-5, 0.01, 0.2]), self.make_gaps("far", standstill=4.0)]
        self.assert_draws("gaps", *paths, "--titles", "A", "B")
        axes = plot.gaps.draw([sp.Results.load(path) for path in paths], [], []).axes
        self.assertEqual(len(axes), 3)
        self.assertEqual(axes[0].get_ylim(), axes[1].get_ylim())
        labels = [text.get_text() for text in axes[2].get_legend().get_texts()]
        for name in ("near: per realization, measured", "near: per realization, upper bound by theory", "far: no collision in 200: upper limit"):
            self.assertIn(name, labels)
        self.assert_rejects("gaps", *paths, "--analysis", self.make_collisions(), saying=["--analysis: must be one for each of the 2 runs, not 1"])

    def test_panels_below_each_other_share_a_legend(self):
        runs = [sp.Results.load(self.make_gaps(name)) for name in ("one", "two")]
        self.addCleanup(plot.style.apply)
        for width, legends in ((None, [True, True, True]), (88.0, [False, True, True])):
            plot.style.apply(width)
            self.assertEqual([axes.get_legend() is not None for axes in plot.gaps.draw(runs, [], []).axes], legends)

    def test_the_distances_of_r157_and_rss_stand_beside_at_the_top_speed_of_the_leader(self):
        of = sp.Results.load(self.make_gaps(standstill=40.0, model={"sample_period": 0.1, "leader": {"speed": [
            {"from_step": 0, "value": 5.0}, {"from_step": 2, "value": 16.0}, {"from_step": 4000, "value": 40.0}]}}))
        labels = [text.get_text() for text in plot.gaps.draw([of], [], []).axes[0].get_legend().get_texts()]
        self.assertIn("R157 at 16 m/s: 25.2 m", labels)
        self.assertIn("RSS at 16 m/s: 49.3 m", labels)
        drive = {"sample_period": 0.1, "leader": {"positions": [0.0, 1.5, 3.1, 4.0]}}
        self.assertAlmostEqual(gaps.top_speed(sp.Results.load(self.make_gaps("drive", model=drive))), 16.0, 9)

    def test_gaps_without_theory_are_drawn(self):
        self.assert_draws("gaps", self.make_gaps())

    def test_one_follower_one_realization_and_one_bin_are_drawn(self):
        self.assert_draws("gaps", self.make_gaps(followers=1, realizations=1))

    def test_many_followers_are_drawn(self):
        self.assert_draws("gaps", self.make_gaps(followers=300, realizations=20))

    def test_a_string_without_collisions_is_drawn_on_a_logarithmic_axis(self):
        run = sp.Results.load(self.make_gaps(standstill=50.0, bounds=[0.0, 1e-300, 1e-200]))
        axes = plot.gaps.draw([run], [], []).axes[1]
        self.assertEqual(axes.get_yscale(), "log")
        low, high = axes.get_ylim()
        self.assertTrue(1e-4 / 200 <= low < 4.0 / 204 < high <= 2.0)

    def test_the_legend_gives_the_figures_of_a_theory_that_is_below_the_axis(self):
        run = sp.Results.load(self.make_gaps(standstill=50.0, bounds=[0.0, 1e-300, 1e-200]))
        analysis = sp.Analysis.load(self.make_collisions(probability=[0.0, 1e-90, 3e-80], limit_probability=2e-70))
        labels = [text.get_text() for text in plot.gaps.draw([run], [analysis], []).axes[1].get_legend().get_texts()]
        self.assertEqual(labels[-3:], ["per realization, upper bound by theory: at most 1e-200", "per step, theory: at most 3e-80",
                                       "per step, endless string: 2e-70"])

    def test_the_legend_and_the_title_name_collisions_and_gaps_below_the_safe_gap(self):
        axes = plot.gaps.draw([sp.Results.load(self.make_gaps(standstill=50.0, safe_gap=2.0))], [], []).axes[1]
        labels = [text.get_text() for text in axes.get_legend().get_texts()]
        self.assertEqual(labels, ["no collision in 200: upper limit", "no gap below 2 m in 200: upper limit"])
        self.assertIn("probability of a collision or of\na gap below 2 m\n", axes.get_title())
        axes = plot.gaps.draw([sp.Results.load(self.make_gaps("near", safe_gap=1.0))], [], []).axes[1]
        labels = [text.get_text() for text in axes.get_legend().get_texts()]
        self.assertEqual(len(labels), len(set(labels)))
        self.assertTrue({"collision, measured", "gap below 1 m, measured"} <= set(labels), labels)

    def test_the_axis_has_room_for_the_mark_of_the_smallest_gap(self):
        for standstill in (2.0, 20.0, 5000.0):
            run = sp.Results.load(self.make_gaps("at-{:g}".format(standstill), standstill=standstill))
            axes = plot.gaps.draw([run], [], []).axes[0]
            low, high = axes.get_ylim()
            self.assertGreater(run.gaps.smallest_gap.min() - low, 0.04 * (high - low), standstill)

    def test_gaps_far_above_0_are_drawn_without_the_line_of_collisions(self):
        for standstill, lowest in ((2.0, False), (5000.0, True)):
            run = sp.Results.load(self.make_gaps("at-{:g}".format(standstill), standstill=standstill))
            self.assertEqual(plot.gaps.draw([run], [], []).axes[0].get_ylim()[0] > 4000.0, lowest)

    def test_the_file_is_read_in_any_order_of_rows(self):
        text = self.gap_table(*smallest_gaps(3, 30, 200), bounds=[0.1, 0.2, 0.3])
        heading, *rows = text.splitlines()
        forward = sp.Results.load(self.make_gaps("a", text)).gaps
        backward = sp.Results.load(self.make_gaps("b", "\n".join([heading] + rows[::-1]) + "\n")).gaps
        for name in ("smallest_gap", "realization", "step", "collisions", "theoretical_collision_bound", "histogram"):
            np.testing.assert_array_equal(getattr(forward, name), getattr(backward, name), name)

    def test_quantiles_are_within_a_bin_of_those_of_the_realizations(self):
        smallest, steps_of = smallest_gaps(4, 30, 500)
        gaps = sp.Results.load(self.make_gaps(text=self.gap_table(smallest, steps_of), followers=4, realizations=500)).gaps
        for share in (0.01, 0.25, 0.5, 0.99):
            np.testing.assert_allclose(plot.gaps.quantile(gaps, share), np.quantile(smallest, share, axis=1), atol=WIDTH)
        np.testing.assert_array_equal(plot.gaps.quantile(gaps, 0.0) >= gaps.smallest_gap, True)

    def test_error_bars_are_wilsons_interval(self):
        # 3 of 100: (0.03 + 0.02 -+ 2 sqrt(0.03 * 0.97 / 100 + 0.0001)) / 1.04
        low, high = plot.gaps.interval(np.array([3.0, 0.0]), np.array([100.0, 100.0]))
        np.testing.assert_allclose([low[0], high[0]], (0.05 + 2.0 * np.sqrt(0.000391) * np.array([-1.0, 1.0])) / 1.04)
        self.assertAlmostEqual(high[1], 4.0 / 104.0)
        for count in range(1, 3000):  # no bar has a negative length
            low, high = plot.gaps.interval(np.array([count, 0.0]), np.array([count, count]))
            self.assertTrue(high[0] >= 1.0 and low[1] <= 0.0, count)

    def test_the_worst_gap_is_named_and_marked(self):
        run = sp.Results.load(self.make_gaps(realizations=1000))
        axes = plot.gaps.draw([run], [], []).axes[0]
        gaps = run.gaps
        worst = int(np.argmin(gaps.smallest_gap))
        self.assertIn("{:.3g} m: follower {}, realization {:.0f}, step {:.0f}".format(
            -gaps.smallest_gap[worst], worst + 1, gaps.realization[worst], gaps.step[worst]), axes.get_title().replace("\u2009", ""))
        self.assertIn([worst + 1.0, gaps.smallest_gap[worst]], [line.get_xydata()[0].tolist() for line in axes.lines])


class GapErrors(GapTest):
    def test_a_run_without_gaps(self):
        self.assert_rejects("gaps", self.make_run(), saying=["gaps.csv: no such file: run with signals:=gap"])
        self.assert_rejects("gaps", self.path("none"), saying=["none: no such folder"])

    def test_a_byte_that_was_changed(self):
        self.make_gaps(realizations=20)
        self.assert_rejects_every_damage("gaps", "gaps.csv", every=7)

    def test_rows_and_columns_that_are_missing(self):
        heading, first, *rows = self.gap_table(*smallest_gaps(3, 30, 200)).splitlines()
        short = heading.split(",bin_")[0]
        for name, lines, words in (("a", [heading] + rows, "each vehicle 1..N"), ("b", [heading], "holds no rows"),
                                   ("c", [heading.replace("collisions", "x"), first] + rows, "column collisions is missing"),
                                   ("d", [heading.replace(",bin_", ",bin_x", 1), first] + rows, "the name of a column bin_X"),
                                   ("e", [short] + [",".join(row.split(",")[:8]) for row in [first] + rows], "column bin_... is missing"),
                                   ("f", [heading, first.replace(",200,", ",201,")] + rows, "the bins do not add up to count")):
            self.assert_rejects("gaps", self.make_gaps(name, "\n".join(lines) + "\n"), saying=["gaps.csv", words])

    def test_a_summary_of_another_string(self):
        self.assert_rejects("gaps", self.make_gaps(summary_followers=4), saying=["followers is 4, but gaps.csv beside it has 3"])

    def test_an_analysis_of_another_platoon_or_without_collisions(self):
        run = self.make_gaps()
        self.assert_rejects("gaps", run, "--analysis", self.make_collisions(4), saying=["3 followers", "has 4"])
        self.assert_rejects("gaps", run, "--analysis", self.make_analysis("plain.json"), saying=["collision.probability is missing"])


class Trajectories(GapTest):
    def test_trajectories_are_drawn_whole_and_around_a_step(self):
        path = self.make_trajectories()
        self.assert_draws("trajectories", path)
        self.assert_draws("trajectories", self.folder, "--around", "12", "--titles", "realization 7")

    def test_one_follower_and_many_followers_are_drawn(self):
        self.assert_draws("trajectories", self.make_trajectories(1))
        self.assert_draws("trajectories", self.make_trajectories(300))

    def test_the_smallest_gap_is_that_of_the_window(self):
        realization = sp.Trajectories.load(self.make_trajectories(steps=200))
        worst, at = plot.trajectories.nearest(realization["gap"])
        self.assertEqual(realization["gap"][worst, at], np.nanmin(realization["gap"]))
        near = plot.trajectories.around(realization, 100)
        self.assertEqual((near.steps[0], near.steps[-1]), (80, 120))
        np.testing.assert_array_equal(near["gap"], realization["gap"][:, 81:122])
        words = "smallest gap {} m, follower {}".format(plot.style.signed(np.nanmin(near["gap"])), plot.trajectories.nearest(near["gap"])[0])
        self.assertIn(words, plot.trajectories.draw(near, [])._suptitle.get_text())

    def test_the_title_of_a_window_names_the_smallest_gap_of_the_realization_if_that_is_elsewhere(self):
        realization = sp.Trajectories.load(self.make_trajectories(steps=200))
        worst, at = plot.trajectories.nearest(realization["gap"])
        step = int(realization.steps[at])
        self.assertNotIn("window", plot.trajectories.draw(realization, [], step)._suptitle.get_text())
        title = plot.trajectories.draw(realization, [], (step + 100) % 200)._suptitle.get_text()
        self.assertIn("smallest gap in this window ", title)
        self.assertIn("smallest gap of the realization {} m, follower {}, {:.4g} s (step {})".format(
            plot.style.signed(realization["gap"][worst, at]), worst, realization.seconds[at], step), title)

    def test_the_worst_pair_is_drawn_in_any_string(self):
        self.assertEqual(list(plot.trajectories.drawn(4, 2)), [0, 1, 2, 3])
        shown = list(plot.trajectories.drawn(501, 234))
        self.assertEqual((shown[0], shown[1], shown[-1]), (0, 1, 500))
        self.assertTrue({233, 234} <= set(shown) and len(shown) <= 19)

    def test_rejects_an_invalid_realization(self):
        self.assert_rejects("trajectories", self.path("none.csv"), saying=["none.csv: must be a regular file", "(No such file or directory)"])
        path = self.make_trajectories()
        self.assert_rejects("trajectories", path, "--around", "30", saying=["--around: 30: must be a step of", "from -1 to 29"])
        lines = self.lines("trajectories.csv")
        for changed, words in ((lines[:-1], "each vehicle 0..N"), ([lines[0].replace("gap", "x")] + lines[1:], "column gap is missing"),
                               (lines[:1], "holds no rows")):
            self.write("\n".join(changed) + "\n", "trajectories.csv")
            self.assert_rejects("trajectories", path, saying=[path, words])


if __name__ == "__main__":
    unittest.main()
