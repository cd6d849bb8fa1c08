#!/usr/bin/python3
"""The page in headless Chromium while a platoon runs: it updates, names the node that blocks the run, sends commands, and
survives a restart of its node."""

import json
import os
import subprocess
import sys
import threading
import unittest

import rospy
from std_msgs.msg import String
from stochastic_platoon.msg import ErrorStatistics

import live_platoon
from dashboard_page import OnePlatoon, ask, state
from orders import setUpModule  # noqa: F401: unittest calls it

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "src", "tools"))
from watching.listening import report_start  # noqa: E402
from watching.state import PlatoonState  # noqa: E402

FOLLOWERS = 5

# The number of pixels of a canvas that have a colour, with a tolerance for smoothed edges.
PIXELS = """const canvas = document.getElementById(arguments[0]), [r, g, b] = arguments[1];
const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
let count = 0;
for (let at = 0; at < data.length; at += 4) count += Math.abs(data[at] - r) + Math.abs(data[at + 1] - g) + Math.abs(data[at + 2] - b) < 6;
return count"""
# Makes the page's event stream accessible as window.stream; runs before the page's own scripts.
KEEP_STREAM = "window.EventSource = class extends EventSource { constructor(...words) { super(...words); window.stream = this; } }"
# Sends the page so many snapshots, 600 per frame, together with the other events that accompany them at twenty per second.
TELL = '''const [snapshots, first, followers] = arguments, done = arguments[arguments.length - 1];
const tell = (kind, news) => window.stream.dispatchEvent(new MessageEvent(kind, {data: JSON.stringify(news)}));
const values = () => Array.from({length: followers}, () => 2 + Math.random());
let step = first;
function frame() {
  for (let j = 0; j < 600 && step < first + snapshots; ++j, ++step) {
    tell("snapshot", {realization: 0, step, position: [2 * step, ...values().map((v, i) => 2 * step - 6 * i - v)], tracking_error: values().map(v => v - 2.5), speed: [20, ...values()], acceleration: [], colliding: []});
    tell("received", {realization: 0, step, position: values().map((v, i) => 2 * step - 6 * i - v)});
    if (step % 20) continue;
    const [v, t] = [values(), values()];
    tell("statistics", {step, realizations: 1, time_average: true, complete: false, theory: "exact", reason: "string stable: because", string_stable: true,
      stable_headways: [[2.8, 1000]], limit_variance: 3, mean: v, variance: v, theoretical_mean: t, theoretical_variance: t, standard_error: t,
      score: v, attempt: 1, restarts: 0, manoeuvre: false, paused_until: null, latest_step: step, max_abs_z: 1, plausible_z: 4, vehicle_steps_per_second: 1, seconds_left: null, wall_seconds: 1,
      smallest_gap: [], smallest_gap_realization: [], smallest_gap_step: [], collisions: [], collision_bound: []});
  }
  step < first + snapshots ? requestAnimationFrame(frame) : done(true);
}
requestAnimationFrame(frame)'''
FIRST, LAST = [0x08, 0x20, 0x5c], [0x5c, 0x04, 0x10]  # dark blue, dark red


