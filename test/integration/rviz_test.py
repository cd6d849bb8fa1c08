#!/usr/bin/python3
"""live.launch with RViz on a virtual screen, rendered in software: the picture shows the vehicles in their colours and order."""

import os
import re
import struct
import subprocess
import unittest

import live_platoon
import numpy
from matplotlib.colors import rgb_to_hsv
from terminal import LaunchTest

# Hues [deg] of followers 1 to 5 (ros/observation/road_scene.cpp): from dark blue through green and yellow to dark red.
HUES = (240, 176, 90, 48, 0)
# RViz crashes at one start in fifty, within Mesa's software renderer (swrast_dri.so of Debian 11): no failure of the platoon.
CRASHED = re.compile(r"rviz-\d+\] process has died \[pid \d+, exit code -11,")
MOST_STARTS = 3
ENOUGH = 60  # fewest pixels of a hue: distant vehicles have about a hundred


def picture(frame_buffer):
    """The screen as an array (rows, columns, RGB from 0 to 1), from Xvfb's frame buffer file in xwd format."""
    with open(frame_buffer, "rb") as file:
        content = file.read()
    header = struct.unpack(">25I", content[:100])
    size, width, height, bytes_per_line, colours = header[0], header[4], header[5], header[12], header[19]
    pixels = numpy.frombuffer(content, numpy.uint8, bytes_per_line * height, size + 12 * colours)
    return pixels.reshape(height, bytes_per_line)[:, :4 * width].reshape(height, width, 4)[:, :, 2::-1] / 255.0


def places(image):
    """The mean (row, column) of each follower's hue in the picture; None if it has too few pixels."""
    hsv = rgb_to_hsv(image)
    found = []
    for hue in HUES:
        away = numpy.abs((360.0 * hsv[:, :, 0] - hue + 180.0) % 360.0 - 180.0)
        rows, columns = numpy.nonzero((away < 8.0) & (hsv[:, :, 1] > 0.85) & (hsv[:, :, 2] > 0.2))
        found.append((rows.mean(), columns.mean()) if len(rows) > ENOUGH else None)
    return found


class Picture(LaunchTest):
    def screen(self):
        """Starts a virtual screen; returns its name."""
        reading, writing = os.pipe()
        server = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "1400x700x24", "-nolisten", "tcp",
                                   "-fbdir", self.folder], pass_fds=(writing,), stderr=subprocess.DEVNULL)
        os.close(writing)
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        with os.fdopen(reading) as number:
            return ":" + number.readline().strip()

    def in_order(self, terminal, frame_buffer):
        """Seen from behind: the last vehicle is nearest, at the lower left. At the start only noise separates the vehicles."""
        self.assertIsNone(terminal.process.poll(), terminal.text())
        found = places(picture(frame_buffer))
        if None in found:
            return None
        rows, columns = [place[0] for place in found], [place[1] for place in found]
        return rows == sorted(rows) and columns == sorted(columns, reverse=True) and columns[0] - columns[-1] > 100

    def test_vehicles_stand_on_the_road_in_their_colours_and_their_order(self):
        os.environ.update(DISPLAY=self.screen(), LIBGL_ALWAYS_SOFTWARE="1", XDG_RUNTIME_DIR=self.folder)
        frame_buffer = os.path.join(self.folder, "Xvfb_screen0")
        self.assertEqual(places(picture(frame_buffer)), [None] * len(HUES), "of an empty screen")
        for start in range(MOST_STARTS):
            terminal = self.launch("live.launch", followers=5, rate=20, output=self.path("run_{}".format(start)))
            live_platoon.wait_for(lambda: CRASHED.search(terminal.text()) or self.in_order(terminal, frame_buffer), "all colours in their order", 90)
            if not CRASHED.search(terminal.text()):
                return
            terminal.end()
        self.fail("RViz has crashed at {} starts:\n{}".format(MOST_STARTS, terminal.text()))


if __name__ == "__main__":
    live_platoon.skip_without("rviz", "Xvfb")
    unittest.main()
