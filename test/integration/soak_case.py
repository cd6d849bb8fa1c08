"""The runs and faults of a soak, determined by its seed. This module starts, stops and observes nothing."""

import random
from dataclasses import dataclass, field

SIGNALS = ("SIGKILL", "SIGSTOP", "SIGTERM")
MODELS, RADIOS = ("paper.yaml", "lossy.yaml", "mixed.yaml", "by_distance.yaml"), ("cacc.yaml", )  # in config
BURN_IN = 50


@dataclass
class Fault:
    """A signal to a node; CLOCK: a jump of the system clock; ORDER: change_run with another headway."""
    signal: str
    victim: str   # a node's name without its namespace
    delay: float  # [s] after the moment of its group
    hold: float   # [s] from SIGSTOP to SIGCONT
    value: float = 0.0  # CLOCK: the jump [s]; ORDER: the headway

    def __str__(self):
        if self.signal == "CLOCK":
            return "the clock jumps by {:+.0f} s".format(self.value)
        if self.signal == "ORDER":
            return "change_run to headway {}".format(self.value)
        held = " for {:.2f} s".format(self.hold) if self.signal == "SIGSTOP" else ""
        return "{} {}{}".format(self.signal, self.victim, held)


@dataclass
class Group:
    """Faults that belong together; the next group waits until the run makes progress again. A single fault is an isolated one.

    start: `after` seconds after the first victim's process exists. flow: after that many seconds of undisturbed progress. commit,
    checkpoint: as flow, then when the next batch is committed or the next checkpoint is being written. finish: `after` seconds
    after the commit of the last realization.
    """
    moment: str
    after: float
    faults: list


@dataclass
class Run:
    settings: dict   # settings of the launch and of monte_carlo, on which the statistics depend
    arguments: dict  # settings of the launch only, on which the statistics must not depend
    record: bool
    groups: list

    @property
    def endless(self):
        return self.settings["steps"] == 0

    @property
    def clock(self):
        """Whether the system clock jumps during the run."""
        return any(fault.signal == "CLOCK" for group in self.groups for fault in group.faults)

    def __str__(self):
        words = ["{}:={}".format(name, value) for name, value in list(self.settings.items()) + list(self.arguments.items())]
        return " ".join(words + ["record"] * self.record)


@dataclass
class Case:
    """Consecutive runs on one master. Vehicles from `kept` on (0: none) are started by followers.launch and outlive the runs."""
    number: int
    followers: int
    kept: int = 0
    runs: list = field(default_factory=list)


@dataclass
class Scale:
    followers: int  # largest number
    seconds: tuple  # [s] shortest and longest undisturbed run
    gap: tuple      # [s] shortest and longest progress between groups
    hold: float     # [s] longest time between SIGSTOP and SIGCONT
    kept_share: float  # share of cases with kept followers
    many_kills: int  # kills in a case of many kills; 0: no such cases
    launch: dict    # arguments of every launch


LONG = Scale(followers=20, seconds=(4.0, 12.0), gap=(0.2, 2.0), hold=3.0, kept_share=0.3, many_kills=200, launch={})
SHORT = Scale(followers=6, seconds=(0.7, 1.2), gap=(0.1, 0.5), hold=0.6, kept_share=0.25, many_kills=0,
              launch=dict(stall_timeout=0.5))


def log_uniform(rng, least, most):
    return int(round(least * (most / least) ** rng.random()))


def nodes_of(hosting, followers):
    if hosting == "one_process":
        return ["platoon"]
    return ["channel", "monitor"] + ["vehicle_{}".format(i) for i in range(followers + 1)]


def draw_fault(rng, nodes, scale, signals=SIGNALS):
    # Unique nodes are drawn as often as followers.
    few = [node for node in nodes if node in ("channel", "monitor", "vehicle_0", "platoon")]
    victim = rng.choice(few if few and rng.random() < 0.5 else nodes)
    return Fault(rng.choices(signals, (5, 3, 2)[:len(signals)])[0], victim, 0.0, rng.uniform(0.05, scale.hold))


def draw_headway(rng):
    return round(rng.uniform(2.2, 3.6), 2)


def draw_order(rng, nodes):
    """change_run, usually with a kill as soon as it is confirmed: of the node that receives it, of this node and the leader, or of all."""
    takes = [node for node in nodes if node in ("monitor", "platoon")]
    victims = rng.choice(([], takes, takes, takes + [node for node in nodes if node == "vehicle_0"], nodes))
    return [Fault("ORDER", "monitor", 0.0, 0.0, draw_headway(rng))] + [Fault("SIGKILL", victim, 0.0, 0.0) for victim in victims]


