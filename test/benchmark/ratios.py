#!/usr/bin/python3
"""Ratios of what belongs together, each pair measured in turn in the same run: medians of several. JSON to the file given."""

import json
import os
import platform
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "integration"))
import live_platoon  # noqa: E402

ROUNDS = 3
REALIZATIONS = 50000
MODEL = live_platoon.shared("config", "paper.yaml")


def output_of(command, **options):
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True, **options).stdout)


def in_turn(*measurements):
    """Medians of several measurements that are taken one after the other, ROUNDS times."""
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

    def launch(self, **arguments):
        """summary.json of a run of platoon.launch."""
        output = self.fresh("run")
        port, environment = self.environment()
        arguments.setdefault("output", output)
        words = ["{}:={}".format(name, value) for name, value in arguments.items()]
        subprocess.run(["roslaunch", "--port", str(port), "stochastic_platoon", "platoon.launch"] + words, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
        with open(os.path.join(output, "summary.json")) as file:
            summary = json.load(file)
        if not summary["complete"] or summary["positions_lost"] != 0:
            raise SystemExit("a run was not complete: nothing is compared with it")
        return summary

    def flood(self, size, count):
        port, environment = self.environment()
        core = subprocess.Popen(["roscore", "-p", str(port)], env=environment, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)
        try:
            live_platoon.wait_for(lambda: live_platoon.process_of("/rosout", environment["ROS_MASTER_URI"]), "the master")
            flood = live_platoon.executable("flood")
            source = subprocess.Popen([flood, "source", str(size), str(count)], env=environment)
            result = output_of([flood, "sink", str(count)], env=environment)
            source.wait()
            return result
        finally:
            core.send_signal(signal.SIGINT)
            core.wait()


def monte_carlo(machine):
    folder = machine.fresh("monte_carlo")
    subprocess.run([live_platoon.executable("monte_carlo"), "--model", MODEL, "--realizations", str(REALIZATIONS), "--output",
                    folder], check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(folder, "summary.json")) as file:
        return json.load(file)["vehicle_steps_per_second"]


def peer(*arguments):
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    return output_of(["/usr/bin/python3", os.path.join(HERE, "peer_numpy.py")] + list(arguments), env=environment)


def timed(command):
    began = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def pairs(machine):
    """(what, against, value, value of the other): larger ratios are better."""
    ours, theirs = in_turn(lambda: output_of([live_platoon.executable("noise_benchmark")])["normals_per_second"],
                           lambda: peer("normals")["normals_per_second"])
    yield "normals per second, one core", "NumPy standard_normal", ours, theirs
    speed = "vehicle_steps_per_second"
    core, numpy, one, many = in_turn(
        lambda: monte_carlo(machine), lambda: peer(str(REALIZATIONS), "1024")[speed],
        lambda: machine.launch(realizations=REALIZATIONS, hosting="one_process")[speed],
        lambda: machine.launch(realizations=REALIZATIONS)[speed])
    yield "monte_carlo, vehicle-steps per second", "NumPy program, one core", core, numpy
    yield "one_process", "monte_carlo", one, core
    yield "processes", "NumPy program, one core", many, numpy
    # Three crossings of a socket for every position: to the channel, to the monitor, to the follower.
    flood = in_turn(lambda: machine.flood(8192, 20000)["bytes_per_second"])[0]
    yield "processes, bytes per second", "flood of 64 kB messages", 24.0 * many, flood
    single, small = in_turn(lambda: machine.launch(realizations=100, batch=1)[speed],
                            lambda: machine.flood(1, 300000)["messages_per_second"])
    yield "one realization a message, deliveries per second", "flood of small messages", 3.05 * single, small
    bag = os.path.join(machine.folder, "run.bag")

    def record():
        machine.fresh("run.bag")
        return machine.launch(realizations=REALIZATIONS, record=bag)[speed]

    recorded, plain = in_turn(record, lambda: machine.launch(realizations=REALIZATIONS)[speed])
    yield "recorded at full speed", "the same unrecorded", recorded, plain
    reading, bare = in_turn(lambda: 1.0 / timed([live_platoon.executable("bag_statistics"), bag]),
                            lambda: 1.0 / timed([live_platoon.executable("view_loop"), bag]))
    yield "bag_statistics, bags per second", "a bare rosbag::View loop", reading, bare


def main():
    machine = Machine()
    print("{} {}, {} cores; medians of {}".format(platform.system(), platform.machine(), os.cpu_count(), ROUNDS))
    print("{:>7}  {:<50} {:<26} {:>10} {:>10}".format("ratio", "what", "against", "value", "other"))
    rows = []
    try:
        for what, against, value, other in pairs(machine):
            print("{:7.2f}  {:<50} {:<26} {:10.3g} {:10.3g}".format(value / other, what, against, value, other), flush=True)
            rows.append({"what": what, "against": against, "ratio": value / other, "value": value, "other": other})
    finally:
        shutil.rmtree(machine.folder, ignore_errors=True)
    if len(sys.argv) > 1:
        with open(sys.argv[1], "w") as file:
            json.dump({"machine": platform.platform(), "cores": os.cpu_count(), "rounds": ROUNDS, "ratios": rows}, file, indent=1)


if __name__ == "__main__":
    main()
