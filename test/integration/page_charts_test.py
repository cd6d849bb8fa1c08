#!/usr/bin/python3
"""The page's chart of the smallest gaps, and charts and data that it saves. PICTURES=FOLDER keeps a screenshot of each state."""

import base64
import math
import os
import re
import unittest

import live_platoon
from page_feed import BURN_IN, Fed, configuration

# Collects the downloads that the page offers, without saving them.
CAUGHT = """window.caught = []; const made = {}, make = URL.createObjectURL;
URL.createObjectURL = blob => { const url = make.call(URL, blob); made[url] = blob; return url; };
HTMLAnchorElement.prototype.click = function () {
  const name = this.download, reader = new FileReader();
  reader.onload = () => caught.push([name, reader.result]);
  reader.readAsDataURL(made[this.href]);
}"""

CLICK = """const road = document.getElementById("road"), box = road.getBoundingClientRect(), [x, y] = JSON.parse(road.dataset.places)[arguments[0]];
road.dispatchEvent(new MouseEvent("click", {clientX: box.left + x, clientY: box.top + y, bubbles: true}))"""


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

    def picks(self):
        return self.browser.run("return [...document.querySelectorAll('#picks button')].map(button => Number(button.dataset.vehicle))")

    def click_vehicle(self, i):
        """Clicks the middle of a vehicle on the road."""
        self.browser.run(CLICK, i)

    def check_motion(self, followers):
        self.begin(followers, vehicle_length=2.0)
        self.drive(range(BURN_IN, BURN_IN + 150))
        self.open()
        self.drive_seen(range(BURN_IN + 150, BURN_IN + 250))
        self.text_comes("#motion-note", "of vehicles leader, 1, {}".format(followers))
        self.browser.run("document.getElementById('pick').value = 4; document.getElementById('pick-button').click()")
        self.wait_for_page("document.querySelectorAll('#picks button').length == 4", "four vehicles")
        for width in self.at_both_sizes("motion-{}".format(followers)):
            self.wait_for_page("document.getElementById('road').dataset.metre > 0", "the road")
            for shown in (True, False):
                self.click_vehicle(3)
                live_platoon.wait_for(lambda: (3 in self.picks()) == shown, "a click on the road", 20.0)
            charts = self.browser.run("return ['gap', 'speed', 'acceleration'].map(name => ({...document.getElementById('motion-' + name).dataset}))")
            for chart in charts:
                self.assertAlmostEqual(float(chart["to"]), 0.1 * (BURN_IN + 249), delta=1e-9)
            now = self.state.give("snapshot")
            gap = now["position"][3] - now["position"][4] - 2.0
            self.text_comes("#picks button:nth-child(4)", "4: {:.1f} m, {:.2f} m/s, ".format(gap, now["speed"][4]))
            self.assertNotIn(" m,", self.browser.text("#picks button:first-child"))  # the leader has no gap
            self.assertIn("leader: 20.00 m/s, 0.00 m/s\N{SUPERSCRIPT TWO}", self.browser.text("#picks button:first-child"))
            gaps, (speeds, strong) = charts[0], charts[1:]
            colours = self.browser.run("return [...document.querySelectorAll('#picks i')].map(key => key.style.borderColor)")
            distances = [sum(abs(int(a) - int(b)) for a, b in zip(*(re.findall("[0-9]+", colours[at]) for at in pair))) for pair in ((1, 2), (1, 3), (2, 3))]
            self.assertGreater(min(distances), 100, colours)
            self.assertTrue(float(gaps["low"]) < gap < float(gaps["high"]))
            self.assertTrue(float(speeds["low"]) < 18.9 and float(speeds["high"]) > 21.1)
            self.assertTrue(float(strong["low"]) < -2.5 and float(strong["high"]) > 2.5)  # 0.9 * 1.3 * 0.25 rad / 0.1 s

    def test_gap_speed_and_acceleration_of_picked_vehicles_of_5(self):
        self.check_motion(5)

    def test_gap_speed_and_acceleration_of_picked_vehicles_of_100(self):
        self.check_motion(100)

    def test_picked_vehicles_have_bounds_and_stay_in_the_next_run(self):
        self.begin(8, vehicle_length=2.0)
        self.drive(range(BURN_IN, BURN_IN + 30))
        self.open()
        self.wait_for_page("document.querySelectorAll('#picks button').length == 3", "three vehicles")
        for i in (2, 3, 4, 5, 99):  # of six the first leaves; 99 does not exist
            self.browser.run("document.getElementById('pick').value = {}; document.getElementById('pick-button').click()".format(i))
        live_platoon.wait_for(lambda: self.picks() == [1, 8, 2, 3, 4, 5], "six vehicles", 20.0)
        self.browser.run("document.querySelector('#picks button[data-vehicle=\"2\"]').click()")
        live_platoon.wait_for(lambda: self.picks() == [1, 8, 3, 4, 5], "five vehicles", 20.0)
        self.begin(4, vehicle_length=2.0)
        live_platoon.wait_for(lambda: self.picks() == [1, 3, 4], "those of the next run", 20.0)

    def test_motion_is_saved_with_its_units_and_begins_again_with_a_restart(self):
        self.begin(5, vehicle_length=2.0)
        self.drive(range(BURN_IN, BURN_IN + 31))
        self.open()
        self.drive_seen(range(BURN_IN + 31, BURN_IN + 40))
        self.drive_seen(range(0, 31), attempt=2)
        self.drive_seen(range(60, 70), attempt=2)  # behind a pause
        self.wait_for_page("Number(document.getElementById('motion-gap').dataset.to) > 6.8", "the latest snapshot")
        self.browser.run(CAUGHT)
        self.browser.run("document.querySelector('[data-saves=motion] [data-kind=CSV]').click()")
        self.wait_for_page("caught.length == 1", "the table")
        heading, *rows = base64.b64decode(self.browser.run("return caught")[0][1].split(",")[1]).decode().splitlines()
        self.assertEqual(heading, "vehicle,realization,step,seconds,gap,speed,acceleration")
        rows = [row.split(",") for row in rows if row.startswith("1,")]
        steps = [int(row[2]) for row in rows]
        self.assertEqual(steps, list(range(steps[0], 31)) + list(range(60, 70)))  # nothing before the restart
        error = {k: 1.3 * math.sin(0.25 * k) for k in steps}
        for row, before in zip(rows[1:], rows):
            k, last = int(row[2]), int(before[2])
            self.assertAlmostEqual(float(row[3]), 0.1 * k, places=9)
            self.assertAlmostEqual(float(row[4]), 4.4 + error[k], places=6)
            self.assertAlmostEqual(float(row[5]), 20.0 + 0.9 * error[k], places=3)
            if k - last > 5:
                self.assertEqual(row[6], "")
            else:
                self.assertAlmostEqual(float(row[6]), 0.9 * (error[k] - error[last]) / (0.1 * (k - last)), delta=0.002)

    def test_snapshots_too_far_apart_for_an_acceleration_say_so(self):
        self.begin(5, vehicle_length=2.0)
        self.drive(range(BURN_IN, BURN_IN + 100, 10))
        self.open()
        self.drive_seen(range(BURN_IN + 100, BURN_IN + 150, 10))
        self.wait_for_page("document.getElementById('motion-acceleration').dataset.note", "a note in place of accelerations")
        for _ in self.at_both_sizes("far-apart"):
            notes = self.browser.run("return ['gap', 'speed', 'acceleration'].map(name => document.getElementById('motion-' + name).dataset.note)")
            self.assertEqual(notes, ["", "", "the snapshots are too many steps apart"])

    def test_a_run_at_full_speed_has_no_motion_to_watch(self):
        self.state.take_configuration(configuration(5, 30))
        self.followers = 5
        self.drive(range(0, 30), time_average=False)
        self.open()
        self.wait_for_page("document.querySelectorAll('#string rect').length == 5", "the bars")
        self.assertTrue(self.browser.run("return document.getElementById('motion-card').hidden"))

    def test_charts_are_saved_as_png_and_their_data_as_csv(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 31))
        self.open()
        self.wait_for_page("document.getElementById('road').dataset.metre > 0", "the road")
        self.browser.run(CAUGHT)
        self.browser.run("document.querySelectorAll('.save button').forEach(button => button.click())")
        self.wait_for_page("caught.length == 10", "five charts and tables")
        saved = {name: base64.b64decode(content.split(",")[1]) for name, content in self.browser.run("return caught")}
        rows = {"string": 20, "curves": 20 * 4, "road": 21, "strip": 20 * 31, "motion": 3}  # the motion since the page was opened
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
        self.assertEqual({row[1] for row in table[1:]}, {str(BURN_IN + 30)})
        self.drive(range(BURN_IN + 40, BURN_IN + 41), manoeuvre=True, counted_from=540)
        self.text_comes("#string-note", "averages paused")
        self.browser.run("caught.length = 0; document.querySelector('[data-saves=string] [data-kind=CSV]').click()")
        self.wait_for_page("caught.length == 1", "the table of paused averages")
        paused = [line.split(",") for line in base64.b64decode(self.browser.run("return caught[0][1]").split(",")[1]).decode().splitlines()]
        self.assertEqual(paused[0], table[0] + ["paused_until"])
        self.assertEqual({(row[1], row[-1]) for row in paused[1:]}, {("", "540")})


if __name__ == "__main__":
    unittest.main()
