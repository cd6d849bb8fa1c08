"""The dashboard of a running platoon, and its page in headless Chromium."""

import http.client
import json
import os
import re

import live_platoon
from browser import Browser
from folder import temporary_folder
from terminal import LaunchTest, Terminal, kept_master


def address(terminal):
    terminal.wait_for_text("Dashboard: http://")
    return re.search(r"Dashboard: (http://(localhost|127.0.0.1):(\d+))", terminal.text()).group(1)


def ask(url, method="GET", path="/state.json", body=None, **headers):
    """Sends a request; returns status and content of the answer."""
    connection = http.client.HTTPConnection(url[len("http://"):], timeout=30)
    connection.request(method, path, body, {name.replace("_", "-"): value for name, value in headers.items()})
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, json.loads(content)


def state(url):
    """The content of /state.json; empty while the dashboard is not reachable."""
    try:
        return ask(url)[1]
    except (OSError, ValueError):
        return {}


def numbers(texts):
    return [float(text) if text not in ("null", "undefined") else None for text in texts]


TABLE = """document.getElementById("table-card").open = true;
return [...document.querySelectorAll("#table tbody tr")].map(row => [...row.cells].map(cell => cell.dataset.value))"""
BARS = """const svg = document.getElementById("string"), box = svg.getBoundingClientRect();
return {data: {...svg.dataset}, top: box.top, left: box.left, bars: [...svg.querySelectorAll("rect")].map(bar => {
  const {top, bottom, left, right} = bar.getBoundingClientRect();
  return {top, bottom, left, right, value: bar.dataset.value, fill: bar.getAttribute("fill")};
}), theory: svg.querySelector("path.theory:not(.halo)").getAttribute("d"),
limit: svg.querySelector("path.limit")?.getAttribute("d") ?? null}"""


class Page(LaunchTest):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        cls.first_window = cls.browser.driver.current_window_handle

    def open(self, url):
        self.browser.open(url)
        return self.browser

    def wait_for_page(self, condition, what):
        """Waits until a JavaScript expression is true in the page."""
        return live_platoon.wait_for(lambda: self.browser.run("return " + condition), what + " on the page", 60.0)

    def page_has(self, expected):
        """Checks that the table shows these numbers of state.json, to the bit."""
        self.wait_for_page("document.querySelectorAll('#table tbody tr').length == {} || (document.getElementById('table-card').open = true, false)"
                           .format(len(expected["variance"])), "the table")
        columns = [numbers(column) for column in zip(*self.browser.run(TABLE))]
        for column, key in ((1, "mean"), (2, "variance"), (3, "standard_error"), (4, "theoretical_variance"), (5, "score")):
            self.assertEqual(columns[column], expected[key], key)

    def bars_stand_where_they_should(self, expected):
        chart = self.browser.run(BARS)
        self.assertEqual(chart["data"]["logarithmic"], "false")
        foot, top, high = (float(chart["data"][key]) for key in ("foot", "top", "high"))
        reach = max(v + 2 * (e or 0) for v, e in zip(expected["variance"], expected["standard_error"]))
        self.assertGreaterEqual(high, max([reach] + expected["theoretical_variance"]))

        def height(value):
            return chart["top"] + foot - value / high * (foot - top)
        self.assertEqual(len(chart["bars"]), len(expected["variance"]))
        for bar, value in zip(chart["bars"], expected["variance"]):
            self.assertEqual(float(bar["value"]), value)
            self.assertAlmostEqual(bar["top"], height(value), delta=0.6)
            self.assertAlmostEqual(bar["bottom"], chart["top"] + foot, delta=0.6)
        middles = [(bar["left"] + bar["right"]) / 2 for bar in chart["bars"]]
        self.assertEqual(middles, sorted(middles))
        points = [tuple(map(float, point.split())) for point in re.split("[ML]", chart["theory"])[1:]]
        for (x, y), middle, value in zip(points, middles, expected["theoretical_variance"]):
            self.assertAlmostEqual(chart["left"] + x, middle, delta=0.6)
            self.assertAlmostEqual(chart["top"] + y, height(value), delta=0.6)
        self.assertEqual(len(points), len(middles))
        return chart, height


class OnePlatoon(Page):
    """Tests of one launch with a dashboard; they share it. RUN holds its arguments."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.shared_folder = temporary_folder(cls.addClassCleanup)
        cls.master, cls.output_folder = kept_master(), os.path.join(cls.shared_folder, "run")
        cls.terminal = Terminal(cls.shared_folder, "platoon.launch", master=cls.master, output=cls.output_folder, **cls.RUN)
        cls.addClassCleanup(cls.terminal.end)
        cls.url = address(cls.terminal)
