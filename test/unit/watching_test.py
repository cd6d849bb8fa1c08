#!/usr/bin/python3
"""Tests of the modules behind the dashboard and `watch`, without ROS: bounded memory, message order, foreign requests."""

import http.client
import json
import math
import os
import re
import socket
import subprocess
import sys
import threading
import time
import tracemalloc
import types
import unittest

import stochastic_platoon as sp

sys.dont_write_bytecode = True
TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "src", "tools")
sys.path.insert(0, TOOLS)

from watching import description, server, state, table  # noqa: E402

NAN = math.nan
RUN = {"realizations": 1000, "batch": 100, "rate": 0.0, "seed": 1, "hosting": "processes", "output": "/tmp/run", "burn_in": 200,
       "resume": False, "first_realization": 0, "record": "", "record_split_mb": 0, "record_compression": "none", "launch_id": "1",
       "window": 16, "stall_timeout": 2.0}


def message(**fields):
    return types.SimpleNamespace(**fields)


def configuration(followers=3, steps=4, **model):
    document = dict(sp.Model.load("paper.yaml").to_dict(), **model)
    return message(data=json.dumps({"version": sp.__version__, "model": document, "run": dict(RUN, followers=followers, steps=steps)}))


def overview(followers=3, step=(0, 1, 2, 3), **changes):
    cells = [float(10 * i + j) for i in range(1, followers + 1) for j in range(len(step))]
    of = dict(run=1, attempt=1, manoeuvre=False, counted_from=0, realizations=100, time_average=False, complete=False, wall_seconds=1.5, theory="exact", string_stable=True, undecided=False,
              reason="string stable: because", limit_variance=2.5, stationary_variance=[2.0] * followers, step=list(step),
              mean=[0.1 * c for c in cells], variance=cells, stable_headways=[0.5, 1.0, 2.8, 320.0], theoretical_mean=[0.0] * len(cells), theoretical_variance=[c + 1 for c in cells],
              standard_error=[0.5] * followers, variance_score=[-1.0] * followers, max_abs_z_mean=1.5, max_abs_z_variance=2.5,
              plausible_z=4.0, realizations_needed=NAN, smallest_gap=[], smallest_gap_realization=[], smallest_gap_step=[], collisions=[],
              collision_bound=[])
    return message(**dict(of, **changes))


def endless(followers, step, **changes):
    of = dict(time_average=True, realizations=1, standard_error=[NAN] * followers, variance_score=[NAN] * followers,
              max_abs_z_mean=NAN, max_abs_z_variance=NAN, plausible_z=NAN)
    return overview(followers, (step,), **dict(of, **changes))


def snapshot(step, followers=3, realization=0, run=1):
    return message(run=run, realization=realization, step=step, position=[2.0 * step - 6.4 * i for i in range(followers + 1)],
                   tracking_error=[0.25 * i for i in range(followers)], speed=[20.0 + i for i in range(followers + 1)])


