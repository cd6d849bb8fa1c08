#!/usr/bin/python3
"""Faults in a model file or a launch argument are rejected with these messages, by the program that platoon.launch runs first."""

import os
import unittest

import live_platoon
from folder import FolderTest

POSITIVE = "must be a finite number > 0"
NOT_NEGATIVE = "must be a finite number >= 0"
FINITE = "must be a finite number"
LIST = "must be a list of finite numbers"
ROWS = "must be a list of rows of finite numbers, all of one length"
MAPPING = "must be a mapping of keys"
COUNT = "must be a whole number from {} to 70368744177664"
HUGE = "must be at most 1e+100 in magnitude"
ALLOWED = ("allowed are allow_unstable, channel, closed_loop, controller, initial_position, inputs, leader, limits, noise_variance, own_acceleration, plant, "
           "safe_gap, sample_period, spacing, standstill_distance, start, string, time_headway, time_headway_seconds, vehicle_length, vehicle_types")

# A part of the paper's model file, its replacement, and the message.
REPLACED = [
    ("time_headway: 3.2", "time_headway: 0", "model/time_headway: 0: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: -3.2", "model/time_headway: -3.2: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: .nan", "model/time_headway: .nan: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: inf", "model/time_headway: inf: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: 1e400", "model/time_headway: 1e400: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: 1e308", "model/time_headway: 1e308: " + HUGE),
    ("time_headway: 3.2", "time_headway: 0x3", "model/time_headway: 0x3: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: '3,2'", "model/time_headway: 3,2: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: 3.2 m", "model/time_headway: 3.2 m: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: true", "model/time_headway: true: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: ''", "model/time_headway: (empty): " + POSITIVE),
    ("time_headway: 3.2", "time_headway:", "model/time_headway: missing: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: [3.2]", "model/time_headway: [3.2]: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: {h: 3.2}", "model/time_headway: {h: 3.2}: " + POSITIVE),
    ("time_headway: 3.2", "time_headway: 3.2\ntime_headway: 2.4", "model/time_headway: given twice: must be given once"),
    ("time_headway: 3.2", 'time_headway: "\\e[31m3.2\\n"', "model/time_headway: \\x1b[31m3.2 : " + POSITIVE),
    ("time_headway: 3.2", "time_headway: " + "9" * 100 + "x", "model/time_headway: " + "9" * 80 + "...: " + POSITIVE),
    ("time_headway: 3.2", "headway: 3.2", "model/headway: unknown key: " + ALLOWED),
    ("time_headway: 3.2", "time_headway: 3.2\n<<: {a: 1}", "model/<<: unknown key: " + ALLOWED),
    ("time_headway: 3.2", "time_headway: 3.2\n[a, b]: 1", "model/[a, b]: unknown key: " + ALLOWED),
    ("time_headway: 3.2", 'time_headway: 3.2\n"\\e[2J": 1', "model/\\x1b[2J: unknown key: " + ALLOWED),
    ("time_headway: 3.2", "time_headway: 0.01", "the closed loop is unstable: rho(A) = "),
    ("standstill_distance: 0.0", "standstill_distance: -1", "model/standstill_distance: -1: " + NOT_NEGATIVE),
    ("standstill_distance: 0.0", "standstill_distance: 1e308", "model/standstill_distance: 1e308: " + HUGE),
    ("sample_period: 0.1", "sample_period: 0", "model/sample_period: 0: must be a finite number >= 1e-9"),
    ("sample_period: 0.1", "sample_period: 1e-10", "model/sample_period: 1e-10: must be a finite number >= 1e-9"),
    ("sample_period: 0.1", "sample_period: 1e10", "model/sample_period: 1e10: must be at most 1e+06 in magnitude"),
    ("noise_variance: 0.6", "noise_variance: -0.6", "model/noise_variance: -0.6: " + NOT_NEGATIVE),
    ("noise_variance: 0.6", "noise_variance: -.inf", "model/noise_variance: -.inf: " + NOT_NEGATIVE),
    ("noise_variance: 0.6", "noise_variance: 1e308", "model/noise_variance: 1e308: " + HUGE),
    ("value: 20.0", "value: fast", "model/leader/speed[0]/value: fast: " + FINITE),
    ("value: 20.0", "value: -1e308", "model/leader/speed[0]/value: -1e308: " + HUGE),
    ("value: 20.0}", "value: 20.0, until: 3}", "model/leader/speed[0]/until: unknown key: allowed are from_step, value"),
    ("from_step: 0", "from_step: -1", "model/leader/speed[0]/from_step: -1: " + COUNT.format(0)),
    ("from_step: 0", "from_step: 0.5", "model/leader/speed[0]/from_step: 0.5: " + COUNT.format(0)),
    ("from_step: 0", "from_step: 9223372036854775808", "model/leader/speed[0]/from_step: 9223372036854775808: " + COUNT.format(0)),
    ("[{from_step: 0, value: 20.0}]", "20", "model/leader/speed: 20: must be a list of mappings"),
    ("[{from_step: 0, value: 20.0}]", "[~]", "model/leader/speed[0]: (nothing): " + MAPPING),
    ("[{from_step: 0, value: 20.0}]", "[{from_step: 5, value: 1}, {from_step: 5, value: 2}]",
     "leader/speed: leader from_step: 5: must be >= 0 and increase from one entry to the next"),
    ("{speed: [{from_step: 0, value: 20.0}]}", "{}", "model/leader/speed: missing: must be a list of mappings"),
    ("{speed: [{from_step: 0, value: 20.0}]}", "{positions: []}", "model/leader/positions: []: " + LIST),
    ("{speed: [{from_step: 0, value: 20.0}]}", "{positions: [0, 1e308]}", "model/leader/positions: [0, 1e308]: " + HUGE),
    ("{speed: [{from_step: 0, value: 20.0}]}", "{positions: [0, 0]}",
     "model/leader/positions: 2 given: must be at least steps + 1 = 101, and steps above 0"),
    ("{speed: [{from_step: 0, value: 20.0}]}", "{positions: [0], speed: []}",
     "model/leader/speed: given: must be absent beside positions"),
    ("mean: 0.0", "mean: left", "model/initial_position/mean: left: " + FINITE),
    ("variance: 0.0}", "variance: -1e-9}", "model/initial_position/variance: -1e-9: " + NOT_NEGATIVE),
    ("{mean: 0.0, variance: 0.0}", "0", "model/initial_position: 0: " + MAPPING),
    ("numerator: [1.0]", "numerator: 1.0", "model/plant/numerator: 1.0: " + LIST),
    ("numerator: [1.0]", "numerator: []", "model/plant/numerator: []: " + LIST),
    ("numerator: [1.0]", "numerator: [one]", "model/plant/numerator: [one]: " + LIST),
    ("numerator: [1.0]", "numerator: [[1.0]]", "model/plant/numerator: [[1.0]]: " + LIST),
    ("numerator: [1.0]", "numerator: [1e200]", "model/plant/numerator: [1e200]: " + HUGE),
    ("numerator: [1.0]", "numerator: &x [*x]", "model/plant/numerator: &1 [*1]: " + LIST),
    ("numerator: [1.0]", "numerator: [0.0]", "plant, controller: G(z) K(z) = 0: neither plant nor controller may be zero"),
    ("numerator: [1.0]", "numerator: [1" + ", 0" * 100000 + "]", "model/plant/numerator: 100001 numbers: must be at most 100"),
    ("numerator: [1.0]", "numerator: *nothing", "must be YAML: yaml-cpp: error at line 1, column 20: the referenced anchor is not defined"),
    ("[1.0, -2.0, 1.0]", "[0, 0]", "model/plant/denominator: all zero: must be a polynomial other than 0"),
    ("[1.0, -2.0, 1.0]", "[1e-320, 1.0, 1.0]", "plant/denominator: leading coefficient 9.99989e-321: too small, as the other "
     "coefficients overflow when they are divided by it"),
    ("[1.0, -2.0, 1.0]", "[1.0, -2.0, 1.0" + ", 0" * 25 + "]",
     "plant, controller: order 29: the closed loop must have at most 20 poles"),
    ("[1.0, -2.0, 1.0]", "[1.0, -1.5, 0.5]", "no double integral action: G(z) K(z) must have two poles at z = 1"),
    ("[1.35, 0.0]", "[1.35, 0.0, 0.0, 0.0]", "plant, controller: relative degree 0: T must be strictly proper (more poles than zeros)"),
    ("controller:\n  numerator: [1.35, 0.0]\n  denominator: [1.0, 0.89]\n  divide_by_one_plus_headway: true", "controller: {kp: 0,2, kd: 0.7}",
     "model/controller/kp: 0,2: must be one number, with a decimal point in place of the comma"),
    ("[1.35, 0.0]", "[13.5, 0.0]", "the closed loop is unstable: rho(A) = "),
    ("divide_by_one_plus_headway: true", "divide_by_one_plus_headway: 1",
     "model/controller/divide_by_one_plus_headway: 1: must be true or false"),
]

