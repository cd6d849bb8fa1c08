#!/usr/bin/python3
"""contained.py PROGRAM...: runs a program. No process that it has started outlives it, also if it fails or is interrupted (Ctrl-C,
SIGTERM, SIGHUP). The status is that of the program, 130 if it was interrupted.

Scripts that start nodes run below this program: bash scripts by their first line, tests in Python because they import folder.py.
"""

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
PR_SET_CHILD_SUBREAPER = 36
PATIENCE = 30.0  # [s] for interrupted processes: roslaunch kills its nodes after 17 s
MARK = "PLATOON_CONTAINED"  # in the environment of a contained program


def children():
    """Process ids of the children of this process."""
    with open("/proc/self/task/{}/children".format(os.getpid())) as file:
        return [int(word) for word in file.read().split()]


def send(number, process):
    with contextlib.suppress(ProcessLookupError):
        os.kill(process, number)


def end_all():
    """Interrupts the children of this process, which include orphans, and kills them after PATIENCE."""
    interrupted, kills = set(), time.monotonic() + PATIENCE
    while children():
        for process in children():
            if time.monotonic() > kills:
                send(signal.SIGKILL, process)
            elif process not in interrupted:
                send(signal.SIGCONT, process)  # a stopped process would not end
                send(signal.SIGINT, process)
                interrupted.add(process)
        with contextlib.suppress(ChildProcessError):
            os.waitpid(-1, os.WNOHANG)
        time.sleep(0.02)


@contextlib.contextmanager
def contained(program, **options):
    """The started program, as a subprocess.Popen; at the end of the context all that it has started ends. An interruption of this
    process is passed on to the program, and raises KeyboardInterrupt."""
    for number in (signal.SIGINT, signal.SIGTERM) + (() if signal.getsignal(signal.SIGHUP) == signal.SIG_IGN else (signal.SIGHUP,)):
        signal.signal(number, signal.default_int_handler)  # SIGHUP is ignored below nohup
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)  # orphans of the program become children of this process
    process = subprocess.Popen(program, start_new_session=True, env=dict(os.environ, **{MARK: "1"}), **options)

    def reap_orphans(*_):
        for child in children():
            if child != process.pid:
                with contextlib.suppress(ChildProcessError):
                    os.waitpid(child, os.WNOHANG)

    signal.signal(signal.SIGCHLD, reap_orphans)
    try:
        yield process
    except KeyboardInterrupt:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGINT)
        raise
    finally:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)  # a second interruption must not leave processes behind
        end_all()


def contain_this_script():
    """Begins a script of this folder again as a contained program, unless it is one."""
    script = os.path.abspath(sys.argv[0]) if sys.argv else ""
    if MARK not in os.environ and script.startswith(HERE + os.sep) and os.path.isfile(script):
        os.execv(sys.executable, [sys.executable, os.path.abspath(__file__), sys.executable, script] + sys.argv[1:])


def main(*program):
    with contained(program) as process:
        return process.wait()


if __name__ == "__main__":
    try:
        sys.exit(main(*sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