class Configuration(unittest.TestCase):
    def test_a_radio_is_described_and_its_loss_is_the_one_to_change(self):
        found = description.described(configuration(**sp.Model.load("cacc.yaml").replace(loss=0.1).to_dict()).data)
        self.assertEqual(found["link"], "additive noise, radio with additive noise, delay 2, loss 0.1")
        self.assertEqual(found["loss"], 0.1)
        self.assertTrue(found["headway_in_seconds"])
        self.assertFalse(description.described(configuration().data)["headway_in_seconds"])

    def test_losses_by_distance_have_no_probability_to_change(self):
        found = description.described(configuration(**sp.Model.load("by_distance.yaml").to_dict()).data)
        self.assertEqual((found["link"], found["loss"]), ("additive noise, losses by distance", None))

    def test_a_platoon_of_another_version_is_named(self):
        known = state.PlatoonState()
        known.take_configuration(message(data=configuration().data.replace(sp.__version__, "0.1.9")))
        self.assertIn("version: 0.1.9: must be " + sp.__version__, " ".join(table.table(known.document(), 24)))


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

    def test_before_the_first_figures_every_curve_is_there_and_empty(self):
        nothing = endless(3, 0)
        nothing.mean = nothing.variance = [NAN] * 3
        self.state.take_overview(nothing, 0.0)
        self.assertIsNone(self.state.document()["step"])
        curves = self.state.give("curves")
        for name in ("mean", "variance", "theoretical_mean", "theoretical_variance"):
            self.assertEqual(curves[name], [[], [], []], name)

    def test_what_does_not_exist_is_null(self):
        self.state.take_overview(endless(3, 7), 0.0)
        self.state.take_overview(overview(theory="none", limit_variance=NAN, theoretical_variance=[NAN] * 12), 0.0)
        document = json.loads(json.dumps(self.state.document(), allow_nan=False))
        self.assertEqual((document["string_stable"], document["limit_variance"], document["theoretical_variance"]), (None, None, [None] * 3))

    def test_another_configuration_begins_anew_and_the_same_one_does_not(self):
        self.state.take_overview(overview(), 0.0)
        self.state.take_snapshot(snapshot(3))
        self.state.take_configuration(configuration())
        self.assertIsNotNone(self.state.give("statistics"))
        self.state.take_configuration(configuration(time_headway=2.4))
        self.assertIsNone(self.state.give("statistics"))
        self.assertIsNone(self.state.give("snapshot"))
        self.assertEqual(self.state.give("strip"), [])
        self.assertEqual(self.state.document()["headway"], 2.4)

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

    def test_a_late_overview_of_the_run_before_does_not_stay(self):
        self.state.take_overview(overview(run=1), 0.0)
        self.state.take_configuration(configuration(time_headway=2.4))
        self.state.take_overview(overview(run=1), 0.0)
        for realizations in (5, 6):
            self.state.take_overview(overview(run=2, realizations=realizations), 0.0)
        self.assertEqual(self.state.document()["realizations"], 6)

    def test_what_followers_were_told_is_of_a_step_as_positions_are(self):
        self.state.take_told(message(run=1, realization=8, step=5, position=[1.0, NAN]))
        self.assertEqual(self.state.give("told"), {"realization": 8, "step": 5, "position": [1.0, None]})

    def test_the_culprit_is_the_monitors_and_goes_when_it_is_over(self):
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

    def test_a_restart_begins_the_curves_anew_and_is_an_event(self):
        self.state.take_configuration(configuration(3, 0))
        for attempt, steps in ((1, range(0, 300, 10)), (2, range(0, 50, 10))):
            for step in steps:
                self.state.take_overview(endless(3, step, attempt=attempt), step / 10)
        self.assertEqual(self.state.give("curves")["step"], [0, 10, 20, 30, 40])
        document = self.state.document()
        self.assertEqual((document["attempt"], document["restarts"]), (2, 1))
        restart, = [event for event in document["events"] if event["kind"] == "restart"]
        self.assertEqual((restart["step"], restart["text"]), (290, "attempt 2: the platoon begins again at step 0; averages keep the steps before"))
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

    def test_averages_are_paused_during_a_manoeuvre_and_a_burn_in_behind_it(self):
        self.state.take_configuration(configuration(3, 0))
        known = []
        for step, manoeuvre, counted_from in ((290, False, 200), (300, True, 501), (310, True, 511), (320, False, 520), (519, False, 520), (520, False, 520)):
            self.state.take_overview(endless(3, step, manoeuvre=manoeuvre, counted_from=counted_from), 0.0)
            known.append((self.state.document()["manoeuvre"], self.state.document()["paused_until"]))
        self.assertEqual(known, [(False, None), (True, 501), (True, 511), (False, 520), (False, 520), (False, None)])
        self.assertEqual(self.texts()[-3:], ["the leader manoeuvres: averages are paused", "the manoeuvre is over: averages go on at step 520",
                                             "averages go on"])
        self.state.take_overview(endless(3, 600, counted_from=800), 0.0)  # it began and ended between two overviews
        self.assertEqual(self.texts()[-2:], ["the leader manoeuvres: averages are paused", "the manoeuvre is over: averages go on at step 800"])
        self.assertIn("averages over time up to step 600 (60 s), burn-in: paused until step 800", table.table(self.state.document(), 24)[2])

    def test_changes_orders_and_the_end_of_a_run_are_events(self):
        self.state.take_overview(overview(complete=True), 0.0)
        self.state.take_order("the leader brakes")
        self.state.take_configuration(configuration(time_headway=2.4))
        self.assertEqual(self.texts()[-3:], ["complete", "the leader brakes", "a run with headway 3.2 sample periods -> 2.4 sample periods"])
        for _ in range(200):
            self.state.take_order("again")
        self.assertEqual(len(self.texts()), 100)

    def test_before_the_first_step_it_counts_the_vehicles_that_are_there(self):
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
                self.state.take_told(message(run=1, realization=0, step=step, position=[float(step)] * 20))
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
    def lines(self, followers, lines, **changes):
        known = state.PlatoonState()
        known.take_configuration(configuration(followers))
        known.take_overview(overview(followers, **changes), 0.0)
        return table.table(known.document(), lines)

    def test_has_a_row_of_mean_variance_error_theory_and_score(self):
        self.assertEqual(self.lines(3, 50)[-1].split(), ["3", "3.3", "33", "0.5", "34", "-1.00"])

    def test_gives_times_in_seconds_beside_steps(self):
        first, _, second = self.lines(3, 50)[:3]
        self.assertIn("h = 3.2 (0.32 s)", first)
        self.assertIn("step 3 (0.3 s), 100 of 1000 realizations", second)
        self.assertIn("averages over time up to step 3 (0.3 s)", " ".join(self.lines(3, 50, time_average=True)))

    def test_of_a_long_string_has_both_ends_in_as_many_lines_as_there_are(self):
        lines = self.lines(500, 24)
        self.assertLessEqual(len(lines), 24)
        self.assertIn("...", lines[-8])
        self.assertEqual(lines[-1].split()[0], "500")

    def test_says_how_many_realizations_a_verdict_needs(self):
        self.assertIn("no verdict before about 2.9e+04", " ".join(self.lines(
            3, 50, max_abs_z_mean=NAN, max_abs_z_variance=NAN, plausible_z=NAN, realizations_needed=29123.0)))
        self.assertNotIn("verdict", " ".join(self.lines(3, 50)))

    def test_without_a_platoon_says_so(self):
        self.assertEqual(table.table(state.PlatoonState().document(), 24), ["Waiting for a platoon's monitor"])