# The same for a model file with a closed loop: A, B, C and the message.
LOOP = "closed_loop: {{A: {}, B: {}, C: {}}}\n"
LOOPS = [
    (("[]", "[1]", "[1]"), "model/closed_loop/A: []: " + ROWS),
    (("x", "[1]", "[1]"), "model/closed_loop/A: x: " + ROWS),
    (("[[1, 2], [3]]", "[1]", "[1]"), "model/closed_loop/A: [[1, 2], [3]]: " + ROWS),
    (("[[1, 2]]", "[1]", "[1]"), "closed_loop/A: 1 x 2: must be square, n x n with n >= 1"),
    (("[[0.5]]", "[1, 2]", "[1]"), "closed_loop/B: 2 x 1, C: 1 x 1: must be n x 1 and 1 x n with A's n = 1"),
    (("[[0.5]]", "[1]", "[.inf]"), "model/closed_loop/C: [.inf]: " + LIST),
    (("[[1e200]]", "[1]", "[1]"), "model/closed_loop/A: [[1e200]]: " + HUGE),
    (("[[1]]", "[1]", "[1]"), "no double integral action"),
    (("[[0.5]]", "[" + "1, " * 101 + "1]", "[1]"), "model/closed_loop/B: 102 numbers: must be at most 100"),
    (("[" + "[1], " * 101 + "[1]]", "[1]", "[1]"), "model/closed_loop/A: 102 rows of 1: must be at most 100 x 100"),
]

