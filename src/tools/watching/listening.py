"""Feeds a PlatoonState from the condensed topics of a platoon."""

from __future__ import annotations

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
    while not rospy.is_shutdown() and not state.began:
        try:
            topics = {name[len(namespace):] for name, _ in master.getPublishedTopics(namespace)}
            text = rospy.get_param(namespace + "configuration", None)
            if text and "configuration" not in topics:
                state.take_configuration(types.SimpleNamespace(data=text))
            state.take_topics(topics)
        except (rosgraph.MasterException, OSError, ValueError, KeyError):
            pass  # retried
        rospy.rostime.wallsleep(POLL)


def listen(state: PlatoonState, namespace: str = "", snapshots: bool = True) -> None:
    """Subscribes the state to the topics of a namespace such as "/platoon/", by default this node's own.

    Short queues drop old messages, so memory stays bounded.
    """
    def subscribe(topic: str, kind: Any, callback: Callable[[Any], None], queue_size: int = 1) -> None:
        rospy.Subscriber(topic if topic.startswith("/") else namespace + topic, kind, callback, queue_size=queue_size, tcp_nodelay=True)

    subscribe("configuration", String, state.take_configuration)
    subscribe("overview", Overview, lambda message: state.take_overview(message, time.monotonic()))
    subscribe("/diagnostics", DiagnosticArray, state.take_diagnostics, queue_size=20)
    if snapshots:
        subscribe("predecessor_snapshot", Snapshot, state.take_told, queue_size=5)
        subscribe("snapshot", Snapshot, state.take_snapshot, queue_size=2)
    threading.Thread(target=report_start, args=(state, namespace or rospy.get_namespace()), daemon=True).start()
