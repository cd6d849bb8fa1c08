#!/usr/bin/python3
"""losing_follower.py INDEX: the example follower; its last answers of the first batch of the first attempt are lost."""

import rospy

import live_platoon

publish = rospy.Publisher.publish


def lose_or_publish(publisher, message):
    if (message.attempt, message.first_realization) != (1, 0) or message.step < 15:
        publish(publisher, message)


rospy.Publisher.publish = lose_or_publish
with open(live_platoon.shared("launch", "examples", "rospy_follower.py")) as example:
    exec(compile(example.read(), example.name, "exec"))
