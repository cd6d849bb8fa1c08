#!/usr/bin/python3
"""watch.py FOLDER ARGUMENT...: runs roslaunch platoon.launch with these arguments and writes its results to FOLDER.

Prints only the run's progress (on one line of a terminal) and its table. The output of roslaunch and the nodes goes to
FOLDER.log; if the run does not complete, the script also prints this log and exits with status 1.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from typing import TextIO

try:
    import stochastic_platoon as sp
except ImportError as error:
    sys.exit("watch.py: {}: . devel/setup.bash first".format(error))

PROGRESS = re.compile(r"\[[#.]+\] +[0-9]+ %")
TABLE_BEGINS = re.compile(r"Platoon of ")
TABLE_GOES_ON = re.compile(r"follower |[ 0-9.e+-]+[0-9]$")

INTERRUPTED = 130  # exit status after Ctrl-C


class Screen:
    def __init__(self) -> None:
        self.terminal = sys.stdout.isatty()
        self.progress_shown = False
        self.in_table = False

    def progress(self, line: str) -> None:
        if self.terminal:
            print("\r" + line[:shutil.get_terminal_size().columns - 1] + "\033[K", end="", flush=True)
        else:
            print(line, flush=True)
        self.progress_shown = True

    def end_progress(self) -> None:
        if self.terminal and self.progress_shown:
            print()
        self.progress_shown = False

    def show(self, line: str) -> None:
        """Prints a line of the log if it is progress or part of the table."""
        if PROGRESS.match(line):
            self.progress(line)
            return
        self.in_table = bool(TABLE_BEGINS.match(line) or (self.in_table and TABLE_GOES_ON.match(line)))
        if self.in_table:
            self.end_progress()
            print(line, flush=True)


def follow(log: TextIO, process: subprocess.Popen[bytes], screen: Screen) -> None:
    """Shows the lines of the growing log until the process has ended and the whole log is read."""
    unfinished = ""
    while True:
        ended = process.poll() is not None
        lines = (unfinished + log.read()).split("\n")
        unfinished = lines.pop()
        for line in lines:
            screen.show(line)
        if ended:
            return
        time.sleep(0.05)


def is_complete(folder: str) -> bool:
    try:
        return sp.Results.load(folder).complete
    except OSError:
        return False


def main(folder: str, *arguments: str) -> int:
    os.makedirs(os.path.dirname(folder), exist_ok=True)
    log_name = folder + ".log"
    screen = Screen()
    with open(log_name, "w") as written, open(log_name, errors="replace") as log:
        process = subprocess.Popen(["roslaunch", "stochastic_platoon", "platoon.launch", "output:=" + folder] + list(arguments),
                                   stdout=written, stderr=subprocess.STDOUT, env=dict(os.environ, PYTHONUNBUFFERED="1"))
        print("roslaunch's own output: " + log_name, flush=True)
        try:
            follow(log, process, screen)
        except KeyboardInterrupt:  # roslaunch receives it as well and ends its nodes
            process.wait()
            return INTERRUPTED
        finally:
            screen.end_progress()
        if is_complete(folder):
            return 0
        log.seek(0)
        print(log.read())
    print("run incomplete; the log above is " + log_name, file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1]), *sys.argv[2:]))
