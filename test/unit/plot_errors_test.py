#!/usr/bin/python3
"""Tests of the errors of src/tools/plot: every documented one."""

import os
import subprocess
import sys
import unittest

import numpy as np
import stochastic_platoon as sp

sys.dont_write_bytecode = True
from plot_files import COUNT, HEADING, PlotTest, TOOLS, plot  # noqa: E402


class Errors(PlotTest):
    def test_a_run_folder_that_is_missing(self):
        self.assert_rejects("errors", self.path("none"), saying=[self.path("none"), "no such folder"])
        self.assert_rejects("norms", self.path("none"), saying=[self.path("none"), "No such file or directory"])

    def test_a_file_in_place_of_a_run_folder(self):
        self.assert_rejects("errors", self.make_analysis(), saying=["analysis.json", "must be a run's folder"])

    def test_a_folder_in_place_of_an_analysis(self):
        self.assert_rejects("gain", self.make_run(), saying=[self.path("run"), "not a folder"])

    def test_files_missing_in_the_run_folder(self):
        for name in ("statistics.csv", "summary.json"):
            run = self.make_run(name + "-less")
            os.remove(os.path.join(run, name))
            self.assert_rejects("errors", run, saying=[os.path.join(run, name), "No such file"])

    def test_a_missing_column(self):
        self.assert_run_rejected("statistics.csv", "column theoretical_mean is missing",
                                heading=HEADING.replace("theoretical_mean", "other"))

    def test_an_empty_file(self):
        run = self.make_run()
        self.write("", "run", "statistics.csv")
        self.assert_rejects("errors", run, saying=[os.path.join(run, "statistics.csv"), "is not as it was written"])
        self.assert_rejects("map", self.write("", "map.csv"), saying=["map.csv: is empty"])

    def test_a_file_that_is_not_text(self):
        self.assert_rejects("map", self.write_bytes(b"headway,gain,\xff\n1,2,3\n", "map.csv"), saying=["map.csv: must be text"])

    def test_a_file_without_rows(self):
        self.assert_run_rejected("statistics.csv", "holds no rows", rows=[])

    def test_a_row_that_is_cut_off(self):
        self.assert_run_rejected("statistics.csv", "line 13 has 3 values instead of 7",
                                rows=self.rows()[:-1] + ["3,3,1"])

    def test_a_value_that_is_not_a_number(self):
        self.assert_run_rejected("statistics.csv", "line 3: count: much: must be a number",
                                rows=self.rows()[:1] + ["1,1,much,0,0,0,0"] + self.rows()[2:])

    def test_a_step_that_is_missing_or_double(self):
        for name, rows in (("a", self.rows()[:-1]), ("b", self.rows()[:-1] + self.rows()[:1])):
            self.assert_run_rejected("statistics.csv", "rows are missing or double", name=name, rows=rows)

    def test_vehicles_that_do_not_begin_at_one(self):
        self.assert_run_rejected("statistics.csv", "each vehicle 1..N", rows=self.rows(followers=4)[4:])

    def test_nan_everywhere(self):
        rows = ["{},0,0,nan,nan,0,1".format(i) for i in (1, 2, 3)]
        self.assert_run_rejected("statistics.csv", "mean is NaN everywhere", rows=rows)

    def test_one_realization_has_no_variance(self):
        rows = ["{},0,1,0.5,nan,0,1".format(i) for i in (1, 2, 3)]
        self.assert_run_rejected("statistics.csv", "variance is NaN everywhere", "two realizations", rows=rows)

    def test_a_summary_that_lacks_a_key(self):
        self.assert_run_rejected("summary.json", "theory.string_stable is missing", theory={"spectral_radius": 0.5})

    def test_a_summary_of_another_string(self):
        self.assert_run_rejected("summary.json", "followers is 3, but statistics.csv beside it has 2",
                                rows=self.rows(followers=2))

    def test_a_byte_that_was_changed_in_either_file(self):
        sp.Results.load(self.make_run(followers=2, steps=2))
        for name in ("statistics.csv", "summary.json"):
            self.assert_rejects_every_damage("run", name)

    def test_a_summary_that_is_not_json(self):
        run = self.make_run()
        self.write('{"complete": tr', "run", "summary.json")
        self.assert_rejects("errors", run, saying=[os.path.join(run, "summary.json"), "not JSON"])

    def test_ensembles_and_time_averages_in_one_figure(self):
        self.assert_rejects("errors", self.make_run(), self.make_average(),
                            saying=[self.path("average"), "time averages"])
        self.assert_rejects("norms", self.path("average"), saying=[self.path("average"), "time averages"])

    def test_norms_of_an_unstable_loop(self):
        run = self.make_run(theory={"spectral_radius": 1.1, "string_stable": False})
        self.assert_rejects("norms", run, saying=[run, "unstable loop"])

    def test_titles_that_are_too_few_or_wrong(self):
        run = self.make_run()
        self.assert_rejects("errors", run, "--titles", "a", "b", saying=["--titles", "1 input"])
        self.assert_rejects("errors", run, "--titles", "$\\nonsense$", saying=["--titles", "$\\nonsense$"])

    def test_runs_and_analyses_that_do_not_pair(self):
        runs = self.make_run("a"), self.make_run("b")
        self.assert_rejects("norms", *runs, self.make_analysis(), saying=["analysis.json", "cannot be paired"])
        self.assert_rejects("string", self.path("analysis.json"), "--run", *runs, saying=["--run", "not 2"])

    def test_a_run_of_another_platoon_than_the_analysis(self):
        run = self.make_run()
        self.assert_rejects("norms", run, self.make_analysis(spectral_radius=0.6), saying=[run, "another platoon"])
        of_noise = self.make_run("noisy", theory={"spectral_radius": 0.5, "string_stable": True, "stationary_variance": [2.0, 3.0, 3.6]})
        self.assert_rejects("string", self.make_analysis(), "--run", of_noise, saying=[of_noise, "another platoon", "stationary variance of follower 3 3.6"])
        self.assert_rejects("string", self.make_analysis(stationary_variance=[1.0]), "--run", run,
                            saying=[run, "3 followers", "has 1"])

    def test_a_run_of_another_leader_or_standstill_distance_than_the_analysis(self):
        gaps = "vehicle,count,smallest_gap,realization,step,collisions,below_safe_gap,theoretical_collision_bound,bin_1\n" \
            + "".join("{},{},1,0,0,0,,,{}\n".format(i, COUNT, COUNT) for i in (1, 2, 3))
        signals = "signal," + HEADING + "\n" + "".join("gap,{},{},9,2,1,{},1\n".format(i, k, 2 + k) for i in (1, 2, 3) for k in range(4))
        run = self.make_run(tables={"gaps.csv": gaps, "signals.csv": signals}, configuration={"model": {}})
        mean = 0.1 * np.arange(1.0, 4.0)[:, np.newaxis] * np.arange(6.0)
        gap = np.tile(2.0 + np.arange(6.0), (3, 1))
        for of_errors, of_gaps, words in ((mean, gap, None), (mean[:, :2], gap[:, :2], None), (mean + 1e-9, gap, None),
                                          (2.0 * mean, gap, "mean error of follower 1 at step 1: 0.1 m instead of 0.2 m"),
                                          (mean, gap + 6.0, "mean gap of follower 1 at step 0: 2 m instead of 8 m"),
                                          (mean, gap + 6.0 * (mean > 0.8), "mean gap of follower 3 at step 3: 5 m instead of 11 m")):
            analysis = self.make_analysis(mean=of_errors.tolist(), signals={"gap": {"mean": of_gaps.tolist()}},
                                          collision={"probability": [0.1, 0.1, 0.1], "limit_probability": 0.1})
            for arguments in (("gaps", run, "--analysis", analysis), ("norms", run, analysis)):
                if words:
                    self.assert_rejects(*arguments, saying=[run + ": is of another platoon than " + analysis, words])
                else:
                    self.assert_draws(*arguments)
            self.assert_draws("string", analysis, "--run", run)  # which shows no means

    def test_an_analysis_that_lacks_a_key(self):
        for figure, key in (("gain", "gain_along_string.frequency"), ("norms", "norms.mean_l2")):
            path = self.make_analysis(**{key.split(".")[0]: {}})
            self.assert_rejects(figure, path, saying=[path, key + " is missing"])
        path = self.make_analysis(stationary_variance=2.0)
        self.assert_rejects("string", path, saying=[path, "stationary_variance must be a list of numbers"])

    def test_an_analysis_that_is_nested_without_end(self):
        path = self.write('{"transfer": ' + "[" * 100000 + "]" * 100000 + "}", "deep.json")
        self.assert_rejects("gain", path, saying=[path, "nested too deep"])

    def test_an_analysis_with_null_everywhere(self):
        path = self.make_analysis(stationary_variance=[None, None, None])
        self.assert_rejects("string", path, saying=[path, "stationary_variance is NaN everywhere"])

    def test_as_many_gains_as_frequencies(self):
        path = self.make_analysis(gain_along_string={"frequency": [0.1, 0.2], "gain": [1.0]})
        self.assert_rejects("gain", path, saying=[path, "as many gains as frequencies"])

    def test_a_map_that_is_not_a_grid(self):
        path = self.make_map()
        self.write("\n".join(self.lines("map.csv")[:-1]), "map.csv")
        self.assert_rejects("map", path, saying=[path, "grid"])
        self.write("headway,gain\n1,2\n", "map.csv")
        self.assert_rejects("map", path, saying=[path, "column spectral_radius is missing"])

    def test_a_map_of_unstable_loops_alone_is_drawn(self):
        self.assert_draws("map", self.make_map(radius=lambda headway, gain: 2.0))

    def test_an_output_folder_that_is_missing(self):
        code, _, message = self.run_plot("errors", self.make_run(), "--output", self.path("none", "figure"))
        self.assertEqual(code, 1)
        self.assertIn(self.path("none") + ": no such folder", message)

    def test_a_folder_in_place_of_a_figure(self):
        os.mkdir(self.output + ".svg")
        self.assert_rejects("gain", self.make_analysis(), saying=[self.output + ".svg", "is a folder"])

    def test_an_error_keeps_existing_figures(self):
        self.assert_draws("errors", self.make_run())
        before = self.read("figure.png")
        self.write("", "run", "statistics.csv")
        self.assert_rejects("errors", self.path("run"), saying=["is not as it was written"])
        self.assertEqual(self.read("figure.png"), before)

    def test_a_full_disk_keeps_existing_figures(self):
        good, bad = self.path("a.png"), self.path("b" * 300)  # a name too long for the file system
        self.write("before", "a.png")
        with self.assertRaisesRegex(OSError, "cannot be written"):
            plot.files.write_all({good: b"after", bad: b"after"}, replace=True)
        self.assertEqual(self.read("a.png"), b"before")
        self.assertEqual(os.listdir(self.folder), ["a.png"])

    def test_programs_without_the_environment_name_the_setup_file(self):
        bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        for name in ("plot", "watch", "dashboard", "recorded_drive", "tune"):
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
