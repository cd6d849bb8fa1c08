#!/usr/bin/python3
"""Recorded bags are complete and reproduce the run bit for bit; damaged ones are rejected with a clear error."""

import json
import os
import resource
import shutil
import struct
import subprocess
import time
import unittest

import rosbag

import live_platoon
from terminal import LaunchTest

DATA = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data")


def bag_statistics(*arguments):
    return subprocess.run([live_platoon.executable("bag_statistics")] + list(arguments), stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, errors="replace")


def xxh64(content, seed):
    """XXH64 from its specification, version 0.1.1."""
    primes = (0, 11400714785074694791, 14029467366897019727, 1609587929392839161, 9650029242287828579, 2870177450012600261)
    full = 2**64 - 1

    def rotated(value, bits):
        return (value << bits | value >> 64 - bits) & full

    def round_(lane, word):
        return rotated((lane + word * primes[2]) & full, 31) * primes[1] & full

    rest = content
    if len(content) < 32:
        value = seed + primes[5]
    else:
        lanes = [seed + primes[1] + primes[2], seed + primes[2], seed, seed - primes[1]]
        while len(rest) >= 32:
            lanes = [round_(lane & full, word) for lane, word in zip(lanes, struct.unpack("<4Q", rest[:32]))]
            rest = rest[32:]
        value = sum(rotated(lane, bits) for lane, bits in zip(lanes, (1, 7, 12, 18)))
        for lane in lanes:
            value = ((value & full ^ round_(0, lane)) * primes[1] + primes[4]) & full
    value = (value + len(content)) & full
    for size, step in ((8, lambda v, w: rotated(v ^ round_(0, w), 27) * primes[1] + primes[4]),
                       (4, lambda v, w: rotated(v ^ w * primes[1] & full, 23) * primes[2] + primes[3]),
                       (1, lambda v, w: rotated(v ^ w * primes[5] & full, 11) * primes[1])):
        while len(rest) >= size:
            value = step(value, int.from_bytes(rest[:size], "little")) & full
            rest = rest[size:]
    for bits, prime in ((33, primes[2]), (29, primes[3]), (32, 1)):
        value = (value ^ value >> bits) * prime & full
    return value


class BagTest(LaunchTest):
    def setUp(self):
        super().setUp()
        self.bag = os.path.join(self.folder, "run.bag")

    def record(self, **arguments):
        terminal = self.launch(record=self.bag, **arguments)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(self.output), terminal.text())
        return terminal

    def csv_of(self, *bags):
        result = bag_statistics(*bags, "--csv")
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout.encode()

    def assert_whole(self, bag, followers, steps, batches):
        with rosbag.Bag(bag) as opened:
            counts = {topic: info.message_count for topic, info in opened.get_type_and_topic_info().topics.items()}
        for i in range(followers + 1):
            self.assertEqual(counts["/platoon/vehicle_{}/position".format(i)], batches * (steps + 1))
        for i in range(1, followers + 1):
            self.assertEqual(counts["/platoon/vehicle_{}/predecessor_position".format(i)], batches * (steps + 1))
        self.assertEqual(counts["/platoon/configuration"], 1)
        self.assertGreaterEqual(counts["/platoon/error_statistics"], steps)


