#!/usr/bin/python3
"""report: the page on runs."""

import html
import os
import pathlib
import re
import shutil
import sys
import unittest

import numpy as np
import stochastic_platoon as sp

import live_platoon
from user_tools_test import RunTest, script, sign

sys.path.insert(0, live_platoon.shared("src", "tools"))
from reporting import page as report_page  # noqa: E402


class Report(RunTest):
    def report(self, *arguments, output="report.html", **limits):
        return script("report", *arguments, "--output", self.path(output), **limits)

    def page(self, *folders):
        done = self.report(*folders)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return pathlib.Path(self.path("report.html")).read_text(encoding="utf-8")

    def test_the_page_has_verdict_numbers_figures_and_checksums_and_needs_no_other_file(self):
        page, summary = self.page(self.run_folder), self.summary()
        for words in ("string stable", "complete, undamaged, in agreement", summary["theory"]["reason"],
                      summary["revision"], summary["version"], summary["date"], "standard error", "prepared by", "controller/denominator",
                      "largest |z|", "noise_variance</th><td>{} m²".format(summary["configuration"]["model"]["noise_variance"]),
                      *summary["crc32"].values(), *summary["warnings"]):
            self.assertIn(words, html.unescape(page))
        self.assertEqual(page.count("<svg"), 3)  # errors, gaps, amplification
        self.assertEqual(re.findall(r'(?:href|src)="(?!#|data:)[^"]*"', page), [])
        last = sp.Results.load(self.run_folder)
        self.assertIn("<td class=\"number\">{:.6g}</td>".format(last.variance[2, -1]), page)
        self.assertIn("<td class=\"number\">{:.6g}</td>".format(last.theoretical_variance[2, -1]), page)

    def test_the_losses_of_a_link_are_on_the_page_and_not_called_lost_where_nothing_is_missing(self):
        self.write("received.csv", "received\n1\n1\n1\n0\n")
        model = sp.Model.load("cacc.yaml").replace({"inputs/0/channel/loss": {"probability": 0.2, "on_loss": "hold"},
                                                    "inputs/1/channel/loss": {"trace": self.path("received.csv"), "column": "received", "on_loss": "hold"}})
        run = sp.monte_carlo(model, followers=3, steps=50, realizations=200, seed=1, output=self.path("lossy"))
        page = html.unescape(self.page(self.path("lossy")))
        arrived = run.ages.share[(run.ages.age == 0) & (run.ages.input == 0)]
        self.assertEqual((arrived.size, abs(arrived - 0.8).max() < 0.02), (3, True))
        self.assertIn("<tr><th>lost on the links, position</th><td>{:.3g} to {:.3g} % on 3 links, by theory 20 %</td></tr>".format(
            100 * (1 - arrived.max()), 100 * (1 - arrived.min())), page)
        self.assertIn("<tr><th>lost on the links, input</th><td>2", page)
        self.assertIn("<tr><th>positions in the statistics</th><td>{}, 0 missing</td></tr>".format(run.summary["positions_received"]), page)
        self.assertNotIn("positions lost", page)
        self.assertEqual(page.count("by theory 20 %"), 1)

    def test_every_number_of_a_model_has_its_unit_unless_it_has_none(self):
        without = {"headway_filter", "divide_by_one_plus_headway", "on_loss", "probability", "numerator", "denominator", "A", "B", "C",
                   "own_acceleration", "inputs", "string", "start", "spacing", "allow_unstable"}
        for name in sorted(os.listdir(live_platoon.shared("config"))):
            if not name.endswith(".yaml"):
                continue
            for path, _ in report_page.flattened(sp.Model.load(name).to_dict()):
                self.assertNotEqual(bool(report_page.unit_of(path)), path.rsplit("/", 1)[-1] in without, "{}: {}".format(name, path))

    def test_inputs_are_shown_whole_but_long_lists_are_cut(self):
        inputs = [{"signal": "position", "noise_variance": 0.02, "channel": {"delay": n, "loss": {"trace": {"runs": [3, 1] * 500}}}} for n in range(20)]
        shown = dict(report_page.flattened({"inputs": inputs, "leader": {"speed": [{"from_step": k, "value": 20.0} for k in range(3000)]},
                                            "types": {"car": {"inputs": inputs}}}))
        self.assertEqual(shown["inputs"].count("'signal': 'position', 'noise_variance': 0.02"), 20)
        self.assertEqual(shown["inputs"].count("(1000 values)"), 20)
        self.assertEqual(shown["types/car/inputs"], shown["inputs"])
        self.assertLess(len(shown["leader/speed"]), 200)
        self.assertIn("(3000 values)", shown["leader/speed"])

    def test_a_run_that_fails_its_check_shows_the_reason(self):
        summary = self.summary()
        summary["agreement"]["max_abs_z_mean"] = 9.5
        sign(self.run_folder, summary)
        page = self.page(self.run_folder, self.whole)
        self.assertIn("check failed", page)
        self.assertIn("largest |z| 9.50 for the means", page)
        self.assertEqual(page.count("<h2>"), 2)

    def test_one_realization_of_cars_without_a_theory_says_why_a_figure_and_the_theory_are_missing(self):
        sp.monte_carlo(sp.Model.load("acc_limits.yaml"), followers=2, steps=20, realizations=1, signals=["gap"], output=self.path("one"))
        page = self.page(self.path("one"))
        self.assertIn("Theory: none, as vehicles have limits.", page)
        self.assertIn("variance is NaN everywhere: it takes at least two realizations", page)
        self.assertEqual(page.count("<svg"), 1)  # gaps
        analysis = self.path("theory.json")
        live_platoon.tool("analyze", model="acc_limits.yaml", json=analysis)
        self.assertIn("theory.json: norms.mean_l2 is missing; theory: none, as vehicles have limits; linear.norms.mean_l2 is that of the same cars "
                      "without limits", script("plot", "norms", analysis).stderr)

    def test_errors_that_are_not_compared_with_their_theory_say_why(self):
        sp.monte_carlo(sp.Model.load("lossy.yaml"), followers=3, steps=20, realizations=20, signals=["speed"], output=self.path("few"))
        page = html.unescape(self.page(self.path("few")))
        self.assertIn("complete and undamaged, tracking errors not compared with the theory, signals in agreement (speed)", page)
        self.assertIn("No verdict on the tracking errors: the tracking errors are not normal, and 20 realizations are too few to tell", page)

    def test_the_table_has_the_z_that_the_program_prints(self):
        for name, options in (("few", dict(followers=10, realizations=5)), ("many", dict(followers=3, steps=60, realizations=300)),
                              ("lossy", dict(followers=2, steps=30, realizations=4000, loss=0.1))):
            done = live_platoon.tool("monte_carlo", output=self.path(name), **options)
            self.assertEqual(done.returncode, 0, done.stderr)
            printed = [line.split() for line in done.stdout.splitlines() if re.match(r" +\d+ ", line)][:options["followers"]]
            run = sp.Results.load(self.path(name))
            table = report_page.numbers(run)
            rows = [re.findall(r"<td[^>]*>([^<]*)</td>", row) for row in table.split("<tr>")[2:]]
            self.assertEqual(len(rows), run.followers)
            normal = name in ("few", "many")
            self.assertEqual(report_page.is_normal(run), normal)
            self.assertEqual("(variance − theory) / standard error" not in table, normal)
            if normal:
                self.assertEqual([row[6].replace("\u2212", "-") for row in rows], [row[4] for row in printed])

    def test_a_z_whose_probability_no_number_holds_is_that_of_the_approximation(self):
        # At 36 standard errors the two meet.
        for count in (50.0, 3000.0):
            scores = [report_page.score_of_variance(ratio, 1.0, count) for ratio in np.linspace(1.0, 50.0, 20000)]
            self.assertGreater(scores[-1], 40.0)
            self.assertTrue((np.diff(scores) > 0.0).all())

    def test_gaps_below_the_safe_gap_and_steps_at_limits_are_on_the_page(self):
        model = sp.Model.load("acc_limits.yaml")
        for name, safe_gap, badge in (("near", 200.0, "bad"), ("far", 0.5, "good")):
            run = sp.monte_carlo(model.replace(safe_gap=safe_gap), followers=2, steps=40, realizations=20, signals=["gap"], output=self.path(name))
            page = html.unescape(self.page(self.path(name)))
            below = run.gaps.below_safe_gap
            self.assertEqual(below.max() > 0, badge == "bad")
            amount = "{:.0f} of 20 realizations of the follower with the most".format(below.max()) if below.max() else "none of 20 realizations"
            self.assertIn('<span class="badge {}">gap below {:g} m: in {}</span>'.format(badge, safe_gap, amount), page)
            self.assertIn('<th class="number">with a gap below {:g} m</th>'.format(safe_gap), page)
            self.assertIn('<td class="number">{:.0f} of 20</td>'.format(below[1]), page)
            shares = re.search(r"Share of the steps at the limits.*?</table>", page, re.S).group(0)
            self.assertIn('<td class="number">{:.3g}</td>'.format(100.0 * run.table("limits")["input_low"][1]), shares)
            os.remove(self.path("report.html"))

    def test_runs_in_folders_of_one_name_have_the_end_of_their_path_that_tells_them_apart(self):
        folders = [self.path("a", "run"), self.path("b", "run"), self.path("b", "other")]
        for folder in folders:
            shutil.copytree(self.run_folder, folder)
        page = self.page(*folders)
        self.assertEqual(re.findall("<h2>(.*)</h2>", page), ["1. a/run", "2. b/run", "3. other"])
        self.assertEqual(re.findall("<tr><td>(.*?)</td>", page)[:3], ["a/run", "b/run", "other"])
        runs = [sp.Results.load(folder) for folder in (folders[0], folders[0])]
        self.assertEqual(report_page.names_of(runs), ["run", "run"])

    def test_nothing_is_overwritten_and_bad_names_are_rejected(self):
        self.write("report.html", "before")
        for output, reason in (("report.html", "exists and is never overwritten"), ("report.txt", "must end in .html or .pdf"),
                               ("none/report.html", "no such folder")):
            done = self.report(self.run_folder, output=output)
            self.assertEqual(done.returncode, 1)
            self.assertIn(reason, done.stderr)

    def test_a_full_disk_leaves_no_page(self):
        before = os.listdir(self.folder)
        done = self.report(self.run_folder, largest=50000)
        self.assertEqual(done.returncode, 1)
        self.assertIn("report.html: cannot be written: File too large", done.stderr)
        self.assertEqual(os.listdir(self.folder), before)

    @unittest.skipUnless(shutil.which("chromium"), "needs chromium")
    def test_a_pdf_is_printed(self):
        done = self.report(self.run_folder, output="report.pdf")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(pathlib.Path(self.path("report.pdf")).read_bytes()[:5], b"%PDF-")


if __name__ == "__main__":
    unittest.main()
