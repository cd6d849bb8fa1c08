#!/usr/bin/python3
"""Tests of the page's server and of the commands that it accepts, without ROS."""

import http.client
import importlib
import json
import math
import os
import socket
import subprocess
import sys
import threading
import time
import types
import unittest

sys.dont_write_bytecode = True
from watching_messages import TOOLS, configuration, message, snapshot  # noqa: E402
from watching import server, state, streams  # noqa: E402


class Served(unittest.TestCase):
    def setUp(self):
        self.state = state.PlatoonState()
        self.commands_received = []
        self.server = server.PageServer("localhost", 0, self.state, self.obey, os.path.join(TOOLS, "watching", "page"))
        thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        self.addCleanup(self.server.closing.set)
        self.own = "localhost:{}".format(self.server.server_port)

    def obey(self, content):
        self.commands_received.append(content)
        return True, "done"

    def ask(self, method, path, body=None, **headers):
        connection = http.client.HTTPConnection("localhost", self.server.server_port, timeout=10)
        self.addCleanup(connection.close)
        connection.putrequest(method, path, skip_host=True)
        for name, value in dict({"Host": self.own}, **headers).items():
            connection.putheader(name.replace("_", "-"), value)
        if body is not None:
            connection.putheader("Content-Length", str(len(body)))
        connection.endheaders(body)
        answer = connection.getresponse()
        return answer.status, answer.read()

    def test_serves_its_page_and_every_file_that_the_page_names(self):
        status, page = self.ask("GET", "/")
        self.assertEqual(status, 200)
        self.assertNotRegex(page.decode(), r"(src|href)=\"(https?:)?//")
        for path in ("/style.css", "/main.js", "/words.js", "/icon.svg"):
            self.assertEqual(self.ask("GET", path)[0], 200, path)
        for path in ("/../server.py", "/..%2fserver.py", "/server.py", "//etc/passwd", "/index.htm", "http://[bad", "//[bad"):
            self.assertEqual(self.ask("GET", path)[0], 404, path)

    def test_accepts_commands_from_its_own_page_only(self):
        body, kind = b'{"command": "brake"}', "application/json"
        own = "http://" + self.own
        for headers in ({"Origin": own}, {}):
            self.assertEqual(self.ask("POST", "/command", body, Content_Type=kind, **headers)[0], 200)
        self.assertEqual(self.commands_received, [{"command": "brake"}] * 2)
        for origin in ("http://evil.example", "http://localhost:1", "https://" + self.own + ".evil.example", "null", "", "http://[::1", "http://[bad]"):
            self.assertEqual(self.ask("POST", "/command", body, Content_Type=kind, Origin=origin)[0], 403, origin)
        # A page of another origin can send this without a preflight request.
        self.assertEqual(self.ask("POST", "/command", body, Content_Type="text/plain", Origin=own)[0], 415)
        self.assertEqual(len(self.commands_received), 2)

    def test_rejects_a_host_name_that_was_rebound_to_this_machine(self):
        for host in ("evil.example", "evil.example:80", "localhost.evil.example", "", "[", "127.0.0.1.evil.example"):
            for method, path, body in (("POST", "/command", b"{}"), ("GET", "/", None), ("GET", "/state.json", None), ("GET", "/events", None)):
                status, _ = self.ask(method, path, body, Host=host, Origin="http://" + host, Content_Type="application/json")
                self.assertEqual(status, 421, (host, path))
        for host in ("127.0.0.1", "localhost:9999", "[::1]:80", "LOCALHOST"):
            self.assertEqual(self.ask("GET", "/state.json", Host=host)[0], 200, host)
        self.assertEqual(self.commands_received, [])

    def test_rejects_an_invalid_command(self):
        for body in (b"", b"[]", b"nonsense", b'{"command": ' + b" " * 5000 + b"1}", b"\xff\xfe", b"[" * 4000):
            self.assertEqual(self.ask("POST", "/command", body, Content_Type="application/json")[0], 400, body[:20])
        self.assertEqual(self.ask("POST", "/", b"{}", Content_Type="application/json")[0], 404)
        self.assertEqual(self.commands_received, [])

    def test_rejects_one_page_too_many_until_another_is_closed(self):
        opened = [self.server.streams.open(()) for _ in range(streams.MOST_PAGES)]
        status, text = self.ask("GET", "/events")
        self.assertEqual(status, 503)
        self.assertIn("pages are open already", text.decode())
        self.server.streams.close(opened[0])
        self.assertIsNotNone(self.server.streams.open(()))

    def test_a_page_that_does_not_read_keeps_the_latest_news_only(self):
        self.state.take_configuration(configuration())
        stream = self.server.streams.open(self.state.KINDS)
        stream.take(0)
        for step in range(1000):
            self.state.take_snapshot(snapshot(step))
            self.server.streams.send("snapshot")
        items = stream.take(0)
        self.assertEqual([kind for kind, _ in items], ["snapshot"])
        self.assertEqual(json.loads(items[0][1])["step"], 999)

    def test_a_command_that_fails_is_answered_with_the_reason(self):
        def fail(content):
            raise OverflowError("int too large to convert to float")
        self.server.obey = fail
        status, text = self.ask("POST", "/command", b'{"command": "brake"}', Content_Type="application/json")
        self.assertEqual((status, json.loads(text)["message"]), (500, "OverflowError: int too large to convert to float"))