class RecordAndReplay(BagTest):
    def check(self, batch, hosting, realizations, **more):
        self.record(followers=3, steps=20, realizations=realizations, batch=batch, hosting=hosting, **more)
        self.assert_whole(self.bag, 3, 20, -(-realizations // batch))
        measured = live_platoon.statistics(self.output)
        self.assertEqual(self.csv_of(self.bag), measured)
        again = os.path.join(self.folder, "again")
        terminal = self.launch("replay.launch", bag=self.bag, output=again)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(again), terminal.text())
        self.assertEqual(live_platoon.statistics(again), measured)

    def test_single_realizations_from_processes(self):
        self.check(1, "processes", 40)

    def test_many_realizations_from_processes(self):
        self.check(500, "processes", 3000)

    def test_single_realizations_from_one_process(self):
        self.check(1, "one_process", 40)

    def test_many_realizations_from_one_process_compressed(self):
        self.check(500, "one_process", 3000, record_compression="lz4")

    def test_links_with_state_and_a_mixed_string(self):
        model = live_platoon.shared("config", "mixed.yaml")
        for hosting in ("processes", "one_process"):
            self.bag = os.path.join(self.folder, hosting + ".bag")
            self.output = os.path.join(self.folder, hosting)
            self.check(500, hosting, 3000, model=model, output=self.output)
            # The truck, with the headway and standstill distance of its own type.
            replay = self.launch("replay.launch", bag=self.bag, drive="vehicle_3", output="")
            replay.wait()
            self.assertIn("vehicle_3: 126 messages equal the recorded ones to the bit", replay.text())

    def test_a_paced_replay_can_be_paced(self):
        self.record(followers=1, steps=10, realizations=20, batch=10)
        again = os.path.join(self.folder, "again")
        self.launch("replay.launch", bag=self.bag, output=again, rate=2).wait()  # 2.2 s of platoon time
        self.assertEqual(live_platoon.statistics(again), live_platoon.statistics(self.output))
        self.assertGreater(live_platoon.completed_summary(again)["wall_seconds"], 0.9)

    def test_a_split_recording_is_read_as_one(self):
        self.record(followers=5, steps=50, realizations=4000, batch=250, record_split_mb=4)
        parts = sorted(name for name in os.listdir(self.folder) if name.endswith(".bag"))
        self.assertGreater(len(parts), 2)
        self.assertEqual(parts[0], "run_0.bag")
        self.assertEqual(self.csv_of(*[os.path.join(self.folder, part) for part in parts]), live_platoon.statistics(self.output))

    def test_plain_rosbag_record_of_a_paced_run_is_complete(self):
        environment = dict(os.environ, ROS_MASTER_URI=self.roscore(), ROS_HOSTNAME="localhost", ROS_HOME=self.folder)
        plain = os.path.join(self.folder, "plain.bag")
        recorder = subprocess.Popen([live_platoon.system_executable("rosbag", "record"), "-a", "-O", plain, "__name:=plain"],
                                    env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        live_platoon.wait_for(lambda: live_platoon.process_of("/plain", environment["ROS_MASTER_URI"]), "rosbag record")
        terminal = self.launch(master=environment["ROS_MASTER_URI"], followers=20, steps=100, realizations=4, batch=2, rate=100, stay=True)
        live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output), "the run to complete")
        time.sleep(2.0)  # an ending node drops unsent messages, and rosbag record does not report how many it has received
        recorder.send_signal(2)
        recorder.wait()
        terminal.interrupt()
        refused = bag_statistics(plain)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("plain.bag: holds no checksums, so that a changed bit would not be noticed", refused.stderr)
        self.assertEqual(self.csv_of(plain, "--unverified"), live_platoon.statistics(self.output))
        again = os.path.join(self.folder, "again")
        terminal = self.launch("replay.launch", bag=plain, output=again, unverified=True)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(again), terminal.text())
        self.assertEqual(live_platoon.statistics(again), live_platoon.statistics(self.output))


class Drive(BagTest):
    def test_one_live_vehicle_equals_its_recording_to_the_bit(self):
        self.record(followers=4, steps=30, realizations=500, batch=100)
        terminal = self.launch("replay.launch", bag=self.bag, drive="vehicle_3", output="")
        terminal.wait()
        self.assertIn("vehicle_3: 155 messages equal the recorded ones to the bit", terminal.text())

    def test_a_vehicle_that_differs_is_told(self):
        self.record(followers=2, steps=10, realizations=10)
        forged = os.path.join(self.folder, "forged.bag")
        with rosbag.Bag(self.bag) as source, rosbag.Bag(forged, "w") as target:
            for topic, message, time in source.read_messages():
                if topic == "/platoon/vehicle_2/position" and message.step == 7:
                    message.position = tuple(value + 1e-12 for value in message.position)
                target.write(topic, message, time)
        terminal = self.launch("replay.launch", bag=forged, drive="vehicle_2", output="", unverified=True)
        terminal.wait()
        self.assertIn("vehicle_2 differs from the recording at step 7", terminal.text())

    def test_live_followers_behind_the_recorded_leader(self):
        self.record(followers=2, steps=30, realizations=100)
        again = os.path.join(self.folder, "again")
        self.launch("replay.launch", bag=self.bag, drive="leader", output=again, followers=3, headway=2.4, seed=5,
                    realizations=3000).wait()
        summary = live_platoon.completed_summary(again)
        self.assertEqual((summary["followers"], summary["seed"], summary["realizations"]), (3, 5, 3000))
        # The theory uses the recorded leader. Bound: the largest of 180 normal scores exceeds it once in 1000 runs.
        self.assertLess(summary["agreement"]["max_abs_z_mean"], 4.6)
        self.assertLess(summary["agreement"]["max_abs_z_variance"], 4.6)


