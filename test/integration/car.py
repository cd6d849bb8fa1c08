#!/usr/bin/python3
"""A simulated car with its own clock and dynamics, without knowledge of the platoon.

It follows a reference point with a time gap of a second and reports its position.
With a file name as argument it logs every reported position ("at X") and every reference ("to X") to that file.
"""

import sys
import time

import rospy
from geometry_msgs.msg import PointStamped
from nav_msgs.msg import Odometry

PERIOD = 0.01       # [s] of its own clock
GAP = 1.0           # [s] behind the reference
GAIN = 4.0          # [1/s^2]: critically damped
STRONGEST = 4.0     # [m/s^2]
START = 123.0       # [m]

reference = None
arguments = rospy.myargv(sys.argv)[1:]
log = open(arguments[0], "w", buffering=1) if arguments else None


def write(word, x):
    if log:
        log.write("{} {!r}\n".format(word, x))


def refer(point):
    global reference
    assert point.header.frame_id == "odom"
    reference = point.point.x
    write("to", reference)


rospy.init_node("car")
publisher = rospy.Publisher("odom", Odometry, queue_size=1)
rospy.Subscriber("reference", PointStamped, refer, queue_size=1)
x, v, before = START, 0.0, time.monotonic()
while not rospy.is_shutdown():
    time.sleep(PERIOD)
    present = time.monotonic()
    passed, before = present - before, present
    while reference is not None and passed > 0.0:  # fixed steps, also after a scheduling gap
        step = min(passed, PERIOD)
        passed -= step
        a = min(max(GAIN * (reference - x - GAP * v), -STRONGEST), STRONGEST)
        x, v = x + step * (v + 0.5 * step * a), v + step * a
    odometry = Odometry()
    odometry.header.stamp = rospy.Time.now()
    odometry.header.frame_id, odometry.child_frame_id = "odom", "base_link"
    odometry.pose.pose.position.x, odometry.twist.twist.linear.x = x, v
    write("at", x)
    publisher.publish(odometry)
