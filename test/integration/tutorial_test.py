#!/usr/bin/python3
"""The tutorial (launch/examples/README.md): its scripts print the numbers of the text and draw its pictures. The Python of this and
of the first README runs, and each value in a comment is the value of its line."""

import glob
import os
import re
import shutil
import subprocess
import tempfile
import unittest
import unittest.mock

import matplotlib.image
import numpy as np
import stochastic_platoon as sp

from code_blocks import BLOCK, CodeTest
from folder import FolderTest, temporary_folder

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
EXAMPLES = os.path.join(PACKAGE, "launch", "examples")
DECIMAL = re.compile(r"(?<![\w.])\d+\.\d+")
# Largest difference of a drawn and a shipped picture, mean over the pixels, from 0 to 1. The reduction to 256 colours causes up to
# 2e-4, twenty points of another colour 1e-3. Other versions of matplotlib place texts elsewhere.
SAME_PICTURE = 6e-4
SHIPPED_BY = "3.6."


def text_of(*names):
    with open(os.path.join(PACKAGE, *names)) as file:
        return file.read()


def tutorial():
    """The sections of the tutorial by the name of their script."""
    sections = re.split(r"^## ", text_of("launch", "examples", "README.md"), flags=re.M)
    named = {re.search(r"`(tutorial_\w+\.py)`", section)[1]: section for section in sections if re.match(r"\d", section)}
    return {name + ".py" if not name.endswith(".py") else name: section for name, section in named.items()}


def picture(path):
    """Red, green and blue of the pixels, from 0 to 1."""
    return matplotlib.image.imread(path)[..., :3]