class Damaged(BagTest):
    def test_a_replay_of_a_changed_position_does_not_complete(self):
        forged = os.path.join(self.folder, "forged.bag")
        with rosbag.Bag(os.path.join(DATA, "small.bag")) as source, rosbag.Bag(forged, "w") as target:
            for topic, message, time_ in source.read_messages():
                if topic == "/platoon/vehicle_1/position" and message.step == 2:
                    message.position = tuple(value + 1e-12 for value in message.position)
                target.write(topic, message, time_)
        for unverified, reason in ((False, "messages are not as they were recorded"),
                                   (True, "are not those of the positions beside them: the recording is damaged")):
            with self.subTest(unverified=unverified):
                self.output = os.path.join(self.folder, "unverified{}".format(unverified))
                terminal = self.launch("replay.launch", bag=forged, unverified=unverified)
                terminal.wait()  # ends by itself
                self.assertIn(reason, terminal.text())
                self.assertFalse(live_platoon.completed_summary(self.output), terminal.text())

    def test_a_replay_ends_with_the_reason_whatever_bit_is_wrong(self):
        """Flips a bit in a received position, in the index after a chunk, and at the end of the file."""
        with open(os.path.join(DATA, "small.bag"), "rb") as file:
            content = file.read()
        with rosbag.Bag(os.path.join(DATA, "small.bag")) as bag:
            values = [message.position[1] for _, message, _ in bag.read_messages("/platoon/vehicle_2/predecessor_position")]
        received = content.find(struct.pack("<d", values[3]))
        end = struct.unpack("<Q", content[content.find(b"index_pos=") + 10:][:8])[0]
        offset = end - 1  # the last byte of the index after the last chunk
        for place, drive, reason in ((received, "vehicle_2", "messages are not as they were recorded"),
                                     (received, "", "messages are not as they were recorded"),
                                     (offset, "", "the index is not that of the messages"),
                                     (end + 12, "", "is damaged")):
            with self.subTest(place=place, drive=drive):
                bent = bytearray(content)
                bent[place] ^= 4
                forged = os.path.join(self.folder, "bent.bag")
                with open(forged, "wb") as file:
                    file.write(bent)
                self.output = os.path.join(self.folder, "out{}{}".format(place, drive))
                terminal = self.launch("replay.launch", bag=forged, drive=drive)
                terminal.wait()
                self.assertIn(reason, terminal.text())
                self.assertNotIn("equal the recorded ones", terminal.text())
                self.assertFalse(live_platoon.completed_summary(self.output), terminal.text())