class Served(unittest.TestCase):
    def setUp(self):
        self.state = state.PlatoonState()
        self.asked = []
        self.server = server.PageServer("localhost", 0, self.state, self.obey, os.path.join(TOOLS, "watching", "page"))
        thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        self.addCleanup(self.server.closing.set)
        self.own = "localhost:{}".format(self.server.server_port)

    def obey(self, content):
        self.asked.append(content)
        return True, "done"

    def ask(self, method, path, body=None, **headers):
        connection = http.client.HTTPConnection("localhost", self.server.server_port, timeout=10)
        self.addCleanup(connection.close)
        connection.putrequest(method, path, skip_host=True)
        for name, value in dict({"Host": self.own}, **headers).items():
            connection.putheader(name.replace("_", "-"), value)
        if body is not None:
            connection.putheader("Content-Length", str(len(body)))
        connection.endheaders(body)
        answer = connection.getresponse()
        return answer.status, answer.read()

    def test_serves_its_page_and_every_file_that_the_page_names(self):
        status, page = self.ask("GET", "/")
        self.assertEqual(status, 200)
        self.assertNotRegex(page.decode(), r"(src|href)=\"(https?:)?//")
        for path in ("/style.css", "/main.js", "/words.js", "/icon.svg"):
            self.assertEqual(self.ask("GET", path)[0], 200, path)
        for path in ("/../server.py", "/..%2fserver.py", "/server.py", "//etc/passwd", "/index.htm"):
            self.assertEqual(self.ask("GET", path)[0], 404, path)

    def test_takes_commands_of_its_own_page_only(self):
        body, kind = b'{"command": "brake"}', "application/json"
        own = "http://" + self.own
        for headers in ({"Origin": own}, {}):
            self.assertEqual(self.ask("POST", "/command", body, Content_Type=kind, **headers)[0], 200)
        self.assertEqual(self.asked, [{"command": "brake"}] * 2)
        for origin in ("http://evil.example", "http://localhost:1", "https://" + self.own + ".evil.example", "null", ""):
            self.assertEqual(self.ask("POST", "/command", body, Content_Type=kind, Origin=origin)[0], 403, origin)
        # A page of another origin can send this without a preflight request.
        self.assertEqual(self.ask("POST", "/command", body, Content_Type="text/plain", Origin=own)[0], 415)
        self.assertEqual(len(self.asked), 2)

    def test_refuses_a_name_that_was_rebound_to_this_machine(self):
        for host in ("evil.example", "evil.example:80", "localhost.evil.example", "", "[", "127.0.0.1.evil.example"):
            for method, path, body in (("POST", "/command", b"{}"), ("GET", "/", None), ("GET", "/state.json", None), ("GET", "/events", None)):
                status, _ = self.ask(method, path, body, Host=host, Origin="http://" + host, Content_Type="application/json")
                self.assertEqual(status, 421, (host, path))
        for host in ("127.0.0.1", "localhost:9999", "[::1]:80", "LOCALHOST"):
            self.assertEqual(self.ask("GET", "/state.json", Host=host)[0], 200, host)
        self.assertEqual(self.asked, [])

    def test_refuses_what_is_no_command(self):
        for body in (b"", b"[]", b"nonsense", b'{"command": ' + b" " * 5000 + b"1}", b"\xff\xfe", b"[" * 4000):
            self.assertEqual(self.ask("POST", "/command", body, Content_Type="application/json")[0], 400, body[:20])
        self.assertEqual(self.ask("POST", "/", b"{}", Content_Type="application/json")[0], 404)
        self.assertEqual(self.asked, [])

    def test_one_page_too_many_is_told_so_and_a_place_that_is_left_is_free(self):
        streams = [self.server.streams.open(()) for _ in range(server.MOST_PAGES)]
        status, text = self.ask("GET", "/events")
        self.assertEqual(status, 503)
        self.assertIn("pages are open already", text.decode())
        self.server.streams.close(streams[0])
        self.assertIsNotNone(self.server.streams.open(()))

    def test_a_page_that_does_not_read_holds_the_latest_news_only(self):
        self.state.take_configuration(configuration())
        stream = self.server.streams.open(self.state.KINDS)
        stream.take(0)
        for step in range(1000):
            self.state.take_snapshot(snapshot(step))
            self.server.streams.send("snapshot")
        items = stream.take(0)
        self.assertEqual([kind for kind, _ in items], ["snapshot"])
        self.assertEqual(json.loads(items[0][1])["step"], 999)


    def test_a_command_that_fails_is_answered_with_the_reason(self):
        def fail(content):
            raise OverflowError("int too large to convert to float")
        self.server.obey = fail
        status, text = self.ask("POST", "/command", b'{"command": "brake"}', Content_Type="application/json")
        self.assertEqual((status, json.loads(text)["message"]), (500, "OverflowError: int too large to convert to float"))


