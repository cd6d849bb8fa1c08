#!/usr/bin/python3
"""The page's chart of the smallest gaps, and charts and data that it saves. PICTURES=FOLDER keeps a screenshot of each state."""

import base64
import math
import os
import unittest

from page_feed import BURN_IN, Fed

# Collects the downloads that the page offers, without saving them.
CAUGHT = """window.caught = []; const made = {}, make = URL.createObjectURL;
URL.createObjectURL = blob => { const url = make.call(URL, blob); made[url] = blob; return url; };
HTMLAnchorElement.prototype.click = function () {
  const name = this.download, reader = new FileReader();
  reader.onload = () => caught.push([name, reader.result]);
  reader.readAsDataURL(made[this.href]);
}"""


class Charts(Fed):
    def gaps(self, followers, **changes):
        """Smallest gaps that decrease along the string to below 0."""
        smallest = [2.5 * math.cos(2.6 * i / followers) + 0.2 * math.sin(7.0 * i) for i in range(followers)]
        collisions = [round(300.0 * (1.0 - math.exp(g))) if g < 0.0 else 0 for g in smallest]
        return dict(dict(smallest_gap=smallest, smallest_gap_realization=[1000 + i for i in range(followers)], smallest_gap_step=[60] * followers,
                         collisions=collisions, collision_bound=[0.003 * i for i in range(followers)], time_average=False, realizations=1000), **changes)

    def check_gaps(self, followers):
        self.begin(followers)
        of = self.gaps(followers)
        self.drive(range(BURN_IN, BURN_IN + 21), **of)
        self.open()
        self.wait_for_page("document.querySelectorAll('#gaps rect').length == {}".format(followers), "the bars")
        for width in self.at_both_sizes("gaps-{}".format(followers)):
            self.assertEqual(self.browser.run("return [...document.querySelectorAll('#gaps rect.collision')].map(bar => Number(bar.dataset.follower))"),
                             [i + 1 for i in range(followers) if of["smallest_gap"][i] < 0.0])
            if followers == 20 and width > 1000:
                self.assertEqual(self.browser.run("return [...document.querySelectorAll('#gaps text.count')].map(text => Number(text.textContent))"),
                                 [count for count in of["collisions"] if count])
        worst = of["smallest_gap"].index(min(of["smallest_gap"]))
        self.text_comes("#gaps-note", "realization {} at step 60, follower {}".format(1000 + worst, worst + 1))
        self.text_comes("#gaps-readout", "Follower {}: smallest gap".format(worst + 1))
        self.assertIn("by theory in at most", self.browser.text("#gaps-readout"))
        self.browser.run("document.getElementById('table-card').open = true")
        self.wait_for_page("document.getElementById('table').rows.length == {}".format(followers + 1), "the table")
        self.assertEqual(self.browser.text("#table tbody tr:nth-child(2) td:nth-child(8)"), "1001")

    def test_smallest_gaps_of_2_followers(self):
        self.check_gaps(2)

    def test_smallest_gaps_of_20_followers_have_collisions_marked_and_counted(self):
        self.check_gaps(20)

    def test_smallest_gaps_of_500_followers(self):
        self.check_gaps(500)

    def test_without_gaps_there_is_no_chart_of_them(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 21))
        self.open()
        self.wait_for_page("document.querySelectorAll('#string rect').length == 20", "the bars")
        self.assertTrue(self.browser.run("return document.getElementById('gaps-card').hidden"))
        self.browser.run("document.getElementById('table-card').open = true")
        self.wait_for_page("document.getElementById('table').rows.length == 21", "the table")
        self.assertTrue(self.browser.run("return [...document.querySelectorAll('.gap')].every(cell => cell.hidden)"))

    def test_gaps_before_the_first_realization_and_without_theory_are_shown(self):
        self.begin(5)
        nothing = [math.inf] * 5
        self.drive(range(BURN_IN, BURN_IN + 1), **self.gaps(5, smallest_gap=nothing, collisions=[0] * 5, collision_bound=[]))
        self.open()
        self.text_comes("#gaps-readout", "nothing is measured yet")
        self.drive(range(BURN_IN + 10, BURN_IN + 11), **self.gaps(5, collision_bound=[]))
        self.text_comes("#gaps-readout", "of 1 000 realizations")
        self.assertNotIn("theory", self.browser.text("#gaps-readout"))
        self.browser.run(CAUGHT)
        self.browser.run("document.querySelectorAll('[data-saves=gaps] .save button').forEach(button => button.click())")
        self.wait_for_page("caught.length == 2", "chart and table")
        saved = {name: base64.b64decode(content.split(",")[1]) for name, content in self.browser.run("return caught")}
        self.assertGreater(len(saved["platoon-gaps.png"]), 5000)
        rows = saved["platoon-gaps.csv"].decode().splitlines()
        self.assertEqual(rows[0], "vehicle,smallest_gap,realization,step,collisions,theoretical_collision_bound")
        self.assertEqual((len(rows), rows[1].count(",")), (6, 5))
        self.assertEqual(self.browser.complaints(), [])

    def test_charts_are_saved_as_png_and_their_data_as_csv(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 31))
        self.open()
        self.wait_for_page("document.getElementById('road').dataset.metre > 0", "the road")
        self.browser.run(CAUGHT)
        self.browser.run("document.querySelectorAll('.save button').forEach(button => button.click())")
        self.wait_for_page("caught.length == 8", "four charts and tables")
        saved = {name: base64.b64decode(content.split(",")[1]) for name, content in self.browser.run("return caught")}
        rows = {"string": 20, "curves": 20 * 4, "road": 21, "strip": 20 * 31}
        for name, count in rows.items():
            picture = saved["platoon-{}.png".format(name)]
            self.assertTrue(picture.startswith(b"\x89PNG"))
            self.assertGreater(len(picture), 5000)
            lines = saved["platoon-{}.csv".format(name)].decode().splitlines()
            self.assertEqual(len(lines), 1 + count, name)
            self.assertEqual({line.count(",") for line in lines}, {lines[0].count(",")})
            if os.environ.get("PICTURES"):
                with open(os.path.join(os.environ["PICTURES"], "saved-{}.png".format(name)), "wb") as file:
                    file.write(picture)
        table = [line.split(",") for line in saved["platoon-string.csv"].decode().splitlines()]
        self.assertEqual([float(row[3]) for row in table[1:]], self.state.document()["variance"])
        self.assertEqual(table[0], ["vehicle", "step", "mean", "variance", "standard_error", "theoretical_mean", "theoretical_variance", "z"])


if __name__ == "__main__":
    unittest.main()
