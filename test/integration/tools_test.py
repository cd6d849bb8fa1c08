#!/usr/bin/python3
"""The tools that need no master, as programs: their common behaviour, and the bits of the paper's example."""

import hashlib
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import live_platoon
from folder import FolderTest
from live_platoon import NODES, SCRIPTS, TOOLS


def run(*command):
    """The finished process. It must not wait for a master: there is none."""
    environment = dict(os.environ, ROS_MASTER_URI="http://localhost:{}".format(live_platoon.free_port()))
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, env=environment,
                          timeout=live_platoon.DEADLINE)


class EveryTool(unittest.TestCase):
    def programs(self):
        return [live_platoon.executable(tool) for tool in TOOLS + NODES] + [live_platoon.shared("src", "tools", tool) for tool in SCRIPTS]

    def test_is_listed(self):
        """What the tests of this class check must hold for a new program, too."""
        benchmarks = {file.stem for file in pathlib.Path(__file__).resolve().parents[1].glob("benchmark/*.cpp")}
        built = live_platoon.programs_in(os.path.dirname(live_platoon.executable("analyze")))
        self.assertEqual(built - benchmarks - set(SCRIPTS), set(TOOLS + NODES))
        self.assertEqual(live_platoon.programs_in(live_platoon.shared("src", "tools")), set(SCRIPTS))

    def test_prints_the_version_of_the_package(self):
        version = run("rosversion", "stochastic_platoon").stdout.strip()
        for program in self.programs():
            done = run(program, "--version")
            self.assertEqual((done.returncode, done.stdout), (0, "stochastic_platoon {}\n".format(version)), program)

    def test_prints_its_help(self):
        launch = pathlib.Path(live_platoon.shared("launch"))
        others = [str(path) for path in (*launch.glob("examples/*.py"), *(launch / name for name in ("demo", "isolated", "shards.sbatch")))]
        self.assertEqual(len(others), 11)
        with tempfile.TemporaryDirectory() as folder:
            for program in self.programs() + others:
                for option in ("--help", "-h")[:1 if program.endswith(".py") else 2]:
                    done = run("env", "--chdir=" + folder, program, option)
                    self.assertEqual(done.returncode, 0, program)
                    self.assertEqual("--version" in done.stdout, program not in others, program)
                    self.assertRegex(done.stdout, r"Example: (rosrun\s+stochastic_platoon )?[\w./]", program)
                    self.assertNotRegex(done.stdout, r"(?m)^Example: .*:$", program)  # a copied line would end in a colon
                    # Options are listed by their names, not in the order of the source.
                    self.assertNotRegex(done.stdout, r"(?m)^ +-.*(  | arg +)the same\b", program)
                    self.assertEqual(os.listdir(folder), [], program)

    def test_the_help_offers_nothing_that_is_rejected(self):
        for program in ("monte_carlo", "rare", "analyze"):
            text = run(live_platoon.executable(program), "--help").stdout
            for rejected in ("endless", "ROS home", "per message"):
                self.assertNotIn(rejected, text)
            self.assertEqual("for merge" in " ".join(text.split()), program == "monte_carlo")  # which rejects the shards of rare

    def test_every_figure_has_an_example_that_names_it(self):
        plot = live_platoon.shared("src", "tools", "plot")
        figures = re.findall(r"(?m)^    (\w+)(?: |$)", run(plot, "--help").stdout)
        self.assertEqual(len(figures), 11)
        for figure in figures:
            self.assertRegex(run(plot, figure, "--help").stdout, r"Example: rosrun\s+stochastic_platoon\s+plot\s+{} ".format(figure))

    def test_rejects_an_option_that_it_does_not_know(self):
        for program in self.programs():
            self.assertEqual(run(program, "--nothing").returncode, 2, program)

    def test_rejects_the_next_option_in_place_of_a_value(self):
        for arguments in (("--followers", "--output", "/nowhere"), ("--model", "paper.yaml", "--leader", "--followers", "3")):
            done = run(live_platoon.executable("monte_carlo"), *arguments)
            option = arguments[-3]
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn("{}: {}: must be a value, not the next option".format(option, arguments[-2]), done.stdout)


