"""The runs of a soak: starts each, injects its faults, and compares its results bit for bit with an undisturbed run."""

import glob
import os
import shutil
import signal
import statistics
import subprocess
import time

import faults
import live_platoon
import processes
import soak_case
import terminal

STANDSTILL = 60.0  # [s] without progress after which a run has failed: twelve times the allowed recovery time
LONGEST = 600.0  # [s] limit for any run


class Soak:
    def __init__(self, folder, master):
        self.folder, self.master = folder, master
        self.watch = faults.ProgressWatch()
        self.runs = self.sent = 0
        self.recoveries = []  # (time [s], fault) for each isolated fault
        self.footprints = []

    def case(self, case):
        kept = None
        try:
            if case.kept:
                kept = terminal.Terminal(self.folder, "followers.launch", master=self.master, first=case.kept, last=case.followers)
            for number, run in enumerate(case.runs):
                say("{}.{}  {}".format(case.number, number, run))
                self.run(run, "{}.{}".format(case.number, number), kept)
        finally:
            if kept:
                end(kept)

    def run(self, run, name, kept):
        output = os.path.join(self.folder, name)
        bag = output + ".bag"
        arguments = dict(with_model(run.settings), **run.arguments)
        if run.record:
            arguments["record"] = bag
        began = time.monotonic()
        self.watch.forget()
        can_preload = shutil.which("cc") and not live_platoon.SANITIZED
        clock = faults.ShiftedClock(self.folder) if run.clock and can_preload else None
        launch = terminal.Terminal(self.folder, "platoon.launch", master=self.master, environment=clock and clock.environment(), output=output,
                                   **arguments)
        launches = [launch.process.pid] + ([kept.process.pid] if kept else [])
        injector = faults.Injector(self.watch, launches, began, say, clock)
        try:
            self.disturb(run, injector, launch, output)
            last = self.finish(run, launch, injector)
            self.compare(run, launch, last or output, bag)
        except Exception as error:
            raise AssertionError("run {}: {}\nroslaunch printed (all of it in {}):\n{}".format(
                name, error, launch.log.name, launch.text()[-3000:]))
        finally:
            end(launch)
            self.watch.run_is_over()
            self.sent += injector.sent
        self.runs += 1
        for folder in [output] + glob.glob(output + "-run*"):
            shutil.rmtree(folder)
        for path in bags(bag):
            os.remove(path)

    def disturb(self, run, injector, launch, output):
        def ended():
            return launch.process.poll() is not None or self.watch.finished
        samples = []
        for group in run.groups:
            if not self.wait_for_moment(group, run, injector, ended, output):
                break
            isolated = len(group.faults) == 1 and group.moment not in ("start", "finish")
            before = self.watch.latest[0]
            conditions = injector.send_all(group)
            if not conditions:
                continue
            recovered = self.watch.wait(lambda: all(holds() for _, holds in conditions), ended, STANDSTILL)
            if recovered is None:
                break
            seconds = recovered - conditions[-1][0]
            if isolated:
                self.recoveries.append((seconds, str(group.faults[0])))
            say("              {} in {:.2f} s, attempt {} -> {}".format("recovered" if isolated else "all recovered", seconds, before,
                                                                       self.watch.latest[0]))
            samples.append({name: (process,) + (processes.footprint(process) or (0, 0))
                            for name, process in processes.nodes(*injector.launches).items()})
        self.tell_footprints(samples)

    def wait_for_moment(self, group, run, injector, ended, output):
        """Waits for the moment of a group; False if the run ends before."""
        if group.moment == "start":
            victim = group.faults[0].victim
            live_platoon.wait_for(lambda: ended() or victim in processes.nodes(*injector.launches), victim + " to start")
            time.sleep(group.after)
            return not ended()
        if group.moment == "finish":
            realizations = run.settings["realizations"]
            self.watch.wait(lambda: self.watch.latest[1] == realizations, ended, LONGEST)
            time.sleep(group.after)
            return True  # for the nodes that still run
        if not self.watch.wait_for_flow(group.after, ended, STANDSTILL):
            return False
        if group.moment == "commit":
            committed = self.watch.latest[1]
            return self.watch.wait(lambda: self.watch.latest[1] > committed, ended, STANDSTILL) is not None
        if group.moment == "checkpoint":
            file = os.path.join(output, "checkpoint.cbor")
            before = live_platoon.written_at(file)
            limit = time.monotonic() + 3.0  # a long batch may take long to commit
            while not ended() and time.monotonic() < limit and live_platoon.written_at(file) == before and not os.path.exists(file + ".part"):
                time.sleep(0.0005)
        return not ended()

    def finish(self, run, launch, injector):
        """Waits until the run ends. Returns the last output folder of an endless run (change_run begins new ones), else None."""
        last = None
        if run.endless:
            configuration = faults.configuration()
            last = configuration["run"]["output"]
            assert_that(configuration["model"]["time_headway"] == (injector.headway or run.settings["headway"]),
                        "headway {} was answered, and the run is of {}".format(injector.headway, configuration["model"]["time_headway"]))
            steps = soak_case.BURN_IN + 100
            self.watch.wait(lambda: self.watch.latest[2] >= steps, lambda: launch.process.poll() is not None, STANDSTILL)
            self.averaged = self.watch.latest[2] + 1 - soak_case.BURN_IN
            launch.process.send_signal(signal.SIGINT)
        deadline = time.monotonic() + LONGEST
        while launch.process.poll() is None:
            still = time.monotonic() - (self.watch.changed or time.monotonic())
            if still > STANDSTILL or time.monotonic() > deadline:
                raise AssertionError("the run does not end; nothing new for {:.0f} s; last report: attempt {}, realization {}, "
                                     "step {}, {} messages".format(still, *self.watch.latest))
            time.sleep(0.02)
        return last

    def compare(self, run, launch, output, bag):
        if run.endless:
            assert_that(live_platoon.summary_of(output)["time_average"], "the summary of an endless run is not one of time averages")
            rows = [line.split(",") for line in live_platoon.statistics(output).decode().splitlines()[1:]]
            assert_that(len(rows) == run.settings["followers"], "{} rows of averages".format(len(rows)))
            assert_that(all(int(row[2]) >= self.averaged for row in rows),
                        "fewer than {} steps in an average: {}".format(self.averaged, rows))
            return say("    goes on: at least {} steps in each average, as expected".format(self.averaged))
        summary = live_platoon.completed_summary(output)
        assert_that(summary, "roslaunch ended, and the run is not complete")
        expected = live_platoon.reference(output, **with_model(run.settings))
        assert_that(live_platoon.statistics(output) == expected,
                    "{0}/statistics.csv differs from {0}/reference/statistics.csv".format(output))
        if run.record:
            read = output + "/of_bag"
            assert_that(live_platoon.tool("bag_statistics", *bags(bag), output=read).returncode == 0, "the bag {} cannot be read".format(bag))
            assert_that(live_platoon.statistics(read) == expected, "the bag {} gives other statistics".format(bag))
        say("    the same bits{}, {} attempts".format(", from the bag, too" if run.record else "", summary["attempts"]))

    def tell_footprints(self, samples):
        """Reports memory and descriptors of the surviving nodes in a run of many kills, at a tenth of the run and at its end."""
        if len(samples) < 20:
            return
        first, last = samples[len(samples) // 10], samples[-1]
        survivors = [name for name in first if name in last and first[name][0] == last[name][0] and last[name][1]]
        sums = [sum(sample[name][part] for name in survivors) for part in (1, 2) for sample in (first, last)]
        self.footprints.append("{} nodes that outlived {} groups of faults ({}): {:.1f} -> {:.1f} MB, {} -> {} descriptors".format(
            len(survivors), len(samples), ", ".join(sorted(survivors)), sums[0] * 1e-6, sums[1] * 1e-6, *sums[2:]))
        say("    " + self.footprints[-1])

    def report(self):
        lines = ["{} runs with the bits of an undisturbed one; {} faults".format(self.runs, self.sent)]
        for what, words in (("end of a node", ("SIGKILL", "SIGTERM")), ("SIGSTOP", ("SIGSTOP",)), ("jump of the clock", ("the clock",)),
                            ("order", ("change_run",))):
            found = sorted(pair for pair in self.recoveries if pair[1].startswith(words))
            if found:
                lines.append("recovery from an isolated {}: median {:.2f} s, worst {:.2f} s ({}), of {}".format(
                    what, statistics.median(seconds for seconds, _ in found), found[-1][0], found[-1][1], len(found)))
        return "\n".join(lines + self.footprints)


def say(text):
    print(text, flush=True)


def assert_that(condition, otherwise):
    if not condition:
        raise AssertionError(otherwise)


def with_model(settings):
    """The settings with the path of their model file instead of its name."""
    return dict(settings, model=live_platoon.shared("config", settings["model"]))


def bags(first):
    folder, stem = os.path.split(first[:-len(".bag")])
    return [os.path.join(folder, name) for name in os.listdir(folder) if name.startswith(stem) and name.endswith(".bag")]


def end(launch):
    """Ends a roslaunch and all its processes, if necessary with SIGKILL."""
    if launch.process.poll() is None:
        launch.process.send_signal(signal.SIGINT)
        try:
            launch.process.wait(timeout=40.0)
        except subprocess.TimeoutExpired:
            for process in processes.children(launch.process.pid) + [launch.process.pid]:
                os.kill(process, signal.SIGKILL)
            launch.process.wait()
    launch.log.close()
