"""An endless platoon, and orders to it from outside."""

import os
import shutil
import tempfile
import unittest

import live_platoon
from terminal import LaunchTest, start_master

FOLLOWERS = 20
HEADWAY = 3.2
NOISE_VARIANCE = 0.6


class Topic:
    """Collects the messages of a topic."""

    def __init__(self, name, kind):
        import rospy
        self.messages = []
        self.subscriber = rospy.Subscriber(name, kind, self.messages.append, queue_size=100000)

    def connections(self):
        return list(self.subscriber.impl.connections)

    def of_step(self):
        return {message.step: message for message in list(self.messages)}

    def newest(self, condition=lambda message: True, what="a message"):
        def found():
            fitting = [message for message in list(self.messages)[-5:] if condition(message)]
            return fitting[-1] if fitting else None
        return live_platoon.wait_for(found, what, 60)

    def close(self):
        self.subscriber.unregister()


def setUpModule():
    """Starts one master for all tests: rospy cannot change its master."""
    import rospy
    folder = tempfile.mkdtemp()
    unittest.addModuleCleanup(shutil.rmtree, folder, ignore_errors=True)
    os.environ["ROS_HOSTNAME"] = "localhost"
    core, os.environ["ROS_MASTER_URI"] = start_master(folder)
    unittest.addModuleCleanup(core.wait)
    unittest.addModuleCleanup(core.terminate)
    rospy.init_node("watcher", disable_signals=True)
    unittest.addModuleCleanup(rospy.signal_shutdown, "done")


class Orders(LaunchTest):
    @property
    def master(self):
        return os.environ["ROS_MASTER_URI"]

    def listen(self, name, kind):
        topic = Topic("/platoon/" + name if not name.startswith("/") else name, kind)
        self.addCleanup(topic.close)
        return topic

    def endless(self, hosting, **settings):
        arguments = dict(followers=FOLLOWERS, steps=0, rate=40, burn_in=100, hosting=hosting, stall_timeout=1.0)
        arguments.update(settings)
        self.terminal = self.launch(master=self.master, **arguments)
        self.terminal.wait_for_text("process[platoon/")
        return self.terminal

    def trigger(self, service):
        import rospy
        from std_srvs.srv import Trigger
        rospy.wait_for_service("/platoon/leader/" + service, 60)
        return rospy.ServiceProxy("/platoon/leader/" + service, Trigger)()

    def change(self, **values):
        import rospy
        from std_srvs.srv import Trigger
        rospy.wait_for_service("/platoon/change_run", 60)
        rospy.set_param("/platoon/change_run", values)
        return rospy.ServiceProxy("/platoon/change_run", Trigger)()

    def in_both(self, check):
        for hosting in ("processes", "one_process"):
            with self.subTest(hosting=hosting):
                self.output = os.path.join(self.folder, hosting)
                try:
                    check(hosting)
                finally:
                    self.terminal.end()
