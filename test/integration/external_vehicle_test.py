#!/usr/bin/python3
"""External vehicles in the string: the examples, the conformance test check_vehicle, and violations of the vehicle contract."""

import os
import re
import signal
import subprocess
import unittest

import live_platoon
from external import CLAUSES, ExternalTest, HERE, rows
from terminal import kept_master


class Example(ExternalTest):
    SETTINGS = dict(followers=4, steps=50, realizations=2500, batch=1000)

    def assert_equal_within_rounding(self):
        folder = os.path.join(self.output, "reference")
        live_platoon.reference(self.output, **{name: value for name, value in self.SETTINGS.items() if name != "batch"})
        measured, expected = rows(self.output), rows(folder)
        self.assertEqual(measured.keys(), expected.keys())
        for cell, (mean, variance, *_) in expected.items():
            # Positions reach 100 m, where the last bit is 1.4e-14 m; errors are about 0.1 m.
            self.assertLess(abs(measured[cell][0] - mean), 1e-11, cell)
            self.assertLess(abs(measured[cell][1] - variance), 1e-11, cell)

    def test_the_rospy_follower_is_the_built_in_vehicle_within_rounding(self):
        bag = self.path("run.bag")
        terminal = self.launch(external=2, record=bag, **self.SETTINGS)
        terminal.wait_for_text("waiting for external vehicle_2: start its node")
        self.start_example(2)
        summary = self.completed(terminal)
        self.assert_equal_within_rounding()
        self.check_that_theory_speaks_of_vehicle_1_alone(summary, terminal.text())
        self.check_what_reads_the_results(bag)
        self.check_replay(bag)

    def test_the_rospy_follower_with_a_radio_is_the_built_in_vehicle_within_rounding(self):
        model = live_platoon.shared("config", "cacc.yaml")
        self.SETTINGS = dict(self.SETTINGS, model=model)
        self.start(live_platoon.shared("launch", "examples", "rospy_radio_follower.py"), "2")
        self.assert_keeps_the_contract(2, "--model", model)
        bag = self.path("run.bag")
        self.run_to_the_end(external=2, record=bag, **self.SETTINGS)
        self.assert_equal_within_rounding()
        self.assertIn("vehicle_2: 153 messages equal the recorded ones to the bit, and its inputs", self.replayed(bag, 2))
        self.start(live_platoon.shared("launch", "examples", "rospy_radio_follower.py"), "3")
        apart = re.search(r"vehicle_3: 153 messages as in the recording, positions at most (\S+) m apart, inputs at most (\S+) m/s\^2 apart",
                          self.replayed(bag, 3))
        self.assertLess(float(apart.group(1)), 1e-11)
        self.assertLess(float(apart.group(2)), 1e-10)
        self.start_example(1)  # without a radio, which vehicle 2 hears
        self.assertRegex(self.replayed(bag, 1, patience=2.0), r"no verdict: vehicle_1 is not running: no publisher of /platoon/vehicle_1/input")

    def replayed(self, bag, vehicle, **options):
        """What a replay into an external vehicle says; no other vehicle runs."""
        terminal = self.launch("replay.launch", bag=bag, drive="vehicle_{}".format(vehicle), external=vehicle, output="", **options)
        terminal.wait()
        return terminal.text()

    def check_that_theory_speaks_of_vehicle_1_alone(self, summary, said):
        for (vehicle, _), (_, _, mean, variance) in rows(self.output).items():
            self.assertEqual((mean is None, variance is None), (vehicle > 1, vehicle > 1))
        self.assertEqual([value is None for value in summary["theory"]["stationary_variance"]], [False, True, True, True])
        self.assertIs(summary["theory"]["string_stable"], True)
        self.assertIsNone(summary["theory"]["limit_variance"])
        self.assertLess(summary["agreement"]["max_abs_z_variance"], 5.0)
        self.assertIn("over all 50 (i, k)", said)
        self.assertIn("this speaks of follower 1, before vehicle_2, which is external", said)

    def check_what_reads_the_results(self, bag):
        with open(os.path.join(self.output, "statistics.csv")) as file:
            measured = file.read()
        found = live_platoon.tool("bag_statistics", bag, "--csv")
        self.assertEqual((found.returncode, found.stdout), (0, measured))
        checked = live_platoon.tool("check", self.output)
        self.assertIn("in agreement up to follower 1 (largest |z|", checked.stdout, checked.stderr)
        tools = live_platoon.shared("src", "tools")
        subprocess.run([os.path.join(tools, "report"), self.output, "--output", self.path("report.html")], check=True)
        figure = self.path("errors")
        plot = os.path.join(tools, "plot")
        subprocess.run([plot, "errors", self.output, "--output", figure], check=True, stdout=subprocess.DEVNULL)
        self.assertGreater(os.path.getsize(figure + ".png"), 10000)

    def check_replay(self, bag):
        self.assertIn("vehicle_2: 153 messages equal the recorded ones to the bit", self.replayed(bag, 2))
        # The other vehicle was recorded from the built-in implementation.
        self.start_example(3)
        text = self.replayed(bag, 3)
        apart = re.search(r"vehicle_3: 153 messages as in the recording, positions at most (\S+) m apart", text)
        self.assertTrue(apart, text)
        self.assertLess(float(apart.group(1)), 1e-11)

    def test_it_stays_up_from_run_to_run_and_goes_with_one_process(self):
        self.start_example(3)
        self.assert_keeps_the_contract(3, "--headway", "2.4", "--model", live_platoon.shared("config", "mixed.yaml"))
        rejected = self.launch(**self.SETTINGS)
        self.assertNotEqual(rejected.wait(), 0)
        self.assertIn("/platoon/vehicle_3/position: node /vehicle_3 publishes it already: must be outside first:= .. last:=, or in external:=",
                      rejected.text())
        self.run_to_the_end(external=3, hosting="one_process", **self.SETTINGS)
        self.assert_equal_within_rounding()

    def test_the_built_in_vehicle_keeps_it(self):
        # A million vehicles have runs of few steps. A vehicle that hears several subscribes to them once it knows the run.
        for index, options in ((2, ()), (1000000, ()), (3, ("--model", live_platoon.shared("config", "path_cacc.yaml")))):
            name = "vehicle_{}".format(index)
            follower = self.start(live_platoon.executable("follower"), "_index:={}".format(index), "__ns:=/platoon", "__name:=" + name)
            self.assert_keeps_the_contract(index, *options)
            # Unlike SIGTERM, SIGINT lets it unregister. Otherwise the master would keep its address, which a vehicle_2 of another
            # master may then use.
            follower.send_signal(signal.SIGINT)
            follower.wait()


