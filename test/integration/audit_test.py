#!/usr/bin/python3
"""Compares analyze for random platoons with an independent computation in 120 digits (mpmath).

Draws admissible models of kinds that revealed errors before: the paper's platoon of orders 1 to 6 (plain models, sampled at a
kilohertz, with long headways, near the border of string stability, with factors that nearly cancel, A, B, C in skewed
coordinates); cars with actuator lag and input delay; strings of one, several and many vehicle types over links that colour, delay,
quantise and lose, independently or in bursts; unlike cars with radar and radio. For each model the audit recomputes the tables,
stationary values, verdict, limits, loss gain, and the verdicts on both sides of critical headways, loss probabilities and mean
bursts, from the numbers in the model file and with other methods (audit/).

audit_test.py [ANALYZE] [--models M] [--seed SEED] [--kind KIND] [--keep FOLDER] [--model FILE ...]
"""

import argparse
import json
import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile

import yaml
from mpmath import mpf

from audit import burst_models, loops, paper, paper_models, radio_models, received_strings, string_models, strings, tables
from audit.convolution import Unresolved
from audit.findings import Findings
from audit.polynomials import slope, value

KINDS = paper_models.KINDS + string_models.KINDS + radio_models.KINDS + burst_models.KINDS
MODELS = len(KINDS)
SLOW = 0.5    # [s] of CPU, followers 20 and steps 100
MOST_LEFT_OUT = 0.1  # largest share of models that analyze rejects or leaves undecided


def is_papers(model):
    if tables.is_received(model):
        return False
    link = model.get("channel", {})
    idle = set(link) <= {"loss"} and link.get("loss", {"probability": 0.0})["probability"] == 0.0
    return idle and set(model.get("string", [])) <= {"default"}


def admitted(model):
    """Whether the model satisfies the assumptions."""
    if tables.is_received(model):
        string = received_strings.String(dict(model, string=["default"] + list(model.get("vehicle_types", {}))))
        return string.rho() < 1 - mpf(10) ** -7 and string.mean_square_stable()
    if not is_papers(model) or "vehicle_types" in model:
        return string_models.admissible(model)
    loop = loops.loop_of(model)
    if loop.rho >= 1 - mpf(10) ** -7:
        return False
    if "closed_loop" in model:  # rounding of a strongly skewed A, B, C can destroy double integral action
        gain = value(loop.n, mpf(1)) / value(loop.d, mpf(1))
        rise = (value(slope(loop.n), mpf(1)) - gain * value(slope(loop.d), mpf(1))) / value(loop.d, mpf(1))
        return abs(gain - 1) <= 5e-5 and abs(rise + loop.h) <= 5e-4 * (1 + loop.h)
    return True


def in_samples(model):
    """The model with all headways in sample periods."""
    def converted(vehicle):
        rest = {key: value for key, value in vehicle.items() if key != "time_headway_seconds"}
        if "time_headway_seconds" in vehicle:
            rest["time_headway"] = vehicle["time_headway_seconds"] / vehicle.get("sample_period", model["sample_period"])
        return rest
    types = {name: converted(own) for name, own in model.get("vehicle_types", {}).items()}
    return dict(converted(model), **({"vehicle_types": types} if types else {}))


def read(text):
    try:
        return json.loads(text)  # a kept model: YAML takes 1e-16 for a word
    except ValueError:
        return yaml.safe_load(text)


def drawn(draw, kind):
    while True:
        model = kind(draw)
        if model is not None and admitted(model):
            return model


