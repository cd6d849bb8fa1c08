#!/usr/bin/python3
"""Prints the ratios of pairs of measurements, taken alternately in one run (medians); writes JSON to the given file."""

import json
import os
import platform
import shutil
import statistics
import subprocess
import sys
import time

import scaling
from machine import Machine, output_of

import live_platoon  # in test/integration, which machine adds to the path

HERE = os.path.dirname(os.path.abspath(__file__))

ROUNDS = 3
REALIZATIONS = 50000
MILLION = 1000000
MODEL = live_platoon.shared("config", "paper.yaml")
HEARING = live_platoon.shared("config", "leader_and_predecessor.yaml")  # three inputs
LIMITED = live_platoon.shared("config", "acc_limits.yaml")


def in_turn(*measurements):
    """Medians of several measurements, taken alternately, ROUNDS times each."""
    values = [[] for _ in measurements]
    for _ in range(ROUNDS):
        for place, measure in zip(values, measurements):
            place.append(measure())
    return [statistics.median(place) for place in values]


def monte_carlo(machine, *options, model=MODEL):
    folder = machine.fresh("monte_carlo")
    subprocess.run([live_platoon.executable("monte_carlo"), "--model", model, "--realizations", str(MILLION), "--output",
                    folder] + list(options), check=True, stdout=subprocess.DEVNULL)
    return live_platoon.summary_of(folder)["vehicle_steps_per_second"]


def without_limits(machine):
    """A model file of the car of acc_limits.yaml without its limits."""
    file = os.path.join(machine.folder, "linear.yaml")
    with open(LIMITED) as limited, open(file, "w") as linear:
        linear.writelines(line for line in limited if not line.startswith("limits:"))
        linear.write("start: steady\n")
    return file


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
    linear = without_limits(machine)
    limited, linear = in_turn(lambda: monte_carlo(machine, "--steps", "100", model=LIMITED),
                              lambda: monte_carlo(machine, "--steps", "100", model=linear))
    yield "monte_carlo, cars with limits", "the same cars without", limited, linear
    three, paper = in_turn(lambda: 3.0 * monte_carlo(machine, "--steps", "100", model=HEARING), lambda: monte_carlo(machine, "--steps", "100"))
    yield "monte_carlo, inputs of cars that hear three", "monte_carlo", three, paper
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
