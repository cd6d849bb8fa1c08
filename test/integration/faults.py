"""Injects faults into the nodes of a running platoon and measures the time until the platoon recovers."""

import json
import os
import signal
import struct
import subprocess
import threading
import time

import rospy
from stochastic_platoon.msg import Progress
from std_srvs.srv import Trigger

from processes import nodes


class ShiftedClock:
    """A jump of the system clock for the processes of one environment only, through a preloaded library."""

    def __init__(self, folder):
        self.shim, self.file, self.shift = os.path.join(folder, "shifted_clock.so"), os.path.join(folder, "shift"), 0.0
        source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "shifted_clock.c")
        subprocess.run(["cc", "-shared", "-fPIC", "-o", self.shim, source, "-ldl"], check=True)
        self.jump(0.0)

    def environment(self):
        return dict(os.environ, LD_PRELOAD=self.shim, SHIFTED_CLOCK=self.file)

    def jump(self, seconds):
        self.shift += seconds
        with open(self.file, "r+b" if os.path.exists(self.file) else "wb", buffering=0) as file:
            file.write(struct.pack("<q", round(1e9 * self.shift)))


class ProgressWatch:
    """The monitor's progress reports of the latest run.

    The platoon has recovered from the end of a node when the monitor reports step 0 or later of an attempt newer than any
    reported before: it has then received two steps of every vehicle after the fault. If the node that ended is the monitor
    itself, the report must come over a new connection instead. The platoon has recovered from a SIGSTOP when, after the SIGCONT,
    the monitor reports more than before. Recovery times count from the signal, for a SIGSTOP from the SIGCONT.
    """

    def __init__(self):
        self.lock = threading.Condition()
        self.old_runs = set()
        self.forget()
        self.subscriber = rospy.Subscriber("/platoon/progress", Progress, self.receive, queue_size=None, tcp_nodelay=True)

    def forget(self):
        """Discards everything reported so far: the next report belongs to a new run."""
        with self.lock:
            self.run = None
            self.latest = (0, 0, -2, 0)  # attempt, first realization, step, messages
            self.most = 0                # largest attempt
            self.connection = None
            self.changed = None          # [s] time of the latest progress
            self.finished = False

    def run_is_over(self):
        self.old_runs.add(self.run)

    def receive(self, message):
        if message.receiver != "monitor" or message.run in self.old_runs:
            return
        with self.lock:
            if self.run not in (None, message.run):  # another run of the launch
                self.old_runs.add(self.run)
                self.most = 0
            self.run = message.run
            report = (message.attempt, message.first_realization, message.step, message.messages)
            if report != self.latest or message._connection_header is not self.connection:
                self.changed = time.monotonic()
            self.latest, self.connection = report, message._connection_header
            self.most = max(self.most, message.attempt)
            self.finished = message.finished
            self.lock.notify_all()

    def moved_on_from(self, reporter):
        """A condition that holds once the platoon has recovered from a node that ends now; `reporter`: the monitor's node."""
        with self.lock:
            run, attempt, connection = self.run, self.most, self.connection
        if reporter:
            return lambda: self.connection is not connection and self.latest[2] >= 0
        return lambda: (self.run != run or self.latest[0] > attempt) and self.latest[2] >= 0

    def another_run(self, before):
        """A condition that holds once step 0 or later of a run other than `before` is reported."""
        return lambda: self.run not in (None, before) and self.latest[2] >= 0

    def more(self):
        """A condition that holds once the reports exceed the present ones."""
        with self.lock:
            before = self.latest
        return lambda: self.latest != before and self.latest[2] >= -1

    def wait(self, condition, ended, deadline):
        """The time [s] at which the condition held; None if ended() came first. Raises AssertionError after the deadline."""
        end = time.monotonic() + deadline
        with self.lock:
            while not condition():
                if ended():
                    return None
                if time.monotonic() > end:
                    raise AssertionError("the platoon stood still for {:.0f} s; last report: attempt {}, realization {}, step {}, "
                                         "{} messages".format(deadline, *self.latest))
                self.lock.wait(0.05)
            return self.changed

    def wait_for_flow(self, seconds, ended, deadline):
        """Waits until the reports have shown steady progress for so many seconds; False if the run ends before."""
        begin = time.monotonic()
        while not ended():
            present = time.monotonic()
            still = present - (self.changed or 0.0)
            if still > 0.5:
                begin = present
            elif present - begin >= seconds and self.latest[2] >= -1:
                return True
            if still > deadline and present - begin > deadline:
                raise AssertionError("the platoon stood still for {:.0f} s".format(still))
            time.sleep(0.01)
        return False