class Audit:
    def __init__(self, analyze, folder, patience):
        self.analyze, self.folder, self.findings, self.patience = analyze, pathlib.Path(folder), Findings(), patience

    def run(self, name, model):
        file, kind = self.folder / (name + ".yaml"), name.split("-")[0]
        file.write_text(json.dumps(model, indent=1) + "\n")
        self.findings.models[kind] += 1
        result = file.with_suffix(".json")
        if self.reported(name, kind, file, result):
            try:
                self.check(name, model, json.loads(result.read_text()))
            except Unresolved as reason:
                self.findings.undecided[kind, "in the audit: " + re.sub(r"\d+", "#", str(reason))] += 1
            result.unlink()
        if not self.findings.failed_of(name):
            file.unlink()

    def reported(self, name, kind, file, result):
        """Runs analyze; returns True, with the numbers in `result`, if it accepts the model."""
        before = os.times()
        done = subprocess.run([self.analyze, "--model", str(file), "--followers", str(strings.FOLLOWERS), "--steps",
                               str(strings.STEPS), "--json", str(result)], capture_output=True, text=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (self.patience, self.patience + 1)))
        after = os.times()
        self.findings.seconds.append(
            (after.children_user + after.children_system - before.children_user - before.children_system, name))
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            self.findings.fail_unless(False, name, "no report within %d s of CPU" % self.patience)
            return False
        self.findings.fail_unless(not re.search(r"\bnan\b|\binf\b", done.stdout), name, "prints a nan or inf")
        if done.returncode > 0:
            reason = done.stderr.strip().split("\n")[-1].split(": ", 1)[-1]
            self.findings.rejected[kind, re.sub(r"-?\d[\d.e+-]*", "#", reason.replace(str(self.folder), ""))[:160]] += 1
        else:
            self.findings.fail_unless(done.returncode == 0, name, "ends by signal %d" % -done.returncode)
        return done.returncode == 0

    def check(self, name, model, found):
        if is_papers(model):
            paper.check(name, model, loops.loop_of(model), found, self.findings)
        else:
            strings.check(name, model, found, self.findings, self.analysed)

    def analysed(self, model, *options):
        """The JSON of analyze for another model."""
        file, result = self.folder / "probe.yaml", self.folder / "probe.json"
        file.write_text(json.dumps(model) + "\n")
        subprocess.run([self.analyze, "--model", str(file), "--json", str(result), *options], stdout=subprocess.DEVNULL, check=True)
        return json.loads(result.read_text())


def parsed():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("analyze", nargs="?", help="the program; default: that of the sourced workspace")
    parser.add_argument("--models", type=int, default=MODELS, help="how many, of all kinds in turn; default: %(default)s")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=[kind.__name__ for kind in KINDS])
    parser.add_argument("--keep", help="folder for the models that failed")
    parser.add_argument("--patience", type=int, default=60, help="seconds of CPU for one report; default: %(default)s")
    parser.add_argument("--model", nargs="+", help="audit these files instead, whose poles at z = 1 may be rounded")
    arguments = parser.parse_args()
    if arguments.analyze is None:
        import live_platoon
        arguments.analyze = live_platoon.executable("analyze")
    return arguments


def models_of(arguments):
    if arguments.model:
        for file in arguments.model:
            yield pathlib.Path(file).stem.replace("-", "_"), in_samples(read(pathlib.Path(file).read_text()))
        return
    kinds = [kind for kind in KINDS if arguments.kind in (None, kind.__name__)]
    for number in range(arguments.models):
        kind = kinds[number % len(kinds)]
        name = "%s-%d-%d" % (kind.__name__, arguments.seed, number)
        yield name, drawn(random.Random(name), kind)


def main():
    arguments = parsed()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or temporary
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        audit = Audit(arguments.analyze, folder, arguments.patience)
        for name, model in models_of(arguments):
            audit.run(name, model)
    findings = audit.findings
    findings.print(SLOW)
    left_out = sum(findings.rejected.values()) + sum(
        count for (_, reason), count in findings.undecided.items() if reason.startswith("by analyze") or "kernel" in reason)
    if left_out > MOST_LEFT_OUT * sum(findings.models.values()):
        print("FAILED: %d models are rejected, undecided or not resolved" % left_out)
        return 1
    return 1 if findings.failures else 0


if __name__ == "__main__":
    sys.exit(main())
