#!/usr/bin/python3
"""slow_accept.py INDEX SECONDS: the example follower, whose links take so long to register a subscriber.

rospy answers a subscriber's handshake before it registers the connection, and what it publishes in between reaches nobody: here that
takes SECONDS, as it does on a machine that schedules another thread there.
"""

import sys
import time

import rospy.topics

import live_platoon

delay = float(sys.argv.pop(2))
register = rospy.topics._PublisherImpl.add_connection


def register_slowly(publisher, connection):
    if publisher.resolved_name.endswith("/position"):
        time.sleep(delay)
    return register(publisher, connection)


rospy.topics._PublisherImpl.add_connection = register_slowly
with open(live_platoon.shared("launch", "examples", "rospy_follower.py")) as example:
    exec(compile(example.read(), example.name, "exec"))