# A whole model file and the message.
FILES = [
    ("", "model: missing: " + MAPPING),
    ("# nothing\n", "model: missing: " + MAPPING),
    ("5", "model: 5: " + MAPPING),
    ("- 1\n- 2\n", "model: - 1 - 2: " + MAPPING),
    ("\0\1\2", "model: \\x01: " + MAPPING),
    ("plant: [1, 2", "must be YAML: yaml-cpp: error at line 1, column 1: end of sequence flow not found"),
    ("plant:\n\tnumerator: [1]\n", "must be YAML: yaml-cpp: error at line 2, column 11: illegal map value"),
    ("a: 1\n---\na: 2\n", "model.yaml: several documents: must be one"),
    ("# one\n--- {a: 1}\n--- {a: 2}\n", "model.yaml: several documents: must be one"),
    ("[" * 100000, "must be YAML: "),
    ("{a: " * 100000, "must be YAML: "),
]

EXTERNAL = "must be numbers of followers from 1 to 20, each once, separated by commas, as in 3,7, or none"

# A launch argument, its value and the message.
ARGUMENTS = [
    ("followers", "0", "run/followers: 0: must be a whole number from 1 to 1000000"),
    ("followers", "-1", "run/followers: -1: must be a whole number from 1 to 1000000"),
    ("followers", "1e7", "run/followers: 1e7: must be a whole number from 1 to 1000000"),
    ("followers", "2.5", "run/followers: 2.5: must be a whole number from 1 to 1000000"),
    ("followers", "", "run/followers: (empty): must be a whole number from 1 to 1000000"),
    ("followers", "99999999999999999999", "run/followers: 99999999999999999999: must be a whole number from 1 to 1000000"),
    ("followers", "1000000", "run/steps x followers: 100 x 1000000: must be at most 20000000"),
    ("steps", "-1", "run/steps: -1: " + COUNT.format(0)),
    ("steps", "nan", "run/steps: nan: " + COUNT.format(0)),
    ("steps", "99999999999", "run/steps x followers: 99999999999 x 20: must be at most 20000000"),
    ("realizations", "0", "run/realizations: 0: " + COUNT.format(1)),
    ("realizations", "1e14", "run/realizations: 1e14: " + COUNT.format(1)),
    ("realizations", "1e-4", "run/realizations: 1e-4: " + COUNT.format(1)),
    ("realizations", "1.25e1", "run/realizations: 1.25e1: " + COUNT.format(1)),
    ("realizations", "1e400", "run/realizations: 1e400: " + COUNT.format(1)),
    ("realizations", "1e4x", "run/realizations: 1e4x: " + COUNT.format(1)),
    ("realizations", "70368744177665", "run/realizations: 70368744177665: " + COUNT.format(1)),
    ("batch", "-1", "run/batch: -1: must be a whole number from 0 to 16777216"),
    ("batch", "16777217", "run/batch: 16777217: must be a whole number from 0 to 16777216"),
    ("rate", "-1", "run/rate: -1: " + NOT_NEGATIVE),
    ("rate", "nan", "run/rate: nan: " + NOT_NEGATIVE),
    ("rate", "1e-12", "run/rate: 1e-12: must be 0 or at least 1e-06"),
    ("rate", "1e12", "run/rate: 1e12: must be at most 1e+06 in magnitude"),
    ("seed", "-1", "run/seed: -1: must be a whole number from 0 to 9223372036854775807"),
    ("seed", "9223372036854775808", "run/seed: 9223372036854775808: must be a whole number from 0 to 9223372036854775807"),
    ("hosting", "cloud", "run/hosting: cloud: must be processes or one_process"),
    ("hosting", "", "run/hosting: (empty): must be processes or one_process"),
    ("resume", "maybe", "run/resume: maybe: must be true or false"),
    ("record", "/tmp/run", "record: /tmp/run: must be a file name that ends in .bag"),
    ("record", "/proc/run.bag", "record: /proc: cannot be written: "),
    ("record_split_mb", "-1", "run/record_split_mb: -1: must be a whole number from 0 to 1073741824"),
    ("record_compression", "bz2", "run/record_compression: bz2: must be none or lz4"),
    ("window", "1048577", "run/window: 1048577: must be a whole number from 0 to 1048576"),
    ("stall_timeout", "-1", "run/stall_timeout: -1: " + NOT_NEGATIVE),
    ("stall_timeout", "1e-9", "run/stall_timeout: 1e-09: must be 0 or at least 0.001"),
    ("external", "0", "run/external: 0: " + EXTERNAL),
    ("external", "21", "run/external: 21: " + EXTERNAL),
    ("external", "3,7,3", "run/external: 3,7,3: " + EXTERNAL),
    ("external", "vehicle_3", "run/external: vehicle_3: " + EXTERNAL),
    ("external", "3, 7", "run/external: 3, 7: " + EXTERNAL),
    ("external", "03", "run/external: 03: " + EXTERNAL),
    ("stall_timeout", "1e300", "run/stall_timeout: 1e300: must be at most 1e+06 in magnitude"),
    ("burn_in", "-1", "run/burn_in: -1: " + COUNT.format(0)),
    ("headway", "-1", "model/time_headway: -1: " + POSITIVE),
    ("headway", "abc", "model/time_headway: abc: " + POSITIVE),
    ("noise_variance", "-1", "model/noise_variance: -1: " + NOT_NEGATIVE),
    ("headway", "3,2", "model/time_headway: 3,2: " + POSITIVE + ", with a decimal point in place of the comma"),
    ("model", "/no/such/file", "model: /no/such/file: no such file: must be a model file, or one of the shipped acc.yaml, "),
    ("model", "cac.yaml", "model: cac.yaml: no such file: must be a model file, or one of the shipped acc.yaml, "),
    ("model", "/proc", "model: /proc: must be a regular file of at most 256 MB that can be read (a folder)"),
    ("model", "/proc/self/mem", "model: /proc/self/mem: must be a regular file of at most 256 MB that can be read"),
    ("model", "/dev/zero", "model: /dev/zero: must be a regular file of at most 256 MB that can be read (a device)"),
    ("model", "", "model: (empty): no such file: must be a model file"),
    ("model", "a" * 300, "must be a regular file of at most 256 MB that can be read (File name too long)"),
    ("leader", "cit.csv", "leader/file: cit.csv: no such file: must be a table of a drive, or one of the shipped city.csv, emergency_stop.csv, motorway.csv"),
    ("leader", "/dev/zero", "leader/file: /dev/zero: must be a regular file of at most 256 MB that can be read (a device)"),
    ("leader", "a" * 300, "must be a regular file of at most 256 MB that can be read (File name too long)"),
    ("record", "/tmp/" + "a" * 300 + ".bag", ".bag: File name too long: must be a new file"),
    ("output", "/tmp/" + "a" * 300, ": cannot be made: File name too long"),
    ("output", "/proc/run", "output: /proc/run: cannot be made: "),
    ("output", "/dev/null", "output: /dev/null: cannot be made: "),
]


