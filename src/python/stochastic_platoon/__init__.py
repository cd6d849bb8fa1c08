"""Vehicle platoons from a script: models, exact theory, Monte Carlo and recordings as NumPy arrays, without a ROS master.

    import stochastic_platoon as sp

    model = sp.Model.load("paper.yaml").replace(time_headway=3.0)
    analysis = sp.analyze(model)
    results = sp.monte_carlo(model, realizations=10**6)
    print(analysis.string_stable, results.variance[-1, -1], analysis.variance[-1, -1])

Errors are ValueError for a model or a setting, FileNotFoundError for a file and KeyError for a result that does not exist, with
the texts of the tools. The messages of this package's topics are in stochastic_platoon.msg.
"""

from ._platoon import version as __version__
from .model import SIGNALS, Configuration, Model, Vehicle, shipped_file
from .rare_events import Rare, rare
from .recording import Recording
from .results import Results, check
from .simulation import Trajectories, UnsavedResults, monte_carlo, trajectories
from .sweeps import Sweep
from .tables import Ages, Amplification, Gaps, Moments
from .theory import Analysis, StabilityMap, analyze, stability_map
from .tuning import Tuning, tune

__all__ = [
    "SIGNALS", "__version__", "Ages", "Amplification", "Analysis", "Configuration", "Gaps", "Model", "Moments", "Rare", "Recording",
    "Results", "StabilityMap", "Sweep", "Trajectories", "Tuning", "UnsavedResults", "Vehicle", "analyze", "check", "monte_carlo", "rare",
    "shipped_file", "stability_map", "trajectories", "tune",
]
