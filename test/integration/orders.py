"""An endless platoon, and orders to it from outside."""

import os
import unittest

import rospy
from std_srvs.srv import Trigger

import live_platoon
from terminal import LaunchTest, kept_master

FOLLOWERS = 10
HEADWAY = 3.2
NOISE_VARIANCE = 0.6


class Topic:
    """Collects the messages of a topic."""

    def __init__(self, name, kind):
        self.messages = []
        self.subscriber = rospy.Subscriber(name, kind, self.messages.append, queue_size=100000)

    def connections(self):
        return list(self.subscriber.impl.connections)

    def newest(self, condition=lambda message: True, what="a message"):
        def found():
            fitting = [message for message in list(self.messages)[-5:] if condition(message)]
            return fitting[-1] if fitting else None
        return live_platoon.wait_for(found, what, 60)

    def close(self):
        self.subscriber.unregister()


def setUpModule():
    """Registers this process with the kept master."""
    os.environ.update(live_platoon.ros_environment(kept_master()))
    rospy.init_node("watcher", disable_signals=True)
    unittest.addModuleCleanup(rospy.signal_shutdown, "done")


class Orders(LaunchTest):
    def listen(self, name, kind):
        topic = Topic("/platoon/" + name if not name.startswith("/") else name, kind)
        self.addCleanup(topic.close)
        return topic

    def endless(self, hosting, **settings):
        arguments = dict(followers=FOLLOWERS, steps=0, rate=100, burn_in=100, hosting=hosting, stall_timeout=1.0)
        arguments.update(settings)
        self.terminal = self.launch(**arguments)
        self.terminal.wait_for_text("process[platoon/")
        return self.terminal

    def trigger(self, service):
        rospy.wait_for_service("/platoon/leader/" + service, 60)
        return rospy.ServiceProxy("/platoon/leader/" + service, Trigger)()

    def change(self, **values):
        rospy.wait_for_service("/platoon/change_run", 60)
        rospy.set_param("/platoon/change_run", values)
        return rospy.ServiceProxy("/platoon/change_run", Trigger)()

    def in_both(self, check):
        for hosting in ("processes", "one_process"):
            with self.subTest(hosting=hosting):
                self.output = self.path(hosting)
                try:
                    check(hosting)
                finally:
                    self.terminal.end()