class Contract(ExternalTest):
    def test_the_page_has_the_words_of_the_programs(self):
        with open(live_platoon.shared("msg", "README.md")) as file:
            page = re.findall(r"^\| (\d+) \| (.*?) \|", file.read(), re.M)
        self.start_example(3)
        said = re.findall(r"^ ?(\d+) holds +(.*)$", self.check_vehicle(3).stdout, re.M)
        self.assertEqual(len(said), len(CLAUSES))
        self.assertEqual(page, said)

    def test_each_broken_vehicle_fails_at_its_clause(self):
        faults = [clause for clause in CLAUSES if clause != "one_publisher"] + ["foreign", "twice", "beyond", "place"]
        self.start(os.path.join(HERE, "broken_follower.py"), *["{}:{}".format(i + 1, fault) for i, fault in enumerate(faults)])
        for i, fault in enumerate(faults):
            with self.subTest(fault=fault):
                said = self.assert_broken({"foreign": "run", "twice": "turn", "beyond": "turn", "place": "start_anew"}.get(fault, fault), i + 1)
                # The attempt number is larger if the vehicle misses the first messages while it connects.
                why = {"size": "999 positions, of 1000", "finite": "a NaN or an infinity", "answer": "no answer within 1 s",
                       "place": r": at 0 m, of -{} m, its initial position".format(5 * (i + 1)),
                       "spacing": "m behind a predecessor that drives 2 m per step; due: 15 m, with a standstill distance of 5 m and a headway of 5 steps",
                       "beyond": r"step 200 of the realizations from 0, attempt \d+: the last step is 199",
                       "twice": r"step 6 of the realizations from 0, attempt \d+ was due, and came: step 5"}
                self.assertRegex(said, why.get(fault, "step "))
        second = self.start_example(len(faults))
        live_platoon.wait_for(lambda: live_platoon.process_of("/vehicle_{}".format(len(faults)), kept_master()), "a second publisher")
        self.assertRegex(self.assert_broken("one_publisher", len(faults)), r"/broken_followers_\d+_\d+ and /vehicle_{0} publish /platoon/vehicle_{0}/position".format(len(faults)))
        second.terminate()

    def test_its_input_is_judged_like_its_position_if_a_vehicle_behind_hears_it(self):
        """The model is cacc.yaml, of cars with radios."""
        radio = ("--model", live_platoon.shared("config", "cacc.yaml"))
        step = "/platoon/vehicle_{}/input: step 5 of the realizations from 0, attempt "
        faults = {"size": ("size", step + r"\d+: 999 positions, of 1000"), "finite": ("finite", step + r"\d+: a NaN or an infinity"),
                  "answer": ("answer", step + r"\d+: no answer within 1 s"), "twice": ("turn", step.replace("5", "6") + r"\d+ was due, and came: step 5"),
                  "causal": ("causal", r"/platoon/vehicle_{}/input: step 19 .* m/s\^2, after the same messages at .* the message of the same step")}
        self.start(os.path.join(HERE, "broken_follower.py"), *["{}:input_{}".format(i + 1, fault) for i, fault in enumerate(faults)], "6:attempt")
        for i, (fault, (clause, said)) in enumerate(faults.items()):
            with self.subTest(fault=fault):
                self.assertRegex(self.assert_broken(clause, i + 1, *radio), said.format(i + 1))
        self.assertRegex(self.assert_broken("answer", 6, *radio), "/platoon/vehicle_6/input: step -1 .*: no answer within 1 s")
        self.assertNotIn("input", self.assert_broken("attempt", 6, *radio, "--followers", "6"), "no vehicle behind hears the input")

    def assert_interrupted(self, index, words):
        """Interrupts a check when it prints a line with these words."""
        check = subprocess.Popen([live_platoon.executable("check_vehicle"), str(index)], env=self.environment, stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, universal_newlines=True)
        self.addCleanup(check.stdout.close)
        self.assertIn(words, next(line for line in check.stdout if words in line))
        check.send_signal(signal.SIGINT)
        said = check.stdout.read()
        self.assertEqual(check.wait(), 1)
        self.assertIn("interrupted: no verdict", said)
        self.assertNotIn("BROKEN", said)
        self.assertNotIn("is not running", said)

    def test_an_interrupted_check_gives_no_verdict(self):
        self.start_example(3)
        self.assert_interrupted(3, "holds")
        self.assert_interrupted(4, "waiting for external vehicle_4: start its node")

    def test_a_vehicle_passes_the_check_after_an_interrupted_one(self):
        self.start_example(3)
        self.assert_interrupted(3, "{} holds".format(CLAUSES.index("attempt") + 1))  # the vehicle knows attempts 1 to 7 by then
        self.assert_keeps_the_contract(3)

    def test_a_vehicle_that_is_not_there_or_no_number_is_named(self):
        self.assertIn("vehicle_4 is not running: it must publish /platoon/vehicle_4/position and subscribe to "
                      "/platoon/vehicle_4/predecessor_position", self.check_vehicle(4, "--wait", "0.1").stdout)
        self.assertIn("waiting for external vehicle_4: start its node", self.check_vehicle(4, "--wait", "0.1").stdout)
        radio = self.check_vehicle(4, "--wait", "0.1", "--model", live_platoon.shared("config", "cacc.yaml")).stdout
        self.assertIn("subscribe to /platoon/vehicle_4/predecessor_position, /platoon/vehicle_4/predecessor_input", radio)
        for word in ("0", "three", "3.0"):
            done = self.check_vehicle(word)
            self.assertEqual(done.returncode, 1)
            self.assertIn("vehicle: {}: must be a whole number from 1 to 1000000".format(word), done.stdout)

    def test_the_monitor_names_it_with_the_clause_and_the_run_goes_on(self):
        self.start(os.path.join(HERE, "broken_follower.py"), "2:each")
        terminal = self.run_to_the_end(followers=3, external=2, steps=20, realizations=700, batch=100, stall_timeout=0.5)
        said = terminal.text()
        stands = r"run stalled: vehicle_2 has sent nothing since step {} \(realizations from {}\); the vehicle is external: {}clause {} of the"
        self.assertRegex(said, stands.format(4, 100, "", 2))
        for step, first, what, number in ((5, 200, "out of turn", 6), (4, 300, "of a wrong batch size", 3), (4, 400, "not finite", 4),
                                          (4, 500, "of another run", 11)):
            self.assertRegex(said, stands.format(step, first, "its last message was dropped, as {}; ".format(what), number))
        self.assertRegex(said, r"/platoon/vehicle_2/position: dropped a message that is out of turn: .*vehicle_2 is external: it violates clause 6 of")
        summary = live_platoon.completed_summary(self.output)
        self.assertEqual(summary["positions_lost"], 0)
        # One more attempt for each violation from the second on, independent of the attempts at start-up.
        second = re.search(r"/platoon/vehicle_2/position: dropped a message that is out of turn: attempt (\d+), realizations from 200,", said)
        self.assertEqual(summary["attempts"], int(second.group(1)) + 4)

    def test_the_run_goes_on_after_a_message_of_an_attempt_that_the_leader_could_not_follow(self):
        self.start(os.path.join(HERE, "broken_follower.py"), "2:last_attempt")
        terminal = self.run_to_the_end(followers=3, external=2, steps=20, realizations=300, batch=100, stall_timeout=0.5)
        self.assertRegex(terminal.text(), r"/platoon/vehicle_2/position: dropped a message that is out of turn: attempt 4294967295, ")
        self.assertEqual(live_platoon.completed_summary(self.output)["positions_lost"], 0)

    def test_a_vehicle_that_never_answers_is_named_once_however_often_the_leader_retries(self):
        self.start(os.path.join(HERE, "broken_follower.py"), "2:mute")
        terminal = self.launch(followers=3, external=2, steps=20, realizations=100, rate=100, stall_timeout=0.5)
        terminal.wait_for_text("run stalled: vehicle_2 has sent nothing at all; the vehicle is external: clause 2 of the vehicle contract", 40)
        terminal.interrupt()
        self.assertEqual(terminal.text().count("run stalled: vehicle_2 has sent nothing at all"), 1)

    def test_the_recorder_names_a_vehicle_without_stamps(self):
        self.start(os.path.join(HERE, "broken_follower.py"), "2:unstamped")
        terminal = self.launch(followers=2, external=2, realizations=10, record=self.path("run.bag"))
        terminal.wait_for_text("/platoon/vehicle_2/position: dropped a message without a stamp, which a bag cannot hold; clause 5 of the vehicle")
        terminal.interrupt()

    def test_the_monitor_names_a_second_publisher(self):
        self.start_example(2)
        self.start(os.path.join(HERE, "broken_follower.py"), "2:none")
        terminal = self.run_to_the_end(followers=2, external=2, steps=20, realizations=500, batch=10)
        self.assertRegex(terminal.text(), r"/platoon/vehicle_2/position has two publishers: .*; the vehicle is external: clause 1 of the vehicle contract: ")


if __name__ == "__main__":
    unittest.main()
