"""Runs, start-ups and floods on this machine, and what they cost."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
import xmlrpc.client

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "integration"))
import live_platoon  # noqa: E402
from processes import descendants  # noqa: E402


def output_of(command, **options):
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True, **options).stdout)


class Machine:
    """A scratch folder and a port for masters."""

    def __init__(self):
        self.folder = tempfile.mkdtemp()

    def fresh(self, name):
        path = os.path.join(self.folder, name)
        if os.path.isdir(path):
            shutil.rmtree(path)
        elif os.path.exists(path):
            os.remove(path)
        return path

    def environment(self):
        port = live_platoon.free_port()
        return port, live_platoon.ros_environment("http://localhost:{}".format(port), ROS_HOME=self.folder)

    def roslaunch(self, port, environment, *words):
        return subprocess.Popen(["roslaunch", "--port", str(port)] + list(words), stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL, env=environment)

    def launch(self, watch=None, **arguments):
        """summary.json of a run of platoon.launch; watch(process) is called again and again while it runs."""
        output = self.fresh("run")
        port, environment = self.environment()
        arguments.setdefault("output", output)
        words = ["{}:={}".format(name, value) for name, value in arguments.items()]
        process = self.roslaunch(port, environment, "stochastic_platoon", "platoon.launch", *words)
        while process.poll() is None:
            if watch:
                watch(process)
            if "dashboard" in arguments and live_platoon.completed_summary(output):  # the page would stay
                process.send_signal(signal.SIGINT)
                process.wait()
            time.sleep(0.02)
        summary = live_platoon.summary_of(output)
        if not summary["complete"] or summary["positions_lost"] != 0:
            raise SystemExit("a run was not complete: nothing is compared with it")
        return summary

    def speed(self, **arguments):
        return self.launch(**arguments)["vehicle_steps_per_second"]

    def speed_with_dashboard(self, **arguments):
        """The same while the dashboard runs and a client reads its event stream (drawing would load the browser's machine)."""
        port = live_platoon.free_port()
        news = [0]

        def read():
            try:
                with urllib.request.urlopen("http://localhost:{}/events".format(port)) as stream:
                    for line in stream:
                        news[0] += line.startswith(b"event: ")
            except OSError:
                pass  # not up yet, or ended with the run
        reader = threading.Thread(target=read)

        def watch(_):
            nonlocal reader
            if not reader.is_alive():
                reader = threading.Thread(target=read)
                reader.start()
        value = self.launch(watch, dashboard="true", dashboard_port=port, **arguments)["vehicle_steps_per_second"]
        if news[0] < 10:
            raise SystemExit("the dashboard sent no state: there is nothing to compare")
        return value

    def memory(self, **arguments):
        """Largest sum of the proportional set sizes [bytes] of all processes of a run."""
        peak = [0]

        def watch(process):
            peak[0] = max(peak[0], sum(map(proportional_set_size, descendants(process.pid))))

        self.launch(watch, **arguments)
        return peak[0]

    def start_up(self, words, wait):
        """Seconds from roslaunch until wait(environment) returns."""
        port, environment = self.environment()
        began = time.perf_counter()
        process = self.roslaunch(port, environment, *words)
        wait(environment)
        seconds = time.perf_counter() - began
        process.send_signal(signal.SIGINT)
        process.wait()
        return seconds

    def seconds_to_first_step(self, followers):
        words = ["stochastic_platoon", "platoon.launch", "followers:={}".format(followers), "realizations:=100000000",
                 "output:=" + self.fresh("run")]
        return self.start_up(words, lambda environment: subprocess.run(
            [live_platoon.executable("first_step")], check=True, env=environment, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL))

    def seconds_to_empty_nodes(self, count):
        """Seconds until so many empty nodes are registered with the master."""
        file = os.path.join(self.folder, "empty.launch")
        node = '<node pkg="stochastic_platoon" type="empty_node" name="empty_{}"/>'
        with open(file, "w") as launch:
            launch.write("<launch>{}</launch>".format("".join(node.format(n) for n in range(count))))
        return self.start_up([file], lambda environment: live_platoon.wait_for(
            lambda: known_nodes(environment["ROS_MASTER_URI"]) >= count, "the empty nodes"))

    def flood(self, *roles):
        """The JSON of the second of two flood processes, which run at the same time on one roscore."""
        port, environment = self.environment()
        core = subprocess.Popen(["roscore", "-p", str(port)], env=environment, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)
        first, second = [[live_platoon.executable("flood")] + [str(word) for word in role] for role in roles]
        try:
            live_platoon.wait_for(lambda: live_platoon.process_of("/rosout", environment["ROS_MASTER_URI"]), "the master")
            other = subprocess.Popen(first, env=environment)
            result = output_of(second, env=environment)
            other.wait()
            return result
        finally:
            core.send_signal(signal.SIGINT)
            core.wait()


def proportional_set_size(pid):
    try:
        with open("/proc/{}/smaps_rollup".format(pid)) as file:
            return next(1024 * int(line.split()[1]) for line in file if line.startswith("Pss:"))
    except (OSError, StopIteration):
        return 0  # it has just ended


def known_nodes(master):
    """The registered nodes: every node has at least a logger service."""
    try:
        services = xmlrpc.client.ServerProxy(master).getSystemState("/benchmark")[2][2]
    except (xmlrpc.client.Error, OSError):
        return 0
    return len({node for _, nodes in services for node in nodes})
