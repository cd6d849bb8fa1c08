"""Vehicle-steps per second of sp.monte_carlo, seconds of sp.analyze and of the import: JSON on standard output."""

import json
import sys
import time

began = time.perf_counter()
import stochastic_platoon as sp  # noqa: E402 - its time is measured

imported = time.perf_counter() - began


def seconds(function):
    began = time.perf_counter()
    function()
    return time.perf_counter() - began


model, realizations = sp.Model.load(), int(sys.argv[1])
analysis = min(seconds(lambda: sp.analyze(model)) for _ in range(50))
run = seconds(lambda: sp.monte_carlo(model, realizations=realizations))
print(json.dumps({"vehicle_steps_per_second": 20 * 100 * realizations / run, "analyze": analysis, "import": imported}))