STARVED = """
import os, resource, sys
sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[1])
from watching import server, state
pages = server.PageServer("localhost", 0, state.PlatoonState(), None, os.path.join(sys.argv[1], "watching", "page"))
print(pages.server_port, flush=True)
most = max(map(int, os.listdir("/proc/self/fd"))) + 5
resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
pages.serve_forever()
"""


class Starved(unittest.TestCase):
    def seconds_of_work(self, process):
        with open("/proc/{}/stat".format(process)) as file:
            words = file.read().rsplit(")", 1)[1].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def test_without_a_free_descriptor_it_answers_with_the_reason_and_does_not_spin(self):
        child = subprocess.Popen([sys.executable, "-c", STARVED, TOOLS], stdout=subprocess.PIPE, universal_newlines=True)
        self.addCleanup(child.stdout.close)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)
        port = int(child.stdout.readline())
        pages = [socket.create_connection(("localhost", port), timeout=30) for _ in range(12)]  # one descriptor each
        for page in pages:
            self.addCleanup(page.close)
            page.sendall(b"GET /events HTTP/1.0\r\nHost: localhost\r\n\r\n")
        answers = [page.recv(1000).decode() for page in pages]
        served = [answer.startswith("HTTP/1.0 200") for answer in answers]
        self.assertTrue(served[0] and not served[-1], answers)
        self.assertIn("503", answers[-1])
        self.assertIn("no file descriptor is free: close some pages, or try again", answers[-1] + pages[-1].recv(1000).decode())
        waiting = socket.create_connection(("localhost", port), timeout=30)
        self.addCleanup(waiting.close)
        before, began = self.seconds_of_work(child.pid), time.monotonic()
        time.sleep(2.0)
        share = (self.seconds_of_work(child.pid) - before) / (time.monotonic() - began)
        self.assertLess(share, 0.5, "it spins")
        # A closed page frees its descriptor for another.
        for page in pages[:6]:
            page.close()

        def served_again():
            with socket.create_connection(("localhost", port), timeout=30) as page:
                page.sendall(b"GET / HTTP/1.0\r\nHost: localhost\r\n\r\n")
                return page.recv(12).endswith(b"200")
        for _ in range(100):
            if served_again():
                return
            time.sleep(0.1)
        self.fail("it serves no page any more")


