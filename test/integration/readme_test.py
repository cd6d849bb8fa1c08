#!/usr/bin/python3
"""Every command line of the READMEs (root, config, launch and its examples, msg) works as written, in a fresh shell with another
HOME; long runs are shortened."""

import os
import re
import signal
import subprocess
import tempfile
import unittest
import xmlrpc.client

import live_platoon
from folder import temporary_folder

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SETUP = "devel/setup.bash"
if not os.path.exists(os.path.join(PACKAGE, SETUP)):  # in a catkin workspace: the workspace's setup.bash
    SETUP = os.path.join(os.environ["CMAKE_PREFIX_PATH"].split(":")[0], "setup.bash")
COMMANDS = ("./launch/demo", "./test/run", ".", "roscore", "rosrun", "roslaunch", "rosparam", "rosservice", "rostopic", "cmp", "parallel", "bash", "cmake", "make")
ORDERS = ("rosparam", "rosservice", "rostopic")  # orders to the platoon of the line before
NOT_RUN = {"./test/run": "is what runs this test", "./launch/demo": "demo_test.py runs it",
           "./launch/demo live": "demo_test.py runs it",
           "cmake -S launch/examples/saturated_follower -B /tmp/follower -DPYTHON_EXECUTABLE=/usr/bin/python3 && make -C /tmp/follower":
           "external_car_test.py builds it",
           "/tmp/follower/devel/lib/saturated_follower/saturated_follower _index:=3 _limit:=0.5": "external_car_test.py starts it",
           "rosrun stochastic_platoon odometry_vehicle _index:=2 ~odometry:=/car/odom ~reference:=/car/reference": "external_car_test.py gives it a car",
           "roslaunch stochastic_platoon platoon.launch followers:=4 external:=2 realizations:=1 steps:=600 rate:=10 stall_timeout:=0":
           "external_car_test.py gives it a car",
           "roslaunch stochastic_platoon replay.launch bag:=/tmp/external.bag drive:=vehicle_3 external:=3": "external_vehicle_test.py replays into it"}

# (beginning of a line, arguments that the test adds); the first match applies.
SHORTER = (
    ("roslaunch stochastic_platoon live.launch", "rviz:=false followers:=3 rate:=100"),
    ("roslaunch stochastic_platoon platoon.launch hosting:=one_process", "realizations:=200 steps:=5"),
    *(("roslaunch stochastic_platoon platoon.launch " + begin, "realizations:=200 steps:=20 followers:=5")  # a second each in place of six
      for begin in ("headway:=2.4", "loss:=0.1", "model:=", "external:=3", "record:=/tmp/external.bag")),
    ("roslaunch stochastic_platoon platoon.launch", "realizations:=200 steps:=20"),
    ("roslaunch stochastic_platoon replay.launch bag:=/tmp/run.bag drive:=leader", "realizations:=200"),
    ("rosrun stochastic_platoon monte_carlo --realizations 1e9 --shard", "--steps 20"),
    ("rosrun stochastic_platoon monte_carlo --model paper_at_rest.yaml", ""),  # 0.3 s; the next lines need its realizations
    ("rosrun stochastic_platoon monte_carlo --repeat", ""),
    ("rosrun stochastic_platoon monte_carlo --model acc_limits.yaml --headway-seconds 2.8", ""),  # its first 20 steps are at rest
    ("rosrun stochastic_platoon monte_carlo --leader city.csv", "--steps 20"),
    ("rosrun stochastic_platoon monte_carlo", "--realizations 200 --steps 20"),
)
# (command that stays up in its own terminal, output that shows that it is up, words of the following lines that need it).
STANDING = (
    ("roslaunch stochastic_platoon followers.launch", "process[platoon/vehicle_20", "last:="),
    ("roslaunch stochastic_platoon platoon.launch dashboard:=true", "The run is complete. Its nodes stay up until Ctrl-C.", "no line"),
    ("roscore", "started core service [/rosout]", " 3|external:="),
    ("rosrun stochastic_platoon rospy_follower.py", "", " 3|external:="),
)
STAY_UP = "roslaunch stochastic_platoon live.launch"
# What roscpp says where a node is ended while it registers a topic: those of its diagnostics begin seconds after its start.
OF_AN_ENDED_NODE = re.compile(r"\[ERROR\] \[[\d.]+\]: \[\w+\] Failed to contact master at \[[^]]+\]\.  Retrying\.\.\.")
# roslaunch and rospy of Debian 11 call a method that its Python no longer has, when they end, and CMake finds no threads in its libc.
OF_DEBIAN_11 = re.compile(r"Traceback \(most recent call last\):\n(?:  .*\n)*AttributeError: '\w+' object has no attribute 'isAlive'"
                          r"|^-- Looking for pthread_create in pthreads - not found$", re.M)


FILES = ("README.md", "config/README.md", "launch/README.md", "launch/examples/README.md", "msg/README.md")


