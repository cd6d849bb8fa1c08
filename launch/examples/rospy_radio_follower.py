#!/usr/bin/python3
"""An external follower with radar and radio, the car of config/cacc.yaml: rosrun stochastic_platoon rospy_radio_follower.py 3 is
vehicle 3 of a launch with model:=cacc.yaml external:=3."""

from __future__ import annotations

import argparse
import collections
import math
import threading
from typing import Any, Deque, Tuple

import numpy as np
import rospy
import stochastic_platoon as sp
from rospy.numpy_msg import numpy_msg
from stochastic_platoon.msg import Position


def name(message: Any) -> Tuple[int, int, int, int]:
    return message.run, message.attempt, message.first_realization, message.step


class Stream:
    """The messages of one topic in order; ignores messages out of order."""

    def __init__(self) -> None:
        self.latest: Any = None
        self.waiting: Deque[Any] = collections.deque()

    def take(self, message: Any) -> None:
        run, attempt, first, step = name(message)
        latest = self.latest
        if step == -1:
            in_turn = not latest or latest[0] != run or (attempt, first) > latest[1:3]
        else:
            in_turn = latest == (run, attempt, first, step - 1)
        if in_turn:
            self.latest = name(message)
            while self.waiting and name(self.waiting[0])[:2] != (run, attempt):
                self.waiting.popleft()  # nobody needs an abandoned attempt
            self.waiting.append(message)


class Follower:
    def __init__(self, index: int) -> None:
        topic = "platoon/vehicle_{}/".format(index)
        self.index, self.lock, self.streams = index, threading.Lock(), [Stream(), Stream()]
        self.position, self.input = (rospy.Publisher(topic + of, numpy_msg(Position), queue_size=0, tcp_nodelay=True) for of in ("position", "input"))
        for of, stream in zip(("predecessor_position", "predecessor_input"), self.streams):
            rospy.Subscriber(topic + of, numpy_msg(Position), self.receive, stream, queue_size=None, tcp_nodelay=True)

    def receive(self, message: Any, stream: Stream) -> None:
        with self.lock:
            stream.take(message)
            positions, inputs = (of.waiting for of in self.streams)
            # Both streams carry every step once; a message without a counterpart belongs to an older attempt or run.
            while positions and inputs:
                if name(positions[0]) == name(inputs[0]):
                    self.answer(positions.popleft(), inputs.popleft())
                else:
                    min(positions, inputs, key=lambda of: (of[0].run == stream.latest[0], of[0].attempt)).popleft()

    def answer(self, received: Any, heard: Any) -> None:
        if received.step == -1:
            self.start(len(received.position))
        position, message = received.position, received  # answers with the same message and its own values at this step
        for publisher, values in ((self.position, self.y), (self.input, self.u)):
            message.position = values
            publisher.publish(message)
        self.move(position, heard.position)

    def start(self, size: int) -> None:
        model = sp.Configuration.parse(rospy.get_param("platoon/configuration")).model
        own, keys, self.period = model.vehicle(self.index), model.vehicle_to_dict(self.index), model.sample_period
        self.h, self.delta, self.controller = own.time_headway, own.standstill_distance, keys["controller"]
        self.gain = next(of["gain"] for of in keys["inputs"] if of["signal"] == "input")
        plant = keys["plant"]["continuous"]
        self.lag = plant["denominator"][-4] if len(plant["denominator"]) > 3 else 0.0
        delay = round(plant["input_delay"] / self.period)  # in whole sample periods
        self.y = np.full(size, own.place)
        self.y_before = self.y - own.speed * self.period
        self.v = np.full(size, own.speed)
        self.a, self.u, self.e = (np.zeros(size) for _ in range(3))  # steady; u(k - 1), e(k - 1)
        self.line = collections.deque([self.u] * delay)

    def move(self, received: Any, heard: Any) -> None:
        e = received - self.y - self.delta - self.h * (self.y - self.y_before)
        command = self.controller["kp"] * e + self.controller["kd"] * (e - self.e) / self.period + self.gain * heard
        self.u, self.e = (command + self.h * self.u) / (1.0 + self.h), e  # after the headway filter 1 / H
        self.line.append(self.u)
        u, t, lag = self.line.popleft(), self.period, self.lag  # the exact zero-order hold of 1 / (s^2 (lag s + 1))
        kept = math.exp(-t / lag) if lag else 0.0
        settled = lag * (1.0 - kept)
        self.y_before = self.y
        self.y = self.y + t * self.v + lag * (t - settled) * self.a + (t * t / 2.0 - lag * (t - settled)) * u
        self.v = self.v + settled * self.a + (t - settled) * u
        self.a = kept * self.a + (1.0 - kept) * u


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, epilog="Example: rosrun stochastic_platoon rospy_radio_follower.py 3")
    parser.add_argument("index", type=int, help="number of the follower, 1 or more")
    index = parser.parse_args(rospy.myargv()[1:]).index
    rospy.init_node("vehicle_{}".format(index), disable_rosout=True)
    follower = Follower(index)
    rospy.spin()