class Ordered(unittest.TestCase):
    """Commands with a stub of ROS."""

    def setUp(self):
        named = {"rospy": types.ModuleType("rospy"), "std_msgs": types.ModuleType("std_msgs"), "std_msgs.msg": types.ModuleType("std_msgs.msg"),
                 "std_srvs": types.ModuleType("std_srvs"), "std_srvs.srv": types.ModuleType("std_srvs.srv")}
        self.published = []
        named["rospy"].Publisher = lambda *_, **__: types.SimpleNamespace(publish=self.published.append, get_num_connections=lambda: 1,
                                                                          resolved_name="/platoon/leader/speed")
        named["std_msgs.msg"].Float64 = named["std_srvs.srv"].Trigger = None
        before = {name: sys.modules.get(name) for name in list(named) + ["watching.commands"]}
        sys.modules.update(named)

        def restore():
            for name, module in before.items():
                sys.modules.pop(name, None)
                if module is not None:
                    sys.modules[name] = module
        self.addCleanup(restore)
        sys.modules.pop("watching.commands", None)
        from watching import commands
        self.known = {"endless": True}
        self.commands = commands.Commands(lambda: self.known)

    def test_a_speed_that_is_no_finite_number_is_refused_in_words(self):
        for value in (10 ** 400, -10 ** 400, math.inf, math.nan, True, "20", [20], 1000.5, -1e6):
            success, message = self.commands.obey({"command": "speed", "speed": value})
            self.assertFalse(success)
            self.assertRegex(message, r"^speed: .{1,43}: must be a finite number")
        self.assertFalse(self.commands.obey({"command": "speed"})[0])
        self.assertEqual(self.published, [])

    def test_a_speed_is_refused_where_the_leader_takes_none(self):
        for known, words in (({"endless": False}, "rejected: in a run of many realizations"), (None, "nothing is known of a run yet")):
            self.known = known
            success, message = self.commands.obey({"command": "speed", "speed": 20})
            self.assertFalse(success)
            self.assertIn(words, message)
        self.known = {"endless": True}
        self.assertEqual(self.commands.obey({"command": "speed", "speed": 20}), (True, "speed 20 m/s"))
        self.assertEqual(self.published, [20.0])


if __name__ == "__main__":
    unittest.main()
