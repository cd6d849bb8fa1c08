#!/usr/bin/python3
"""Prints the ratios of pairs of measurements, taken alternately in one run (medians); writes JSON to the given file."""

import json
import os
import platform
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
import xmlrpc.client

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "integration"))
import live_platoon  # noqa: E402
import scaling  # noqa: E402

ROUNDS = 3
REALIZATIONS = 50000
MILLION = 1000000
MODEL = live_platoon.shared("config", "paper.yaml")


def output_of(command, **options):
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True, **options).stdout)


def in_turn(*measurements):
    """Medians of several measurements, taken alternately, ROUNDS times each."""
    values = [[] for _ in measurements]
    for _ in range(ROUNDS):
        for place, measure in zip(values, measurements):
            place.append(measure())
    return [statistics.median(place) for place in values]


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
        return port, dict(os.environ, ROS_MASTER_URI="http://localhost:{}".format(port), ROS_HOSTNAME="localhost",
                          ROS_HOME=self.folder)

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
            time.sleep(0.02)
        with open(os.path.join(output, "summary.json")) as file:
            summary = json.load(file)
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
            raise SystemExit("the dashboard told nothing: nothing is compared with it")
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


def descendants(pid):
    """A process and all its descendants."""
    try:
        with open("/proc/{0}/task/{0}/children".format(pid)) as file:
            children = file.read().split()
    except OSError:
        return []  # it has just ended
    return [pid] + [below for child in children for below in descendants(int(child))]


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


def monte_carlo(machine, *options):
    folder = machine.fresh("monte_carlo")
    subprocess.run([live_platoon.executable("monte_carlo"), "--model", MODEL, "--realizations", str(MILLION), "--output",
                    folder] + list(options), check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(folder, "summary.json")) as file:
        return json.load(file)["vehicle_steps_per_second"]


def rate_of_program(machine):
    """Vehicle-steps per second of the program monte_carlo, from its start to its end."""
    folder = machine.fresh("monte_carlo")
    return 2000 * MILLION / timed([live_platoon.executable("monte_carlo"), "--model", MODEL, "--realizations", str(MILLION), "--output", folder])


