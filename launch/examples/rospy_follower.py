#!/usr/bin/python3
"""An external follower, here the paper's: rosrun stochastic_platoon rospy_follower.py 3 is vehicle 3 of a launch with external:=3."""

from __future__ import annotations

import argparse
from typing import Any, Tuple

import numpy as np
import rospy
import stochastic_platoon as sp
from rospy.numpy_msg import numpy_msg
from stochastic_platoon.msg import Position


def batch(message: Any) -> Tuple[int, int]:
    return message.attempt, message.first_realization


class Follower:
    def __init__(self, index: int) -> None:
        topic = "platoon/vehicle_{}/".format(index)
        self.index = index
        self.latest: Any = None  # the latest message that was answered
        self.out = rospy.Publisher(topic + "position", numpy_msg(Position), queue_size=0, tcp_nodelay=True)
        rospy.Subscriber(topic + "predecessor_position", numpy_msg(Position), self.receive, queue_size=None, tcp_nodelay=True)

    def receive(self, message: Any) -> None:
        latest = self.latest
        if message.step == -1:  # a batch begins: reset
            if latest and message.run == latest.run and batch(message) <= batch(latest):
                return
            self.start(len(message.position))
        elif not latest or (message.run, batch(message), message.step) != (latest.run, batch(latest), latest.step + 1):
            return
        self.latest = message
        received, message.position = message.position, self.y  # answer with the same message and its own position at this step
        self.out.publish(message)
        self.move(received)

    def start(self, size: int) -> None:
        model = sp.Configuration.parse(rospy.get_param("platoon/configuration")).model
        own = model.vehicle(self.index)
        self.h, self.delta = own.time_headway, own.standstill_distance
        self.y = np.full(size, own.place)                          # y(k)
        self.y_before = self.y - own.speed * model.sample_period   # y(k - 1); own.speed is 0 for a start from rest
        self.u = np.zeros(size)

    def move(self, received: Any) -> None:
        zeta = received - self.y - self.delta - self.h * (self.y - self.y_before)  # eq. (error1)
        y_next = 2.0 * self.y - self.y_before + self.u                             # G(z) = 1 / (z - 1)^2, from u(k - 1)
        self.u = -0.89 * self.u + 1.35 / (1.0 + self.h) * zeta                     # K(z) = 1.35 z / (z + 0.89) / (1 + h)
        self.y, self.y_before = y_next, self.y


parser = argparse.ArgumentParser(description=__doc__, epilog="Example: rosrun stochastic_platoon rospy_follower.py 3")
parser.add_argument("index", type=int, help="number of the follower, 1 or more")
index = parser.parse_args(rospy.myargv()[1:]).index
rospy.init_node("vehicle_{}".format(index), disable_rosout=True)
follower = Follower(index)
rospy.spin()
