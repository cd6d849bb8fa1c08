#!/usr/bin/python3
"""The states of the page in headless Chromium at the sizes of a laptop and of a phone, for 20, 100 and 500 followers. The test
feeds the page's server with messages of a simulated platoon; no node runs. PICTURES=FOLDER keeps a screenshot of each state."""

import base64
import math
import os
import sys
import threading
import unittest

import stochastic_platoon as sp

import live_platoon
from browser import Browser

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "unit"))
from watching_messages import TOOLS, configuration, endless, message, snapshot  # noqa: E402
from watching import server, state  # noqa: E402

SIZES = ((1366, 768), (390, 844))
BURN_IN = 200

OUTSIDE = """return [...document.querySelectorAll("#controls button, #controls input, #pause, #verdict")].filter(element => {
  const {left, top, right, bottom} = element.getBoundingClientRect();
  return left < 0 || top < 0 || right > innerWidth || bottom > innerHeight;
}).map(element => element.id || element.textContent)"""
# The highest and the lowest y of the error bars.
WHISKERS = """const box = document.querySelector("path.whiskers:not(.halo)").getBBox(); return [box.y, box.y + box.height]"""
# Collects the downloads that the page offers, without saving them.
CAUGHT = """window.caught = []; const made = {}, make = URL.createObjectURL;
URL.createObjectURL = blob => { const url = make.call(URL, blob); made[url] = blob; return url; };
HTMLAnchorElement.prototype.click = function () {
  const name = this.download, reader = new FileReader();
  reader.onload = () => caught.push([name, reader.result]);
  reader.readAsDataURL(made[this.href]);
}"""