class Killed(BagTest):
    def test_kill_9_of_the_recorder_costs_no_message(self):
        for split in (0, 1):
            with self.subTest(split_mb=split):
                self.output = os.path.join(self.folder, "run{}".format(split))
                self.bag = self.output + ".bag"
                terminal = self.launch(record=self.bag, followers=3, steps=20, realizations=20000, batch=1000, rate=120,
                                       stall_timeout=0.5, record_split_mb=split)
                terminal.wait_for_text("/20000 realizations")
                live_platoon.kill("/platoon/channel", terminal.master)
                terminal.wait()
                self.assertGreater(live_platoon.completed_summary(self.output)["attempts"], 1)
                names = [name for name in sorted(os.listdir(self.folder)) if name.startswith("run{}".format(split))]
                self.assertFalse([name for name in names if ".active" in name or ".recovered" in name], names)
                bags = [os.path.join(self.folder, name) for name in names if name.endswith(".bag")]
                bags.sort(key=lambda name: (len(name), name))
                if split == 0:
                    self.assert_whole(self.bag, 3, 20, 20)
                self.assertEqual(self.csv_of(*bags), live_platoon.statistics(self.output))

    def test_kill_9_of_a_follower_leaves_nothing_of_the_attempt_it_ended(self):
        terminal = self.launch(record=self.bag, followers=3, steps=20, realizations=20000, batch=1000, rate=120, stall_timeout=0.5)
        terminal.wait_for_text("/20000 realizations")
        live_platoon.kill("/platoon/vehicle_2", terminal.master)
        terminal.wait()
        self.assertGreater(live_platoon.completed_summary(self.output)["attempts"], 1)
        self.assert_whole(self.bag, 3, 20, 20)
        self.assertEqual(self.csv_of(self.bag), live_platoon.statistics(self.output))

    def test_kill_9_of_recorder_and_monitor_at_once_costs_no_message(self):
        terminal = self.launch(record=self.bag, followers=3, steps=20, realizations=20000, batch=1000, rate=120, stall_timeout=0.5,
                               hosting="one_process")
        terminal.wait_for_text("/20000 realizations")
        live_platoon.kill("/platoon/platoon", terminal.master)
        terminal.wait()
        self.assertTrue(live_platoon.completed_summary(self.output), terminal.text())
        self.assert_whole(self.bag, 3, 20, 20)
        self.assertEqual(self.csv_of(self.bag), live_platoon.statistics(self.output))

    def test_a_recorder_that_is_killed_once_its_bag_is_complete_says_so_again(self):
        for hosting, node in (("processes", "channel"), ("one_process", "platoon")):
            with self.subTest(hosting=hosting):
                self.output = os.path.join(self.folder, hosting)
                self.bag = self.output + ".bag"
                terminal = self.launch(record=self.bag, followers=2, steps=10, realizations=100, hosting=hosting, stay="true")
                live_platoon.wait_for(lambda: live_platoon.completed_summary(self.output) and os.path.exists(self.bag), "the bag")
                live_platoon.kill("/platoon/" + node, terminal.master)
                # A program that starts after the end of the run.
                ended = subprocess.run([live_platoon.executable("until_complete")], timeout=20, stdout=subprocess.DEVNULL,
                                       env=dict(os.environ, ROS_MASTER_URI=terminal.master, ROS_NAMESPACE="platoon"))
                self.assertEqual(ended.returncode, 0)
                terminal.end()
                self.assertEqual(self.csv_of(self.bag), live_platoon.statistics(self.output))

    def test_an_unfinished_recording_of_another_run_is_not_touched(self):
        with open(self.bag + ".active", "w") as file:
            file.write("precious")
        terminal = self.launch(record=self.bag)
        self.assertNotEqual(terminal.wait(), 0)
        self.assertIn("run.bag.active: exists: must be a new file", terminal.text())
        with open(self.bag + ".active") as file:
            self.assertEqual(file.read(), "precious")


