"""A run's configuration in the fields and words of the page."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Set, Tuple, Union

import stochastic_platoon as sp
from stochastic_platoon.model import FASTEST_CAR


MOST_LINKS = 4  # unlike ones in a text
SMALL = 1e-6    # change of a value that keeps every vehicle stable


def channel_words(channel: Dict[str, Any], unit: str) -> List[str]:
    colour = channel.get("noise_filter", {})
    words = ["additive noise" if colour.get("numerator") == colour.get("denominator") else "coloured noise"]
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


def vehicles_of(model: Dict[str, Any], followers: int) -> Dict[str, Dict[str, Any]]:
    """The keys of the model file for each type among the followers, by name: its own in place of the default ones. A type with
    inputs of its own has no other channel than theirs."""
    found: Dict[str, Dict[str, Any]] = {}
    for name in model.get("string", ["default"])[:followers]:
        own = model.get("vehicle_types", {}).get(name, {})
        found[name] = {**{key: value for key, value in model.items() if key != "channel" or "inputs" not in own}, **own}
    return found


def vehicle_of(model: Dict[str, Any], follower: int) -> Dict[str, Any]:
    """The keys of the model file for one follower."""
    string = model.get("string", ["default"])
    vehicle, = vehicles_of(dict(model, string=[string[(follower - 1) % len(string)]]), 1).values()
    return vehicle


def sources_of(model: Dict[str, Any], follower: int) -> List[int]:
    """The vehicles that a follower hears, from the leader on."""
    ahead = {"predecessor": 1, "leader": follower}
    heard = [of.get("from", "predecessor") for of in vehicle_of(model, follower).get("inputs", [])] or ["predecessor"]
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


def link_of_vehicle(vehicle: Dict[str, Any], every_input: bool) -> str:
    """A text that describes the links of a vehicle: of every input by its source, or of position and radio of its predecessor."""
    inputs = vehicle.get("inputs", [{"signal": "position", "channel": vehicle.get("channel", {})}])
    if every_input:
        return "hears " + "; ".join(map(input_words, inputs))
    position, radio = (next((of for of in inputs if of["signal"] == signal), None) for signal in ("position", "input"))
    words = channel_words((position or {}).get("channel", vehicle.get("channel", {})), "m")
    if radio:
        words.append("radio with " + ", ".join(channel_words(radio.get("channel", {}), "m/s²")))
    return ", ".join(words)


def link_of(model: Dict[str, Any], followers: int) -> str:
    """A text that describes the links of the string's vehicles, unlike ones each with their types."""
    vehicles = vehicles_of(model, followers)
    every_input = hears_others(model) or any("weight" in of for vehicle in vehicles.values() for of in vehicle.get("inputs", []))
    types: Dict[str, List[str]] = {}
    for name, vehicle in vehicles.items():
        types.setdefault(link_of_vehicle(vehicle, every_input), []).append(name)
    if len(types) == 1:
        return ", ".join([*types, *(["mixed string"] if len(vehicles) > 1 else [])])
    shown = ["{} ({})".format(words, ", ".join(names[:3]) + (", ..." if names[3:] else "")) for words, names in types.items()]
    return "mixed string: " + "; ".join(shown if len(shown) <= MOST_LINKS else shown[:2] + ["{} other links".format(len(shown) - 2)])


Figure = Union[None, float, List[float]]  # of all vehicles: none, the same, or the least and the greatest


def figure_of(values: Sequence[float]) -> Figure:
    least, most = min(values, default=None), max(values, default=None)
    return least if least is None or most is None or least == most else [least, most]


def headway_of(vehicles: Sequence[Dict[str, Any]]) -> Figure:
    """Headway [sample periods] of the vehicles that have one; 0 if all spacing is constant."""
    return figure_of([of["time_headway"] for of in vehicles if of.get("spacing") != "constant"] or [0.0])


def noise_variance_of(vehicles: Sequence[Dict[str, Any]]) -> Figure:
    """Noise variance [m^2] of the positions that the vehicles hear."""
    return figure_of([position.get("noise_variance", vehicle.get("noise_variance")) for vehicle in vehicles
                      for position in vehicle.get("inputs", [{"signal": "position"}]) if position["signal"] == "position"])


def losses_of(vehicle: Dict[str, Any]) -> List[Dict[str, Any]]:
    channels = [vehicle.get("channel", {}), *(of.get("channel", {}) for of in vehicle.get("inputs", []))]
    return [channel["loss"] for channel in channels if channel.get("loss")]


def loss_of(vehicles: Sequence[Dict[str, Any]]) -> Figure:
    """Loss probability of the links that lose, 0 for a vehicle without one; None where losses have another form."""
    losses = [of for vehicle in vehicles for of in losses_of(vehicle) or [{"probability": 0.0}]]
    return figure_of([of["probability"] for of in losses]) if all("probability" in of for of in losses) else None


def changeable_of(model: sp.Model, followers: int) -> Dict[str, Optional[float]]:
    """What a change of the run may alter, with the default vehicle's values: what no follower has from the default vehicle is left out.
    None for losses that no probability describes."""
    document, default = model.to_dict(), model.vehicle(0)
    is_probability = all("probability" in of for of in losses_of(document))
    values = {"headway": default.time_headway, "noise_variance": default.noise_variance, "loss": default.loss_probability or 0.0}

    def followers_with(key: str, value: float) -> List[Tuple[float, float, Optional[float]]]:
        vehicles = map(model.replace({key: value}).vehicle, range(1, min(followers, len(document.get("string", ["default"]))) + 1))
        return [(of.time_headway, of.noise_variance, of.loss_probability) for of in vehicles]

    def changes(key: str, value: float) -> bool:
        if key == "headway" and not value:
            return False  # constant spacing has none
        try:
            # Two other values: either may be the present one of every type.
            return followers_with(key, value + SMALL) != followers_with(key, value + 2.0 * SMALL)
        except ValueError:
            return True  # the answer to the order has the reason

    return {key: value if key != "loss" or is_probability else None for key, value in values.items() if changes(key, value)}


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
    vehicles = list(vehicles_of(model, run["followers"]).values())
    return {"followers": run["followers"], "steps": run["steps"], "realizations_wanted": run["realizations"],
            "rate_wanted": run["rate"], "seed": run["seed"], "hosting": run["hosting"], "endless": run["steps"] == 0,
            "burn_in": run["burn_in"], "spacing": configuration.model.spacing, "noise": configuration.model.noise,
            "headway": headway_of(vehicles), "headway_in_seconds": in_seconds(model), "noise_variance": noise_variance_of(vehicles),
            "loss": loss_of(vehicles), "changeable": changeable_of(configuration.model, run["followers"]) if run["steps"] == 0 else None,
            "link": link_of(model, run["followers"]),
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
