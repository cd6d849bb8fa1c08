#!/usr/bin/python3
"""equal_bits.py RUN RUN: checks that the statistics of two runs are equal to the bit; prints the differences and their size."""

import csv
import struct
import sys

KEYS = ("vehicle", "step", "count")


def rows(run):
    with open(run + "/statistics.csv") as file:
        return list(csv.DictReader(file))


def steps_apart(a, b):
    """The distance of two doubles, counted in representable doubles."""
    ordered = []
    for value in (a, b):
        bits = struct.unpack("<q", struct.pack("<d", float(value)))[0]
        ordered.append(bits if bits >= 0 else -(bits & 0x7fffffffffffffff))
    return abs(ordered[0] - ordered[1])


def main(first, second):
    ours, theirs = rows(first), rows(second)
    if [[row[key] for key in KEYS] for row in ours] != [[row[key] for key in KEYS] for row in theirs]:
        sys.exit("the rows differ")
    equal = True
    for column in ours[0]:
        differing = [(steps_apart(a[column], b[column]), a, b) for a, b in zip(ours, theirs) if a[column] != b[column]]
        if not differing:
            continue
        equal = False
        most, a, b = max(differing, key=lambda entry: entry[0])
        print("{}: {} of {} differ, at most by {} units in the last place: vehicle {}, step {}: {} and {}".format(
            column, len(differing), len(ours), most, a["vehicle"], a["step"], a[column], b[column]))
    return 0 if equal else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
