"""Feeds a PlatoonState from the condensed topics of a platoon."""

from __future__ import annotations

import signal
import threading
import time
import types
from typing import Any, Callable

import rosgraph
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import String
from stochastic_platoon.msg import Overview, Snapshot

from .state import PlatoonState

POLL = 1.0  # [s]


def report_start(state: PlatoonState, namespace: str) -> None:
    """Reports the start from the master's data: the monitor starts last, half a minute after the first of 500 followers."""
    master = rosgraph.Master(rospy.get_name())
    while not rospy.is_shutdown() and not state.began and not state.latest:
        try:
            topics = {name[len(namespace):] for name, _ in master.getPublishedTopics(namespace)}
            text = rospy.get_param(namespace + "configuration", None)
            if text and "configuration" not in topics:
                state.take_configuration(types.SimpleNamespace(data=text))
            state.take_topics(topics)
        except (rosgraph.MasterException, OSError, ValueError, KeyError):
            pass  # retried
        rospy.rostime.wallsleep(POLL)


def listen(state: PlatoonState, received: bool = True) -> None:
    """Subscribes the state to the topics of its namespace. Short queues drop old messages, so memory stays bounded."""
    namespace = "/{}/".format(state.namespace) if state.namespace else "/"

    def subscribe(topic: str, kind: Any, callback: Callable[[Any], None], queue_size: int = 1) -> None:
        rospy.Subscriber(topic, kind, callback, queue_size=queue_size, tcp_nodelay=True)

    subscribe(namespace + "configuration", String, state.take_configuration)
    subscribe(namespace + "overview", Overview, lambda message: state.take_overview(message, time.monotonic()))
    subscribe("/diagnostics", DiagnosticArray, state.take_diagnostics, queue_size=20)
    subscribe(namespace + "snapshot", Snapshot, state.take_snapshot, queue_size=2)
    if received:
        subscribe(namespace + "predecessor_snapshot", Snapshot, state.take_received, queue_size=5)
    threading.Thread(target=report_start, args=(state, namespace), daemon=True).start()


def observe(program: str, namespace: str) -> PlatoonState:
    """The state of a platoon, without the received positions, for a program beside the launch. Raises ValueError without a master."""
    if not rosgraph.is_master_online():
        raise ValueError("there is no ROS master at {}: launch a platoon, or set ROS_MASTER_URI".format(rosgraph.get_master_uri()))
    # A signal ends the program until it is registered: rospy's handlers may wait forever for a lock that the interrupted call holds.
    rospy.init_node(program, anonymous=True, disable_rosout=True, disable_signals=True)
    state = PlatoonState(namespace=namespace.strip("/"))
    listen(state, received=False)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: rospy.signal_shutdown("signal"))
    return state