class BadInput(unittest.TestCase):
    def rejected(self, said, tool, *arguments):
        """Checks that the tool fails at once with these words and no other output."""
        done = subprocess.run([live_platoon.executable(tool)] + list(arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=live_platoon.DEADLINE)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(said, done.stderr)
        self.assertLess(len(done.stderr), 600)
        self.assertNotIn("h = ", done.stdout)

    def test_a_number_of_threads_that_is_none_is_rejected(self):
        for threads in ("-1", "0", "abc", "1000000000"):
            self.rejected("threads: {}: must be a whole number from 1 to 1024".format(threads), "monte_carlo", "--threads", threads,
                         "--output", "/nowhere")

    def test_sizes_that_cannot_be_held_are_rejected_before_memory_is_allocated(self):
        for tool in ("analyze", "monte_carlo", "configure"):
            self.rejected("run/steps x followers: 99999999999 x 20: must be at most 20000000", tool, "--steps", "99999999999",
                         "--model", live_platoon.shared("config", "paper.yaml"))

    def test_a_sweep_that_is_wrong_is_rejected_before_anything_is_printed(self):
        self.rejected("--sweep-headway: 3:2:1: must be FROM:TO:COUNT", "analyze", "--sweep-headway", "3:2:1")
        self.rejected("gain: 0: must be a finite number > 0", "analyze", "--sweep-headway", "1:3:3", "--sweep-gain", "0:2:3")
        self.rejected("loss: 1: must be from 0 to below 1", "analyze", "--sweep-loss", "0:1:3")
        self.rejected("mean_burst: 0.5: must be a finite number >= 1", "analyze", "--sweep-burst", "0.5:3:3")

    def test_signals_that_the_model_does_not_have_are_rejected(self):
        self.rejected("signals: input: must be absent unless every vehicle has limits, a radio, or a plant by its actuator_lag", "analyze",
                     "--signals", "input")
        for options in (("--burn-in", "5"), ("--signals", "speed", "--burn-in", "500")):
            self.rejected("burn-in: {}: must go with --signals speed, and be at most steps - 2 = 98".format(options[-1]), "analyze", *options)

    def test_a_long_value_is_cut(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as model:
            model.write("no mapping " * 1000)
            model.flush()
            self.rejected("no mapping no mapping", "analyze", "--model", model.name)

    def test_a_million_followers_are_analysed(self):
        done = run(live_platoon.executable("analyze"), "--followers", "1000000", "--steps", "10")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("of follower 1000000", done.stdout)


@unittest.skipIf(live_platoon.SANITIZED, "a sanitizer has memory of its own")
class Memory(unittest.TestCase):
    def test_that_of_a_monte_carlo_does_not_grow_with_the_realizations(self):
        """Each realization is a block of 320 kB. Blocks that wait for other threads must not accumulate."""
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.Popen([live_platoon.executable("monte_carlo"), "--followers", "50", "--steps", "400", "--batch", "1",
                                        "--realizations", "4000", "--threads", "4", "--output", os.path.join(folder, "run")],
                                       stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
        self.assertEqual(status, 0)
        # 32 MB per thread, twice that for each thread that the system delays, plus the blocks being merged: 0.23 to 0.5 GB.
        # All blocks together are 1.3 GB.
        self.assertLess(usage.ru_maxrss, 900000)


class Repeat(FolderTest):
    """monte_carlo --repeat SUMMARY repeats the run of a summary."""

    def setUp(self):
        super().setUp()
        done = self.monte_carlo("first", "--headway", "2.4", "--followers", "3", "--steps", "20", "--realizations", "500",
                                "--seed", "7", "--model", live_platoon.shared("config", "lossy.yaml"))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.summary = self.path("first", "summary.json")

    def monte_carlo(self, output, *arguments):
        return run(live_platoon.executable("monte_carlo"), "--output", self.path(output), *arguments)

    def test_gives_the_same_bits_and_says_so(self):
        done = self.monte_carlo("again", "--repeat", self.summary)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("statistics.csv equals the one that {} describes, bit for bit".format(self.summary), done.stdout)
        first, again = (live_platoon.statistics(self.path(name)) for name in ("first", "again"))
        self.assertEqual(first, again)

    def test_rejects_settings_that_would_change_the_run(self):
        for option, value in (("--headway", "3.2"), ("--seed", "8"), ("--realizations", "10"), ("--shard", "0/2")):
            done = self.monte_carlo("again", "--repeat", self.summary, option, value)
            self.assertEqual(done.returncode, 1, option)
            self.assertIn("{}: given: must be absent beside repeat".format(option[2:]), done.stdout)
            self.assertFalse(os.path.exists(self.path("again", "statistics.csv")))

    def test_rejects_a_changed_summary(self):
        with open(self.summary) as file:
            text = file.read()
        with open(self.summary, "w") as file:
            file.write(text.replace('"seed": 7', '"seed": 8'))
        done = self.monte_carlo("again", "--repeat", self.summary)
        self.assertEqual(done.returncode, 1)
        self.assertIn("damaged", done.stdout)

    def test_never_overwrites_the_run_that_it_repeats(self):
        done = self.monte_carlo("first", "--repeat", self.summary)
        self.assertEqual(done.returncode, 1)
        self.assertIn("holds", done.stdout)


TEST_PROGRAMS = os.environ.get("PLATOON_TEST_PROGRAMS", live_platoon.shared("build", "test", "programs"))


@unittest.skipUnless(os.path.exists(os.path.join(TEST_PROGRAMS, "monte_carlo_without_avx2")), "needs GCC on x86-64")
class VectorWidths(unittest.TestCase):
    """Without AVX-512, and without AVX2 and FMA, the programs use the narrower versions of all vectorised functions."""

    def monte_carlo(self, name, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            output = os.path.join(folder, "run")
            program = os.path.join(TEST_PROGRAMS, name) if "without" in name else live_platoon.executable(name)
            done = subprocess.run([program, "--realizations", "300", "--followers", "7", "--output", output]
                                  + list(arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            return live_platoon.statistics(output), done.stderr

    def test_every_width_gives_the_same_bits(self):
        for model in ("paper", "lossy", "mixed"):
            arguments = ("--model", live_platoon.shared("config", model + ".yaml"))
            widest = self.monte_carlo("monte_carlo", *arguments)[0]
            for hidden in ("avx512", "avx2"):
                self.assertEqual(self.monte_carlo("monte_carlo_without_" + hidden, *arguments)[0], widest, (model, hidden))

    def test_a_machine_without_fma_reports_once_that_it_is_slow(self):
        said = self.monte_carlo("monte_carlo_without_avx2")[1]
        self.assertEqual(said.count("the noise is slow: this processor has no AVX2 and FMA"), 1, said)
        self.assertNotIn("the noise is slow", self.monte_carlo("monte_carlo_without_avx512")[1])


class PaperExample(FolderTest):
    """20 followers, 100 steps, 10000 realizations, seed 1.

    An intended change of the numbers changes these digests and must be in CHANGELOG.rst: older recordings and checkpoints then no
    longer match the program.
    """

    def digest(self, headway):
        csv = live_platoon.reference(self.folder, headway=headway, followers=20, steps=100, realizations=10000, seed=1)
        return hashlib.sha256(csv).hexdigest()

    def test_keeps_its_bits_where_the_string_is_stable(self):
        self.assertEqual(self.digest(3.2), "5a489175d660b651533fa93a918acbf40c95db91560c7191ce936c9cc5f980b1")

    def test_keeps_its_bits_where_the_string_is_not_stable(self):
        self.assertEqual(self.digest(2.4), "cca2d1edbd8e4ae021fbda069d21b1a6dcd2c07ddcbf9beeea911bd2db594200")


if __name__ == "__main__":
    unittest.main()
