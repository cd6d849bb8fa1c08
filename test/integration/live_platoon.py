"""Access to a running platoon for the integration tests, and waiting for conditions with a deadline."""

import contextlib
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import time
import xmlrpc.client

import rosgraph
import rospkg

SANITIZED = "PLATOON_SANITIZED" in os.environ
PATIENCE = 5.0 if SANITIZED else 1.0
# Most attempts of a start that nothing disturbs: a scheduling gap longer than the timeout of an attempt's first step, 0.1 s and 0.01 s
# per follower, begins another one. In a sanitized build that step may take longer than the stall timeout.
UNDISTURBED = 5 if SANITIZED else 3
# The package's programs: without ROS or a master, nodes, and those in Python. tools_test.py checks that none is missing.
TOOLS = ["analyze", "bag_statistics", "check", "check_vehicle", "configure", "merge", "monte_carlo", "rare", "sweep"]
NODES = ["channel", "follower", "leader", "markers", "monitor", "platoon", "player", "until_complete", "vehicle_replay"]
SCRIPTS = ["dashboard", "export", "odometry_vehicle", "plot", "recorded_drive", "report", "tune", "watch"]
RESERVED = []  # sockets of free_port()
DEADLINE = 150.0  # [s] for a run to complete on a busy machine


def skip_without(*programs):
    """Skips the test (status 77) and prints the reason if any of these programs is not installed."""
    missing = [program for program in programs if not shutil.which(program)]
    if missing:
        print("skipped: needs " + ", ".join(missing))
        sys.exit(77)


def wait_for(condition, what, deadline=DEADLINE):
    """Waits for condition(); returns its first true value. Raises AssertionError, which names `what`, after the deadline [s]."""
    end = time.monotonic() + deadline * PATIENCE
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError("waited {:.0f} s in vain for {}".format(deadline * PATIENCE, what))


def written_at(file):
    """Modification time [ns] of a file; None if it does not exist, as a checkpoint until the new one takes its name."""
    try:
        return os.stat(file).st_mtime_ns
    except OSError:
        return None


def free_port():
    """A free port for a master, outside the range from which the system assigns ports.

    It is reserved while this process runs: a socket stays bound to it, so that no other test can choose it. A server that sets
    SO_REUSEADDR, as those of Python do, can listen on it.
    """
    while True:
        port, bound = random.randrange(20000, 32000), socket.socket()
        try:
            bound.bind(("localhost", port))
        except OSError:
            bound.close()
            continue
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        RESERVED.append(bound)
        return port


def ros_environment(master, **more):
    """The environment of a process that is to be on this master."""
    return dict(os.environ, ROS_MASTER_URI=master, ROS_HOSTNAME="localhost", **more)


def summary_of(output):
    """The content of summary.json."""
    with open(os.path.join(output, "summary.json")) as file:
        return json.load(file)


def completed_summary(output):
    """The content of summary.json of a completed run; None before."""
    try:
        summary = summary_of(output)
    except OSError:
        return None
    return summary if summary["complete"] else None


def statistics(output):
    """The bytes of statistics.csv: %.17g keeps every bit of a double."""
    with open(os.path.join(output, "statistics.csv"), "rb") as file:
        return file.read()


def executable(name):
    """Path of one of the package's programs, in the devel or the install space."""
    from catkin.find_in_workspaces import find_in_workspaces

    for folder in find_in_workspaces(["libexec"], project="stochastic_platoon"):
        path = os.path.join(folder, name)
        if os.access(path, os.X_OK):
            return path
    raise AssertionError("no executable " + name)


def system_executable(package, name):
    """Path of a program of another package."""
    found = subprocess.run(["catkin_find", "--libexec", package, name], stdout=subprocess.PIPE, universal_newlines=True)
    paths = [path for path in found.stdout.split() if os.access(path, os.X_OK)]
    return paths[0] if paths else "/usr/lib/{}/{}".format(package, name)


def programs_in(folder):
    """Names of the programs in a folder, without the examples in Python."""
    return {name for name in os.listdir(folder) if os.path.isfile(os.path.join(folder, name)) and os.access(os.path.join(folder, name), os.X_OK)
            and not name.endswith(".py")}


def shared(*parts):
    """Path of a file of the package's source or share folder."""
    return os.path.join(rospkg.RosPack().get_path("stochastic_platoon"), *parts)


def tool(name, *arguments, **options):
    """The finished process of one of the package's programs."""
    command = [executable(name), *arguments]
    for option, value in options.items():
        command += ["--" + option.replace("_", "-"), str(value)]
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, errors="replace",
                          timeout=DEADLINE * PATIENCE)


def reference(output, **settings):
    """statistics.csv of monte_carlo with these settings: the same platoon in one process, without ROS."""
    folder = os.path.join(output, "reference")
    settings.setdefault("model", shared("config", "paper.yaml"))
    done = tool("monte_carlo", output=folder, **settings)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return statistics(folder)


def process_of(node, master=None):
    """Process id of a node on the given master (default: this test's); None while it is unknown."""
    caller = "/integration_test"
    try:
        with xmlrpc.client.ServerProxy(master or rosgraph.get_master_uri()) as proxy:
            uri = proxy.lookupNode(caller, node)[2]
        with xmlrpc.client.ServerProxy(uri) as proxy:
            return proxy.getPid(caller)[2]
    except (xmlrpc.client.Error, OSError):
        return None


def kill(node, master=None):
    """Kills a node with SIGKILL and waits until roslaunch has restarted it."""
    before = wait_for(lambda: process_of(node, master), node)
    os.kill(before, signal.SIGKILL)
    wait_for(lambda: process_of(node, master) not in (None, before), node + " to come back")


@contextlib.contextmanager
def held(node, master=None):
    """Holds a node by SIGSTOP, from its start on if it does not run yet; continues it at the end."""
    process = wait_for(lambda: process_of(node, master), node)
    os.kill(process, signal.SIGSTOP)
    try:
        yield
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, signal.SIGCONT)
