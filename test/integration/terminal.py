"""roslaunch as run from a terminal, for tests that start it themselves."""

import os
import shutil
import signal
import subprocess
import tempfile
import unittest

import live_platoon

# Each master runs rosversion twice for parameters that the tests do not need: two Python programs, a tenth of a short launch.
QUICK = os.path.join(os.path.dirname(os.path.abspath(__file__)), "quick")


class Terminal:
    """One roslaunch of a shipped launch file with its output, on its own master unless one is given.

    `inside` is a command prefix, for example for another network namespace; `environment` replaces the default environment.
    """

    def __init__(self, folder, file, master=None, inside=(), environment=None, **arguments):
        self.master = master or "http://localhost:{}".format(live_platoon.free_port())  # roslaunch starts it
        self.log = tempfile.NamedTemporaryFile("w+", dir=folder, suffix=".log", delete=False)
        environment = environment or dict(os.environ, ROS_HOSTNAME="localhost")
        environment = dict(environment, ROS_MASTER_URI=self.master, ROS_HOME=folder,
                           PYTHONUNBUFFERED="1",  # otherwise roslaunch buffers its output
                           PATH=QUICK + ":" + environment["PATH"])
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
            self.process.send_signal(signal.SIGINT)
            self.wait()
        self.log.close()


def start_master(folder):
    """Starts a master that outlives launches; returns its process and address."""
    port = live_platoon.free_port()
    master = "http://localhost:{}".format(port)
    environment = dict(os.environ, ROS_MASTER_URI=master, ROS_HOSTNAME="localhost", ROS_HOME=folder)
    core = subprocess.Popen(["roscore", "-p", str(port)], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        live_platoon.wait_for(lambda: live_platoon.process_of("/rosout", master), "the master")
    except BaseException:
        core.terminate()
        raise
    return core, master


class LaunchTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.output = os.path.join(self.folder, "run")

    def roscore(self):
        """Starts a master that outlives launches; returns its address."""
        core, master = start_master(self.folder)
        self.addCleanup(core.wait)
        self.addCleanup(core.terminate)
        return master

    def launch(self, file="platoon.launch", **arguments):
        arguments.setdefault("output", self.output)
        arguments = {name: value for name, value in arguments.items() if value is not None}
        terminal = Terminal(self.folder, file, **arguments)
        self.addCleanup(terminal.end)
        return terminal

    def monte_carlo(self, name, *flags, **options):
        """Folder of a run of monte_carlo that must succeed."""
        folder = os.path.join(self.folder, name)
        done = live_platoon.monte_carlo(folder, *flags, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return folder

    def model_with(self, **changes):
        """The paper's model file with some lines replaced; None removes a line."""
        with open(live_platoon.shared("config", "paper.yaml")) as file:
            lines = file.read().splitlines()
        for key, value in changes.items():
            lines = [line for line in lines if not line.startswith(key + ":")]
            if value is not None:
                lines.append("{}: {}".format(key, value))
        path = os.path.join(self.folder, "model.yaml")
        with open(path, "w") as file:
            file.write("\n".join(lines) + "\n")
        return path
