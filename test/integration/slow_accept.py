#!/usr/bin/python3
"""slow_accept.py INDEX SECONDS: the example follower with a delay of SECONDS before it registers a subscriber.

rospy answers a subscriber's handshake before it registers the connection; messages published in between are lost. The delay
simulates a machine that schedules another thread at this point.
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