class Scripts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = temporary_folder(cls.addClassCleanup)
        cls.names = sorted(os.path.basename(path) for path in glob.glob(os.path.join(EXAMPLES, "tutorial_*.py")))
        cls.runs = {name: cls.run_script(name, os.path.join(cls.folder, "made", "new")) for name in cls.names}

    @classmethod
    def run_script(cls, name, *arguments):
        return subprocess.run([os.path.join(EXAMPLES, name), *arguments], cwd=cls.folder, env=dict(os.environ, MPLBACKEND="Agg"),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

    def drawn(self, *names):
        return os.path.join(self.folder, "made", "new", *names)

    def test_the_text_has_a_section_for_each_script(self):
        self.assertEqual(list(tutorial()), self.names)
        self.assertEqual(len(self.names), 6)

    def test_every_script_prints_what_the_text_quotes(self):
        for name, section in tutorial().items():
            with self.subTest(script=name):
                run = self.runs[name]
                self.assertEqual((run.returncode, run.stderr), (0, ""))
                self.assertEqual([run.stdout], [text for language, text in BLOCK.findall(section) if not language])

    def test_numbers_in_the_sentences_stand_in_the_output_or_in_the_script(self):
        found = 0
        for name, section in tutorial().items():
            known = self.runs[name].stdout + text_of("launch", "examples", name) + "".join(text for _, text in BLOCK.findall(section))
            for number in DECIMAL.findall(BLOCK.sub("", section)):
                found += 1
                self.assertTrue(re.search(r"(?<![\d.]){}(?!\d)".format(re.escape(number)), known), "{}: {}".format(name, number))
        self.assertGreater(found, 20)

    def test_calls_of_the_module_in_the_text_are_those_of_the_scripts(self):
        for name, section in tutorial().items():
            script = [line.strip() for line in text_of("launch", "examples", name).splitlines()]
            first = next(text for language, text in BLOCK.findall(section) if language == "python")
            calls = [line for line in first.splitlines() if re.match(r"\w+ = sp\.", line)]
            self.assertTrue(calls, name)
            for call in calls:
                self.assertTrue(call in script, "{}: {}".format(name, call))

    def test_the_pictures_are_drawn_and_are_those_of_the_text(self):
        for name, section in tutorial().items():
            file = name.replace(".py", ".png")
            with self.subTest(picture=file):
                self.assertEqual(re.findall(r"!\[[^]]+\]\(\.\./\.\./\.figures/([^)]+)\)", section), [file])
                drawn, shipped = picture(self.drawn(file)), picture(os.path.join(PACKAGE, ".figures", file))
                self.assertGreater(np.mean(drawn < 0.9), 0.01, "blank")
                self.assertEqual(drawn.shape, shipped.shape)
                if matplotlib.__version__.startswith(SHIPPED_BY):
                    self.assertLess(np.abs(drawn - shipped).mean(), SAME_PICTURE, "draw .figures/{} again".format(file))

    def test_scripts_are_short(self):
        for name in self.names:
            self.assertLessEqual(len(text_of("launch", "examples", name).splitlines()), 60, name)

    def test_without_a_folder_the_picture_goes_to_the_working_folder(self):
        self.assertEqual(self.run_script("tutorial_4_gaps.py").returncode, 0)
        self.assertTrue(os.path.exists(os.path.join(self.folder, "tutorial_4_gaps.png")))

    def test_the_car_is_a_model_file(self):
        car = sp.Model.load(self.drawn("your_car.yaml"))
        self.assertAlmostEqual(sp.analyze(car)["critical_headway_seconds"], 25 / 12, places=9)

    def test_the_figure_for_a_paper_has_its_text_as_text_and_its_data_beside_it(self):
        with open(self.drawn("tutorial_6_figure.pdf"), "rb") as file:
            pdf = file.read()
        self.assertTrue(pdf.startswith(b"%PDF"))
        self.assertFalse(b"/Subtype /Type3" in pdf, "a Type 3 font")
        with open(self.drawn("tutorial_6_figure.svg")) as file:
            self.assertTrue("<text" in file.read(), "no text")
        with open(self.drawn("tutorial_6_figure.csv")) as file:
            names = file.readline().strip().split(",")
            table = dict(zip(names, np.loadtxt(file, delimiter=",", unpack=True)))
        self.assertEqual(table["variance"].size, 2 * 3 * 100)
        for h in (3.2, 2.4):
            results = sp.Results.load(self.drawn("run_h{}".format(h)))
            for follower in (1, 5, 20):
                rows = (table["time_headway"] == h) & (table["follower"] == follower)
                np.testing.assert_allclose(table["variance"][rows], results.variance[follower - 1], rtol=1e-8)
                np.testing.assert_allclose(table["theoretical_variance"][rows], results.theoretical_variance[follower - 1], rtol=1e-8)
                np.testing.assert_allclose(table["standard_error"][rows], results.variance[follower - 1] * np.sqrt(2 / 999), rtol=1e-8)

    def test_the_figure_for_a_paper_may_be_drawn_again(self):
        again = self.run_script("tutorial_6_figure.py", self.drawn())
        self.assertEqual((again.returncode, again.stdout), (0, self.runs["tutorial_6_figure.py"].stdout))


class CodeBlocks(FolderTest, CodeTest):
    def setUp(self):
        super().setUp()
        within = unittest.mock.patch.object(tempfile, "tempdir", self.folder)  # a block makes a folder
        within.start()
        self.addCleanup(within.stop)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)

    def run_blocks(self, *names):
        """Runs all blocks of a file in one namespace."""
        session = {}
        for language, text in BLOCK.findall(text_of(*names)):
            if language == "python":
                self.run_block(text.replace("/tmp/", self.folder + "/"), session)

    def test_those_of_the_tutorial_run_and_have_the_values_of_their_comments(self):
        self.run_blocks("launch", "examples", "README.md")
        self.assertGreaterEqual(self.checked, 18)

    def test_that_of_the_first_readme_runs_and_has_the_values_of_its_comments(self):
        shutil.copy(os.path.join(PACKAGE, "test", "data", "small.bag"), os.path.join(self.folder, "run.bag"))
        self.run_blocks("README.md")
        self.assertGreaterEqual(self.checked, 3)


if __name__ == "__main__":
    unittest.main()