class Live(OnePlatoon):
    RUN = dict(followers=FOLLOWERS, steps=0, realizations=1, rate=50, headway=3.2, dashboard=True, dashboard_host="127.0.0.1")

    @classmethod
    def setUpClass(cls):
        cls.statistics = {}
        rospy.Subscriber("/platoon/error_statistics", ErrorStatistics, lambda m: cls.statistics.__setitem__(m.step, m), queue_size=1000)
        super().setUpClass()

    def setUp(self):
        super().setUp()
        self.browser.complaints()
        self.open(self.url)
        self.wait_for_page("document.querySelectorAll('#string rect').length == {}".format(FOLLOWERS), "the bars")

    def step(self):
        return state(self.url).get("step") or 0

    def steps_on(self):
        """Waits until the page shows a new step."""
        facts = self.browser.text("#facts")
        self.wait_for_page("document.getElementById('facts').textContent != {}".format(json.dumps(facts)), "another step")

    def test_its_numbers_are_error_statistics_of_that_step_to_the_bit(self):
        def pair():
            shown = state(self.url)
            return (shown.get("step") or 0) > 100 and shown["step"] in self.statistics and (shown, self.statistics[shown["step"]])
        shown, said = live_platoon.wait_for(pair, "a step that both tell of")
        for key in ("mean", "variance", "theoretical_variance"):
            self.assertEqual(shown[key], list(getattr(said, key)), key)
        for error, score, variance, theory in zip(shown["standard_error"], shown["score"], shown["variance"], shown["theoretical_variance"]):
            self.assertTrue(0.0 < error < variance)
            # The variance about the measured mean of few steps is expected below the theory's.
            self.assertGreater(score, 0.0 if variance > theory else -100.0)

    def test_the_road_has_vehicles_in_the_papers_colours_and_the_strip_fills(self):
        self.browser.show_as(1280, 1200)
        for colour in (FIRST, LAST):
            live_platoon.wait_for(lambda: self.browser.run(PIXELS, "road", colour) > 100, "a vehicle of that colour")
        grid = self.browser.run("return getComputedStyle(document.documentElement).getPropertyValue('--grid').trim()")
        empty = [int(grid[at:at + 2], 16) for at in (1, 3, 5)]
        before = self.browser.run(PIXELS, "strip", empty)
        live_platoon.wait_for(lambda: before == 0 or self.browser.run(PIXELS, "strip", empty) < before, "more of the strip")
        self.assertEqual([said for said in self.browser.complaints() if "Uncaught" in said], [])

    def kinds(self, *of):
        return [event["kind"] for event in state(self.url)["events"] if event["kind"] in of]

    def test_who_holds_the_platoon_up_is_named_and_no_longer_when_it_moves(self):
        before = self.step()
        with live_platoon.held("/platoon/vehicle_3"):
            self.wait_for_page("!document.getElementById('culprit').hidden && document.getElementById('culprit').textContent.includes('vehicle_3')",
                               "the name of the vehicle that is stopped")

            def retried():
                shown = state(self.url)
                self.assertIn("vehicle_3", shown["culprit"] or "nobody")
                return shown["retries"] >= 2
            live_platoon.wait_for(retried, "several retries")
        self.wait_for_page("document.getElementById('culprit').hidden", "no culprit")
        self.steps_on()
        events = [event for event in state(self.url)["events"] if event["kind"] in ("stall", "restart")]
        self.assertEqual([event["kind"] for event in events][-3:], ["stall", "restart", "stall"])
        self.assertRegex(events[-2]["text"], r"^attempts? \d+( to \d+)?: the platoon restarts at step 0")
        self.assertLess(events[-2]["step"] - before, 500)
        # The curves begin again, and a line marks the restart.
        self.wait_for_page("document.getElementById('strip').dataset.restarts > 0", "the mark of the restart")
        self.wait_for_page("document.getElementById('curves-note').textContent.includes('since the latest restart')", "the restart")

    def test_the_page_goes_on_behind_a_restart_of_its_node(self):
        self.browser.run("window.same_page = true")
        live_platoon.kill("/platoon/dashboard")
        live_platoon.wait_for(lambda: self.step() > 0, "the dashboard at its old address")
        self.wait_for_page("document.getElementById('connection').textContent == 'live'", "the connection")
        self.steps_on()
        self.assertTrue(self.browser.run("return window.same_page"))

    def test_orders_are_given_by_buttons_and_what_cannot_be_is_rejected_with_an_explanation(self):
        for command in ("brake", "cruise"):
            self.browser.run("document.getElementById('answer').textContent = ''; document.querySelector(arguments[0]).click()",
                             "[data-command={}]".format(command))
            self.wait_for_page("document.getElementById('answer').textContent.includes('the leader')", "the answer")
            self.assertEqual(self.browser.run("return document.getElementById('answer').dataset.success"), "true")
            if command == "brake":
                self.wait_for_page("document.getElementById('string-note').textContent.startsWith('averages paused: the leader manoeuvres')", "the pause")
                self.assertLess(state(self.url)["latest_step"], state(self.url)["paused_until"])
        live_platoon.wait_for(lambda: self.kinds("manoeuvre", "averages")[-3:] == ["manoeuvre", "manoeuvre", "averages"], "the end of the pause")
        self.assertEqual(self.kinds("order"), ["order", "order"])
        own = dict(Content_Type="application/json", Origin=self.url)
        for wrong, words in (({"headway": 0.0}, "headway"), ({"headway": -1}, "headway"), ({"loss": 1.0}, "loss"), ({"noise_variance": -1}, "noise_variance")):
            status, answer = ask(self.url, "POST", "/command", json.dumps(dict(wrong, command="change")), **own)
            self.assertEqual((status, answer["success"]), (409, False))
            self.assertIn(words, answer["message"])
        for speed in (-1000.5, 1001):
            status, answer = ask(self.url, "POST", "/command", json.dumps({"command": "speed", "speed": speed}), **own)
            self.assertEqual((status, answer["success"]), (409, False))
            self.assertIn("must be from -1000 to 1000 m/s, which the leader reaches", answer["message"])
        self.steps_on()

    def test_the_pages_memory_does_not_grow_over_an_hour(self):
        added = self.browser.device("Page.addScriptToEvaluateOnNewDocument", source=KEEP_STREAM)
        try:
            self.open(self.url)
            self.wait_for_page("window.stream && document.querySelectorAll('#string rect').length == {}".format(FOLLOWERS), "the bars")
            self.browser.device("Page.removeScriptToEvaluateOnNewDocument", **added)
            self.browser.driver.set_script_timeout(120)

            def heap_after(snapshots, first):
                self.browser.driver.execute_async_script(TELL, snapshots, first, FOLLOWERS)
                self.browser.device("HeapProfiler.collectGarbage")
                return self.browser.device("Runtime.getHeapUsage")["usedSize"]
            # An hour has 72000 snapshots; the first tenth fills all bounded buffers. Heap use varies by 1 MB. Unbounded columns
            # of the strip took 12 MB more, and 50 bytes kept per snapshot would take 3 MB.
            filled = heap_after(7200, 10 ** 6)
            self.assertLess(heap_after(64800, 10 ** 6 + 7200) - filled, 3000000)
        finally:
            self.open("about:blank")

    def test_it_is_served_on_the_given_host(self):
        self.assertTrue(self.url.startswith("http://127.0.0.1:"), self.url)

    def test_watch_once_prints_one_table_of_a_run_that_goes_on(self):
        lines = subprocess.run(["rosrun", "stochastic_platoon", "watch", "--once"], stdout=subprocess.PIPE, universal_newlines=True,
                               timeout=live_platoon.DEADLINE, check=True).stdout.splitlines()
        heading = [row for row, line in enumerate(lines) if line.split()[:2] == ["follower", "mean"]]
        self.assertEqual(len(heading), 1, lines)
        rows = [line.split() for line in lines[heading[0] + 1:] if line.strip()]
        self.assertEqual([row[0] for row in rows], [str(i) for i in range(1, FOLLOWERS + 1)])
        self.assertTrue(all(float(row[2]) > 0.0 for row in rows), rows)

    def test_the_start_is_read_from_the_master(self):
        fresh = PlatoonState()
        fresh.take_configuration(String(rospy.get_param("/platoon/configuration")))
        threading.Thread(target=report_start, args=(fresh, "/platoon/"), daemon=True).start()
        live_platoon.wait_for(lambda: fresh.start, "the state of the start")
        self.assertEqual(fresh.start, "all 6 vehicles are running, the first step is under way")
        fresh.began = True

    def test_the_stable_headways_are_marked_below_the_slider(self):
        (low, high), = live_platoon.wait_for(lambda: state(self.url).get("stable_headways"), "the stable headways")
        self.assertAlmostEqual(low, 2.8, places=9)
        self.assertGreater(high, 100.0)
        self.wait_for_page("document.querySelectorAll('#stable-headways i').length == 1", "the mark")
        left, right, track = self.browser.run('''const box = name => document.querySelector(name).getBoundingClientRect();
            const mark = box("#stable-headways i"); return [mark.left, mark.right, box("#headway")].map(x => x.left === undefined ? x : [x.left, x.right])''')
        # The centre of the slider's thumb moves from 8 pixels right of its left end to 8 pixels left of its right end.
        place = (left - track[0] - 8.0) / (track[1] - track[0] - 16.0)
        self.assertAlmostEqual(place, (2.8 - 0.5) / (6.0 - 0.5), delta=0.02)
        self.assertAlmostEqual(right, track[1] - 8.0, delta=1.0)
        self.assertIn("stable from 2.8", self.browser.text("#changes"))

    def test_with_another_headway_from_the_page_begins_a_new_run_with_its_verdict(self):
        self.assertIn("String stable", self.browser.text("#verdict"))
        self.browser.run("""const slider = document.getElementById("headway");
            slider.value = 2.4; slider.dispatchEvent(new Event("input")); document.querySelector("[data-command=change]").click()""")
        self.wait_for_page("document.getElementById('verdict').textContent.includes('Not string stable')", "the new verdict")
        self.assertEqual(state(self.url)["headway"], 2.4)
        self.assertIn("a run with headway 0.32 s (3.2 sample periods) -> 0.24 s (2.4 sample periods)", [event["text"] for event in state(self.url)["events"]])
        live_platoon.wait_for(lambda: self.step() > 0, "the first figures of the new run")
        self.steps_on()


if __name__ == "__main__":
    unittest.main()
