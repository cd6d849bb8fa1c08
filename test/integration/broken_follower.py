#!/usr/bin/python3
"""External followers that each violate one clause of the vehicle contract: broken_follower.py INDEX:FAULT...

Apart from its fault, the position of a follower is the one received from its predecessor one step before, minus the standstill
distance; so it also ignores the headway.
"""

import json
import sys

import numpy as np
import rospy
from rospy.numpy_msg import numpy_msg
from stochastic_platoon.msg import Position

STEP = 5  # the step of faults that occur once


class Follower:
    def __init__(self, index, fault):
        topic = "/platoon/vehicle_{}/".format(index)
        self.index, self.fault, self.latest, self.y, self.delta = index, fault, None, np.zeros(1), 0.0
        self.faults = ["answer", "twice", "size", "finite", "wrong_run"]  # the faults of `each`
        self.batches, self.silent = 0, False                              # in this attempt
        self.out = rospy.Publisher(topic + "position", numpy_msg(Position), queue_size=0, tcp_nodelay=True)
        # Faults of the control input begin with input_; a follower with another fault sends no input.
        self.radio = rospy.Publisher(topic + "input", numpy_msg(Position), queue_size=0, tcp_nodelay=True) if fault.startswith("input_") else None
        rospy.Subscriber(topic + "predecessor_position", numpy_msg(Position), self.receive, tcp_nodelay=True,
                         queue_size=1 if fault == "queues" else None)

    def is_in_turn(self, message):
        if self.latest is None or message.step == -1:
            return message.step == -1 and not self.is_old(message)
        same = (message.run, message.attempt, message.first_realization) == \
            (self.latest.run, self.latest.attempt, self.latest.first_realization)
        if self.fault == "attempt":  # accepts messages of any attempt
            same = (message.run, message.first_realization) == (self.latest.run, self.latest.first_realization)
        if self.fault == "foreign":  # accepts messages of any run
            same = message.attempt == self.latest.attempt
        due = (self.latest.step, self.latest.step + 1) if self.fault == "turn" else (self.latest.step + 1,)
        return same and message.step in due

    def is_old(self, message):
        if self.latest is None or message.run != self.latest.run:
            return False
        return (message.attempt, message.first_realization) <= (self.latest.attempt, self.latest.first_realization)

    def receive(self, message):
        if not self.is_in_turn(message):
            return
        if message.step == -1 and (self.fault != "start_anew" or self.y.size != message.position.size):
            if self.fault != "place":
                self.delta = json.loads(rospy.get_param("/platoon/configuration"))["model"]["standstill_distance"]
            self.y = np.full(message.position.size, 0.0 - self.index * self.delta)
        if message.step == -1:
            if self.latest is None or message.attempt != self.latest.attempt:
                self.batches, self.silent = 0, False
            self.batches += 1
        first_run = self.latest.run if self.latest else message.run
        self.latest = Position(run=message.run, attempt=message.attempt, first_realization=message.first_realization, step=message.step)
        if self.fault == "run":
            self.latest.run = first_run  # keeps the first run
        if not self.silent and self.fault != "mute":
            self.answer(message)
        self.y = message.position - self.delta

    def answer(self, message):
        answer = numpy_msg(Position)(header=message.header, run=self.latest.run, attempt=message.attempt, step=message.step,
                                     first_realization=message.first_realization, position=self.y)
        fault = self.present_fault(message) if message.step == STEP else None
        if self.fault == "stamp":
            answer.header.stamp = rospy.Time.now()
        if self.fault == "unstamped":
            answer.header.stamp = rospy.Time()
        if self.fault == "causal":
            answer.position = message.position
        if self.fault == "queues":
            rospy.sleep(0.001)
        if self.fault == "last_attempt" and message.step == -1 and self.batches == 2:
            self.fault, answer.attempt = None, 2 ** 32 - 1  # once
        if fault == "answer":
            return
        if fault == "size":
            answer.position = self.y[1:]
        if fault == "finite":
            answer.position = self.y * np.nan
        if fault == "wrong_run":
            answer.run ^= 1
        if fault == "twice":
            self.out.publish(answer)
        self.out.publish(answer)
        if self.fault == "beyond" and message.step + 1 == json.loads(rospy.get_param("/platoon/configuration"))["run"]["steps"]:
            answer.step += 1
            self.out.publish(answer)
        if self.radio:
            self.send_input(answer, (fault or "input_").split("_", 1)[1], message.position)

    def send_input(self, answer, fault, received):
        values = {"size": self.y[1:], "finite": self.y * np.nan, "causal": received}
        answer.position = values.get("causal" if self.fault == "input_causal" else fault, 0.0 * self.y)
        for _ in range({"twice": 2, "answer": 0}.get(fault, 1)):
            self.radio.publish(answer)

    def present_fault(self, message):
        """The present fault of the follower. `each`: the next fault of the list in the second batch of every attempt, then silence."""
        if self.fault != "each" or self.batches < 2 or not self.faults:
            return None if self.fault == "each" else self.fault
        self.silent = True
        return self.faults.pop(0)


rospy.init_node("broken_followers", anonymous=True, disable_rosout=True)
followers = [Follower(int(index), fault) for index, fault in (word.split(":") for word in sys.argv[1:] if ":=" not in word)]
rospy.spin()
