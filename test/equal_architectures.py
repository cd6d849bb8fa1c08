#!/usr/bin/python3
"""equal_architectures.py FOLDER FOLDER: checks that two machines computed the same in every statistics.csv and *.json below the first.

Measured columns must be equal to the bit. Figures of the theory are computed with the machine's long double, which has 64 bits on
x86-64 and 113 on AArch64: they must agree to 1e-12 of the largest of a column in tables, and to 1e-9 of the largest of its kind in
analyze.
"""

import json
import math
import os
import sys

import equal_bits

ROUNDING = ("/integral_defect", "/rounding", "/crc32/summary")  # figures that consist of rounding errors, and the checksum of all


def differing(ours, theirs):
    """Names of the columns that are not equal in all digits, with their largest difference relative to the column's largest value."""
    for column in ours[0]:
        pairs = [(float(a[column] or "nan"), float(b[column] or "nan")) for a, b in zip(ours, theirs) if a[column] != b[column]]
        if pairs:
            apart = [abs(a - b) for a, b in pairs]
            most = math.nan if any(map(math.isnan, apart)) else max(apart)  # a figure here and none there: within no tolerance
            yield column, most / max(abs(float(row[column] or 0)) for row in ours)


def figures(value, name=""):
    """The leaves of a JSON document, by name."""
    if isinstance(value, (dict, list)):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            yield from figures(part, "{}/{}".format(name, key))
    else:
        yield name, value


def kind(name):
    """The name of a figure without list indices: all figures of a list have one scale."""
    return "/".join(part for part in name.split("/") if not part.isdigit())


def compare_statistics(first, second):
    ours, theirs = equal_bits.rows(first), equal_bits.rows(second)
    equal = len(ours) == len(theirs)
    for column, difference in differing(ours, theirs):
        allowed = 1e-12 if column.startswith("theoretical") else 0.0
        equal = equal and difference <= allowed
        print("{}: {}: differs by {:.2g} of the largest, allowed {:g}".format(second, column, difference, allowed))
    return equal


def compare_figures(first, second):
    with open(first) as ours, open(second) as theirs:
        ours, theirs = dict(figures(json.load(ours))), dict(figures(json.load(theirs)))
    equal = ours.keys() == theirs.keys()
    largest, most = {}, (0.0, "")
    for key, value in ours.items():
        if isinstance(value, float):
            largest[kind(key)] = max(largest.get(kind(key), 0.0), abs(value))
    for key in ours.keys() & theirs.keys():
        if ours[key] == theirs[key] or kind(key) in ROUNDING:
            continue
        if not all(isinstance(value, float) and math.isfinite(value) for value in (ours[key], theirs[key])):
            equal = False
            print("{}: {}: {} and {}".format(second, key, ours[key], theirs[key]))
            continue
        most = max(most, (abs(ours[key] - theirs[key]) / max(largest[kind(key)], 1e-300), key))
    if most[0] > 0.0:
        print("{}: at most {:.2g} of the largest apart, {}".format(second, *most))
    return equal and most[0] <= 1e-9


def main(first, second):
    equal = compared = 0
    for folder, _, names in os.walk(first):
        there = os.path.join(second, os.path.relpath(folder, first))
        if not os.path.isdir(there):
            continue
        for name in names:
            if name == "statistics.csv":
                compared += 1
                equal += compare_statistics(folder, there)
            elif name.endswith(".json") and name != "summary.json":
                compared += 1
                equal += compare_figures(os.path.join(folder, name), os.path.join(there, name))
    print("{} of {} equal".format(equal, compared))
    return 0 if equal == compared > 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
