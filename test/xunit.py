#!/usr/bin/python3
"""xunit.py RESULT NAME PROGRAM...: runs a program as a test that `catkin test` and ctest see, with RESULT as its JUnit file.

The test fails unless the program ends with status 0; status 77 means that it cannot be run here. The output of the program goes to
the screen at once, and also into the file if the test has not passed. No process that the program has started outlives the test,
also if the test is interrupted (Ctrl-C).
"""

import os
import subprocess
import sys
import time
import xml.etree.ElementTree as tree

from contained import contained

SKIPPED = 77
QUICK = os.path.join(os.path.dirname(os.path.abspath(__file__)), "integration", "quick")  # a faster rosversion


def run(program):
    """Runs the program and prints its output; returns status and output."""
    printed = []
    with contained(program, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, errors="replace") as process:
        for line in process.stdout:
            sys.stdout.write(line)
            sys.stdout.flush()
            printed.append(line)
        return process.wait(), "".join(printed)


def report(name, status, printed, seconds):
    passed, skipped = status == 0, status == SKIPPED
    suite = tree.Element("testsuite", name=name, tests="1", errors="0", failures=str(int(not passed and not skipped)),
                         skipped=str(int(skipped)), time="{:.3f}".format(seconds))
    case = tree.SubElement(suite, "testcase", classname=name, name=name, time=suite.get("time"))
    if not passed:
        found = tree.SubElement(case, "skipped" if skipped else "failure", message="status {}".format(status))
        # XML does not allow most control characters.
        found.text = "".join(character for character in printed if character.isprintable() or character in "\n\t")
    return tree.ElementTree(suite)


def main(result, name, *program):
    os.makedirs(os.path.dirname(os.path.abspath(result)), exist_ok=True)
    os.environ["PATH"] = QUICK + os.pathsep + os.environ["PATH"]
    began = time.monotonic()
    status, printed = run(program)
    report(name, status, printed, time.monotonic() - began).write(result, encoding="utf-8", xml_declaration=True)
    return 0 if status == SKIPPED else status


if __name__ == "__main__":
    try:
        sys.exit(main(*sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
