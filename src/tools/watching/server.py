"""Serves the page over HTTP with the standard library, and its updates as server-sent events."""

from __future__ import annotations

import errno
import http.server
import ipaddress
import json
import os
import socket
import threading
import time
import urllib.parse
from typing import Any, Callable, Dict, Set, Tuple

from .state import PlatoonState
from .streams import MOST_PAGES, Streams, encoded

Obey = Callable[[Dict[str, Any]], Tuple[bool, str]]

HEARTBEAT = 2.0         # [s] between comment lines on an idle stream
LONGEST_COMMAND = 4096  # bytes
PAUSE = 0.2             # [s] before the next accept when the system has no resources for another connection
NOTHING_LEFT = {errno.EMFILE: "no file descriptor is free", errno.ENFILE: "the system has no file descriptor free",
                errno.ENOBUFS: "the system has no buffer free", errno.ENOMEM: "the system has no memory free"}
KINDS_OF_FILE = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml"}


def host_of(authority: str) -> str:
    """The host in "host:port" in lower case; empty if there is none."""
    try:
        return (urllib.parse.urlsplit("//" + authority).hostname or "").lower()
    except ValueError:
        return ""


def is_own(origin: str, host: str) -> bool:
    """Whether an Origin header is a page of this Host."""
    try:
        return urllib.parse.urlsplit(origin).netloc.lower() == host.lower()
    except ValueError:
        return False


def names_this_machine(host: str, own_names: Set[str]) -> bool:
    """Whether a Host header is an IP address or one of the server's own names.

    Prevents DNS rebinding: a foreign page has its own name in Host even if that name resolves to this machine.
    """
    try:
        ipaddress.ip_address(host)
        return True
    except ValueError:
        return host in own_names


class Handler(http.server.BaseHTTPRequestHandler):
    server: PageServer
    server_version = "platoon"
    sys_version = ""
    timeout = 30.0  # [s] for a page that does not read, or does not finish its request

    def log_message(self, *_: Any) -> None:
        pass  # requests are not logged

    def answer(self, status: int, content: bytes, kind: str = "application/json") -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind + "; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.send_common_headers()
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def send_common_headers(self) -> None:
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("X-Frame-Options", "DENY")
        self.send_header("Content-Security-Policy", "default-src 'self'; img-src 'self' blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'self'")

    def reject(self, status: int, why: str) -> None:
        self.report(status, False, why)

    def report(self, status: int, success: bool, message: str) -> None:
        self.answer(status, encoded({"success": success, "message": message}))

    def of_this_machine(self) -> bool:
        """Whether the Host header names this server; if not, answers with status 421."""
        if names_this_machine(host_of(self.headers.get("Host", "")), self.server.names):
            return True
        self.reject(421, "the server does not have this name: use localhost or the machine's address")
        return False

    def do_GET(self) -> None:
        if not self.of_this_machine():
            return
        try:
            path = urllib.parse.urlsplit(self.path).path
        except ValueError:  # "http://[", which is no address
            path = ""
        if path == "/events":
            self.stream()
        elif path == "/state.json":
            self.answer(200, encoded(self.server.state.document()))
        else:
            content = self.server.files.get("/index.html" if path == "/" else path)
            if content is None:
                return self.reject(404, "not found: the server has /, /state.json and /events")
            self.answer(200, content, KINDS_OF_FILE[os.path.splitext(path)[1] or ".html"])

    do_HEAD = do_GET

    def do_POST(self) -> None:
        if not self.of_this_machine():
            return
        # Browsers send the page's Origin; only this server's own page has the same address in Origin and Host.
        origin = self.headers.get("Origin")
        if origin is not None and not is_own(origin, self.headers.get("Host", "")):
            return self.reject(403, "the server accepts commands from its own page only, not from " + origin[:100])
        if self.headers.get("Content-Type", "").split(";")[0] != "application/json":
            return self.reject(415, "a command must be application/json")
        if self.path != "/command":
            return self.reject(404, "not found: the server accepts commands at /command")
        try:
            length = int(self.headers.get("Content-Length", ""))
            if not 0 <= length <= LONGEST_COMMAND:
                raise ValueError
            content = json.loads(self.rfile.read(length))
            if not isinstance(content, dict):
                raise ValueError
        except (ValueError, RecursionError):
            return self.reject(400, "a command must be a JSON object of at most {} bytes".format(LONGEST_COMMAND))
        try:
            success, message = self.server.obey(content)
        except Exception as error:  # an internal error: report it to the page and keep the connection
            return self.reject(500, "{}: {}".format(type(error).__name__, error)[:200])
        self.report(200 if success else 409, success, message)

    def stream(self) -> None:
        stream = self.server.streams.open(self.server.state.KINDS + ("strip",))
        if stream is None:
            return self.reject(503, "{} pages are open already: close one".format(MOST_PAGES))
        try:
            self.send_response(200)
            self.send_header("Content-Type", "text/event-stream")
            self.send_common_headers()
            self.end_headers()
            self.wfile.write(b"retry: 1000\n\n")
            while not self.server.closing.is_set():
                items = stream.take(HEARTBEAT)
                lines = b"".join(b"event: " + kind.encode() + b"\ndata: " + data + b"\n\n" for kind, data in items)
                self.wfile.write(lines or b": alive\n\n")
        except OSError:
            pass  # the page was closed
        finally:
            self.server.streams.close(stream)


