#!/usr/bin/python3
"""The states of the page in headless Chromium at the sizes of a laptop and of a phone, for 20, 100 and 500 followers. The test
feeds the page's server with messages of a simulated platoon. PICTURES=FOLDER keeps a screenshot of each state."""

import math
import unittest

import stochastic_platoon as sp

import live_platoon
from page_feed import BURN_IN, Fed, configuration, endless, message, snapshot

OUTSIDE = """return [...document.querySelectorAll("#controls button, #controls input, #pause, #verdict")].filter(element => {
  const {left, top, right, bottom} = element.getBoundingClientRect();
  return left < 0 || top < 0 || right > innerWidth || bottom > innerHeight;
}).map(element => element.id || element.textContent)"""
# The highest and the lowest y of the error bars.
WHISKERS = """const box = document.querySelector("path.whiskers:not(.halo)").getBBox(); return [box.y, box.y + box.height]"""


class States(Fed):
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
            self.assertIn("spacingh = 0.32 s (3.2 sample periods)", self.browser.text("#facts"))
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

    def test_constant_spacing_has_no_headway_and_arcs_lead_from_those_heard_to_the_chosen_vehicle(self):
        self.begin(6, **sp.Model.load("leader_and_predecessor.yaml").to_dict())
        self.drive(range(BURN_IN, BURN_IN + 20))
        self.open()
        self.wait_for_page("document.getElementById('road').dataset.heard === '0'", "the arc from the leader to the last vehicle")
        self.text_comes("#facts", "spacingconstant spacing of 9.2 m")
        for _ in self.at_both_sizes("constant-spacing"):
            self.assertTrue(self.browser.run("return document.getElementById('headway').closest('label').hidden"))
        self.assertFalse(self.browser.run("return document.getElementById('noise_variance').closest('label').hidden"))

    def test_an_arc_leads_from_the_vehicle_two_ahead(self):
        self.begin(6, **sp.Model.load("two_ahead.yaml").to_dict())
        self.drive(range(BURN_IN, BURN_IN + 20))
        self.open()
        self.wait_for_page("document.getElementById('road').dataset.heard === '4'", "the arc")
        self.assertFalse(self.browser.run("return document.getElementById('headway').closest('label').hidden"))

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

    def test_a_small_noise_has_a_slider_of_its_size_and_is_shown_with_its_digits(self):
        self.begin(5, noise_variance=0.0123)
        self.drive(range(BURN_IN, BURN_IN + 20))
        self.open()
        self.text_comes("output[for=noise_variance]", "0.0123")
        self.browser.run("const slider = document.getElementById('noise_variance'); slider.value = 2 * 0.0123; slider.dispatchEvent(new Event('input'))")
        self.text_comes("output[for=noise_variance]", "0.0246")
        self.begin(5)
        self.text_comes("output[for=noise_variance]", "0.6")

    def test_sliders_show_what_the_vehicles_of_the_string_have_and_those_that_change_none_are_hidden(self):
        self.begin(7, **sp.Model.load("cars_and_trucks.yaml").to_dict())
        self.drive(range(BURN_IN, BURN_IN + 20))
        self.open()
        self.text_comes("output[for=loss]", "0 to 0.1")
        self.text_comes("output[for=headway]", "3.5 to 4 = 70 to 80 samples")
        self.browser.run("const slider = document.getElementById('loss'); slider.value = 0.2; slider.dispatchEvent(new Event('input'))")
        self.assertEqual(self.browser.text("output[for=loss]"), "0.2")
        self.begin(7, **sp.Model.load("by_distance.yaml").to_dict())
        self.text_comes("output[for=loss]", "\N{EN DASH}")
        self.begin(7, vehicle_types={"a": {"time_headway": 5.0, "noise_variance": 0.1}}, string=["a"])
        self.wait_for_page("document.getElementById('headway').closest('label').hidden", "no headway to change")
        self.assertTrue(self.browser.run("return document.getElementById('noise_variance').closest('label').hidden"))
        self.assertFalse(self.browser.run("return document.getElementById('loss').closest('label').hidden"))

    def test_all_vehicles_are_in_sight_while_a_stop_travels_along_the_string(self):
        self.begin(20, vehicle_length=4.5)
        self.drive(range(BURN_IN, BURN_IN + 11))
        self.open()
        gaps = 10 * [7.5] + 10 * [60.0]
        of = snapshot(BURN_IN + 11, 20)
        of.position = [2000.0 - sum(gaps[:i]) for i in range(21)]
        self.state.take_snapshot(of)
        self.browser.show_as(1366, 768)  # one lane
        self.wait_for_page("{} * document.getElementById('road').dataset.metre < document.getElementById('road').clientWidth".format(sum(gaps)), "the string")

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
        self.text_comes("#string-note", "theory; burn-in until 20 s (step 200), in 20 s of driving")

    def check_provisional(self, followers):
        pale = "document.querySelectorAll('#string rect.provisional').length"
        self.begin(followers)
        nothing = [math.nan] * followers
        early = [2.0 + math.sin(i) for i in range(followers)]
        self.drive(range(0, 100), mean=nothing, variance=nothing, standard_error=nothing, variance_score=nothing, provisional_mean=[0.1] * followers, provisional_variance=early)
        self.open()
        self.wait_for_page("{} == {}".format(pale, followers), "pale bars")
        self.browser.run("document.getElementById('table-card').open = true")
        for _ in self.at_both_sizes("provisional-{}".format(followers)):
            self.text_comes("#string-note", "provisional averages up to 9 s (step 90): burn-in until 20 s (step 200), in 11 s of driving")
            self.text_comes("#curves-note", "provisional averages up to k")
            self.text_comes("#string-key", "provisional, until the burn-in is over")
            self.text_comes("#table tbody tr:nth-child(2) td:nth-child(3)", "~ 2.84147")
            self.assertEqual(self.browser.run("return ['string-key', 'curves-key'].map(key => document.getElementById(key).hidden)"), [False, False])
            self.assertGreater(self.browser.run("return document.querySelector('#string rect').getBoundingClientRect().height"), 3)
        self.browser.run("document.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true}))")
        self.text_comes("#readout", "Follower 1: provisional variance 2 m")
        self.drive(range(100, 101), mean=nothing, variance=nothing, provisional_mean=[0.1] * followers, provisional_variance=early, manoeuvre=True, counted_from=301)
        self.text_comes("#string-note", "provisional averages, paused while the leader manoeuvres: burn-in at the earliest until 30.1 s (step 301), in 20.1 s of driving")
        self.drive(range(BURN_IN, BURN_IN + 11))
        self.wait_for_page(pale + " == 0", "full bars")
        self.text_comes("#string-note", "averages over time up to 21 s (step 210)")
        self.assertEqual(self.browser.run("return ['string-key', 'curves-key'].map(key => document.getElementById(key).hidden)"), [True, True])
        self.assertNotIn("~", self.browser.text("#table"))

    def test_averages_are_provisional_and_pale_until_the_burn_in_is_over(self):
        self.check_provisional(5)

    def test_provisional_averages_of_100_followers(self):
        self.check_provisional(100)

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
            self.text_comes("#string-note", "averages paused: burn-in after a manoeuvre or restart, until 20 s (step 200), in 15 s of driving")
        curves = self.state.give("curves")
        self.assertEqual(curves["step"], [0, 10, 20, 30, 40, 50])
        self.assertEqual(self.state.document()["restarts"], 1)

    def test_during_a_manoeuvre_the_averages_are_paused(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 100))
        self.drive(range(BURN_IN + 100, BURN_IN + 121), manoeuvre=True, counted_from=540)
        self.open()
        for _ in self.at_both_sizes("manoeuvre"):
            self.text_comes("#string-note", "averages paused: the leader manoeuvres; at the earliest until 54 s (step 540), in 22 s of driving")
            self.text_comes("#log", "step 300: the leader manoeuvres: averages are paused")
        self.drive(range(330, 331), counted_from=550)
        self.text_comes("#string-note", "averages paused: burn-in after a manoeuvre or restart, until 55 s (step 550)")
        self.drive(range(550, 551), counted_from=550)
        self.text_comes("#string-note", "averages over time up to 55 s (step 550)")
        self.text_comes("#log", "step 550: averages go on")

    def test_a_stopped_follower_is_named_and_vehicles_that_overlap_are_marked(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 100))
        self.open()
        entries = [message(key="culprit", value="vehicle_3 has sent nothing since step 299"), message(key="retries", value="2")]
        self.state.take_diagnostics(message(status=[message(name="platoon/monitor: monitor", message="", values=entries)]))
        of = snapshot(300, 20)
        of.position = [600.0 - 6.4 * i - (9.0 if i == 2 else 4.0 if i == 8 else 0.0) for i in range(21)]  # vehicle 2 is behind vehicle 3
        self.state.take_snapshot(of)
        for _ in self.at_both_sizes("stopped"):
            self.text_comes("#culprit", "Run stalled: vehicle_3 has sent nothing since step 299 (2 retries)")
            self.text_comes("#log", "run stalled: vehicle_3")
            self.text_comes("#road-note", "1 overlapping: 3")  # a point 2.4 m behind vehicle 8 does not touch it
            self.text_comes("#conduct", "The cars: follower 3 overlaps the vehicle ahead")
            self.text_comes("#body-length", "gap below 0, vehicles without length")
            self.wait_for_page("document.getElementById('road').dataset.overlaps === '3'", "the mark")
            # Only those that overlap are drawn so, once the drawn vehicles have moved to their positions.
            live_platoon.wait_for(lambda: self.touching() == [3], "vehicle 3 alone to touch the one ahead", 20.0)

    def touching(self):
        """The vehicles that are drawn over the one ahead."""
        bodies = self.browser.run("return JSON.parse(document.getElementById('road').dataset.places)")
        return [i + 1 for i, ((x, lane, long), (behind, same, other)) in enumerate(zip(bodies, bodies[1:]))
                if lane == same and x - long / 2 < behind + other / 2 - 1]

    def test_what_the_cars_do_stands_beside_the_verdict(self):
        self.begin(20, vehicle_length=4.5)
        self.drive(range(BURN_IN, BURN_IN + 21))
        self.open()
        self.text_comes("#conduct", "\N{CHECK MARK} The cars: no collision or reversing seen; strongest acceleration seen ")
        of = snapshot(BURN_IN + 21, 20)
        of.position = [600.0 - 6.4 * i - (2.0 if i == 2 else 0.0) for i in range(21)]
        of.speed = [20.0] * 20 + [-3.0]
        self.state.take_snapshot(of)
        for _ in self.at_both_sizes("conduct"):
            self.text_comes("#conduct", "\N{BALLOT X} The cars: follower 3 overlaps the vehicle ahead; follower 20 reverses; strongest acceleration seen -2")
            self.assertEqual(self.browser.run("return document.getElementById('conduct').dataset.possible"), "false")
            self.wait_for_page("document.getElementById('road').dataset.overlaps === '3'", "the mark")
            self.assertEqual(self.browser.text("#body-length"), "gap below 0, length 4.5 m")
        self.begin(20)
        self.wait_for_page("document.getElementById('conduct').hidden", "nothing of the previous run")

    def test_orders_show_what_the_leader_reaches_in_real_units(self):
        self.begin(5, **sp.Model.load("acc_limits.yaml").to_dict())
        self.drive(range(BURN_IN, BURN_IN + 21))
        self.open()
        for command, words in (("brake", "4 m/s\N{SUPERSCRIPT TWO} until it stands"), ("sinusoid", "\N{PLUS-MINUS SIGN} 2 m/s in 10 s"),
                               ("accelerate", "2 m/s\N{SUPERSCRIPT TWO}, 10 m/s faster, to 40 m/s at most"),
                               ("cruise", "back, by -2 to 2 m/s\N{SUPERSCRIPT TWO}"), ("speed", "0 to 40 m/s, by -6 to 3 m/s\N{SUPERSCRIPT TWO}")):
            self.text_comes("[data-command={}] small".format(command), words)
        valid = "const speed = document.getElementById('speed'); speed.value = arguments[0]; return speed.checkValidity()"
        self.assertEqual([self.browser.run(valid, speed) for speed in (-1, 0, 40, 41)], [False, True, True, False])
        for _ in self.at_both_sizes("orders"):
            self.assertEqual(self.browser.run(OUTSIDE), [], "out of sight")
        self.begin(5)
        self.text_comes("[data-command=speed] small", "cars reach 60 m/s, at once")
        self.text_comes("[data-command=sinusoid] small", "\N{PLUS-MINUS SIGN} 2 m/s in 1 s")

    def test_a_paced_drive_shows_its_step_before_the_first_figures(self):
        self.followers = 5
        self.state.take_configuration(configuration(5, 6000, run={"rate": 10.0, "realizations": 1}))
        nothing = [math.nan] * 5
        waiting = dict(attempt=0, mean=nothing, variance=nothing, time_average=False, realizations=0, standard_error=nothing, variance_score=nothing)
        self.state.take_overview(endless(5, 0, **waiting), 0.0)
        self.state.take_topics({"vehicle_{}/position".format(i) for i in range(6)} | {"overview"})
        self.open()
        self.text_comes("#string-note", "the first step is under way")
        self.state.take_snapshot(snapshot(3104, 5))
        self.state.take_topics({"vehicle_{}/position".format(i) for i in range(6)} | {"overview"})
        for _ in self.at_both_sizes("paced"):
            self.text_comes("#facts", "time t310.4 s of 599.9 s (step 5999)")
            self.text_comes("#string-note", "theory; the first figures appear when a batch of realizations is complete, behind 599.9 s (step 5999)")

    def test_header_and_strip_show_the_same_step(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 58))
        self.open()
        self.text_comes("#facts", "time t25.7 s")
        self.assertEqual(self.browser.run("return document.getElementById('strip').dataset.step"), "257")

    def test_a_paused_page_stands_still_and_then_shows_everything(self):
        self.begin(20)
        self.drive(range(BURN_IN, BURN_IN + 21))
        self.open()
        self.text_comes("#facts", "time t22 s")
        self.browser.run("document.getElementById('pause').click()")
        self.text_comes("#connection", "paused")
        live_platoon.wait_for(lambda: self.state.take_order("an order") or not self.server.streams.streams, "the end of its stream", 20.0)
        self.drive(range(BURN_IN + 21, BURN_IN + 41))
        self.assertIn("time t22 s", self.browser.text("#facts"))
        self.browser.run("document.getElementById('pause').click()")
        self.text_comes("#facts", "time t24 s")
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


if __name__ == "__main__":
    unittest.main()