STARVED = """
import os, resource, sys
sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[1])
from watching import server, state
pages = server.PageServer("localhost", 0, state.PlatoonState(), None, os.path.join(sys.argv[1], "watching", "page"))
print(pages.server_port, flush=True)
most = max(map(int, os.listdir("/proc/self/fd"))) + 5
resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
pages.serve_forever()
"""


class Starved(unittest.TestCase):
    def seconds_of_work(self, process):
        with open("/proc/{}/stat".format(process)) as file:
            words = file.read().rsplit(")", 1)[1].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def test_answers_with_the_reason_without_a_free_descriptor_and_does_not_spin(self):
        child = subprocess.Popen([sys.executable, "-c", STARVED, TOOLS], stdout=subprocess.PIPE, universal_newlines=True)
        self.addCleanup(child.stdout.close)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)
        port = int(child.stdout.readline())
        pages = [socket.create_connection(("localhost", port), timeout=30) for _ in range(12)]  # one descriptor each
        for page in pages:
            self.addCleanup(page.close)
            page.sendall(b"GET /events HTTP/1.0\r\nHost: localhost\r\n\r\n")
        answers = [page.recv(1000).decode() for page in pages]
        served = [answer.startswith("HTTP/1.0 200") for answer in answers]
        self.assertTrue(served[0] and not served[-1], answers)
        self.assertIn("503", answers[-1])
        self.assertIn("no file descriptor is free: close some pages, or try again", answers[-1] + pages[-1].recv(1000).decode())
        waiting = socket.create_connection(("localhost", port), timeout=30)
        self.addCleanup(waiting.close)
        before, began = self.seconds_of_work(child.pid), time.monotonic()
        time.sleep(2.0)
        share = (self.seconds_of_work(child.pid) - before) / (time.monotonic() - began)
        self.assertLess(share, 0.5, "it spins")
        # A closed page frees its descriptor for another.
        for page in pages[:6]:
            page.close()

        def served_again():
            with socket.create_connection(("localhost", port), timeout=30) as page:
                page.sendall(b"GET / HTTP/1.0\r\nHost: localhost\r\n\r\n")
                return page.recv(12).endswith(b"200")
        for _ in range(100):
            if served_again():
                return
            time.sleep(0.1)
        self.fail("it serves no page any more")


