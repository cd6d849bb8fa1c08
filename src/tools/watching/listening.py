"""Feeds a PlatoonState from the condensed topics of a platoon."""

import time

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import String
from stochastic_platoon.msg import Overview, Snapshot


def listen(state, namespace="", snapshots=True):
    """Subscribes the state to the topics of a namespace such as "/platoon/", by default this node's own.

    Short queues drop old messages, so memory stays bounded.
    """
    def subscribe(topic, kind, callback, queue_size=1):
        rospy.Subscriber(topic if topic.startswith("/") else namespace + topic, kind, callback, queue_size=queue_size, tcp_nodelay=True)

    subscribe("configuration", String, state.take_configuration)
    subscribe("overview", Overview, lambda message: state.take_overview(message, time.monotonic()))
    subscribe("/diagnostics", DiagnosticArray, state.take_diagnostics, queue_size=20)
    if snapshots:
        subscribe("predecessor_snapshot", Snapshot, state.take_told, queue_size=5)
        subscribe("snapshot", Snapshot, state.take_snapshot, queue_size=2)