def peer(program, *arguments):
    """The JSON of another program for the same Monte Carlo, on one core."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    interpreter = ["/usr/bin/python3"] if program.endswith(".py") else ["octave-cli", "--no-gui"]
    return output_of(interpreter + [os.path.join(HERE, program)] + list(arguments), env=environment, stderr=subprocess.DEVNULL)


def timed(command):
    began = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def pairs(machine):
    """Yields (quantity, compared with, its value, value of the other)."""
    ours, theirs = in_turn(lambda: output_of([live_platoon.executable("noise_benchmark")])["normals_per_second"],
                           lambda: peer("peer_numpy.py", "normals")["normals_per_second"])
    yield "normals per second, one core", "NumPy standard_normal", ours, theirs
    speed = "vehicle_steps_per_second"
    core, lossy, signals, numpy, scipy, octave, one, many = in_turn(
        lambda: monte_carlo(machine), lambda: monte_carlo(machine, "--loss", "0.1"),
        lambda: monte_carlo(machine, "--signals", "gap,speed,acceleration,jerk"),
        lambda: peer("peer_numpy.py", str(REALIZATIONS), "1024")[speed],
        lambda: peer("peer_scipy.py", str(REALIZATIONS // 4), "256")[speed],
        lambda: peer("peer_octave.m", str(REALIZATIONS // 4), "256")[speed],
        lambda: machine.speed(realizations=MILLION, hosting="one_process"),
        lambda: machine.speed(realizations=4 * REALIZATIONS))
    yield "monte_carlo, vehicle-steps per second", "NumPy program, one core", core, numpy
    yield "monte_carlo, positions lost with probability 0.1", "monte_carlo", lossy, core
    yield "monte_carlo, gap, speed, acceleration and jerk", "monte_carlo", signals, core
    yield "monte_carlo", "SciPy lfilter program, one core", core, scipy
    yield "monte_carlo", "Octave program", core, octave
    yield "one_process", "monte_carlo", one, core
    yield "processes", "NumPy program, one core", many, numpy
    module, program = in_turn(lambda: peer("from_python.py", str(MILLION))[speed], lambda: rate_of_program(machine))
    yield "sp.monte_carlo in Python", "monte_carlo, its start and end included", module, program
    yield from scaling.pairs(machine.folder, in_turn)
    # Three crossings of a socket for every position: to the channel, to the monitor, to the follower.
    flood, = in_turn(lambda: machine.flood(("source", 8192, 20000), ("sink", 20000))["bytes_per_second"])
    yield "processes, bytes per second", "flood of 64 kB messages", 24.0 * many, flood
    single, small = in_turn(lambda: machine.speed(realizations=200, batch=1),
                            lambda: machine.flood(("source", 1, 300000), ("sink", 300000))["messages_per_second"])
    yield "one realization a message, deliveries per second", "flood of small messages", 3.05 * single, small
    # A step goes from the leader to the monitor, and the credit for it back.
    steps, round_trips = in_turn(lambda: machine.speed(followers=1, realizations=200, batch=1),
                                 lambda: machine.flood(("pong", 20000), ("ping", 1, 20000))["round_trips_per_second"])
    yield "steps per second of one follower", "round trips of a ping-pong", steps, round_trips
    for hosting, followers in (("processes", 100), ("one_process", 500)):
        short, long = in_turn(lambda: machine.speed(hosting=hosting, realizations=4 * REALIZATIONS),
                              lambda: machine.speed(hosting=hosting, realizations=REALIZATIONS, followers=followers))
        yield "cost of a vehicle-step at N = {}, {}".format(followers, hosting), "N = 20", short, long
    # 104: 100 followers, leader, channel, monitor and until_complete; configure is not a node
    first, empty = in_turn(lambda: machine.seconds_to_first_step(100), lambda: machine.seconds_to_empty_nodes(104))
    yield "seconds to the first step, N = 100", "104 empty nodes up", first, empty
    large, small = in_turn(lambda: machine.memory(realizations=MILLION), lambda: machine.memory(realizations=10000))
    yield "memory of the graph, 10^6 realizations [byte]", "10^4 realizations", large, small
    watched, plain = in_turn(lambda: machine.speed_with_dashboard(realizations=2 * REALIZATIONS),
                             lambda: machine.speed(realizations=2 * REALIZATIONS))
    yield "with the dashboard open", "the same without", watched, plain
    bag = os.path.join(machine.folder, "run.bag")

    def record():
        machine.fresh("run.bag")
        return machine.speed(realizations=4 * REALIZATIONS, record=bag)

    recorded, plain = in_turn(record, lambda: machine.speed(realizations=4 * REALIZATIONS))
    yield "recorded at full speed", "the same unrecorded", recorded, plain
    reading, bare = in_turn(lambda: 1.0 / timed([live_platoon.executable("bag_statistics"), bag]),
                            lambda: 1.0 / timed([live_platoon.executable("view_loop"), bag]))
    yield "bag_statistics, bags per second", "a bare rosbag::View loop", reading, bare


def processor():
    with open("/proc/cpuinfo") as file:
        return next(line.split(":")[1].strip() for line in file if line.startswith("model name"))


def main():
    machine = Machine()
    print("{}, {} cores; medians of {}".format(processor(), os.cpu_count(), ROUNDS))
    print("{:>7}  {:<50} {:<31} {:>10} {:>10}".format("ratio", "what", "against", "value", "other"))
    rows = []
    try:
        for what, against, value, other in pairs(machine):
            print("{:7.2f}  {:<50} {:<31} {:10.3g} {:10.3g}".format(value / other, what, against, value, other), flush=True)
            rows.append({"what": what, "against": against, "ratio": value / other, "value": value, "other": other})
    finally:
        shutil.rmtree(machine.folder, ignore_errors=True)
    if len(sys.argv) > 1:
        with open(sys.argv[1], "w") as file:
            json.dump({"machine": platform.platform(), "processor": processor(), "cores": os.cpu_count(), "rounds": ROUNDS, "ratios": rows}, file, indent=1)


if __name__ == "__main__":
    main()
