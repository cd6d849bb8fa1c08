#!/usr/bin/python3
"""watch.py FOLDER ARGUMENT...: roslaunch platoon.launch with these arguments and with its results in FOLDER, on a quiet screen.

Shows the run's progress, on one line where the screen is a terminal, and its table. All that roslaunch and the nodes print goes to
FOLDER.log; where the run does not end complete, that is shown, too, and the status is 1.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import time

PROGRESS = re.compile(r"\[[#.]+\] +[0-9]+ %")
TABLE_BEGINS = re.compile(r"Platoon of ")
TABLE_GOES_ON = re.compile(r"follower |[ 0-9.e+-]+[0-9]$")

INTERRUPTED = 130  # the status of what Ctrl-C has ended


class Screen:
    def __init__(self):
        self.terminal = sys.stdout.isatty()
        self.progress_shown = False
        self.in_table = False

    def progress(self, line):
        if self.terminal:
            print("\r" + line[:shutil.get_terminal_size().columns - 1] + "\033[K", end="", flush=True)
        else:
            print(line, flush=True)
        self.progress_shown = True

    def end_progress(self):
        if self.terminal and self.progress_shown:
            print()
        self.progress_shown = False

    def show(self, line):
        """Of a line of the log, what is worth seeing."""
        if PROGRESS.match(line):
            self.progress(line)
            return
        self.in_table = bool(TABLE_BEGINS.match(line) or (self.in_table and TABLE_GOES_ON.match(line)))
        if self.in_table:
            self.end_progress()
            print(line, flush=True)


def follow(log, process, screen):
    """Shows the lines of the growing log until the process has ended and all of it is read."""
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


def is_complete(folder):
    try:
        with open(os.path.join(folder, "summary.json")) as file:
            return json.load(file)["complete"]
    except OSError:
        return False


def main(folder, *arguments):
    os.makedirs(os.path.dirname(folder), exist_ok=True)
    log_name = folder + ".log"
    screen = Screen()
    with open(log_name, "w") as written, open(log_name, errors="replace") as log:
        process = subprocess.Popen(["roslaunch", "stochastic_platoon", "platoon.launch", "output:=" + folder] + list(arguments),
                                   stdout=written, stderr=subprocess.STDOUT, env=dict(os.environ, PYTHONUNBUFFERED="1"))
        print("roslaunch's own output: " + log_name, flush=True)
        try:
            follow(log, process, screen)
        except KeyboardInterrupt:  # roslaunch has it, too, and ends its nodes
            process.wait()
            return INTERRUPTED
        finally:
            screen.end_progress()
        if is_complete(folder):
            return 0
        log.seek(0)
        print(log.read())
    print("The run did not end complete; the above is " + log_name, file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1]), *sys.argv[2:]))