def draw_group(rng, moment, nodes, scale, endless=False):
    drawn = rng.random()
    after = rng.uniform(*scale.gap)
    if moment not in ("start", "finish"):
        if drawn < 0.1:
            return Group(moment, after, [Fault("SIGKILL", node, 0.0, 0.0) for node in nodes])
        if drawn < 0.2:  # no kill after a jump back: roslaunch would wait until the clock catches up
            jump = rng.choice((-3600.0, -2.0, 0.7, 3600.0, 1e8))
            kill = [draw_fault(rng, nodes, scale, ("SIGKILL",))] if jump > 0 and rng.random() < 0.5 else []
            return Group(moment, after, [Fault("CLOCK", "", 0.0, 0.0, jump)] + kill)
        if endless and drawn < 0.5:
            return Group(moment, after, draw_order(rng, nodes))
        if moment == "checkpoint" and drawn < 0.6:  # the node that writes it
            writer = [node for node in nodes if node in ("monitor", "platoon")]
            return Group(moment, after, [draw_fault(rng, writer, scale, ("SIGKILL",))])
    faults = [draw_fault(rng, nodes, scale)]
    if rng.random() < 0.4:  # several, at once or overlapping
        spread = rng.choice((0.0, 0.05, 1.0)) * min(1.0, scale.hold)
        for _ in range(rng.randint(1, 4)):
            fault = draw_fault(rng, nodes, scale)
            fault.delay = spread * rng.random()
            faults.append(fault)
        faults.sort(key=lambda fault: fault.delay)
    if moment in ("start", "finish"):
        after = rng.choice((0.0, 0.05, 0.4)) * rng.random()
    return Group(moment, after, faults)


def draw_groups(rng, nodes, scale, seconds, endless):
    groups = [draw_group(rng, "start", nodes, scale)] if rng.random() < 0.4 else []
    planned = 0.0
    while planned < seconds:
        moment = "flow" if endless else rng.choice(("flow", "flow", "commit", "checkpoint"))
        groups.append(draw_group(rng, moment, nodes, scale, endless))
        planned += groups[-1].after + 0.2  # some time passes before progress is detected
    if not endless and rng.random() < 0.4:
        groups.append(draw_group(rng, "finish", nodes, scale))
    return groups


def draw_size(rng, run, followers, hosting, seconds):
    """Draws steps, realizations, batch and rate of a run that takes about `seconds` undisturbed on two busy cores."""
    steps = log_uniform(rng, 5, 100)
    paced = rng.random() < 0.5
    rate = max(log_uniform(rng, 50, 400), 2 * steps) if paced else 0
    batch = log_uniform(rng, 1, 4096)
    messages = 250000.0 if hosting == "one_process" else 40000.0    # [1/s]
    positions = 4e7 if hosting == "one_process" else 2e7            # [1/s]
    pace = min(messages, positions / batch) / (2 * followers + 1)   # [steps/s]
    batches = max(1, int(seconds * (min(rate, pace) if paced else pace) / (steps + 1)))
    realizations = batches * batch - rng.randrange(batch)
    if run.record:  # 16 bytes per position on the disk
        realizations = max(1, min(realizations, int(4e6 / ((steps + 1) * (followers + 1)))))
    run.settings.update(steps=steps, realizations=realizations)
    run.arguments.update(batch=0 if not paced and rng.random() < 0.2 else batch, rate=rate)


def draw_run(rng, case, scale, models=None, endless_share=0.1):
    hosting = "processes" if case.kept or rng.random() < 0.6 else "one_process"
    seconds = rng.uniform(*scale.seconds)
    endless = rng.random() < endless_share
    run = Run(dict(followers=case.followers, headway=draw_headway(rng), seed=rng.randrange(1, 2 ** 31), model=rng.choice(models or MODELS + RADIOS)),
              dict(scale.launch, hosting=hosting), not endless and rng.random() < 0.35, [])
    if endless:
        run.settings.update(steps=0, realizations=1)
        run.arguments.update(rate=log_uniform(rng, 200, 1000), burn_in=BURN_IN)
    else:
        draw_size(rng, run, case.followers, hosting, seconds)
    if case.kept:
        run.arguments["last"] = case.kept - 1
    run.groups = draw_groups(rng, nodes_of(hosting, case.followers), scale, seconds, endless)
    return run


def draw_many_kills(rng, case, scale):
    """One run with many kills of half the nodes: the others show whether memory and descriptors grow with the kills."""
    nodes = nodes_of("processes", case.followers)
    victims = rng.sample(nodes, (len(nodes) + 1) // 2)
    steps, rate, gap, batch = 20, 200, 0.3, log_uniform(rng, 16, 512)
    batches = int(scale.many_kills * gap * rate / (steps + 1))
    groups = [Group("flow", gap, [draw_fault(rng, victims, scale, ("SIGKILL",))]) for _ in range(scale.many_kills)]
    case.runs = [Run(dict(followers=case.followers, headway=3.2, seed=rng.randrange(1, 2 ** 31), model=MODELS[0], steps=steps,
                          realizations=batches * batch), dict(scale.launch, hosting="processes", batch=batch, rate=rate), False, groups)]


def draw_case(seed, number, scale):
    """Case `number` of a seed, independent of all other cases."""
    rng = random.Random("{}/{}".format(seed, number))
    case = Case(number, rng.randint(2, scale.followers))
    if scale.many_kills and number % 25 == 5:
        case.followers = min(case.followers, 8)
        draw_many_kills(rng, case, scale)
        return case
    if rng.random() < scale.kept_share:
        case.kept = rng.randint(2, case.followers)
    # On kept followers, models with radios in turn with others.
    first = rng.randrange(2)
    for number in range(rng.randint(2, 4) if case.kept else 1):
        case.runs.append(draw_run(rng, case, scale, (MODELS, RADIOS)[(first + number) % 2] if case.kept else None))
    return case
