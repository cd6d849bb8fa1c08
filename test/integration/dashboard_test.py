#!/usr/bin/python3
"""The page in headless Chromium against running platoons: it shows the monitor's numbers at the right places, and survives a
restart of its node."""

import json
import os
import re
import socket
import subprocess
import unittest

import rospy
from stochastic_platoon.msg import ErrorStatistics, Overview

import live_platoon
from dashboard_page import OnePlatoon, Page, address, ask, state
from orders import setUpModule  # noqa: F401: unittest calls it
from processes import listening

FOLLOWERS = 5
RUN = dict(followers=FOLLOWERS, steps=30, realizations=2000, headway=2.4, dashboard=True)


def answers(port):
    with socket.socket() as caller:
        return caller.connect_ex(("localhost", port)) == 0


class Ensemble(OnePlatoon):
    """A complete run whose nodes stay up: its state is constant."""

    RUN = RUN

    @classmethod
    def setUpClass(cls):
        cls.statistics, cls.overviews = [], []
        rospy.Subscriber("/platoon/error_statistics", ErrorStatistics, cls.statistics.append, queue_size=1000)
        rospy.Subscriber("/platoon/overview", Overview, cls.overviews.append, queue_size=1000)
        super().setUpClass()
        cls.summary = live_platoon.wait_for(lambda: live_platoon.completed_summary(cls.output_folder), "the run to complete")
        cls.state = live_platoon.wait_for(lambda: state(cls.url).get("complete") and state(cls.url), "the page's final figures")

    def test_a_speed_is_rejected_with_the_reason(self):
        for speed, words in ((20, "rejected: in a run of many realizations the leader drives by the model file"), (10 ** 400, "must be a finite number")):
            status, answer = ask(self.url, "POST", "/command", json.dumps({"command": "speed", "speed": speed}), Content_Type="application/json",
                                 Origin=self.url)
            self.assertEqual((status, answer["success"]), (409, False))
            self.assertIn(words, answer["message"])

    def last_statistics(self):
        return live_platoon.wait_for(lambda: next((m for m in self.statistics[-1:] if m.step == 29 and m.realizations == 2000), None),
                                     "the statistics of the last step")

    def test_state_json_is_error_statistics_to_the_bit_and_the_summary(self):
        last = self.last_statistics()
        for key in ("mean", "variance", "theoretical_variance"):
            self.assertEqual(self.state[key], list(getattr(last, key)), key)
        self.assertEqual((self.state["followers"], self.state["step"], self.state["realizations"]), (FOLLOWERS, 29, 2000))
        self.assertIs(self.state["string_stable"], self.summary["theory"]["string_stable"])
        self.assertEqual(self.state["limit_variance"], self.summary["theory"]["limit_variance"])
        self.assertEqual(self.state["max_abs_z"], max(self.summary["agreement"][key] for key in ("max_abs_z_mean", "max_abs_z_variance")))
        self.assertIsNone(self.state["culprit"])
        self.assertEqual(self.state["warnings"], self.summary["warnings"])
        self.assertEqual(len(self.state["warnings"]), 2)

    def test_the_page_shows_these_numbers_and_its_bars_stand_where_they_should(self):
        browser = self.open(self.url)
        self.page_has(self.state)
        chart, height = self.bars_stand_where_they_should(self.state)
        self.assertIsNone(chart["limit"])
        self.assertIn("Not string stable", browser.text("#verdict"))
        self.assertIn("exceeds 1", browser.text("#reason"))
        for warning in self.state["warnings"]:
            self.assertIn(warning, browser.text("#warnings"))
        self.assertIn("{:.2f}".format(self.state["max_abs_z"]), browser.text("#facts"))
        self.assertEqual(browser.complaints(), [])

    def test_two_pages_and_a_reload_show_the_same(self):
        browser = self.open(self.url)
        self.page_has(self.state)
        browser.driver.refresh()
        self.page_has(self.state)
        browser.driver.switch_to.new_window("tab")
        self.addCleanup(browser.driver.switch_to.window, self.first_window)
        self.addCleanup(browser.driver.close)
        browser.open(self.url)
        self.page_has(self.state)
        browser.driver.switch_to.window(self.first_window)
        self.page_has(self.state)
        browser.driver.switch_to.window(browser.driver.window_handles[-1])

    def test_a_phone_and_a_dark_page_need_no_sideways_scrolling_and_keys_choose_a_follower(self):
        browser = self.open(self.url)
        self.addCleanup(browser.device, "Emulation.clearDeviceMetricsOverride")
        browser.show_as(390, 844, dark=True)
        browser.driver.refresh()
        self.page_has(self.state)
        self.assertEqual(browser.run("return document.documentElement.scrollWidth"), 390)
        self.assertEqual(browser.run("return document.documentElement.dataset.theme"), "dark")
        self.bars_stand_where_they_should(self.state)
        body = browser.driver.switch_to.active_element
        body.send_keys("\ue014")  # arrow right
        self.wait_for_page("document.getElementById('readout').textContent.startsWith('Follower 1: variance')", "what is known of follower 1")
        browser.show_as(1280, 900)
        self.wait_for_page("document.documentElement.dataset.theme == 'light'", "the light page")

    def test_curves_over_k_are_all_steps_of_the_run(self):
        last = live_platoon.wait_for(lambda: next((m for m in self.overviews[-1:] if m.complete), None), "the overview of the complete run")
        self.assertEqual(list(last.step), list(range(30)))
        with open(os.path.join(self.output_folder, "statistics.csv")) as file:
            rows = [line.split(",") for line in file.read().splitlines()[1:]]
        self.assertEqual(list(last.variance), [float(row[4]) for row in rows])
        self.assertEqual(list(last.theoretical_mean), [float(row[5]) for row in rows])

    def test_the_page_survives_a_restart_of_its_node(self):
        browser = self.open(self.url)
        self.page_has(self.state)
        browser.run("window.same_page = true")
        live_platoon.kill("/platoon/dashboard", self.master)
        live_platoon.wait_for(lambda: state(self.url).get("complete"), "the dashboard at its old address")
        self.wait_for_page("performance.getEntriesByName(location.origin + '/events').length > 0 && document.getElementById('connection').textContent.startsWith('complete')",
                           "the connection")
        self.page_has(self.state)
        self.assertTrue(browser.run("return window.same_page"))

    def test_commands_from_another_origin_or_name_are_rejected_and_so_is_a_manoeuvre_of_an_ensemble(self):
        body, own = json.dumps({"command": "brake"}), dict(Content_Type="application/json", Origin=self.url)
        self.assertEqual(ask(self.url, "POST", "/command", body, **dict(own, Origin="http://evil.example"))[0], 403)
        self.assertEqual(ask(self.url, "POST", "/command", body, **dict(own, Host="evil.example", Origin="http://evil.example"))[0], 421)
        status, answer = ask(self.url, "POST", "/command", body, **own)
        self.assertEqual((status, answer["success"]), (409, False))
        self.assertRegex(answer["message"], "leader/brake|realizations")
        for wrong, words in (({"command": "fly"}, "fly"), ({"command": "speed"}, "speed: missing"), ({"command": "speed", "speed": "x"}, "finite"),
                             ({"command": "change", "headway": float("inf")}, "finite")):
            status, answer = ask(self.url, "POST", "/command", json.dumps(wrong), **own)
            self.assertEqual(status, 409)
            self.assertIn(words, answer["message"])
        self.assertEqual(state(self.url)["variance"], self.state["variance"])

    def test_a_page_of_another_origin_cannot_send_a_command(self):
        """Uses the browser itself, with a page from another server."""
        self.write("other.html", "<p>another origin")
        port = live_platoon.free_port()
        self.background("/usr/bin/python3", "-m", "http.server", str(port), "--bind", "localhost", "--directory", self.folder,
                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        page = "http://localhost:{}/other.html".format(port)
        live_platoon.wait_for(lambda: answers(port), "the other server")
        browser = self.open(page)
        outcome = browser.driver.execute_async_script("""
            const done = arguments[1], send = (kind, mode) => fetch(arguments[0] + "/command", {method: "POST", mode, headers: {"Content-Type": kind},
              body: '{"command": "brake"}'}).then(answer => answer.type, error => "rejected");
            Promise.all([send("application/json", "cors"), send("text/plain", "no-cors"),
              fetch(arguments[0] + "/state.json").then(() => "read", () => "rejected")]).then(done)""", self.url)
        # Without a preflight request a page may send text, without access to the answer: the server rejects it
        # (test/unit/watching_server_test.py).
        self.assertEqual(outcome, ["rejected", "opaque", "rejected"])
        browser.complaints()

    def test_it_listens_on_this_machine_only(self):
        node = live_platoon.process_of("/platoon/dashboard", self.master)
        own = int(self.url.rsplit(":", 1)[1])
        self.assertIn(("this machine", own), listening(node))
        self.assertEqual([where for where, _ in listening(node) if where != "this machine"], [])

    def test_watch_prints_the_same_table(self):
        printed = subprocess.run(["rosrun", "stochastic_platoon", "watch"], stdout=subprocess.PIPE, universal_newlines=True, timeout=live_platoon.DEADLINE,
                                 check=True).stdout
        self.assertIn("not string stable", printed)
        rows = [line.split() for line in printed.splitlines() if re.match(r" +\d+ +[-0-9]", line)]
        self.assertEqual([row[0] for row in rows], [str(i) for i in range(1, FOLLOWERS + 1)])
        for row, variance, theory, score in zip(rows, self.state["variance"], self.state["theoretical_variance"], self.state["score"]):
            self.assertEqual((row[2], row[4], row[5]), ("{:.6g}".format(variance), "{:.6g}".format(theory), "{:.2f}".format(score)))

    def test_plot_follow_draws_what_the_results_draw(self):
        figure = self.path("followed")
        subprocess.run(["rosrun", "stochastic_platoon", "plot", "errors", "--follow", "--titles", "run", "--output", figure], check=True,
                       stdout=subprocess.DEVNULL, timeout=live_platoon.DEADLINE)
        subprocess.run(["rosrun", "stochastic_platoon", "plot", "errors", self.output_folder, "--titles", "run", "--output", figure + "_again"],
                       check=True, stdout=subprocess.DEVNULL, timeout=live_platoon.DEADLINE)
        with open(figure + ".png", "rb") as one, open(figure + "_again.png", "rb") as other:
            self.assertEqual(one.read(), other.read())


class OtherRuns(Page):
    def test_a_port_in_use_is_said_and_the_run_goes_on_and_of_a_stable_string_the_limit_is_a_line(self):
        with socket.socket() as taken:
            taken.bind(("localhost", 0))
            taken.listen()
            port = taken.getsockname()[1]
            terminal = self.launch(**dict(RUN, headway=3.2, realizations=300, dashboard_port=port))
            terminal.wait_for_text("cannot serve the page at localhost:{}: Address already in use".format(port))
            live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output), "the run to complete")
        url = address(terminal)  # retried until the port is free
        final = live_platoon.wait_for(lambda: state(url).get("complete") and state(url), "the final figures")
        browser = self.open(url)
        self.page_has(final)
        chart, height = self.bars_stand_where_they_should(final)
        self.assertAlmostEqual(chart["top"] + float(re.match(r"M\S+ (\S+)H", chart["limit"]).group(1)), height(final["limit_variance"]), delta=0.6)
        self.assertIn("String stable", browser.text("#verdict"))

    def said_by_a_node(self, name, *arguments):
        """Starts a node; returns a function that waits until it has printed these words."""
        with open(self.path(name), "w") as file:
            node = self.background(live_platoon.shared("src", "tools", "dashboard"), "__ns:=" + name, *arguments, stdout=file,
                                   stderr=subprocess.STDOUT)
        self.addCleanup(node.kill)  # rospy may ignore a signal while it starts

        def has(words):
            with open(self.path(name)) as printed:
                return words in printed.read() or node.poll() is not None

        def said(words):
            live_platoon.wait_for(lambda: has(words), words)
            self.assertIsNone(node.poll(), "the node has ended")
        return said

    def test_an_address_that_is_none_is_said_and_one_of_digits_is_served(self):
        self.said_by_a_node("no_address", "_host:=a..b")("cannot serve the page at a..b:0: ")
        self.said_by_a_node("digits", "_host:=0")("Dashboard: http://0:")

    def test_a_port_in_use_is_tried_again_without_a_clock(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        with socket.socket() as taken:
            taken.bind(("localhost", 0))
            taken.listen()
            port = taken.getsockname()[1]
            said = self.said_by_a_node("no_clock", "_port:={}".format(port))
            said("cannot serve the page at localhost:{}: ".format(port))
        said("Dashboard: http://localhost:{}".format(port))

    def test_of_a_replay(self):
        terminal = self.launch("replay.launch", bag=live_platoon.shared("test", "data", "small.bag"), dashboard=True)
        url = address(terminal)
        final = live_platoon.wait_for(lambda: state(url).get("complete") and state(url), "the final figures")
        self.open(url)
        self.page_has(final)
        with open(live_platoon.shared("test", "data", "small_statistics.csv")) as file:
            rows = [line.split(",") for line in file.read().splitlines()[1:]]
        expected = [float(row[4]) for row in rows if int(row[1]) == final["step"]]
        self.assertEqual(final["variance"], expected)


if __name__ == "__main__":
    unittest.main()