class Injector:
    """Sends the faults of a group to the nodes of these launches, and prints each with its time."""

    def __init__(self, watch, launches, began, say, clock=None):
        self.watch, self.launches, self.began, self.say, self.clock = watch, launches, began, say, clock
        self.headway = None  # headway of the latest confirmed order
        self.stopped = {}  # process: time of its SIGCONT [s]
        self.sent = 0

    def continue_due(self, present=float("inf")):
        """Sends the SIGCONTs that are due; returns their recovery conditions."""
        conditions = []
        for process in [process for process, until in self.stopped.items() if until <= present]:
            del self.stopped[process]
            if process not in nodes(*self.launches).values():
                continue  # killed meanwhile
            conditions.append((time.monotonic(), self.watch.more()))
            os.kill(process, signal.SIGCONT)
        return conditions

    def send(self, fault):
        """Sends a fault. Returns [(time sent [s], recovery condition)], empty for a SIGSTOP or if the process does not exist."""
        if fault.signal in ("CLOCK", "ORDER"):
            return self.jump(fault) if fault.signal == "CLOCK" else self.order(fault)
        process = nodes(*self.launches).get(fault.victim)
        if process is None:
            return []
        present = time.monotonic()
        if fault.signal == "SIGSTOP":
            self.stopped[process] = max(present + fault.hold, self.stopped.get(process, 0.0))
            condition = []
        else:
            condition = [(present, self.watch.moved_on_from(fault.victim in ("monitor", "platoon")))]
        os.kill(process, getattr(signal, fault.signal))
        self.sent += 1
        self.say("{:8.2f} s  {}".format(present - self.began, fault))
        return condition

    def jump(self, fault):
        if self.clock is None:
            self.say("skipped: {}: a preload needs a C compiler, and no sanitizer".format(fault))
            return []
        condition = [(time.monotonic(), self.watch.more())]
        self.clock.jump(fault.value)
        self.sent += 1
        self.say("{:8.2f} s  {}".format(time.monotonic() - self.began, fault))
        return condition

    def order(self, fault):
        """Calls change_run. Returns the condition that the new run makes progress, or no condition without an answer."""
        before = self.watch.run
        try:
            rospy.wait_for_service("/platoon/change_run", 5.0)
            rospy.set_param("/platoon/change_run", {"headway": fault.value})
            answer = rospy.ServiceProxy("/platoon/change_run", Trigger)()
        except (rospy.ROSException, rospy.ServiceException):
            return []
        if not answer.success:
            raise AssertionError("{}: {}".format(fault, answer.message))
        self.sent += 1
        self.headway = fault.value
        self.say("{:8.2f} s  {}".format(time.monotonic() - self.began, fault))
        return [(time.monotonic(), self.watch.another_run(before))]

    def send_all(self, group):
        """Sends all faults of a group, up to the last SIGCONT; returns the recovery conditions with their start times [s]."""
        begin, waiting, conditions = time.monotonic(), list(group.faults), []
        try:
            while waiting or self.stopped:
                present = time.monotonic()
                conditions += self.continue_due(present)
                while waiting and present - begin >= waiting[0].delay:
                    conditions += self.send(waiting.pop(0))
                time.sleep(0.005)
        finally:
            conditions += self.continue_due()
        return conditions


def configuration():
    """The configuration of the platoon's latest run: model and run."""
    return json.loads(rospy.get_param("/platoon/configuration"))