def command_lines(text):
    """The indented lines of a text, without its blocks of code."""
    text = re.sub(r"^```\w*\n.*?^```$", "", text, flags=re.S | re.M)
    lines = [line.strip() for line in text.splitlines() if line.startswith("    ")]
    return [re.sub(r"\s+# .*", "", line) for line in lines]


def text_of(name):
    with open(os.path.join(PACKAGE, name)) as file:
        return file.read()


class Commands(unittest.TestCase):
    """Runs command lines as they are typed."""

    shorter = SHORTER

    @classmethod
    def setUpClass(cls):
        cls.folder = temporary_folder(cls.addClassCleanup)
        cls.home = os.path.join(cls.folder, "home")
        os.mkdir(cls.home)
        cls.environment = dict(HOME=cls.home, TMPDIR=cls.folder, PATH="/usr/bin:/bin", LANG="C.UTF-8", TERM="dumb", ROS_HOSTNAME="localhost",
                               ROS_MASTER_URI="http://localhost:{}".format(live_platoon.free_port()), REALIZATIONS="1000",
                               PYTHONUNBUFFERED="1")  # otherwise roslaunch buffers its output
        if "PLATOON_SANITIZED" in os.environ:  # see test/sanitize
            cls.environment.update({name: value for name, value in os.environ.items() if name == "CXXFLAGS" or name.endswith("SAN_OPTIONS")})

    def start(self, line):
        extra = next((extra for begin, extra in self.shorter if line.startswith(begin)), "")
        if line == "roscore":
            extra = "-p " + self.environment["ROS_MASTER_URI"].rsplit(":", 1)[1]
        typed = (line + " " + extra).replace("/tmp/", self.folder + "/")
        typed = re.sub(r"(--sweep-\w+ [\d.]+:[\d.]+:)\d{3}", r"\g<1>20", typed)  # a map of 20 x 20 points
        if line == ". devel/setup.bash":
            typed = ". " + SETUP
        self.log = tempfile.NamedTemporaryFile("w+", dir=self.folder, suffix=".log", delete=False)
        self.addCleanup(self.log.close)
        process = subprocess.Popen(["bash", "-c", typed if line.startswith(".") else ". " + SETUP + " && exec " + typed],
                                   cwd=PACKAGE, env=self.environment, stdout=self.log, stderr=subprocess.STDOUT,
                                   start_new_session=True)
        self.addCleanup(self.interrupt, process)
        return process

    def said(self):
        with open(self.log.name, errors="replace") as file:
            return file.read()

    def check(self, line, process):
        status = process.wait(timeout=4 * live_platoon.DEADLINE)
        text = self.said()
        self.assertEqual(status, 0, "{}\n{}".format(line, text))
        text = OF_AN_ENDED_NODE.sub("", OF_DEBIAN_11.sub("", text))
        for bad in ("Traceback", "[ERROR]", "FATAL", "RLException", "DISAGREE") + (() if line.startswith("cmake") else ("not found",)):
            self.assertNotIn(bad, text, line)
        if line.startswith("rosservice"):
            self.assertIn("success: True", text, line)
        if line.startswith("roslaunch") and "drive:=vehicle" not in line:
            self.assertIn("Results: ", text, line)
        if "drive:=vehicle" in line:
            self.assertIn("equal the recorded ones to the bit", text)

    def takes_orders(self):
        try:
            with xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"]) as master:
                return all(master.lookupService("/readme_test", "/platoon/" + service)[0] == 1
                           for service in ("leader/cruise", "change_run"))
        except OSError:
            return False

    def type_all(self, lines):
        standing = []
        for line in lines:
            if line in NOT_RUN:
                continue
            self.assertTrue(line.startswith(COMMANDS + ("/tmp/",)), "a line that is no command: " + line)
            with self.subTest(line=line):
                while standing and not re.search(standing[-1][1], line):
                    self.interrupt(standing.pop()[0])
                process = self.start(line)
                stands = next((entry for entry in STANDING if line.startswith(entry[0])), None)
                if line.startswith(STAY_UP):
                    standing.append((process, "^({})".format("|".join(ORDERS))))
                    live_platoon.wait_for(self.takes_orders, line)
                elif stands:
                    standing.append((process, stands[2]))
                    live_platoon.wait_for(lambda: stands[1] in self.said() or process.poll() is not None, line)
                    self.assertIsNone(process.poll(), self.said())
                else:
                    self.check(line, process)
        while standing:
            self.interrupt(standing.pop()[0])

    def interrupt(self, process):
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
        process.wait(timeout=live_platoon.DEADLINE)


class Readme(Commands):
    def test_every_command_line_works_as_typed(self):
        lines = [line for name in FILES for line in command_lines(text_of(name))]
        self.assertGreater(len(lines), 15)
        self.type_all(lines)


if __name__ == "__main__":
    unittest.main()
