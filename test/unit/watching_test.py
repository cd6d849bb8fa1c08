#!/usr/bin/python3
"""Tests of the state of the page and of the terminal's table, without ROS."""

import json
import sys
import tracemalloc
import unittest

import stochastic_platoon as sp

sys.dont_write_bytecode = True
from watching_messages import NAN, burning_in, configuration, endless, message, overview, snapshot, table_of  # noqa: E402
from watching import state, table  # noqa: E402


class State(unittest.TestCase):
    def setUp(self):
        self.state = state.PlatoonState()
        self.state.take_configuration(configuration())

    def test_shows_each_follower_at_the_last_step(self):
        self.state.take_overview(overview(), 0.0)
        document = self.state.document()
        self.assertEqual(document["variance"], [13.0, 23.0, 33.0])
        self.assertEqual(document["theoretical_variance"], [14.0, 24.0, 34.0])
        self.assertEqual((document["step"], document["followers"], document["max_abs_z"]), (3, 3, 2.5))
        self.assertEqual(self.state.give("curves")["variance"], [[10, 11, 12, 13], [20, 21, 22, 23], [30, 31, 32, 33]])

    def test_every_curve_is_empty_before_the_first_figures(self):
        nothing = endless(3, 0)
        nothing.mean = nothing.variance = [NAN] * 3
        self.state.take_overview(nothing, 0.0)
        self.assertIsNone(self.state.document()["step"])
        curves = self.state.give("curves")
        for name in ("mean", "variance", "theoretical_mean", "theoretical_variance"):
            self.assertEqual(curves[name], [[], [], []], name)

    def test_averages_are_provisional_until_the_burn_in_is_over(self):
        self.state.take_configuration(configuration(3, 0))
        for step in (10, 20):
            self.state.take_overview(burning_in(3, step), 0.0)
        document = json.loads(json.dumps(self.state.document(), allow_nan=False))
        self.assertEqual((document["step"], document["mean"], document["variance"]), (None, [None] * 3, [None] * 3))
        self.assertEqual(document["provisional"], {"step": 20, "mean": [0.0, 0.01, 0.02], "variance": [3.0, 4.0, 5.0]})
        curves = self.state.give("curves")
        self.assertEqual((curves["provisional"], curves["step"], curves["variance"][2]), (True, [10, 20], [5.0, 5.0]))
        self.state.take_overview(endless(3, 200, counted_from=200), 0.0)
        self.assertIsNone(self.state.document()["provisional"])
        curves = self.state.give("curves")
        self.assertEqual((curves["provisional"], curves["step"], curves["variance"][2]), (False, [200], [30.0]))

    def test_the_losses_of_a_link_are_named_by_their_kind(self):
        probability = {"probability": 0.1, "on_loss": [1.0], "mean_burst": 3.0}
        for loss, words in ((probability, "loss 0.1, bursts of 3"), ({"runs": "3 1 2 1", "on_loss": [1.0]}, "recorded losses"),
                            ({"by_distance": [[20.0, 0.01], [100.0, 0.2]], "on_loss": [1.0]}, "losses by distance"),
                            ({"markov": {"transition": [[0.9, 0.1], [0.3, 0.7]], "probability": [0.02, 0.7]}, "on_loss": [1.0]},
                             "losses by the states of a chain")):
            self.state.take_configuration(configuration(channel={"loss": loss}))
            self.assertEqual(self.state.document()["link"], "additive noise, " + words)

    def test_a_packet_shows_the_losses_of_its_position(self):
        lossy = {"packet": "v2v", "delay": 2, "loss": {"probability": 0.3, "on_loss": [1.0]}}
        inputs = [{"signal": "position", "noise_variance": 0.01, "weight": 1.0, "channel": lossy},
                  {"signal": "input", "noise_variance": 0.02, "gain": 1.0, "channel": {"packet": "v2v", "delay": 1}}]
        car = {key: value for key, value in sp.Model.load("cacc.yaml").to_dict().items() if key != "noise_variance"}
        self.state.take_configuration(configuration(**dict(car, inputs=inputs)))
        document = self.state.document()
        self.assertEqual(document["link"], "hears position of the predecessor (additive noise, delay 2, loss 0.3); "
                         "input of the predecessor (additive noise, delay 1)")
        self.assertEqual(document["loss"], 0.3)

    def test_missing_figures_are_null(self):
        self.state.take_overview(endless(3, 7), 0.0)
        self.state.take_overview(overview(theory="none", limit_variance=NAN, theoretical_variance=[NAN] * 12), 0.0)
        document = json.loads(json.dumps(self.state.document(), allow_nan=False))
        self.assertEqual((document["string_stable"], document["limit_variance"], document["theoretical_variance"]), (None, None, [None] * 3))

    def test_another_configuration_resets_the_state_and_the_same_one_does_not(self):
        self.state.take_overview(overview(), 0.0)
        self.state.take_snapshot(snapshot(3))
        self.state.take_configuration(configuration())
        self.assertIsNotNone(self.state.give("statistics"))
        self.state.take_configuration(configuration(time_headway=2.4))
        self.assertIsNone(self.state.give("statistics"))
        self.assertIsNone(self.state.give("snapshot"))
        self.assertEqual(self.state.give("strip"), [])
        self.assertEqual(self.state.document()["headway"], 2.4)

    def test_describes_the_string_and_not_the_default_vehicle(self):
        types = {"truck": {"time_headway": 4.0, "noise_variance": 0.5}, "van": {"time_headway": 6.0}}
        self.state.take_configuration(configuration(vehicle_types=types, string=["truck", "van"]))
        document = self.state.document()
        self.assertEqual((document["spacing"], document["noise"]), ("h = 0.4 to 0.6 s (4 to 6 sample periods)", "P_d = 0.5 to 0.6 m^2"))
        self.assertIn("h = 0.4 to 0.6 s (4 to 6 sample periods), P_d = 0.5 to 0.6 m^2, ", table.table(document, 50)[0])

    def test_an_overview_may_come_before_its_configuration(self):
        early = state.PlatoonState()
        early.take_overview(overview(complete=True), 0.0)
        self.assertIsNone(early.give("statistics"))
        early.take_configuration(configuration())
        self.assertTrue(early.document()["complete"])
        # The same holds for the next run.
        early.take_overview(overview(run=2, realizations=7), 0.0)
        self.assertEqual(early.document()["realizations"], 100)
        early.take_configuration(configuration(time_headway=2.4))
        self.assertEqual((early.document()["realizations"], early.document()["headway"]), (7, 2.4))

    def test_the_parameter_is_the_same_configuration_as_the_topic(self):
        fresh, text = state.PlatoonState(), configuration().data
        fresh.take_configuration(message(data=text + "\n"))  # as configure prints it and the master keeps it
        fresh.take_overview(overview(), 0.0)
        fresh.take_configuration(message(data=text))
        fresh.take_overview(overview(), 1.0)
        self.assertEqual(fresh.document()["realizations"], 100)
        self.assertEqual([event["text"] for event in fresh.document()["events"]][1:], ["the first step has arrived"])

    def test_a_late_overview_of_the_previous_run_is_replaced(self):
        self.state.take_overview(overview(run=1), 0.0)
        self.state.take_configuration(configuration(time_headway=2.4))
        self.state.take_overview(overview(run=1), 0.0)
        for realizations in (5, 6):
            self.state.take_overview(overview(run=2, realizations=realizations), 0.0)
        self.assertEqual(self.state.document()["realizations"], 6)

    def test_received_positions_have_a_realization_and_a_step(self):
        self.state.take_received(message(run=1, realization=8, step=5, position=[1.0, NAN]))
        self.assertEqual(self.state.give("received"), {"realization": 8, "step": 5, "position": [1.0, None]})

    def test_the_culprit_is_that_of_the_monitor_until_the_stall_ends(self):
        def diagnostics(name, culprit, retries="0"):
            entries = [message(key="culprit", value=culprit), message(key="retries", value=retries)]
            self.state.take_diagnostics(message(status=[message(name=name, message="", values=entries)]))
        diagnostics("convoy/monitor: monitor", "who knows")
        self.assertIsNone(self.state.document()["culprit"])
        diagnostics("platoon/monitor: monitor", "vehicle_7 has sent nothing since step 12", "5")
        self.assertEqual(self.state.document()["culprit"], "vehicle_7 has sent nothing since step 12")
        self.assertEqual(self.state.document()["retries"], 5)
        self.assertIn("RUN STALLED: vehicle_7 has sent nothing since step 12 (5 retries)", table.table(self.state.document(), 24))
        diagnostics("platoon/monitor: monitor", "")
        self.assertIsNone(self.state.document()["culprit"])

    def texts(self):
        return [event["text"] for event in self.state.document()["events"]]

    def test_a_restart_clears_the_curves_and_is_an_event(self):
        self.state.take_configuration(configuration(3, 0))
        for attempt, steps in ((1, range(0, 300, 10)), (2, range(0, 50, 10))):
            for step in steps:
                self.state.take_overview(endless(3, step, attempt=attempt), step / 10)
        self.assertEqual(self.state.give("curves")["step"], [0, 10, 20, 30, 40])
        document = self.state.document()
        self.assertEqual((document["attempt"], document["restarts"]), (2, 1))
        restart, = [event for event in document["events"] if event["kind"] == "restart"]
        self.assertEqual((restart["step"], restart["text"]), (290, "attempt 2: the platoon restarts at step 0; averages keep the earlier steps"))
        # A restarted monitor has no attempt at first, then the latest one.
        self.state.take_overview(endless(3, 0, attempt=0), 40.0)
        self.state.take_overview(endless(3, 0, attempt=2), 40.0)
        self.state.take_overview(endless(3, 10, attempt=3), 40.0)
        self.assertEqual([event["step"] for event in self.state.document()["events"] if event["kind"] == "restart"], [290, 40])

    def test_the_attempts_of_a_stalled_platoon_are_one_event(self):
        self.state.take_configuration(configuration(3, 0))
        for attempt, step in ((1, 80), (2, 0), (3, 0), (4, 0), (4, 50), (5, 0)):
            self.state.take_overview(endless(3, step, attempt=attempt), 0.0)
        for attempt, realizations in ((1, 8), (2, 8), (3, 8), (3, 16), (4, 16)):
            self.state.take_overview(overview(run=2, attempt=attempt, realizations=realizations), 0.0)
            self.state.take_overview(overview(run=2, attempt=attempt, realizations=realizations), 0.0)
        restarts = [event["text"].split(":")[0] for event in self.state.document()["events"] if event["kind"] == "restart"]
        self.assertEqual(restarts, ["attempts 2 to 4", "attempt 5", "attempts 2 to 3", "attempt 4"])

    def test_changes_orders_and_the_end_of_a_run_are_events(self):
        self.state.take_overview(overview(complete=True), 0.0)
        self.state.take_order("the leader brakes")
        self.state.take_configuration(configuration(time_headway=2.4))
        self.assertEqual(self.texts()[-3:], ["complete", "the leader brakes", "a run with headway 0.32 s (3.2 sample periods) -> 0.24 s (2.4 sample periods)"])
        for _ in range(200):
            self.state.take_order("again")
        self.assertEqual(len(self.texts()), 100)

    def test_the_running_vehicles_are_counted_before_the_first_step(self):
        def start(count, *others):
            self.state.take_topics({"vehicle_{}/position".format(i) for i in range(count)} | set(others))
            return self.state.document()["start"]
        self.assertEqual(start(1), "1 of 4 vehicles are running, missing: vehicle_1, vehicle_2, vehicle_3")
        self.assertEqual(start(4), "all 4 vehicles are running, the monitor starts")
        self.assertEqual(start(4, "overview"), "all 4 vehicles are running, the first step is under way")
        self.assertIn("Starting: all 4", " ".join(table.table(self.state.document(), 24)))
        self.state.take_overview(overview(attempt=0), 0.0)
        self.assertIsNotNone(self.state.document()["start"])
        self.state.take_overview(overview(), 0.0)
        self.assertIsNone(start(2))

    def test_rate_and_time_left(self):
        self.state.take_overview(overview(realizations=100), 10.0)
        self.state.take_overview(overview(realizations=300), 12.0)
        statistics = self.state.give("statistics")
        self.assertEqual(statistics["vehicle_steps_per_second"], 100 * 4 * 3)
        self.assertEqual(statistics["seconds_left"], 7.0)

    def test_memory_does_not_grow_with_the_length_of_a_run(self):
        """Two hours of 20 followers at 10 steps a second; the second hour must not need more memory."""
        self.state.take_configuration(configuration(20, 0))

        def hour(first):
            for step in range(first, first + 36000):
                self.state.take_received(message(run=1, realization=0, step=step, position=[float(step)] * 20))
                self.state.take_snapshot(snapshot(step, 20))
                if step % 10 == 0:
                    self.state.take_overview(endless(20, step), step / 10)

        hour(0)
        tracemalloc.start()
        before = tracemalloc.get_traced_memory()[0]
        hour(36000)
        grown = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
        # tracemalloc counts objects that replace older ones as new: their total is bounded by the size of one state.
        curves, strip = self.state.give("curves"), self.state.give("strip")
        self.assertLessEqual(len(curves["step"]), state.COLUMNS)
        self.assertGreater(len(curves["step"]), state.COLUMNS // 2 - 1)
        self.assertGreater(curves["step"][-1], 70000)
        self.assertEqual(len(strip), state.STRIP)
        self.assertLess(grown, 2e6)

    def test_a_long_string_is_drawn_by_some_of_its_followers(self):
        self.assertEqual(state.drawn_followers(40), list(range(1, 41)))
        drawn = state.drawn_followers(500)
        self.assertEqual((len(drawn), drawn[0], drawn[-1]), (16, 1, 500))


class Table(unittest.TestCase):
    def test_has_a_row_of_mean_variance_error_theory_and_score(self):
        self.assertEqual(table_of(3, 50)[-1].split(), ["3", "3.3", "33", "0.5", "34", "-1.00"])

    def test_gives_times_in_seconds_before_steps(self):
        first, _, second = table_of(3, 50)[:3]
        self.assertIn("h = 0.32 s (3.2 sample periods)", first)
        self.assertIn("0.3 s (step 3), 100 of 1000 realizations", second)
        self.assertIn("averages over time up to 0.3 s (step 3)", " ".join(table_of(3, 50, time_average=True)))

    def test_shows_the_step_of_a_drive_before_its_figures(self):
        known = state.PlatoonState()
        known.take_configuration(configuration(3, 6000))
        known.take_topics({"vehicle_0/position"})
        nothing = [NAN] * 3
        known.take_overview(overview(3, (0,), attempt=0, realizations=0, mean=nothing, variance=nothing), 0.0)
        self.assertIsNotNone(known.document()["start"])
        known.take_snapshot(snapshot(3104))
        document = known.document()
        self.assertEqual((document["start"], document["present"]), (None, {"realization": 0, "step": 3104}))
        known.take_topics({"vehicle_0/position"})
        self.assertIsNone(known.document()["start"])
        self.assertIn("nothing is measured yet: realization 0 at 310.4 s of 599.9 s (step 5999)", " ".join(table.table(document, 50)))

    def test_marks_provisional_averages(self):
        known = state.PlatoonState()
        known.take_configuration(configuration(3, 0))
        known.take_overview(burning_in(3, 20), 0.0)
        lines = table.table(known.document(), 50)
        self.assertEqual(lines[-1].split()[:3], ["3", "~0.02", "~5"])
        self.assertIn("~ provisional averages up to 2 s (step 20), replaced when the burn-in is over: at the earliest at 20 s (step 200)", " ".join(lines))
        known.take_overview(burning_in(3, 30, manoeuvre=True, counted_from=231), 0.0)
        self.assertIn("~ provisional averages, paused while the leader manoeuvres, replaced", " ".join(table.table(known.document(), 50)))
        known.take_overview(endless(3, 200, counted_from=200), 0.0)
        self.assertNotIn("~", " ".join(table.table(known.document(), 50)))

    def test_shows_both_ends_of_a_long_string_within_the_lines(self):
        lines = table_of(500, 24)
        self.assertLessEqual(len(lines), 24)
        self.assertIn("...", lines[-8])
        self.assertEqual(lines[-1].split()[0], "500")

    def test_shows_the_realizations_that_a_verdict_needs(self):
        self.assertIn("no verdict before about 2.9e+04", " ".join(table_of(
            3, 50, max_abs_z_mean=NAN, max_abs_z_variance=NAN, plausible_z=NAN, realizations_needed=29123.0)))
        self.assertNotIn("verdict", " ".join(table_of(3, 50)))

    def test_shows_that_there_is_no_platoon(self):
        self.assertEqual(table.table(state.PlatoonState().document(), 24), ["Waiting for a platoon's monitor"])


if __name__ == "__main__":
    unittest.main()
