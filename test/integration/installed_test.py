#!/usr/bin/python3
"""The package as a workspace gets it: catkin_lint, catkin build into an install space, and runs of what is installed there.

The workspace is temporary, and its sources are gone before anything runs. It is built without optimisation and several files at
once, to save time; the bits must be those of the optimised build all the same. Without catkin-tools and catkin-lint there is nothing to test: status 77.
"""

import os
import shutil
import subprocess
import tempfile
import unittest

import live_platoon

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SETTINGS = dict(followers=2, steps=20, realizations=100)


def run(command, folder, **environment):
    """Its output, of a shell that knows nothing of this one's workspace."""
    done = subprocess.run(["bash", "-c", command], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, errors="replace",
                          env=dict(environment, HOME=folder, PATH="/usr/bin:/bin", ROS_HOSTNAME="localhost"))
    if done.returncode != 0:
        raise AssertionError("{}: status {}\n{}".format(command, done.returncode, done.stdout))
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        sources = os.path.join(cls.folder, "src", "stochastic_platoon")
        shutil.copytree(SOURCE, sources, ignore=shutil.ignore_patterns("build", "devel", "install", ".git", "__pycache__"))
        cls.lint = run("catkin_lint --offline --strict -W2 src", cls.folder)
        # A ROS outside of /usr is what the workspace extends.
        setup = "/opt/ros/{}/setup.bash".format(os.environ.get("ROS_DISTRO", ""))
        underlay = ". {}; ".format(setup) if os.path.exists(setup) else ""
        run(underlay + "catkin config --init --install --cmake-args -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= "
            "-DCMAKE_UNITY_BUILD=ON -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCATKIN_ENABLE_TESTING=OFF && catkin build --no-status --summarize",
            cls.folder)
        for space in ("src", "build", "devel"):
            shutil.rmtree(os.path.join(cls.folder, space))

    def installed(self, command, **environment):
        return run(". install/setup.bash; " + command, self.folder, **environment)

    def test_every_tool_runs(self):
        for tool in ("analyze", "bag_statistics", "check_vehicle", "configure", "merge", "monte_carlo", "plot", "sweep", "watch"):
            self.assertIn("--version", self.installed("rosrun stochastic_platoon {} --help".format(tool)))
            self.assertRegex(self.installed("rosrun stochastic_platoon {} --version".format(tool)),
                             r"^stochastic_platoon [0-9.]+\n$")

    def test_the_theory_is_that_of_the_installed_model_file(self):
        report = self.installed("rosrun stochastic_platoon analyze --json analysis.json")
        self.assertIn(self.folder + "/install/share/stochastic_platoon/config/paper.yaml", report)
        figures = self.installed("rosrun stochastic_platoon plot gain analysis.json --output gain")
        self.assertEqual(figures, "gain.png\ngain.svg\n")

    def test_a_run_of_the_graph_gives_the_bits_of_the_optimised_build(self):
        words = " ".join("{}:={}".format(name, value) for name, value in SETTINGS.items())
        port = live_platoon.free_port()
        printed = self.installed("roslaunch --port {} stochastic_platoon platoon.launch output:=$PWD/run {}".format(port, words),
                                 ROS_MASTER_URI="http://localhost:{}".format(port))
        run_folder = os.path.join(self.folder, "run")
        self.assertTrue(live_platoon.completed_summary(run_folder), printed)
        self.assertEqual(live_platoon.statistics(run_folder), live_platoon.reference(self.folder, **SETTINGS))

    def test_another_package_builds_its_vehicle_against_it_and_the_vehicle_keeps_the_contract(self):
        self.installed("cp -r install/share/stochastic_platoon/launch/examples/saturated_follower follower && "
                       "cmake -S follower -B follower/build -DPYTHON_EXECUTABLE=/usr/bin/python3 && make -C follower/build")
        self.check_in_ros("follower/build/devel/lib/saturated_follower/saturated_follower _index:=2")

    def test_the_example_in_rospy_keeps_the_contract(self):
        self.check_in_ros("rosrun stochastic_platoon rospy_follower.py 2")

    def check_in_ros(self, vehicle):
        """On a master of its own, all of whose processes end with the shell."""
        port = live_platoon.free_port()
        said = self.installed("trap 'kill $(jobs -p); wait' EXIT; roscore -p {} > /dev/null & "
                              "until rosnode list > /dev/null 2>&1; do sleep 0.2; done; {} & "
                              "rosrun stochastic_platoon check_vehicle 2".format(port, vehicle),
                              ROS_MASTER_URI="http://localhost:{}".format(port))
        self.assertIn("vehicle_2 keeps the vehicle contract", said)

    def test_nothing_is_installed_that_needs_the_sources(self):
        share = os.path.join(self.folder, "install", "share", "stochastic_platoon")
        self.assertEqual(sorted(os.listdir(share + "/launch")),
                         sorted(name for name in os.listdir(SOURCE + "/launch")
                                if name in ("examples", "include") or name.endswith(".launch")))


if __name__ == "__main__":
    live_platoon.skip_without("catkin", "catkin_lint")
    unittest.main()
