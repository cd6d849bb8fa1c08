"""A run's configuration in the fields and words of the page."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Set

import stochastic_platoon as sp
from stochastic_platoon.model import FASTEST_CAR


def channel_words(channel: Dict[str, Any], unit: str) -> List[str]:
    words = ["additive noise" if not channel.get("noise_filter") else "coloured noise"]
    if channel.get("quantisation_step"):
        words.append("quantised to {:g} {}".format(channel["quantisation_step"], unit))
    if channel.get("delay"):
        words.append("delay {}".format(channel["delay"]))
    loss = channel.get("loss", {})
    if "probability" in loss:
        burst = ", bursts of {:g}".format(loss["mean_burst"]) if loss.get("mean_burst") else ""
        words.append("loss {:g}{}".format(loss["probability"], burst))
    elif loss:
        kinds = {"by_distance": "losses by distance", "markov": "losses by the states of a chain", "runs": "recorded losses"}
        words.append(next(words for key, words in kinds.items() if key in loss))
    return words


def radio_of(model: Dict[str, Any]) -> Optional[Dict[str, Any]]:
    """The default vehicle's input by radio; None without one."""
    return next((of for of in model.get("inputs", []) if of["signal"] == "input"), None)


def inputs_of(model: Dict[str, Any], follower: int) -> List[Dict[str, Any]]:
    """What a follower hears, as in the model file; empty if it hears its predecessor's position alone."""
    string = model.get("string", ["default"])
    own = model.get("vehicle_types", {}).get(string[(follower - 1) % len(string)], {})
    inputs: List[Dict[str, Any]] = own.get("inputs", model.get("inputs", []))
    return inputs


def sources_of(model: Dict[str, Any], follower: int) -> List[int]:
    """The vehicles that a follower hears, from the leader on."""
    ahead = {"predecessor": 1, "leader": follower}
    heard = [of.get("from", "predecessor") for of in inputs_of(model, follower)] or ["predecessor"]
    return sorted({max(follower - ahead.get(of, of), 0) for of in heard})


def hears_others(model: Dict[str, Any]) -> bool:
    """Whether a vehicle hears more than position and control input of its predecessor."""
    every = [model, *model.get("vehicle_types", {}).values()]
    return any(of["signal"] in ("speed", "acceleration") or of.get("from", "predecessor") != "predecessor"
               for vehicle in every for of in vehicle.get("inputs", []))


def input_words(of: Dict[str, Any]) -> str:
    source = {"predecessor": "the predecessor", "leader": "the leader"}.get(of.get("from", "predecessor"), "vehicle i-{}".format(of.get("from")))
    unit = {"position": "m", "speed": "m/s"}.get(of["signal"], "m/s²")
    return "{} of {} ({})".format(of["signal"], source, ", ".join(channel_words(of.get("channel", {}), unit)))


def link_of(model: Dict[str, Any]) -> str:
    """A text that describes the links of the default vehicle."""
    if hears_others(model) or any("weight" in of for of in model.get("inputs", [])):
        words = ["hears " + "; ".join(map(input_words, model["inputs"]))] if "inputs" in model else []
        return ", ".join(words + (["mixed string"] if model.get("vehicle_types") else []))
    words, radio = channel_words(model.get("channel", {}), "m"), radio_of(model)
    if radio:
        words.append("radio with " + ", ".join(channel_words(radio["channel"], "m/s²")))
    if model.get("vehicle_types"):
        words.append("mixed string")
    return ", ".join(words)


def in_seconds(model: Dict[str, Any]) -> bool:
    """Whether the model file uses physical units: lag and delay in s, or gains in 1/s^2 and 1/s."""
    return "continuous" in model.get("plant", {}) or "kp" in model.get("controller", {})


def lengths_of(model: sp.Model, mixed: bool, followers: int) -> List[float]:
    """The lengths [m] of vehicles 0 .. N; 0 where the model has none."""
    if not mixed:
        return (followers + 1) * [model.vehicle(0).vehicle_length]
    return [model.vehicle(i).vehicle_length for i in range(followers + 1)]


def described(text: str) -> Dict[str, Any]:
    """The fields of a configuration that the page shows. Raises ValueError if another version wrote it."""
    configuration = sp.Configuration.parse(text)
    vehicle, model, run = configuration.model.vehicle(0), configuration.model.to_dict(), configuration.run
    channels = [of.get("channel", {}) for of in [model, *model.get("inputs", [])]]
    return {"followers": run["followers"], "steps": run["steps"], "realizations_wanted": run["realizations"],
            "rate_wanted": run["rate"], "seed": run["seed"], "hosting": run["hosting"], "endless": run["steps"] == 0,
            "burn_in": run["burn_in"], "spacing": configuration.model.spacing, "noise": configuration.model.noise,
            "headway": vehicle.time_headway, "headway_in_seconds": in_seconds(model),
            "noise_variance": vehicle.noise_variance,
            "loss": vehicle.loss_probability if any("probability" in of.get("loss", {}) for of in channels) else None, "link": link_of(model),
            "standstill_distance": vehicle.standstill_distance, "sample_period": configuration.model.sample_period,
            "manoeuvres": configuration.model.manoeuvres(), "fastest_car": FASTEST_CAR,
            "vehicle_lengths": lengths_of(configuration.model, "vehicle_types" in model, run["followers"]),
            "heard": [sources_of(model, i) for i in range(1, run["followers"] + 1)] if hears_others(model) else [],
            "output": run["output"], "external": [int(i) for i in run.get("external", "").split(",") if i]}


def start_of(topics: Set[str], followers: int, external: Sequence[int]) -> str:
    """A text on a platoon before its first step: missing vehicles, or the next stage."""
    missing = [i for i in range(followers + 1) if "vehicle_{}/position".format(i) not in topics]
    if not missing:
        return "all {} vehicles are running, the {}".format(followers + 1, "first step is under way" if "overview" in topics else "monitor starts")
    names = ", ".join("vehicle_{}{}".format(i, " (external)" if i in external else "") for i in missing[:3])
    return "{} of {} vehicles are running, missing: {}{}".format(followers + 1 - len(missing), followers + 1, names, ", ..." if missing[3:] else "")
