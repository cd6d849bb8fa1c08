#!/usr/bin/python3
"""The installed package: catkin_lint, an install space, and runs of the installed programs without the checkout.

By default the test installs the build beside the checkout and hides the checkout behind an empty folder if the system allows it.
`installed_test.py --workspace` builds a copy with `catkin build` in a temporary workspace instead (four minutes of two cores):
without optimisation and as a unity build, to save time; the results must still equal the optimised build bit for bit. Without
catkin-tools and catkin-lint the test is skipped: status 77.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import live_platoon

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SETTINGS = dict(followers=2, steps=20, realizations=100)


def run(command, folder, inside=(), **environment):
    """The output of a command in a shell without the environment of this workspace."""
    done = subprocess.run(list(inside) + ["bash", "-c", command], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, errors="replace",
                          env=dict(environment, HOME=folder, PATH="/usr/bin:/bin", ROS_HOSTNAME="localhost"))
    if done.returncode != 0:
        raise AssertionError("{}: status {}\n{}".format(command, done.returncode, done.stdout))
    return done.stdout


def install_by_catkin_build(folder, _):
    # The workspace extends a ROS outside of /usr.
    setup = "/opt/ros/{}/setup.bash".format(os.environ.get("ROS_DISTRO", ""))
    underlay = ". {}; ".format(setup) if os.path.exists(setup) else ""
    run(underlay + "catkin config --init --install --cmake-args -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= "
        "-DCMAKE_UNITY_BUILD=ON -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCATKIN_ENABLE_TESTING=OFF && catkin build --no-status --summarize",
        folder)
    for space in ("src", "build", "devel"):
        shutil.rmtree(os.path.join(folder, space))
    return []


def install_the_build(folder, build):
    """Installs the build; returns a command prefix under which the checkout is hidden."""
    prefix = os.path.join(folder, "install")
    run("cmake --install {} --prefix {}".format(build, prefix), folder)
    # Files that catkin adds when it installs a workspace.
    open(os.path.join(prefix, ".catkin"), "w").close()
    for file in ("_setup_util.py", "setup.sh", "setup.bash"):
        shutil.copy(os.path.join(build, "catkin_generated", "installspace", file), prefix)
    root = [] if os.geteuid() == 0 else ["--map-root-user"]
    hidden = ["unshare", "--mount"] + root + ["bash", "-c", 'mount -t tmpfs none "$0" && exec "$@"', SOURCE]
    return hidden if subprocess.run(hidden + ["true"], stderr=subprocess.DEVNULL).returncode == 0 else []


class Installed(unittest.TestCase):
    install = staticmethod(install_the_build)
    build = os.path.join(SOURCE, "build")

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        sources = os.path.join(cls.folder, "src", "stochastic_platoon")
        shutil.copytree(SOURCE, sources, ignore=shutil.ignore_patterns("build", "devel", "install", ".git", "__pycache__"))
        cls.lint = run("catkin_lint --offline --strict -W2 src", cls.folder)
        cls.inside = cls.install(cls.folder, cls.build)

    def installed(self, command, **environment):
        return run(". install/setup.bash; " + command, self.folder, self.inside, **environment)

    def test_every_program_is_installed_and_runs(self):
        programs = set(live_platoon.TOOLS + live_platoon.NODES + live_platoon.SCRIPTS)
        of_launch = {"isolated", "shards.sbatch"}  # scripts for bash and Slurm, which have no --version
        self.assertEqual(live_platoon.programs_in(os.path.join(self.folder, "install", "lib", "stochastic_platoon")), programs | of_launch)
        each = "for tool in {}; do {{}} rosrun stochastic_platoon $tool {{}} || exit; done".format(" ".join(sorted(programs)))
        versions = self.installed(each.format("", "--version")).splitlines()
        self.assertEqual(len(versions), len(programs), versions)
        self.assertEqual(len(set(versions)), 1, versions)
        self.assertRegex(versions[0], "^stochastic_platoon [0-9.]+$")
        for said in self.installed(each.format("echo @of $tool;", "--help")).split("@of ")[1:]:
            self.assertIn("--version", said)
        examples = sorted(path.name for path in pathlib.Path(self.folder, "install", "lib", "stochastic_platoon").glob("*.py"))
        self.assertEqual(len(examples), 8)
        for program in [*examples, *sorted(of_launch)]:
            self.assertIn("Example: ", self.installed("rosrun stochastic_platoon {} --help".format(program)), program)

    def test_the_theory_is_that_of_the_installed_model_file(self):
        report = self.installed("rosrun stochastic_platoon analyze --json analysis.json")
        self.assertIn(self.folder + "/install/share/stochastic_platoon/config/paper.yaml", report)
        figures = self.installed("rosrun stochastic_platoon plot gain analysis.json --output gain")
        self.assertEqual(figures, "gain.png\ngain.svg\n")
        figures = self.installed("rosrun stochastic_platoon plot gain {} --output gains.pdf".format("analysis.json " * 6))
        self.assertEqual(figures, "gains.pdf\n")

    def test_the_python_module_is_installed_and_finds_the_installed_models(self):
        program = ("import stochastic_platoon as sp, stochastic_platoon._platoon as core; print(sp.__file__); "
                   "print(core.shipped_file('acc.yaml', 'config')); print(sp.analyze(sp.Model.load('acc.yaml')).critical_headway / 100)")
        found = self.installed('/usr/bin/python3 -c "{}"'.format(program)).split()
        for path in found[:2]:
            self.assertTrue(path.startswith(self.folder + "/install/"), path)
        self.assertAlmostEqual(float(found[2]), 3.1572816, places=7)

    def test_the_tutorial_runs_and_finds_the_shipped_drive(self):
        self.assertIn("critical headway: 0.280 s (2.800 sample periods)", self.installed("rosrun stochastic_platoon tutorial_1_paper.py tutorial"))
        self.assertIn("theory 0.9620", self.installed("rosrun stochastic_platoon tutorial_5_drive.py tutorial"))
        self.assertEqual(sorted(os.listdir(os.path.join(self.folder, "tutorial"))), ["tutorial_1_paper.png", "tutorial_5_drive.png"])

    def test_a_run_of_the_graph_gives_the_bits_of_the_checkout(self):
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
        """Runs check_vehicle on its own master; all processes end with the shell."""
        port = live_platoon.free_port()
        said = self.installed("trap 'kill $(jobs -p); wait' EXIT; roscore -p {} > /dev/null & "
                              "until rosnode list > /dev/null 2>&1; do sleep 0.2; done; {} & "
                              "rosrun stochastic_platoon check_vehicle 2".format(port, vehicle),
                              ROS_MASTER_URI="http://localhost:{}".format(port))
        self.assertIn("vehicle_2 keeps the vehicle contract", said)

    def test_another_package_uses_the_mathematics(self):
        self.installed("cp -r install/share/stochastic_platoon/launch/examples/string_margin margin && "
                       "cmake -S margin -B margin/build -DPYTHON_EXECUTABLE=/usr/bin/python3 && make -C margin/build")
        printed = self.installed("margin/build/devel/lib/string_margin/string_margin")
        self.assertIn("critical headway 0.2800 s", printed)
        self.assertIn("variance 1.361445 m^2 of follower 1, 2.281824 m^2 of follower 20\nvariance 2.292677 m^2 in an endless string\n", printed)

    @unittest.skipUnless(os.path.exists(os.path.join(build, "CPackConfig.cmake")) and shutil.which("dpkg-deb"), "needs a build of this package alone, on Debian")
    def test_the_debian_package_has_the_programs_of_users_below_usr(self):
        printed = run("cpack -G DEB --config {}/CPackConfig.cmake -B $PWD/.cpack -D CPACK_OUTPUT_FILE_PREFIX=$PWD".format(self.build), self.folder)
        packages = [name for name in os.listdir(self.folder) if name.endswith(".deb")]
        self.assertEqual(len(packages), 1, printed)
        run("dpkg-deb -x {} root".format(packages[0]), self.folder)
        root = os.path.join(self.folder, "root")
        files = {os.path.relpath(os.path.join(folder, name), root) for folder, _, names in os.walk(root) for name in names}
        for file in files:
            self.assertRegex(file, "^usr/(lib|share|include)/")
        programs = {os.path.basename(file) for file in files if file.startswith("usr/lib/stochastic_platoon/") and os.access(os.path.join(root, file), os.X_OK)}
        self.assertTrue({"analyze", "check", "export", "monte_carlo", "plot", "report", "leader"} <= programs)
        self.assertEqual({name for name in programs if "unit" in name or "test" in name or "without" in name}, set())
        with open(os.path.join(root, "usr/share/stochastic_platoon/cmake/stochastic_platoonConfig.cmake")) as file:
            self.assertNotIn("/usr/local", file.read())

    def test_nothing_is_installed_that_needs_the_sources(self):
        share = os.path.join(self.folder, "install", "share", "stochastic_platoon")
        self.assertEqual(sorted(os.listdir(share + "/launch")),
                         sorted(name for name in os.listdir(SOURCE + "/launch")
                                if name in ("examples", "include") or name.endswith(".launch")))


if __name__ == "__main__":
    live_platoon.skip_without("catkin", "catkin_lint")
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workspace", action="store_true", help="build a copy with catkin build")
    parser.add_argument("--build", default=Installed.build, help="the build folder that is installed (%(default)s)")
    options, others = parser.parse_known_args()
    Installed.build = options.build
    if options.workspace:
        Installed.install = staticmethod(install_by_catkin_build)
    unittest.main(argv=sys.argv[:1] + others)
