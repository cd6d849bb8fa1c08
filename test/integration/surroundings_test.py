#!/usr/bin/python3
"""A launch in adverse surroundings: unusual paths, a full disk, the death of the master, of roslaunch and of nodes."""

import contextlib
import os
import re
import resource
import signal
import socket
import subprocess
import time
import unittest
import xmlrpc.client

import live_platoon
from terminal import LaunchTest


class Surroundings(LaunchTest):
    """The environment of a launch: unusual paths, a read-only home folder, the death of the master and of roslaunch."""

    def test_a_quote_in_a_path_is_rejected_with_an_explanation(self):
        for argument in ("output", "record", "model"):
            terminal = self.launch(**{argument: self.folder + "/it's.bag"})
            self.assertNotEqual(terminal.wait(), 0)
            self.assertIn("a path with a quote (')", terminal.text())
            self.assertNotIn("No closing quotation", terminal.text())

    def test_other_odd_paths_work(self):
        output = self.folder + "/a folder with blanks, \"quotes\" and $signs"
        self.run_to_the_end(output=output, followers=1, steps=5, realizations=10)

    def test_a_home_that_cannot_be_written_is_named(self):
        blocked = self.write("file", "")
        environment = dict(os.environ, ROS_HOSTNAME="localhost", ROS_LOG_DIR=blocked + "/log")
        terminal = self.launch(environment=environment)
        self.assertNotEqual(terminal.wait(), 0)
        self.assertIn("ROS_LOG_DIR: " + blocked + "/log: cannot be made: Not a directory: must be a folder", terminal.text())

    def nodes_of(self, master):
        names = ["/platoon/" + name for name in ("vehicle_0", "vehicle_1", "vehicle_2", "channel", "monitor", "until_complete")]
        return [live_platoon.wait_for(lambda name=name: live_platoon.process_of(name, master), name) for name in names]

    def test_kill_9_of_roslaunch_leaves_no_node_and_the_next_launch_works_at_once(self):
        master = self.roscore()
        terminal = self.launch(master=master, followers=2, rate=20)
        processes = self.nodes_of(master)
        terminal.wait_for_text("process[platoon/monitor")
        terminal.process.kill()
        terminal.wait()
        live_platoon.wait_for(lambda: not any(os.path.exists("/proc/{}".format(process)) for process in processes),
                              "the nodes to end")
        settings, second = dict(followers=2, steps=20, realizations=100), self.path("second")
        summary = self.completed(self.launch(master=master, output=second, **settings), second)
        # The master still names the dead nodes to the new ones: the channel may hear the leader's first message too late.
        self.assertLessEqual(summary["attempts"], 1 + live_platoon.UNDISTURBED)
        self.assert_bits(second, **settings)

    def test_a_run_whose_launch_was_killed_with_its_monitor_is_gone_on_with_at_once(self):
        settings = dict(followers=2, steps=20, realizations=1000)
        terminal = self.launch(own_master=True, batch=50, rate=100, **settings)  # the second launch is as fast as it can
        live_platoon.wait_for(lambda: os.path.exists(self.output + "/checkpoint.cbor"), "a checkpoint")
        processes = self.nodes_of(terminal.master) + [live_platoon.process_of("/rosout", terminal.master)]
        with xmlrpc.client.ServerProxy(terminal.master) as master:
            processes.append(master.getPid("/launch_test")[2])
        terminal.process.send_signal(signal.SIGSTOP)  # a living roslaunch would answer the death of a node
        for process in processes + [terminal.process.pid]:
            os.kill(process, signal.SIGKILL)
        terminal.wait()
        again = self.run_to_the_end(own_master=True, resume="true", **settings)
        self.assertNotIn("in use", again.text())
        self.assert_bits(**settings)

    def test_a_node_that_comes_back_at_the_address_it_had_is_connected_to(self):
        shim, port = self.path("forced_port.so"), self.path("port")
        subprocess.run(["cc", "-shared", "-fPIC", "-o", shim, os.path.join(os.path.dirname(__file__), "forced_port.c"), "-ldl"], check=True)
        # The platoon moves for 27 s at this rate, so that no machine completes the run before the last node is killed.
        settings = dict(followers=2, steps=20, realizations=40000)
        terminal = self.launch(environment=dict(os.environ, ROS_HOSTNAME="localhost", LD_PRELOAD=shim, FORCED_PORT=port),
                               batch=100, rate=300, stall_timeout=0.5, **settings)
        for name in ("vehicle_0", "vehicle_1", "channel", "monitor"):
            shown = len(re.findall("/40000 realizations", terminal.text()))
            live_platoon.wait_for(lambda: len(re.findall("/40000 realizations", terminal.text())) > shown, "the platoon to move")
            with xmlrpc.client.ServerProxy(terminal.master) as master:
                address = master.lookupNode("/launch_test", "/platoon/" + name)[2]
            with open(port, "w") as file:
                file.write(address.rsplit(":", 1)[1].strip("/"))
            os.kill(live_platoon.process_of("/platoon/" + name, terminal.master), signal.SIGKILL)
            self.assert_closed(self.connections_until_moved(address, "/platoon/" + name, terminal.master))
            self.assertFalse(os.path.exists(port), "no node had that port")
        self.completed(terminal)
        self.assert_bits(**settings)

    def connections_until_moved(self, address, node, master):
        """Connections to this address of a node, opened until the node has another one."""
        host, port = address.rstrip("/").rsplit("/", 1)[1].split(":")
        connections = []

        def moved():
            with contextlib.suppress(OSError):
                connections.append(socket.create_connection((host, int(port)), 10.0))
            with xmlrpc.client.ServerProxy(master) as known:
                return known.lookupNode("/launch_test", node)[2] not in ("", address)

        live_platoon.wait_for(moved, node + " to move from " + address)
        return connections

    def assert_closed(self, connections):
        """A caller whose connection stayed open, unanswered, would wait for ever."""
        self.assertTrue(connections, "no connection was opened")
        for connection in connections:
            with connection, contextlib.suppress(ConnectionResetError):
                self.assertEqual(connection.recv(1), b"")

    def test_a_killed_channel_with_state_needs_no_timeout(self):
        settings = dict(followers=3, steps=600, realizations=2, model=live_platoon.shared("config", "lossy.yaml"))
        terminal = self.launch(batch=1, rate=100, stall_timeout=100, **settings)
        listener = self.listen_for_the_attempt(terminal)
        terminal.wait_for_text("1/2 realizations")  # in the last batch: a later batch would reveal the gap
        before = self.attempt_heard_by(listener)
        live_platoon.kill("/platoon/channel", terminal.master)
        terminal.wait(60.0)
        self.assertIn(self.completed(terminal)["attempts"] - before, range(1, 1 + live_platoon.UNDISTURBED))
        self.assert_bits(**settings)

    def test_kill_9_of_until_complete_ends_the_launch_and_loses_nothing(self):
        settings = dict(followers=2, steps=20, realizations=2000)
        terminal = self.launch(batch=100, rate=100, **settings)
        terminal.wait_for_text("/2000 realizations")
        end = live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/until_complete", terminal.master), "until_complete")
        os.kill(end, signal.SIGKILL)
        terminal.wait()
        self.assertIn("To continue, launch again with output:={} resume:=true".format(self.output), terminal.text())
        self.run_to_the_end(resume="true", **settings)
        self.assert_bits(**settings)

    def test_nodes_outlive_a_master_that_is_started_anew(self):
        port = live_platoon.free_port()
        address = "http://localhost:{}".format(port)

        def master():
            return self.background("rosmaster", "--core", "-p", str(port), env=live_platoon.ros_environment(address, ROS_HOME=self.folder),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        first = master()
        settings = dict(followers=2, steps=20, realizations=3000)
        terminal = self.launch(master=address, batch=100, rate=100, **settings)
        terminal.wait_for_text("/3000 realizations")
        before = self.attempt_heard_by(self.listen_for_the_attempt(terminal))
        first.kill()
        first.wait()
        master()
        summary = live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output), "the run to complete")
        self.assertEqual(summary["attempts"], before)
        self.assert_bits(**settings)


class FullDisk(LaunchTest):
    def test_the_monitor_says_so_once_and_writes_when_there_is_room(self):
        settings = dict(followers=6, steps=100, realizations=1000)
        terminal = self.launch(rate=200, batch=100, **settings)
        before = self.attempt_heard_by(self.listen_for_the_attempt(terminal))
        monitor = live_platoon.wait_for(lambda: live_platoon.process_of("/platoon/monitor", terminal.master), "the monitor")
        resource.prlimit(monitor, resource.RLIMIT_FSIZE, (9000, resource.RLIM_INFINITY))  # its log is smaller
        terminal.wait_for_text("100 %")
        time.sleep(2.0)
        self.assertIsNone(terminal.process.poll(), "ended without results")
        self.assertFalse(os.path.exists(self.output + "/summary.json"))
        resource.prlimit(monitor, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        summary, text = self.completed(terminal), terminal.text()
        self.assertEqual(text.count("Retrying until there is space; the run continues"), 1, text)
        self.assertIn("File too large", text)
        self.assertIn("MB are free there", text)
        self.assertIn(self.output + ": can be written again", text)
        self.assertEqual(summary["attempts"], before)
        self.assert_bits(**settings)


if __name__ == "__main__":
    unittest.main()