class Commands(unittest.TestCase):
    """Commands with a stub of ROS."""

    def setUp(self):
        named = {"rospy": types.ModuleType("rospy"), "std_msgs": types.ModuleType("std_msgs"), "std_msgs.msg": types.ModuleType("std_msgs.msg"),
                 "std_srvs": types.ModuleType("std_srvs"), "std_srvs.srv": types.ModuleType("std_srvs.srv")}
        self.published = []
        self.parameters, self.called = {}, []
        for name, value in (("wait_for_service", lambda *_: None), ("set_param", self.parameters.__setitem__),
                            ("ServiceProxy", lambda name, _: lambda: self.serve(name)), ("ROSException", OSError), ("ServiceException", OSError)):
            setattr(named["rospy"], name, value)
        named["rospy"].Publisher = lambda *_, **__: types.SimpleNamespace(publish=self.published.append, get_num_connections=lambda: 1,
                                                                          resolved_name="/platoon/leader/speed")
        named["std_msgs.msg"].Float64 = named["std_srvs.srv"].Trigger = None
        before = {name: sys.modules.get(name) for name in list(named) + ["watching.commands"]}
        sys.modules.update(named)

        def restore():
            for name, module in before.items():
                sys.modules.pop(name, None)
                if module is not None:
                    sys.modules[name] = module
        self.addCleanup(restore)
        sys.modules.pop("watching.commands", None)
        commands = importlib.import_module("watching.commands")  # with this stub; the package keeps that of the test before
        self.state = state.PlatoonState()
        self.commands = commands.Commands(self.state)

    def serve(self, name):
        """The service, which reads its parameter a while after the call."""
        time.sleep(0.05)
        self.called.append((name, self.parameters.pop(name, None)))
        return types.SimpleNamespace(success=True, message="begun")

    def test_two_changes_at_a_time_are_both_carried_out(self):
        orders = [{"headway": 2.0 + i} for i in range(4)]
        pages = [threading.Thread(target=self.commands.obey, args=(dict(order, command="change"),)) for order in orders]
        for page in pages:
            page.start()
        for page in pages:
            page.join()
        self.assertEqual(sorted(self.called, key=str), [("change_run", order) for order in orders])

    def test_a_change_without_a_setting_or_of_another_one_is_rejected(self):
        allowed = "headway, noise_variance or loss"
        for content, why in (({}, "change: no setting: must be with " + allowed), ({"headway": None}, "change: no setting: must be with " + allowed),
                             ({"headways": 2}, "headways: unknown key: must be " + allowed),
                             ({"headway": 2, "seed": 3}, "seed: unknown key: must be " + allowed),
                             ({"headway": "2"}, "headway: 2: must be a finite number")):
            self.assertEqual(self.commands.obey(dict(content, command="change")), (False, why))
        self.assertEqual(self.called, [])
        self.assertEqual(self.commands.obey({"command": "change", "loss": 0}), (True, "begun"))
        self.assertEqual(self.called, [("change_run", {"loss": 0.0})])

    def test_an_invalid_speed_is_rejected_with_the_reason(self):
        for value in (10 ** 400, -10 ** 400, math.inf, math.nan, True, "20", [20]):
            success, message = self.commands.obey({"command": "speed", "speed": value})
            self.assertFalse(success)
            self.assertRegex(message, r"^speed: .{1,43}: must be a finite number")
        self.assertFalse(self.commands.obey({"command": "speed"})[0])
        self.assertEqual(self.published, [])

    def test_a_speed_is_rejected_if_the_leader_accepts_none(self):
        for known, words in (({"endless": False}, "rejected: in a run of many realizations"), (None, "no run is known yet")):
            self.state.configuration = known
            success, message = self.commands.obey({"command": "speed", "speed": 20})
            self.assertFalse(success)
            self.assertIn(words, message)
        self.state.configuration = {"endless": True, "manoeuvres": {"speed": [-1000.0, 1000.0]}}
        self.assertEqual(self.commands.obey({"command": "speed", "speed": 20}), (True, "speed 20 m/s"))
        self.assertEqual(self.published, [20.0])
        self.assertEqual([event["text"] for event in self.state.document()["events"]], ["speed 20 m/s"])

    def test_a_speed_beyond_those_of_the_leader_is_rejected(self):
        for lower, upper, beyond, within, words in ((0.0, 40.0, (-0.5, 40.5), (0.0, 40.0), "must be from 0 to 40 m/s"),
                                                    (-1000.0, 1000.0, (1000.5, -1e6), (-50.0, 60.0), "must be from -1000 to 1000 m/s")):
            self.state.configuration = {"endless": True, "manoeuvres": {"speed": [lower, upper]}}
            self.published.clear()
            for speed in beyond:
                success, message = self.commands.obey({"command": "speed", "speed": speed})
                self.assertFalse(success)
                self.assertIn(words, message)
            for speed in within:
                self.assertTrue(self.commands.obey({"command": "speed", "speed": speed})[0])
            self.assertEqual(self.published, list(within))
        self.assertEqual(self.commands.obey({"command": "speed", "speed": 61}), (True, "speed 61 m/s; cars reach 60 m/s"))


if __name__ == "__main__":
    unittest.main()
