#!/usr/bin/python3
"""A platoon on three machines: a link outage of 10 s and the permanent loss of a machine cost time but do not change a bit.

The machines are network namespaces connected by a bridge, inside a network, process and mount namespace of this test, so that
everything ends with it. Without permission for namespaces the test is skipped: status 77.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

import rospy

import live_platoon
from faults import ProgressWatch
from processes import children
from terminal import LaunchTest, Terminal

INSIDE = "--inside"
NAMESPACES = ["unshare", "--net", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc"]
BRIDGE = "10.77.0.254"
MASTER = "http://10.77.0.1:11311"
SETTINGS = dict(followers=20, steps=20, realizations=6400)
DOWN = 10.0  # [s] duration of the outage


def network(command):
    subprocess.run(["ip"] + command.split(), check=True)


def own_namespaces():
    """The command prefix that runs a command in its own namespaces: as root, or as root of a user namespace."""
    if os.geteuid() != 0:
        return NAMESPACES + ["--user", "--map-root-user"]
    return NAMESPACES


class Machine:
    """A network namespace with an address, connected to the bridge."""

    def __init__(self, number, address=None):
        self.name, self.address = "machine{}".format(number), address or "10.77.0.{}".format(number)
        self.port = "port{}".format(number)  # on the bridge
        network("netns add " + self.name)
        network("link add {0} type veth peer name eth0 netns {1}".format(self.port, self.name))
        network("link set {} master road up".format(self.port))
        for command in ("link set lo up", "address add {}/24 dev eth0".format(self.address), "link set eth0 up"):
            network("-n {} {}".format(self.name, command))

    def launch(self, folder, file, **arguments):
        environment = {name: value for name, value in os.environ.items() if name != "ROS_HOSTNAME"}
        return Terminal(folder, file, MASTER, ["nsenter", "--net=/run/netns/" + self.name],
                        dict(environment, ROS_IP=self.address), **arguments)

    def set_link(self, state):
        network("link set {} {}".format(self.port, state))


class SeveralMachines(LaunchTest):
    def setUp(self):
        super().setUp()
        network("link set lo up")
        # A fixed hardware address: the default is the lowest of the ports' addresses, and the machines notice its changes late.
        network("link add road address 02:00:00:00:00:fe type bridge")
        network("address add {}/24 dev road".format(BRIDGE))
        network("link set road up")
        self.first, self.second, self.third = Machine(1), Machine(2), Machine(3)

    def launch_on(self, machine, file, **arguments):
        terminal = machine.launch(self.folder, file, **arguments)
        self.addCleanup(terminal.end)
        return terminal

    def power_off(self, machine, terminal):
        """Removes a machine without notice: it closes no connection and answers no packet."""
        machine.set_link("down")
        for process in children(terminal.process.pid) + [terminal.process.pid]:
            os.kill(process, signal.SIGKILL)
        terminal.process.wait()
        network("netns delete " + machine.name)

    def recovers(self, what):
        """Waits until the platoon has recovered; prints the time from now."""
        began = time.monotonic()
        recovered = self.watch.wait(self.watch.moved_on_from(False), lambda: self.run.process.poll() is not None, 60.0)
        self.assertIsNotNone(recovered, what + ": the run was over before:\n" + self.run.text())
        print("{}: {:.1f} s".format(what, recovered - began), flush=True)

    def flows(self):
        self.assertTrue(self.watch.wait_for_flow(0.5, lambda: self.run.process.poll() is not None, 60.0), self.run.text())

    def test_the_bits_are_those_of_one_process_whatever_link_or_machine_fails(self):
        self.run = self.launch_on(self.first, "platoon.launch", last=0, output=self.output, rate=150, batch=100, **SETTINGS)
        live_platoon.wait_for(lambda: live_platoon.process_of("/rosout", MASTER), "the master")
        self.launch_on(self.second, "followers.launch", first=1, last=10)
        lost = self.launch_on(self.third, "followers.launch", first=11, last=20)
        os.environ.update(ROS_MASTER_URI=MASTER, ROS_IP=BRIDGE)
        os.environ.pop("ROS_HOSTNAME", None)
        rospy.init_node("several_machines_test", disable_signals=True)
        self.watch = ProgressWatch()

        self.flows()
        self.third.set_link("down")
        time.sleep(DOWN)
        self.third.set_link("up")
        self.recovers("a link that was down for {:.0f} s".format(DOWN))

        self.flows()
        self.power_off(self.third, lost)
        # The new machine takes the old address: otherwise the ROS master would wait for nodes registered at an unused address.
        fourth = Machine(4, self.third.address)
        self.launch_on(fourth, "followers.launch", first=11, last=20)
        self.recovers("a machine replaced by another")

        self.assertEqual(self.completed(self.run)["positions_lost"], 0)
        self.assert_bits(**SETTINGS)


def why_not():
    """The reason why the test cannot run here; empty if it can."""
    missing = [program for program in ("ip", "nsenter", "unshare") if not shutil.which(program)]
    if missing:
        return "needs " + ", ".join(missing)
    probe = "mount -t tmpfs tmpfs /run && ip netns add probe && ip link add probe type bridge && ip link add type veth"
    tried = subprocess.run(own_namespaces() + ["sh", "-c", probe], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           universal_newlines=True)
    return "no network namespaces here: " + tried.stdout.strip() if tried.returncode != 0 else ""


if __name__ == "__main__":
    if INSIDE in sys.argv:
        sys.argv.remove(INSIDE)
        subprocess.run(["mount", "-t", "tmpfs", "tmpfs", "/run"], check=True)  # for the namespace names of ip
        unittest.main(warnings="ignore")  # rospy's warnings
    reason = why_not()
    if reason:
        print("skipped: " + reason)
        sys.exit(77)
    command = own_namespaces() + [sys.executable, os.path.abspath(__file__), INSIDE] + sys.argv[1:]
    os.execvp(command[0], command)
