"""roslaunch as run from a terminal, for tests that start it themselves."""

import functools
import os
import signal
import subprocess
import tempfile
import unittest

import live_platoon
from folder import FolderTest, temporary_folder


class Terminal:
    """One roslaunch of a shipped launch file with its output, on its own master unless one is given.

    `inside` is a command prefix, for example for another network namespace; `environment` replaces the default environment.
    """

    def __init__(self, folder, file, master=None, inside=(), environment=None, **arguments):
        self.master = master or "http://localhost:{}".format(live_platoon.free_port())  # roslaunch starts it
        self.log = tempfile.NamedTemporaryFile("w+", dir=folder, suffix=".log", delete=False)
        environment = environment or dict(os.environ, ROS_HOSTNAME="localhost")
        environment = dict(environment, ROS_MASTER_URI=self.master, ROS_HOME=folder,
                           PYTHONUNBUFFERED="1")  # otherwise roslaunch buffers its output
        words = ["{}:={}".format(name, value) for name, value in arguments.items()]
        self.process = subprocess.Popen(list(inside) + ["roslaunch", "stochastic_platoon", file] + words,
                                        stdout=self.log, stderr=subprocess.STDOUT, env=environment)

    def text(self):
        with open(self.log.name, errors="replace") as file:
            return file.read()

    def wait_for_text(self, words, deadline=live_platoon.DEADLINE):
        """Waits until roslaunch has printed these words. Raises AssertionError with the output if it ends or takes too long."""
        try:
            live_platoon.wait_for(lambda: words in self.text() or self.process.poll() is not None, words, deadline)
            if words not in self.text():
                raise AssertionError("roslaunch ended without " + words)
        except AssertionError as error:
            raise AssertionError("{}; it printed:\n{}".format(error, self.text()))

    def wait(self, deadline=live_platoon.DEADLINE):
        return self.process.wait(timeout=deadline * live_platoon.PATIENCE)

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)
        self.wait()

    def end(self):
        if self.process.poll() is None:
            self.interrupt()
        self.log.close()


def start_master(folder, cleanup):
    """Starts a master that outlives launches, until `cleanup` (such as addCleanup) ends it; returns its address. roscore ends itself if its
    master has not answered in ten seconds, as on a machine with a load of ten: another one is then started."""
    while True:
        port = live_platoon.free_port()
        master = "http://localhost:{}".format(port)
        core = subprocess.Popen(["roscore", "-p", str(port)], env=live_platoon.ros_environment(master, ROS_HOME=folder),
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cleanup(core.wait)
        cleanup(core.terminate)
        live_platoon.wait_for(lambda: live_platoon.process_of("/rosout", master) or core.poll() is not None, "the master")
        if core.poll() is None:
            return master


@functools.lru_cache(maxsize=None)
def kept_master():
    """The master of all launches of a test module that need none of their own: a launch that starts one takes twice as long."""
    return start_master(temporary_folder(unittest.addModuleCleanup), unittest.addModuleCleanup)


class LaunchTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.output = self.path("run")

    def roscore(self):
        """Starts a master for this test alone; returns its address."""
        return start_master(self.folder, self.addCleanup)

    def launch(self, file="platoon.launch", own_master=False, **arguments):
        arguments.setdefault("output", self.output)
        arguments = {name: value for name, value in arguments.items() if value is not None}
        if not own_master:
            arguments.setdefault("master", kept_master())
        terminal = Terminal(self.folder, file, **arguments)
        self.addCleanup(terminal.end)
        return terminal

    def listen_for_the_attempt(self, terminal):
        """Listens for the attempt in which a realization is complete: from then on only a stall timeout begins another one."""
        return self.background("rostopic", "echo", "-n", "1", "--filter", "m.realizations > 0", "/platoon/overview/attempt",
                               env=live_platoon.ros_environment(terminal.master), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                               universal_newlines=True)

    def attempt_heard_by(self, listener):
        return int(listener.communicate(timeout=live_platoon.DEADLINE)[0].split()[0])

    def completed(self, terminal, output=None):
        """Waits for the end of a launch; returns the summary of its run, which must be complete."""
        terminal.wait()
        summary = live_platoon.completed_summary(output or self.output)
        self.assertTrue(summary, terminal.text())
        return summary

    def assert_bits(self, output=None, **settings):
        """Checks that the statistics of a run are those of monte_carlo."""
        output = output or self.output
        self.assertEqual(live_platoon.statistics(output), live_platoon.reference(output, **settings))

    def run_to_the_end(self, file="platoon.launch", **arguments):
        """A launch that has ended, with a complete run in its output folder."""
        terminal = self.launch(file, **arguments)
        self.completed(terminal, arguments.get("output"))
        return terminal

    def replayed(self, bag, **arguments):
        """What the replay of a recording has printed at its end."""
        terminal = self.launch("replay.launch", bag=bag, **arguments)
        terminal.wait()
        return terminal.text()

    def assert_replays(self, bag, messages, *vehicles):
        """Checks that vehicles driven from a recording send the recorded numbers, so many messages each."""
        for vehicle in vehicles:
            self.assertIn("{}: {} messages equal the recorded ones to the bit".format(vehicle, messages),
                          self.replayed(bag, drive=vehicle, output=""))

    def assert_statistics_of(self, bag, measured):
        """Checks that the statistics of a recording are those of its run."""
        found = live_platoon.tool("bag_statistics", bag, "--csv")
        self.assertEqual((found.returncode, found.stdout.encode()), (0, measured))

    def assert_replayed_run(self, bag, measured):
        """Checks that the run of a recorded platoon has the statistics of the recording."""
        again = self.path("again")
        text = self.replayed(bag, output=again)
        self.assertTrue(live_platoon.completed_summary(again), text)
        self.assertEqual(live_platoon.statistics(again), measured)

    def monte_carlo(self, name, *flags, **options):
        """Folder of a run of monte_carlo that must succeed."""
        done = live_platoon.tool("monte_carlo", *flags, output=self.path(name), **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.path(name)

    def model_with(self, **changes):
        """The paper's model file with some lines replaced; None removes a line."""
        with open(live_platoon.shared("config", "paper.yaml")) as file:
            lines = file.read().splitlines()
        for key, value in changes.items():
            lines = [line for line in lines if not line.startswith(key + ":")]
            if value is not None:
                lines.append("{}: {}".format(key, value))
        return self.write("model.yaml", "\n".join(lines) + "\n")
