"""Programs that compare analyze with other computations for random models: their arguments, and the figures of analyze."""

import argparse
import json
import os
import subprocess
import tempfile

import live_platoon


def parsed(description, models):
    """The arguments: analyze, models (default given), seed."""
    parser = argparse.ArgumentParser(description=description.split("\n")[0])
    parser.add_argument("analyze", nargs="?", help="the program; default: that of the sourced workspace")
    parser.add_argument("--models", type=int, default=models, help="of each kind (%(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    arguments.analyze = arguments.analyze or live_platoon.executable("analyze")
    return arguments


def analysis_of(analyze, name, model, **options):
    """The JSON of the program analyze for a model; None if its loop or its predictions are unstable."""
    with tempfile.TemporaryDirectory() as folder:
        file, result = os.path.join(folder, "model.yaml"), os.path.join(folder, "result.json")
        with open(file, "w") as stream:
            json.dump(model, stream)
        words = ["--{}={}".format(option.replace("_", "-"), value) for option, value in options.items()]
        done = subprocess.run([analyze, "--model", file, "--json", result] + words, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True)
        if done.returncode != 0 and any(words in done.stderr for words in ("rho(A)", "variance grows")):
            return None
        assert done.returncode == 0, "%s: %s\n%s" % (name, done.stderr, json.dumps(model))
        with open(result) as stream:
            return json.load(stream)
