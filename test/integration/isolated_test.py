#!/usr/bin/python3
"""Checks on which sockets a running platoon listens, and that launch/isolated makes them unreachable from outside."""

import os
import subprocess
import tempfile
import unittest

import live_platoon
from processes import descendants, listening, node_of, words_of
from terminal import LaunchTest

ISOLATED = live_platoon.shared("launch", "isolated")
NODES = ["vehicle_0", "vehicle_1", "vehicle_2", "channel", "monitor"]


def name_of(process):
    words = words_of(process)
    return node_of(process) or os.path.basename(words[1] if "python" in words[0] and len(words) > 1 else words[0])


class Listening(LaunchTest):
    def run_platoon(self, prefix):
        terminal = self.launch(own_master=True, inside=prefix, followers=2, steps=20, realizations=100, stay=True)
        live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output), "the run to complete")
        return {name_of(process): (process, listening(process)) for process in descendants(terminal.process.pid)}

    def check_sockets(self, found):
        """TCPROS and all Python servers listen on the loopback interface only, roscpp's XML-RPC server on all interfaces."""
        for name in NODES:
            self.assertEqual([where for where, _ in found[name][1]], ["everywhere", "this machine"], name)
        for name in ("roslaunch", "rosmaster"):
            self.assertEqual({where for where, _ in found[name][1]}, {"this machine"}, name)

    def test_in_the_open_only_the_xmlrpc_servers_of_roscpp_can_be_reached_from_elsewhere(self):
        found = self.run_platoon(())
        self.check_sockets(found)
        for process, _ in found.values():
            self.assertEqual(os.readlink("/proc/{}/ns/net".format(process)), os.readlink("/proc/self/ns/net"))

    def test_isolated_it_has_a_network_of_its_own_with_no_way_out(self):
        refusal = subprocess.run([ISOLATED, "true"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        if refusal.returncode != 0:
            self.skipTest(refusal.stdout.strip())
        found = self.run_platoon((ISOLATED,))
        self.check_sockets(found)
        for name, (process, _) in found.items():
            self.assertNotEqual(os.readlink("/proc/{}/ns/net".format(process)), os.readlink("/proc/self/ns/net"), name)
        monitor = found["monitor"][0]
        with open("/proc/{}/net/dev".format(monitor)) as interfaces:
            self.assertEqual([line.split(":")[0].strip() for line in interfaces if ":" in line], ["lo"])
        with open("/proc/{}/net/route".format(monitor)) as routes:
            self.assertEqual(len(routes.readlines()), 1, "a heading, and no route")


class Rejected(unittest.TestCase):
    def run_isolated(self, *words, **environment):
        return subprocess.run([ISOLATED] + list(words), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True, env=dict(os.environ, **environment))

    def test_where_namespaces_are_not_allowed_it_says_so_and_starts_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            unshare = os.path.join(folder, "unshare")
            with open(unshare, "w") as file:
                file.write("#!/bin/sh\necho unshare failed: Operation not permitted\nexit 1\n")
            os.chmod(unshare, 0o755)
            done = self.run_isolated("echo", "started", PATH=folder + ":" + os.environ["PATH"])
        self.assertEqual(done.returncode, 1)
        self.assertIn("cannot create a network namespace (unshare failed: Operation not permitted)", done.stdout)
        self.assertNotIn("started", done.stdout.replace("Nothing was started", ""))

    def test_a_command_that_is_missing_is_named(self):
        self.assertIn("usage: isolated COMMAND", self.run_isolated().stdout)
        if self.run_isolated("true").returncode == 0:
            self.assertEqual(self.run_isolated("no_such_program").stdout, "isolated: no_such_program: No such file or directory\n")
            self.assertEqual(self.run_isolated("sh", "-c", "exit 7").returncode, 7)


if __name__ == "__main__":
    unittest.main()
