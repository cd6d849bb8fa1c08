#!/usr/bin/python3
"""Faults in a model file or an option are rejected with the messages of test/messages, by the program that platoon.launch runs first."""

import os
import unittest

import yaml

import live_platoon
from folder import FolderTest

REGULAR = "must be a regular file of at most 256 MB that can be read"

# Too long for a table: a part of the paper's model file, its replacement, and the message.
LONG = [
    ("numerator: [1.0]", "numerator: [1" + ", 0" * 100000 + "]", "model/plant/numerator: 100001 numbers: must be at most 100"),
    ("time_headway: 3.2", "time_headway: " + "9" * 1000 + "x", "model/time_headway: " + "9" * 80 + "...: must be a finite number > 0"),
]
LONG_LOOP = "closed_loop: {{A: [{}[1]], B: [1], C: [1]}}\n".format("[1], " * 101)


def table(name):
    with open(os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "messages", name)) as file:
        return yaml.safe_load(file)


def base(name):
    """A shipped model without its comments; closed_loop.yaml without its loop, and nothing for `none`."""
    if name == "none":
        return ""
    with open(live_platoon.shared("config", name)) as file:
        lines = [line.split("#")[0].rstrip() for line in file]
    text = "\n".join(line for line in lines if line) + "\n"
    return text[text.index("time_headway"):] if name == "closed_loop.yaml" else text


class Rejected(FolderTest):
    def check(self, said, **given):
        """Checks that configure rejects its input with this message alone, or with all of a list, in printable lines, before any file is
        created."""
        settings = dict(dict(model=live_platoon.shared("config", "paper.yaml"), output=self.path("run")), **given)
        with self.subTest(**{name: value[:200] for name, value in given.items()}, said=said):
            done = live_platoon.tool("configure", **settings)
            self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
            problems = done.stderr.split("stochastic_platoon: the configuration is not valid: ")[1].strip().split("\n")
            if isinstance(said, str):
                self.assertEqual(len(problems), 1, problems)
                self.assertIn(said, problems[0])
            else:
                self.assertEqual(problems.pop(0), "{} errors:".format(len(said)))
                for message in said:
                    self.assertEqual(sum(line.startswith("  " + message) for line in problems), 1, (message, problems))
            self.assertTrue(done.stderr.replace("\n", "").isprintable(), repr(done.stderr))
            self.assertFalse(os.path.exists(self.path("run")), "the folder for the results was made")

    def check_model(self, text, part, other, said):
        if part:
            self.assertEqual(text.count(part), 1, part)
        self.check(said, model=self.write("model.yaml", text.replace(part, other) if part else text + other))

    def test_a_model_file(self):
        for name, rows in table("models.yaml").items():
            text = base(name)
            for row in rows:
                self.check_model(text, *row)

    def test_an_option(self):
        for name, value, said in table("options.yaml"):
            self.check(said, **{name: value})
        self.check(["model: nowhere: no such file", "run/steps: x: must be", "run/followers: y: must be"], model="nowhere", steps="x", followers="y")

    def test_a_fault_hides_no_other(self):
        own = dict(headway="-3", loss="2", record="foo", first="3", last="1", noise_variance="-1", delay="-1", external="9", dashboard_port="x")
        said = ["model/time_headway: -3: must be", "model/channel/loss/probability: 2: must be", "model/noise_variance: -1: must be",
                "model/channel/delay: -1: must be", "record: {}: must be a file name".format(os.path.abspath("foo")),
                "dashboard_port: x: must be", "last: 1: must be a whole number from 2 to 20"]
        self.check(said, **own)
        self.check(["model: nope.yaml: no such file", *said], model="nope.yaml", **own)
        self.check(["model: nope.yaml: no such file", "model/leader/file: cit.csv: no such file"], model="nope.yaml", leader="cit.csv",
                   mean_burst="3")
        self.check(["output: /dev/null/run: cannot be made: Not a directory: must be", *said], output="/dev/null/run", **own)
        os.mkdir(self.path("full"))
        self.write("full/statistics.csv", "precious")
        full = "output: {}: holds results already".format(self.path("full"))
        self.check([full, "dashboard_port: x: must be"], output=self.path("full"), dashboard_port="x")
        self.check([full, "model/time_headway: -3: must be"], output=self.path("full"), headway="-3")
        self.check(["headway_seconds: given: must be absent beside headway", "model/time_headway_seconds: -1: must be", "run/steps: x: must be"],
                   headway="2", headway_seconds="-1", steps="x")

    def test_a_fault_causes_no_message_about_another_value(self):
        self.check("run/followers: 0: must be", followers="0", external="9", last="0", first="1")
        self.check("run/followers: x: must be", followers="x", external="9", last="x", first="1", realizations="1e13")
        self.check("run/steps: -1: must be", steps="-1", signals="gap", leader="city.csv")
        self.check("model/time_headway: -1: must be", headway="-1", signals="speed", burn_in="500", model="acc.yaml")

    def test_all_faults_of_a_command_are_named_at_once(self):
        for program, words, options, said in table("programs.yaml"):
            with self.subTest(program=program):
                done = live_platoon.tool(program, *words, **options)
                self.assertEqual(done.returncode, 1, done.stdout)
                first, *problems = done.stderr.strip().split("\n")
                self.assertEqual(os.path.basename(first), "{}: {} errors:".format(program, len(said)), done.stderr)
                for message in said:
                    self.assertEqual(sum(message in line for line in problems), 1, (message, problems))

    def test_what_is_very_long(self):
        for row in LONG:
            self.check_model(base("paper.yaml"), *row)
        self.check_model(base("closed_loop.yaml"), "", LONG_LOOP, "model/closed_loop/A: 102 rows of 1: must be at most 100 x 100")
        for brackets in ("[", "{a: "):
            self.check_model("", "", brackets * 100000, "must be YAML: ")
        name = "a" * 300
        for argument in ("model", "leader"):
            self.check(REGULAR + " (File name too long)", **{argument: name})
        self.check(".bag: File name too long: must be a new file", record="/tmp/{}.bag".format(name))
        self.check(": cannot be made: File name too long", output="/tmp/" + name)

    def test_names_that_lead_to_no_regular_file(self):
        """A FIFO without a writer would hang for ever; a link to itself ends in an error of the system."""
        os.mkfifo(self.path("fifo"))
        for name in ("loop", "loop.bag"):
            os.symlink(name, self.path(name))
        for argument in ("model", "leader"):
            for name, reason in (("fifo", "a FIFO"), ("loop", "Too many levels of symbolic links")):
                self.check("{}: {} ({})".format(self.path(name), REGULAR, reason), **{argument: self.path(name)})
        self.check("loop.bag: Too many levels of symbolic links: must be a new file", record=self.path("loop.bag"))


if __name__ == "__main__":
    unittest.main()
