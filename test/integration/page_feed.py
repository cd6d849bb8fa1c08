"""The page's server, fed with messages of a simulated platoon; no node runs."""

import math
import os
import sys
import threading
import unittest

import live_platoon
from browser import Browser

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "unit"))
from watching_messages import TOOLS, configuration, endless, message, snapshot  # noqa: E402
from watching import server, state  # noqa: E402

SIZES = ((1366, 768), (390, 844))
BURN_IN = 200
DRAWN = "return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"  # resolved when the page has drawn


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
        self.addCleanup(self.browser.open, "about:blank")  # before the server ends: a page without server complains in the next test
        self.browser.complaints()

    def open(self):
        self.browser.open(self.server.url)
        self.browser.device("Emulation.clearDeviceMetricsOverride")

    def wait_for_page(self, condition, what):
        return live_platoon.wait_for(lambda: self.browser.run("return " + condition), what + " on the page", 20.0)

    def text_comes(self, selector, words):
        self.wait_for_page("document.querySelector('{}')?.textContent.includes('{}')".format(selector, words), words)

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

    def drive_seen(self, steps, **changes):
        """The same, and the open page gets every snapshot: a stream keeps the latest one alone."""
        for step in steps:
            self.drive([step], **changes)
            live_platoon.wait_for(self.taken, "the page to take step {}".format(step), 20.0)

    def taken(self):
        """Whether a page is connected, and nothing waits for it."""
        streams = list(self.server.streams.streams)
        return bool(streams) and not any(stream.waiting for stream in streams)

    def at_both_sizes(self, name):
        """Yields at each size, after the checks that apply to every state."""
        for width, height in SIZES:
            with self.subTest(width=width):
                self.browser.show_as(width, height)
                self.wait_for_page("innerWidth == {}".format(width), "the size")
                self.browser.run(DRAWN)
                yield width
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
                if os.environ.get("PICTURES"):
                    self.browser.run(DRAWN)
                    self.browser.picture(os.path.join(os.environ["PICTURES"], "{}-{}.png".format(name, width)))
        self.assertEqual(self.browser.complaints(), [])