class Rejected(FolderTest):
    def check(self, said, **given):
        """Checks that the input is rejected with these words, in printable lines, before any file is created."""
        settings = dict(dict(model=live_platoon.shared("config", "paper.yaml"), output=self.path("run")), **given)
        with self.subTest(**{name: value[:200] for name, value in given.items()}, said=said):
            done = live_platoon.tool("configure", **settings)
            self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
            self.assertIn("stochastic_platoon: the configuration is not valid: ", done.stderr)
            self.assertIn(said, done.stderr)
            self.assertTrue(done.stderr.replace("\n", "").isprintable(), repr(done.stderr))
            self.assertFalse(os.path.exists(self.path("run")), "the folder for the results was made")

    def check_model(self, text, said):
        self.check(said, model=self.write("model.yaml", text))

    def test_what_stands_in_the_place_of_a_part_of_a_model_file(self):
        with open(live_platoon.shared("config", "paper.yaml")) as file:
            lines = [line.split("#")[0] for line in file]
        text = "\n".join(line.rstrip() for line in lines if line.strip()) + "\n"
        for part, other, said in REPLACED:
            self.assertEqual(text.count(part), 1, part)
            self.check_model(text.replace(part, other), said)

    def test_a_closed_loop_that_is_none(self):
        with open(live_platoon.shared("config", "closed_loop.yaml")) as file:
            rest = "".join(file.readlines()).split("time_headway", 1)[1]
        for parts, said in LOOPS:
            self.check_model(LOOP.format(*parts) + "time_headway" + rest, said)

    def test_a_model_file_that_is_none(self):
        for text, said in FILES:
            self.check_model(text, said)

    def test_names_that_lead_to_no_regular_file(self):
        """A FIFO without a writer would hang for ever; a link to itself ends in an error of the system."""
        os.mkfifo(self.path("fifo"))
        os.symlink("loop", self.path("loop"))
        for argument in ("model", "leader"):
            for name, reason in (("fifo", "a FIFO"), ("loop", "Too many levels of symbolic links")):
                self.check("{}: must be a regular file of at most 256 MB that can be read ({})".format(self.path(name), reason),
                           **{argument: self.path(name)})
        self.check("loop.bag: Too many levels of symbolic links: must be a new file", record=self.link("loop.bag"))

    def link(self, name):
        os.symlink(name, self.path(name))
        return self.path(name)

    def test_a_launch_argument_that_is_wrong(self):
        for name, value, said in ARGUMENTS:
            self.check(said, **{name: value})


if __name__ == "__main__":
    unittest.main()