class FullDisk(BagTest):
    """A limit on the size of a node's files simulates a full disk, and can be lifted."""

    def limit(self, terminal, node, size):
        process = live_platoon.wait_for(lambda: live_platoon.process_of(node, terminal.master), node)
        resource.prlimit(process, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    def test_the_recorder_waits_for_room_and_goes_on(self):
        settings = dict(followers=3, steps=50, realizations=10000)
        reference = live_platoon.reference(self.folder, **settings)
        for hosting, node in (("processes", "/platoon/channel"), ("one_process", "/platoon/platoon")):
            with self.subTest(hosting=hosting):
                output, bag = (os.path.join(self.folder, hosting + suffix) for suffix in ("", ".bag"))
                terminal = self.launch(record=bag, hosting=hosting, rate=400, batch=500, output=output, **settings)
                self.limit(terminal, node, 1000000)  # less than a batch, as each attempt begins a new file
                terminal.wait_for_text("run stalled: recorder blocks the run: " + bag)
                time.sleep(4.0)  # retries fail as well
                self.limit(terminal, node, resource.RLIM_INFINITY)
                terminal.wait()
                text = terminal.text()
                self.assertEqual(text.count("The platoon waits, and continues when there is space"), 1, text)
                self.assertIn("MB are free there", text)
                self.assertIn(bag + ": is recorded again", text)
                self.assertTrue(live_platoon.completed_summary(output), text)
                self.assertEqual(live_platoon.statistics(output), reference)
                from_bag = os.path.join(self.folder, hosting + "-from-bag")
                self.assertEqual(bag_statistics(bag, "--output", from_bag).returncode, 0)
                self.assertEqual(live_platoon.statistics(from_bag), reference)


class SmallBag(unittest.TestCase):
    """The bag in test/data pins the format: 2 followers, steps -1 .. 4, 6 realizations in batches of 4 and 2."""

    def setUp(self):
        import tempfile
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.small = os.path.join(DATA, "small.bag")

    def altered(self, name, keep):
        path = os.path.join(self.folder, name)
        with rosbag.Bag(self.small) as source, rosbag.Bag(path, "w") as target:
            for topic, message, time in source.read_messages():
                for _ in range(keep(topic, message)):
                    target.write(topic, message, time)
        return path

    def refused(self, bag, *said, options=()):
        result = bag_statistics(bag, *options)
        self.assertEqual(result.returncode, 1)
        for words in said:
            self.assertIn(words, result.stderr)
        self.assertNotIn("terminate", result.stderr)
        return result

    def partial(self, bag, *options):
        output = os.path.join(self.folder, "partial")
        result = bag_statistics(bag, "--partial", "--output", output, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(output, "summary.json")) as file:
            return json.load(file)

    def test_it_gives_the_statistics_it_was_recorded_with(self):
        output = os.path.join(self.folder, "run")
        result = bag_statistics(self.small, "--output", output)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(DATA, "small_statistics.csv"), "rb") as file:
            self.assertEqual(live_platoon.statistics(output), file.read())
        self.assertTrue(live_platoon.completed_summary(output))

    def test_a_bag_of_version_0_1_0_is_refused_by_name(self):
        old = os.path.join(DATA, "small_0.1.0.bag")
        self.refused(old, "small_0.1.0.bag: holds no checksums", "versions before 0.2.0")
        self.refused(old, "small_0.1.0.bag: was recorded by stochastic_platoon 0.1.0: must be of", options=["--unverified"])

    def test_messages_of_another_run_are_named_and_not_used(self):
        def forge(topic, message):
            if topic.endswith("vehicle_1/position") and message.first_realization == 4:
                message.run ^= 1
            return 1

        self.refused(self.altered("foreign.bag", forge), "vehicle_1/position: step -1 of the realizations from 4 is of another run",
                     options=["--unverified"])
        self.assertEqual(self.partial(os.path.join(self.folder, "foreign.bag"), "--unverified")["realizations"], 4)

    def bent(self, name, change):
        def forge(topic, message):
            change(topic, message)
            return 1

        return self.altered(name, forge)

    def test_what_another_program_changed_is_refused_even_in_part(self):
        bag = self.bent("bent.bag", lambda topic, message: setattr(message, "step", 4) if topic.endswith("vehicle_1/predecessor_position")
                        and message.step == 3 else None)
        for options in ([], ["--partial"]):
            self.refused(bag, "bent.bag: is damaged, or was changed by another program", "messages are not as they were recorded",
                         options=options)

    def test_a_position_that_was_changed_is_recognized_by_the_figures_beside_it(self):
        def change(topic, message):
            if topic.endswith("vehicle_2/position") and message.step == 3 and message.first_realization == 4:
                bits = bytearray(struct.pack("<2d", *message.position))
                bits[1] ^= 1  # bit 8, counted from the lowest
                message.position = struct.unpack("<2d", bits)

        self.refused(self.bent("bent.bag", change),
                     "error_statistics: the figures of step 3 are not those of the positions beside them: the recording is damaged",
                     options=["--unverified"])

    def test_every_value_that_was_changed_is_recognized(self):
        """Flips one bit of one position at a time, also of positions that do not enter the statistics."""
        with open(self.small, "rb") as file:
            content = file.read()
        values = set()
        with rosbag.Bag(self.small) as bag:
            for topic, message, _ in bag.read_messages():
                if topic.endswith("/position"):
                    values.update(message.position)
        places = sorted({content.find(struct.pack("<d", value)) for value in values if value != 0.0} - {-1})
        self.assertGreater(len(places), 20)
        path = os.path.join(self.folder, "bent.bag")
        for count, at in enumerate(places):
            bent = bytearray(content)
            bent[at + count % 7] ^= 1 << count % 8
            with open(path, "wb") as file:
                file.write(bent)
            self.refused(path, "messages are not as they were recorded", options=[["--partial"], []][count % 2])

    def test_a_leader_that_is_not_at_one_place_is_refused(self):
        def change(topic, message):
            if topic.endswith("vehicle_0/position") and message.step == 2 and message.first_realization == 0:
                message.position = (message.position[0] + 1e-9,) + tuple(message.position[1:])

        bag = self.bent("leader.bag", change)
        for unverified, reason in (("false", "messages are not as they were recorded"),
                                   ("true", "is damaged: the leader is not at one place at step 2")):
            result = subprocess.run([live_platoon.executable("configure"), "--bag", bag, "--recorded-leader", "true", "--hosting",
                                     "one_process", "--output", self.folder + "/out", "--unverified", unverified],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(reason, result.stderr)

    def test_a_bag_of_two_runs_is_refused(self):
        from std_msgs.msg import String
        path = os.path.join(self.folder, "two.bag")
        with rosbag.Bag(self.small) as source, rosbag.Bag(path, "w") as target:
            for topic, message, time in source.read_messages():
                target.write(topic, message, time)
                if topic.endswith("configuration"):
                    target.write(topic, String(message.data.replace('"seed":1', '"seed":2')), time)
        self.refused(path, "two.bag: holds more than one run of a platoon: must hold one", options=["--unverified"])

    def test_results_are_not_written_over(self):
        output = os.path.join(self.folder, "run")
        bag_statistics(self.small, "--output", output)
        result = bag_statistics(self.small, "--output", output)
        self.assertEqual(result.returncode, 1)
        self.assertIn("holds results already, which are never overwritten", result.stderr)

    def test_a_hole_is_named_by_topic_and_step(self):
        bag = self.altered("hole.bag", lambda topic, message: 0 if topic.endswith("vehicle_1/position") and message.step == 2
                           and message.first_realization == 4 else 1)
        self.refused(bag, "vehicle_1/position: step 3 of the realizations from 4 follows step 1 of the realizations from 4: what is "
                     "between is missing", "--partial", options=["--unverified"])
        self.assertEqual(self.partial(bag, "--unverified")["realizations"], 4)

    def test_a_duplicate_is_named_by_topic_and_step(self):
        bag = self.altered("twice.bag", lambda topic, message: 2 if topic.endswith("vehicle_2/position") and message.step == 3
                           and message.first_realization == 0 else 1)
        self.refused(bag, "vehicle_2/position: step 3 of the realizations from 0 comes twice", options=["--unverified"])

    def test_what_rosbag_compressed_is_as_good(self):
        """As `rosbag compress` does: copies every message unchanged, ordered by time."""
        for compression in (rosbag.Compression.BZ2, rosbag.Compression.LZ4):
            path = os.path.join(self.folder, "compressed.bag")
            with rosbag.Bag(self.small) as source, rosbag.Bag(path, "w", compression=compression) as target:
                for topic, message, time_ in source.read_messages(raw=True):
                    target.write(topic, message, time_, raw=True)
            with open(os.path.join(DATA, "small_statistics.csv")) as file:
                self.assertEqual(bag_statistics(path, "--csv").stdout, file.read())

    def test_the_checksums_are_what_their_message_says(self):
        """An independent computation of the checksums: see msg/Checksum.msg."""
        messages = digest = checksums = since = 0
        with rosbag.Bag(self.small) as bag:
            for topic, (_, content, _, _, kind), time_ in bag.read_messages(raw=True):
                if topic != "/platoon/checksum":
                    seed = xxh64(topic.encode(), 0) + time_.to_nsec()
                    digest = (digest + xxh64(content, seed % 2**64)) % 2**64
                    messages, since = messages + 1, since + 1
                    continue
                checksum = kind().deserialize(content)
                self.assertEqual((checksum.messages, checksum.digest), (messages, digest))
                digest = since = 0
                checksums += 1
        self.assertGreaterEqual(checksums, 2)
        self.assertEqual(since, 0, "messages behind the last checksum")

    def test_foreign_topics_are_named_and_passed_over(self):
        from std_msgs.msg import String
        path = os.path.join(self.folder, "foreign.bag")
        shutil.copy(self.small, path)
        with rosbag.Bag(path, "a") as target:
            import rospy
            target.write("/chatter", String("hello"), rospy.Time(1))
        result = bag_statistics(path)
        self.assertEqual(result.returncode, 0)
        self.assertIn("/chatter: foreign", result.stderr)

    def test_a_truncated_bag_is_refused_and_its_readable_part_used_when_asked(self):
        with open(self.small, "rb") as file:
            content = file.read()
        for share in (0.95, 0.55):
            path = os.path.join(self.folder, "cut.bag")
            with open(path, "wb") as file:
                file.write(content[:int(share * len(content))])
            self.refused(path, "cut.bag: ")
            result = bag_statistics(path, "--partial")
            self.assertIn("the file ends early, before byte {} of".format(int(share * len(content))), result.stderr)
            # The first batch, of four realizations, ends before the middle of the file and the second before its last tenth.
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("4 realizations" if share < 0.9 else "6 realizations", result.stdout)

    def test_any_cut_and_any_flipped_byte_is_survived(self):
        """A truncated file gives whole batches; a changed byte is rejected unless nothing relevant follows it."""
        with open(os.path.join(DATA, "small_statistics.csv")) as file:
            right = file.read()
        with open(self.small, "rb") as file:
            content = file.read()
        path = os.path.join(self.folder, "hostile.bag")
        for i in range(120):
            at = (i * 7919) % len(content)
            bent = bytearray(content[:at] if i % 2 else content)
            if i % 2 == 0:
                bent[at] ^= 0xff
            with open(path, "wb") as file:
                file.write(bent)
            result = bag_statistics(path, "--partial", "--csv")
            self.assertIn(result.returncode, (0, 1), "cut or bent at byte {}: {}".format(at, result.stderr))
            if i % 2 == 0 and result.returncode == 0:
                self.assertEqual(result.stdout, right, "bent at byte {}: {}".format(at, result.stderr))

    def test_an_empty_bag_a_missing_one_and_something_else_are_refused(self):
        empty = os.path.join(self.folder, "empty.bag")
        rosbag.Bag(empty, "w").close()
        self.refused(empty, "empty.bag: holds no topic \"configuration\": it is no recording of a platoon")
        nothing = os.path.join(self.folder, "nothing.bag")
        with open(nothing, "w"):
            pass
        self.refused(nothing, "nothing.bag: is damaged or no bag")
        self.refused(os.path.join(self.folder, "missing.bag"), "missing.bag: must be a bag file that can be read")
        self.refused(__file__, "bag_test.py: is damaged or no bag")

    def test_the_file_of_a_killed_recorder_is_refused_and_used_when_asked(self):
        from terminal import Terminal
        output, bag = os.path.join(self.folder, "run"), os.path.join(self.folder, "killed.bag")
        terminal = Terminal(self.folder, "platoon.launch", output=output, record=bag, followers=2, steps=10, realizations=400,
                            batch=10, rate=200)
        try:
            terminal.wait_for_text("/400 realizations")
            left = os.path.join(self.folder, "left.bag.active")
            shutil.copy(bag + ".active", left)
        finally:
            terminal.end()
        self.refused(left, "was not closed")
        self.assertIn(self.partial(left)["realizations"] % 10, (0,))


if __name__ == "__main__":
    unittest.main()
