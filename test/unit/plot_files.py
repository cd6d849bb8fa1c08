"""The program plot, and small files for its tests."""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import shutil
import sys
import tempfile
import unittest
import xml.dom.minidom
import zlib

import numpy as np
import stochastic_platoon as sp

sys.dont_write_bytecode = True
TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "src", "tools")

loader = importlib.machinery.SourceFileLoader("plot_program", os.path.join(TOOLS, "plot"))
plot = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot_program", loader))
loader.exec_module(plot)

HEADING = "vehicle,step,count,mean,variance,theoretical_mean,theoretical_variance"
COUNT = 101  # realizations: the relative standard error of a variance is sqrt(2 / 100)


def transfer(headway, gain=1.35):
    """T(z) of the paper's example, coefficients in descending powers."""
    denominator = (1.0 + headway) * np.polymul([1.0, 0.89], [1.0, -2.0, 1.0])
    return {"numerator": [gain, 0.0],
            "denominator": np.polyadd(denominator, gain * np.array([1.0 + headway, -headway])).tolist()}


def gain_along_string(headway):
    """|T| of the paper's example."""
    loop, frequency = transfer(headway), np.geomspace(1e-4, np.pi, 2000)
    z = np.exp(1j * frequency)
    return {"frequency": frequency.tolist(), "gain": np.abs(np.polyval(loop["numerator"], z) / np.polyval(loop["denominator"], z)).tolist()}


class PlotTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.output = os.path.join(self.folder, "figure")

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, text, *names):
        with open(self.path(*names), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(*names)

    def write_bytes(self, content, *names):
        with open(self.path(*names), "wb") as file:
            file.write(content)
        return self.path(*names)

    def read(self, *names):
        with open(self.path(*names), "rb") as file:
            return file.read()

    def lines(self, *names):
        return self.read(*names).decode().splitlines()

    def rows(self, followers=3, steps=4):
        return ["{},{},{},{},{},{},{}".format(i, k, COUNT, 0.1 * i * k, 1.0 + i + 0.1 * k, 0.1 * i * k, 1.0 + i)
                for i in range(1, followers + 1) for k in range(steps)]

    def make_run(self, name="run", rows=None, followers=3, steps=4, heading=HEADING, tables={}, **changes):
        """A folder with statistics.csv, further tables (name: text), and summary.json."""
        os.mkdir(self.path(name))
        for table, text in tables.items():
            self.write(text, name, table)
        rows = self.rows(followers, steps) if rows is None else rows
        self.write("\n".join([heading] + rows) + "\n", name, "statistics.csv")
        summary = {"complete": True, "followers": followers, "steps": steps, "time_average": False,
                   "realizations": COUNT, "seed": 7, "theory": {"spectral_radius": 0.5, "string_stable": True},
                   "standard_error_of_variance": [0.25 * i for i in range(1, followers + 1)],
                   "largest_standard_error_of_variance": [0.5 * i for i in range(1, followers + 1)]}
        summary.update(changes)
        return self.write_summary(name, summary)

    def write_summary(self, name, summary):
        """Writes the summary of the tables in a run's folder, with their checksums."""
        tables = {table[:-len(".csv")]: self.checksum(name, table) for table in os.listdir(self.path(name)) if table.endswith(".csv")}
        text = json.dumps(dict(summary, crc32=dict(tables, summary="00000000")), indent=2) + "\n"
        self.write(text, name, "summary.json")
        own = self.checksum(name, "summary.json")
        self.write(text.replace('"summary": "00000000"', '"summary": "{}"'.format(own)), name, "summary.json")
        return self.path(name)

    def checksum(self, *names):
        return "{:08x}".format(zlib.crc32(self.read(*names)))

    def make_average(self, name="average", step=5000):
        rows = ["{},{},4800,0.01,{},0,{}".format(i, step, 1.0 + i, 1.1 + i) for i in (1, 2, 3)]
        return self.make_run(name, rows=rows, time_average=True, steps=0, realizations=1)

    def make_analysis(self, name="analysis.json", **changes):
        analysis = {"spectral_radius": 0.5, "mean_square_stable": True, "string_stable": True,
                    "stationary_variance": [2.0, 3.0, 3.5], "limit_variance": 4.0, "gain_along_string": gain_along_string(3.2), "sample_period": 0.1,
                    "peak_gain": 1.0, "peak_frequency": 0.0,
                    "norms": {"mean_l2": [0.4, 0.7, 1.1], "variance_linf": [2.0, 3.0, 4.0],
                              "mean_bound": 1.5, "variance_bound": 4.5}}
        analysis.update(changes)
        return self.write(json.dumps(analysis), name)

    def make_map(self, radius=lambda headway, gain: gain / headway, gains=(1.0, 1.35, 1.7, 2.5)):
        rows = ["headway,gain,spectral_radius,peak_gain,string_stable"]
        for gain in gains:
            for headway in (2.0, 2.4, 2.8, 3.2, 3.6):
                rows.append("{},{},{},{},{}".format(headway, gain, radius(headway, gain),
                                                    max(1.0, 3.0 - headway / gain), int(headway > 2.0 * gain)))
        return self.write("\n".join(rows) + "\n", "map.csv")

    def run_plot(self, *arguments):
        """Exit code, standard output and error message."""
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                plot.main(list(arguments))
        except SystemExit as stop:
            return (1, printed.getvalue(), stop.code) if isinstance(stop.code, str) else (stop.code, "", "")
        return 0, printed.getvalue(), ""

    def assert_draws(self, *arguments):
        code, printed, message = self.run_plot(*arguments, "--output", self.output)
        self.assertEqual(code, 0, message)
        self.assertEqual(printed.split(), [self.output + ".png", self.output + ".svg"])
        self.assertEqual(self.read("figure.png")[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(xml.dom.minidom.parse(self.output + ".svg").documentElement.tagName, "svg")
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith(".tmp")], [])

    def assert_rejects(self, *arguments, saying):
        before = sorted(os.listdir(self.folder))
        code, printed, message = self.run_plot(*arguments, "--output", self.output)
        self.assertEqual(code, 1)
        self.assertEqual(printed, "")
        for words in saying:
            self.assertIn(words, message)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def assert_run_rejected(self, *saying, **run):
        path = self.make_run(**run)
        self.assert_rejects("errors", path, saying=(path,) + saying)

    def assert_rejects_every_damage(self, run, name, every=1, load=sp.Results.load):
        """Rejects the run, and names the file, after a flipped bit in every such byte of the file."""
        written = self.read(run, name)
        for at in range(0, len(written), every):
            damaged = bytearray(written)
            damaged[at] ^= 1 << at % 8
            self.write_bytes(damaged, run, name)
            with self.assertRaisesRegex(ValueError, name, msg="{} byte {}".format(name, at)):
                load(self.path(run))
        self.write_bytes(written, run, name)