class PageServer(http.server.ThreadingHTTPServer):
    """Serves a folder's files, the state and its events. obey(command) carries out a command and returns (success, message)."""

    daemon_threads = True

    def __init__(self, host: str, port: int, state: PlatoonState, obey: Obey, folder: str) -> None:
        self.host, self.state, self.obey = host, state, obey
        self.names = {"localhost", host.lower(), socket.gethostname().lower()}
        self.streams = Streams(state.give)
        self.closing = threading.Event()
        self.files = {}
        for name in os.listdir(folder):
            if os.path.splitext(name)[1] in KINDS_OF_FILE:
                with open(os.path.join(folder, name), "rb") as file:
                    self.files["/" + name] = file.read()
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        self.address_family = family
        self.keep_spare()
        super().__init__(address[:2], Handler)  # closes the server if the port is in use

    def get_request(self) -> Tuple[socket.socket, Any]:
        """The next connection. If the system has no descriptor for it, the server answers 503 with the spare one and pauses:
        otherwise the connection stays pending and serve_forever retries it in a busy loop."""
        try:
            return super().get_request()
        except OSError as error:
            if error.errno in NOTHING_LEFT:
                self.reject_one(NOTHING_LEFT[error.errno])
                time.sleep(PAUSE)
            raise

    def reject_one(self, why: str) -> None:
        self.spare.close()
        try:
            connection, _ = self.socket.accept()
            with connection:
                connection.settimeout(PAUSE)
                content = encoded({"success": False, "message": why + ": close some pages, or try again"})
                connection.sendall(b"HTTP/1.0 503 Service Unavailable\r\nContent-Type: application/json; charset=utf-8\r\n"
                                   b"Retry-After: 1\r\nContent-Length: " + str(len(content)).encode() + b"\r\n\r\n" + content)
                connection.shutdown(socket.SHUT_WR)
                connection.recv(1 << 16)  # unread data would reset the connection before the answer arrives
        except OSError:
            pass  # the client disconnected, or another thread took the descriptor
        finally:
            self.keep_spare()

    def keep_spare(self) -> None:
        try:
            self.spare = open(os.devnull, "rb")
        except OSError:
            pass  # retried at the next rejection

    def server_close(self) -> None:
        self.spare.close()
        super().server_close()

    def handle_error(self, *_: Any) -> None:
        pass  # a page disconnected during a request

    @property
    def url(self) -> str:
        host = "[{}]".format(self.host) if ":" in self.host else self.host
        return "http://{}:{}".format(host, self.server_port)