class Fed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.state = state.PlatoonState(lambda kind: self.server.streams.send(kind))
        self.server = server.PageServer("localhost", 0, self.state, lambda content: (True, "done"), os.path.join(TOOLS, "watching", "page"))
        thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        for undo in (thread.join, self.server.server_close, self.server.shutdown, self.server.closing.set):
            self.addCleanup(undo)
        self.browser.complaints()

    def open(self):
        self.browser.open(self.server.url)
        self.browser.device("Emulation.clearDeviceMetricsOverride")

    def wait_for_page(self, condition, what):
        return live_platoon.wait_for(lambda: self.browser.run("return " + condition), what + " on the page", 20.0)

    def text_comes(self, selector, words):
        self.wait_for_page("document.querySelector('{}').textContent.includes('{}')".format(selector, words), words)

    def begin(self, followers, **model):
        self.followers = followers
        self.state.take_configuration(configuration(followers, 0, **model))

    def drive(self, steps, attempt=1, **changes):
        """Steps of a string with a wave that travels along it; the averages follow at every tenth step."""
        n = self.followers
        theory = [1.0 + 0.02 * i if n > 60 else 1.2 * (1.0 - 0.8 ** i) for i in range(1, n + 1)]
        for step in steps:
            error = [1.3 * math.sin(0.25 * step - 0.9 * i) for i in range(n)]
            of = snapshot(step, n)
            of.position = [2.0 * step] + [2.0 * step - 6.4 * (i + 1) - e for i, e in enumerate(error)]
            of.tracking_error, of.speed = error, [20.0] + [20.0 + 0.9 * e for e in error]
            self.state.take_received(message(run=1, realization=0, step=step, position=[p + 0.8 * math.sin(9.0 * i) for i, p in enumerate(of.position[:n])]))
            self.state.take_snapshot(of)
            if step % 10 == 0:
                variance = [v * (1.0 + 0.2 * math.sin(5.0 * i) + 2.0 / (step + 10)) for i, v in enumerate(theory)]
                self.state.take_overview(endless(n, step, **dict(dict(
                    counted_from=BURN_IN, attempt=attempt, mean=[0.05 * math.sin(3.0 * i + 0.01 * step) for i in range(n)], variance=variance,
                    theoretical_mean=[0.0] * n, theoretical_variance=theory, standard_error=[v * (0.7 if n > 60 else 0.1) for v in variance],
                    variance_score=[0.5] * n, reason="string stable: abs(T) stays below 1 for all w > 0: its largest value away from 0 is 0.94",
                    limit_variance=theory[-1] * 1.05, stable_headways=[2.8, 320.0]), **changes)), 0.1 * step)

    def at_both_sizes(self, name):
        """Yields at each size, after the checks that apply to every state."""
        for width, height in SIZES:
            with self.subTest(width=width):
                self.browser.show_as(width, height)
                self.wait_for_page("innerWidth == {}".format(width), "the size")
                yield width
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
                if os.environ.get("PICTURES"):
                    self.browser.run("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
                    self.browser.picture(os.path.join(os.environ["PICTURES"], "{}-{}.png".format(name, width)))
        self.assertEqual(self.browser.complaints(), [])

    def check_driving(self, followers):
        self.begin(followers)
        self.drive(range(BURN_IN, BURN_IN + 100))
        self.open()
        self.wait_for_page("document.querySelectorAll('#string rect').length == {}".format(followers), "the bars")
        for _ in self.at_both_sizes("driving-{}".format(followers)):
            self.wait_for_page("document.getElementById('road').dataset.metre > 0", "the road")
            self.assertEqual(self.browser.run(OUTSIDE), [], "out of sight")
            chart = self.browser.run("return {...document.getElementById('string').dataset}")
            if followers <= 200:
                top, foot = self.browser.run(WHISKERS)
                self.assertGreaterEqual(top, float(chart["top"]) - 0.1)
                self.assertLessEqual(foot, float(chart["foot"]) + 0.1)
            self.assertIn("headway h3.2 sample periods = 0.32 s", self.browser.text("#facts"))
            self.assertIn("leader 20.0 m/s (72 km/h)", self.browser.text("#road-note"))
            road = self.browser.run("return {...document.getElementById('road').dataset, height: document.getElementById('road').clientHeight}")
            self.assertIn(float(road["scale"]), [v * p for v in (1, 2, 5) for p in (1, 10, 100)])
            self.assertTrue(30 < float(road["scale"]) * float(road["metre"]) < 250)
            self.assertEqual(road["overlaps"], "")

    def test_20_followers(self):
        self.check_driving(20)

    def test_100_followers_error_bars_stay_in_their_chart(self):
        self.check_driving(100)

    def test_500_followers(self):
        self.check_driving(500)

    def test_the_headway_of_a_car_by_lag_and_gains_is_set_in_seconds(self):
        self.begin(5, **sp.Model.load("acc.yaml").to_dict())
        self.drive(range(BURN_IN, BURN_IN + 20), stable_headways=[50.0, 35000.0])
        self.open()
        self.text_comes("output[for=headway]", "3.5 = 350 samples")
        self.assertEqual(self.browser.text("#headway-unit"), "[s]")
        self.text_comes("#stable-headways", "stable from 0.5")
        self.browser.run("const slider = document.getElementById('headway'); slider.value = 1.2; slider.dispatchEvent(new Event('input'))")
        self.text_comes("output[for=headway]", "1.2 = 120 samples")
        self.begin(5)
        self.text_comes("output[for=headway]", "3.2 = 0.32 s")
        self.assertEqual(self.browser.text("#headway-unit"), "[Ts]")

    def test_500_followers_that_start_are_counted(self):
        self.open()
        self.begin(500)
        self.state.take_topics({"vehicle_{}/position".format(i) for i in range(213)})
        self.text_comes("#reason", "213 of 501 vehicles are running")
        for _ in self.at_both_sizes("start"):
            self.assertEqual(self.browser.text("#verdict"), "Starting")
            self.assertIn("followers N500", self.browser.text("#facts"))
        self.state.take_overview(endless(500, 0, attempt=0, mean=[math.nan] * 500, variance=[math.nan] * 500), 0.0)
        self.text_comes("#string-note", "213 of 501")
        self.drive(range(0, 1), mean=[math.nan] * 500, variance=[math.nan] * 500)
        self.text_comes("#string-note", "theory; burn-in until step 200, 20 s of driving from now")

    def test_a_restart_is_an_event_and_a_mark_and_curves_begin_again(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 150))
        self.open()
        self.wait_for_page("document.getElementById('strip').dataset.restarts === '0'", "the strip")
        self.drive(range(0, 60), attempt=2)
        self.wait_for_page("document.getElementById('strip').dataset.restarts === '1'", "the mark of the restart")
        for _ in self.at_both_sizes("restart"):
            self.text_comes("#log", "step 340: attempt 2: the platoon restarts at step 0")
            self.text_comes("#curves-note", "since the latest restart")
            self.text_comes("#string-note", "averages paused: burn-in after a manoeuvre or restart, until step 200, 15 s of driving from now")
        curves = self.state.give("curves")
        self.assertEqual(curves["step"], [0, 10, 20, 30, 40, 50])
        self.assertEqual(self.state.document()["restarts"], 1)

    def test_during_a_manoeuvre_the_averages_are_paused(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 100))
        self.drive(range(BURN_IN + 100, BURN_IN + 121), manoeuvre=True, counted_from=540)
        self.open()
        for _ in self.at_both_sizes("manoeuvre"):
            self.text_comes("#string-note", "averages paused: the leader manoeuvres; at the earliest until step 540, 22 s of driving from now")
            self.text_comes("#log", "step 300: the leader manoeuvres: averages are paused")
        self.drive(range(330, 331), counted_from=550)
        self.text_comes("#string-note", "averages paused: burn-in after a manoeuvre or restart, until step 550")
        self.drive(range(550, 551), counted_from=550)
        self.text_comes("#string-note", "averages over time up to step 550")
        self.text_comes("#log", "step 550: averages go on")

    def test_a_stopped_follower_is_named_and_vehicles_that_overlap_are_marked(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 100))
        self.open()
        entries = [message(key="culprit", value="vehicle_3 has sent nothing since step 299"), message(key="retries", value="2")]
        self.state.take_diagnostics(message(status=[message(name="platoon/monitor: monitor", message="", values=entries)]))
        of = snapshot(300, 20)
        of.position = [600.0 - 6.4 * i - (9.0 if i == 2 else 0.0) for i in range(21)]  # vehicle 2 is behind vehicle 3
        self.state.take_snapshot(of)
        for _ in self.at_both_sizes("stopped"):
            self.text_comes("#culprit", "Run stalled: vehicle_3 has sent nothing since step 299 (2 retries)")
            self.text_comes("#log", "run stalled: vehicle_3")
            self.text_comes("#road-note", "1 overlapping: 3")
            self.wait_for_page("document.getElementById('road').dataset.overlaps === '3'", "the mark")

    def test_header_and_strip_show_the_same_step(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 58))
        self.open()
        self.text_comes("#facts", "step k257")
        self.assertEqual(self.browser.run("return document.getElementById('strip').dataset.step"), "257")

    def test_a_paused_page_stands_still_and_then_shows_everything(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 21))
        self.open()
        self.text_comes("#facts", "step k220")
        self.browser.run("document.getElementById('pause').click()")
        self.text_comes("#connection", "paused")
        live_platoon.wait_for(lambda: self.state.take_order("an order") or not self.server.streams.streams, "the end of its stream", 20.0)
        self.drive(range(BURN_IN + 21, BURN_IN + 41))
        self.assertIn("step k220", self.browser.text("#facts"))
        self.browser.run("document.getElementById('pause').click()")
        self.text_comes("#facts", "step k240")
        self.text_comes("#connection", "live")
        self.assertEqual(self.browser.text("#pause"), "Pause")

    def test_a_series_is_hidden_and_shown(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 21))
        self.open()
        visible = "[...document.querySelectorAll('#string rect')].filter(bar => bar.getAttribute('height') > 0).length"
        self.wait_for_page(visible + " == 20", "the bars")
        for count in (0, 20):
            self.browser.run("document.querySelector('[data-saves=string] [data-series=measured]').click()")
            self.wait_for_page("{} == {}".format(visible, count), "{} bars".format(count))
        self.browser.run("document.querySelector('[data-saves=string] [data-series=theory]').click()")
        self.wait_for_page("!document.querySelector('path.theory').getAttribute('d')", "no theory")

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
