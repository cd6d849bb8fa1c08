#!/usr/bin/python3
"""Diagnosis of a stall of an endless platoon, in both hostings."""

import unittest

from diagnostic_msgs.msg import DiagnosticArray

import live_platoon
from orders import Orders, setUpModule  # noqa: F401: unittest calls setUpModule


class Diagnosed(Orders):
    def statuses(self, topic):
        """The latest status for each name as (level, dictionary)."""
        found = {}
        for message in list(topic.messages):
            for status in message.status:
                found[status.name.split(": ")[-1]] = (ord(status.level) if isinstance(status.level, bytes) else status.level,
                                                      {value.key: value.value for value in status.values})
        return found

    def test_every_component_reports_and_the_monitor_names_who_stands(self):
        self.in_both(self.check_diagnostics)

    def check_diagnostics(self, hosting):
        topic = self.listen("/diagnostics", DiagnosticArray)
        terminal = self.endless(hosting, record=self.path(hosting + ".bag"))
        one = hosting == "one_process"
        names = {"leader", "followers" if one else "follower", "channel", "monitor", "recorder"}

        def all_report():
            found = self.statuses(topic)
            return set(found) == names and all(int(values.get("step", -2)) > 10 for _, values in found.values())
        live_platoon.wait_for(all_report, "all components to report", 60)
        found = self.statuses(topic)
        for name, (level, values) in found.items():
            self.assertEqual(level, 0, name)
            for key in ("steps per second", "attempts", "dropped: out of turn", "dropped: of another run"):
                self.assertIn(key, values, name)
        self.assertRegex(found["leader"][1]["credit"], r"^\d+ of \d+ steps$")
        self.assertEqual(found["monitor"][1]["culprit"], "")
        if one:
            self.assertLessEqual(max(len(message.status) for message in topic.messages), 5)
            return
        with live_platoon.held("/platoon/vehicle_3"):
            live_platoon.wait_for(lambda: "vehicle_3 has sent nothing" in self.statuses(topic)["monitor"][1]["culprit"],
                                  "the culprit", 60)
            self.assertEqual(self.statuses(topic)["monitor"][0], 2)
            terminal.wait_for_text("run stalled: vehicle_3 has sent nothing")
        live_platoon.wait_for(lambda: self.statuses(topic)["monitor"][1]["culprit"] == "", "the platoon to move", 60)

    def test_a_stall_is_one_state_until_a_step_is_complete_and_counts_retries(self):
        topic = self.listen("/diagnostics", DiagnosticArray)
        terminal = self.endless("processes", followers=5)

        def of_monitor():
            """(culprit, retries) of each status of the monitor."""
            found = []
            for message in list(topic.messages):
                for status in message.status:
                    values = {value.key: value.value for value in status.values}
                    if "culprit" in values:
                        found.append((values["culprit"], int(values.get("retries", -1))))
            return found
        live_platoon.wait_for(lambda: of_monitor() and int(self.statuses(topic)["monitor"][1]["step"]) > 10, "the platoon to move", 60)
        with live_platoon.held("/platoon/vehicle_3"):
            before = len(terminal.text())  # while the nodes start, a busy machine may stall
            live_platoon.wait_for(lambda: of_monitor()[-1][0], "the culprit", 60)
            begin = len(of_monitor())
            live_platoon.wait_for(lambda: len(of_monitor()) >= begin + 10, "ten more statuses", 60)
            during = of_monitor()[begin:]
        self.assertEqual([culprit for culprit, _ in during if "vehicle_3 has sent nothing since step" not in culprit], [])
        retries = [count for _, count in during]
        self.assertEqual(retries, sorted(retries))
        self.assertGreater(retries[-1], 2)
        live_platoon.wait_for(lambda: of_monitor()[-1] == ("", 0), "the platoon to move", 60)
        live_platoon.wait_for(lambda: "run continues, after " in terminal.text()[before:], "the monitor's words", 20)
        said = terminal.text()[before:]
        self.assertEqual((said.count("run stalled: vehicle_3"), said.count("run stalled"), said.count("run continues")),
                         (1, 1, 1), said)
        terminal.end()


if __name__ == "__main__":
    unittest.main()
