"""Commands that a page may send to the platoon: manoeuvres of the leader, and another headway, noise or loss."""

from __future__ import annotations

import math
import threading
from typing import Any, Dict, Optional, Tuple

import rospy
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from stochastic_platoon.model import FASTEST_CAR

from .state import PlatoonState

MANOEUVRES = ("brake", "accelerate", "sinusoid", "cruise")
CHANGES = ("headway", "noise_variance", "loss")
PATIENCE = 1.0  # [s] until a service must be available


def number_of(content: Dict[str, Any], key: str) -> float:
    """The finite number under the key. Raises ValueError for any other value."""
    value = content.get(key)
    try:
        if not isinstance(value, bool) and isinstance(value, (int, float)) and math.isfinite(float(value)):
            return float(value)
    except OverflowError:
        pass  # an integer beyond the floating-point range
    raise ValueError("{}: {}: must be a finite number".format(key, "missing" if value is None else shortened(value)))


def shortened(value: object) -> str:
    text = str(value)
    return text if len(text) <= 40 else text[:40] + "..."


class Commands:
    """Carries out commands. The state logs those that succeed."""

    def __init__(self, state: PlatoonState) -> None:
        self.state = state
        self.speed = rospy.Publisher("leader/speed", Float64, queue_size=1)
        self.one_change = threading.Lock()  # the server answers each page in a thread of its own

    def obey(self, content: Dict[str, Any]) -> Tuple[bool, str]:
        """(success, message) of a command like {"command": "brake"}, {"command": "speed", "speed": 20.0} or
        {"command": "change", "headway": 2.4}."""
        success, message = self.carry_out(content)
        if success:
            self.state.take_order(message)
        return success, message

    def carry_out(self, content: Dict[str, Any]) -> Tuple[bool, str]:
        command = content.get("command")
        try:
            if command in MANOEUVRES:
                return self.call("leader/" + command)
            if command == "speed":
                return self.set_speed(number_of(content, "speed"))
            if command == "change":
                return self.change(content)
            return False, "command: {}: must be one of {}, speed, change".format(shortened(command), ", ".join(MANOEUVRES))
        except ValueError as error:
            return False, str(error)

    def set_speed(self, speed: float) -> Tuple[bool, str]:
        # The leader receives its speed on a topic, which returns no answer: check here whether it accepts one.
        configuration = self.state.configuration
        if configuration is None:
            return False, "speed: no run is known yet: try again when the platoon has started"
        if not configuration["endless"]:
            return False, ("speed: rejected: in a run of many realizations the leader drives by the model file (leader/speed there); an endless "
                           "run (live.launch, steps:=0) accepts orders")
        lower, upper = configuration["manoeuvres"]["speed"]
        if not lower <= speed <= upper:
            return False, "speed: {:g}: must be from {:g} to {:g} m/s, which the leader reaches".format(speed, lower, upper)
        if self.speed.get_num_connections() == 0:
            return False, "no subscriber of {}: the leader is not running, or accepts no speed".format(self.speed.resolved_name)
        self.speed.publish(speed)
        return True, "speed {:g} m/s{}".format(speed, "; cars reach {:g} m/s".format(FASTEST_CAR) if abs(speed) > FASTEST_CAR else "")

    def change(self, content: Dict[str, Any]) -> Tuple[bool, str]:
        allowed = "{} or {}".format(", ".join(CHANGES[:-1]), CHANGES[-1])
        for key in content:
            if key != "command" and key not in CHANGES:
                raise ValueError("{}: unknown key: must be {}".format(shortened(key), allowed))
        settings = {key: number_of(content, key) for key in CHANGES if content.get(key) is not None}
        if not settings:
            raise ValueError("change: no setting: must be with {}".format(allowed))
        with self.one_change:  # otherwise the service may read the parameter of another page's change
            return self.call("change_run", settings)

    def call(self, name: str, parameter: Optional[Dict[str, float]] = None) -> Tuple[bool, str]:
        """Calls a service that reads the parameter of the same name, if any."""
        try:
            rospy.wait_for_service(name, PATIENCE)
            if parameter is not None:
                rospy.set_param(name, parameter)
            answer = rospy.ServiceProxy(name, Trigger)()
            return answer.success, answer.message
        except (rospy.ROSException, rospy.ServiceException, OSError) as error:
            return False, "{}: {}".format(rospy.resolve_name(name), error)
