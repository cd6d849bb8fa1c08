#!/usr/bin/python3
"""Runs, result files and recordings of the Python module against the programs: the same bits; progress, Ctrl-C, threads."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
import rosbag
import stochastic_platoon as sp

import live_platoon
from python_module import SIGNALS, ModuleTest, program


class Simulation(ModuleTest):
    SETTINGS = dict(followers=4, steps=30, realizations=3000, seed=3)

    def test_a_run_has_the_bits_of_the_tool(self):
        for name in ("paper_at_rest.yaml", "lossy.yaml"):
            output = self.path(name)
            report = program("monte_carlo", model=name, output=output, signals=",".join(SIGNALS), **self.SETTINGS)
            results = sp.monte_carlo(sp.Model.load(name), signals=SIGNALS, **self.SETTINGS)
            loaded = sp.Results.load(output)
            self.assertSameTables(loaded, results)
            self.assertEqual(results.report.splitlines()[1:3], report.splitlines()[1:3])
            self.assertEqual(results.variance.shape, (4, 30))
            self.assertEqual(loaded.model, sp.Model.load(name))
            np.testing.assert_array_equal(results.signals["gap"].variance, loaded.signals["gap"].variance)
            np.testing.assert_array_equal(results.gaps.histogram, loaded.gaps.histogram)
            self.assertEqual(results.gaps.histogram.sum(), 4 * 3000)
            self.assertEqual(results.amplification.measured["l2_ratio"].shape, (5,))
            self.assertEqual("ages" in results.summary["crc32"], name == "lossy.yaml")
        self.assertEqual(set(results.ages.signal), {"position"})
        self.assertEqual(set(results.ages.input), {0.0})

    def test_the_variance_agrees_with_the_theory(self):
        results = sp.monte_carlo(sp.Model.load(), followers=3, steps=20, realizations=20000, seed=11)
        self.assertLess(results.max_abs_z, 5.0)
        np.testing.assert_allclose(results.theoretical_variance, sp.analyze(sp.Model.load(), followers=3, steps=20).variance, rtol=1e-12)

    def test_threads_and_folders_change_no_bit(self):
        model = sp.Model.load()
        results = sp.monte_carlo(model, threads=1, **self.SETTINGS)
        written = sp.monte_carlo(model, threads=3, output=self.path("run"), **self.SETTINGS)
        self.assertSameTables(results, written)
        self.assertSameTables(results, sp.Results.load(self.path("run")))
        self.assertRaisesText(ValueError, "holds results", sp.monte_carlo, model, output=self.path("run"), **self.SETTINGS)

    def test_progress_is_reported_and_may_stop_a_run_which_continues_in_its_folder(self):
        settings = dict(followers=20, steps=100, realizations=400000, seed=5, threads=1, output=self.path("run"))
        calls = []

        class Enough(Exception):
            pass

        def progress(done, of):
            calls.append(done)
            self.assertEqual(of, 400000)
            if 0 < done < of:
                raise Enough(done)

        self.assertRaises(Enough, sp.monte_carlo, sp.Model.load(), progress=progress, **settings)
        stopped = sp.Results.load(self.path("run"))
        self.assertFalse(stopped.complete)
        self.assertTrue(0 < stopped.realizations < 400000)
        calls.clear()
        results = sp.monte_carlo(sp.Model.load(), progress=lambda done, of: calls.append(done), **settings)
        self.assertGreaterEqual(calls[0], stopped.realizations)
        self.assertEqual(calls[-1], 400000)
        whole = program("monte_carlo", output=self.path("whole"), realizations=400000, seed=5, followers=20, steps=100)
        self.assertIn("Results", whole)
        self.assertSameTables(results, sp.Results.load(self.path("whole")))

    def test_ctrl_c_ends_a_computation_at_once(self):
        """Computations of minutes, by each part of the theory that takes them; a loaded machine may be ten times slower than a second."""
        paper, cars = sp.Model.load(), sp.Model.load("cacc.yaml")
        lossy, bursts = paper.replace(loss=0.1), paper.replace(loss=0.1, mean_burst=3.0)
        wide = np.linspace(2.0, 4.0, 1000)
        for name, compute in {
                "runs": lambda: sp.monte_carlo(paper, realizations=10**9),
                "a batch of a minute": lambda: sp.monte_carlo(paper, realizations=10**6, followers=2000, steps=9000),
                "theory of a run": lambda: sp.monte_carlo(lossy, realizations=10, followers=400, steps=10000),
                "a string": lambda: sp.analyze(paper, followers=20000, steps=1000),
                "signals": lambda: sp.analyze(paper, followers=2000, steps=2000, signals=["gap"], collision_probability=1e-6),
                "losses": lambda: sp.analyze(lossy, followers=3000, steps=500),
                "bursts": lambda: sp.analyze(bursts, followers=20, steps=2000),
                "radios": lambda: sp.analyze(cars.replace(loss=0.1), followers=200, steps=5000),
                "a map": lambda: sp.stability_map(paper, headway=wide, gain=np.linspace(1.0, 1.5, 300)),
                "a map of bursts": lambda: sp.stability_map(bursts, loss=np.linspace(0.05, 0.5, 100), mean_burst=wide),
                "trajectories": lambda: sp.trajectories(paper, 0, followers=2000, steps=10000),
                "a trajectory": lambda: sp.trajectories(paper, 0, followers=1, steps=10**7)}.items():
            with self.subTest(name):
                sent = []

                def interrupt():
                    sent.append(time.monotonic())
                    os.kill(os.getpid(), signal.SIGINT)

                timer = threading.Timer(0.3, interrupt)
                with self.assertRaises(KeyboardInterrupt):
                    timer.start()
                    compute()
                self.assertLess(time.monotonic() - sent[0], 10.0)

    def test_trajectories_take_little_memory(self):
        """In a process of its own, as other tests here take more. ru_maxrss of a child begins with what its parent took; VmHWM does not."""
        code = """if True:
            import stochastic_platoon as sp
            peak = lambda: int(open("/proc/self/status").read().split("VmHWM:")[1].split()[0])
            model, before = sp.Model.load(), peak()
            realization = sp.trajectories(model, 0, followers=100, steps=10000)
            print(*realization["gap"].shape, peak() - before)
            """
        done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, check=True)
        vehicles, steps, kilobytes = map(int, done.stdout.split())
        self.assertEqual((vehicles, steps), (101, 10001))
        # Nine numbers, and what the vehicle in hand takes.
        self.assertTrue(72.0 <= 1024 * kilobytes / (vehicles * steps) < 120.0, kilobytes)

    def test_other_threads_go_on_during_a_computation(self):
        counted = [0]
        ended = threading.Event()

        def count():
            while not ended.wait(0.001):
                counted[0] += 1

        thread = threading.Thread(target=count)
        thread.start()
        before = counted[0]
        sp.monte_carlo(sp.Model.load(), realizations=300000, threads=1)
        during = counted[0] - before
        ended.set()
        thread.join()
        self.assertGreater(during, 10)

    def test_a_realization_is_that_of_the_tool(self):
        program("monte_carlo", "--trajectories", only=17, output=self.path("one"), **self.SETTINGS)
        loaded = sp.Trajectories.load(self.path("one"))
        computed = sp.trajectories(sp.Model.load(), 17, **self.SETTINGS)
        self.assertEqual(computed.steps[0], -1.0)
        self.assertEqual(computed["position"].shape, (5, 31))
        for quantity in sp.Trajectories.QUANTITIES:
            np.testing.assert_array_equal(computed[quantity], loaded[quantity])
        part = computed.between(5, 8)
        np.testing.assert_array_equal(part["gap"], computed["gap"][:, 6:10])
        self.assertEqual((list(part.steps), part.name), ([5.0, 6.0, 7.0, 8.0], "realization 17"))
        self.assertRaisesText(ValueError, "realization 17: no step from 40 to 50: must be from -1 to 29", computed.between, 40, 50)
        self.assertRaisesText(KeyError, "colour: must be one of position", lambda: computed["colour"])
        self.assertRaisesText(ValueError, "only: 3000: must be below", sp.trajectories, sp.Model.load(), 3000, **self.SETTINGS)

    def test_a_realization_has_every_input_of_a_vehicle(self):
        program("monte_carlo", "--trajectories", only=17, output=self.path("one"), model="path_cacc.yaml", **self.SETTINGS)
        model = sp.Model.load("path_cacc.yaml")
        loaded, computed = sp.Trajectories.load(self.path("one")), sp.trajectories(model, 17, **self.SETTINGS)
        for quantity in (*sp.Trajectories.QUANTITIES, "received_1", "received_2", "received_3", "received_4"):
            np.testing.assert_array_equal(computed[quantity], loaded[quantity])
        speed = np.diff(loaded["position"][0]) / model.sample_period
        noise = computed.between(0, 28)["received_4"][1:] - speed[:-1]
        self.assertLess(abs(noise.var() / 0.04 - 1.0), 5.0 * (2.0 / noise.size) ** 0.5)

    def test_bad_settings_raise_with_the_texts_of_the_tools(self):
        model = sp.Model.load()
        self.assertRaisesText(ValueError, "realizations: 0: must be", sp.monte_carlo, model, realizations=0)
        self.assertRaisesText(ValueError, "steps: 0: must be at least 1 for a Monte Carlo", sp.monte_carlo, model, steps=0)
        self.assertRaisesText(ValueError, "threads: 0: must be 1 or more", sp.monte_carlo, model, threads=0)
        self.assertRaisesText(ValueError, "threads: 'two': must be a whole number", sp.monte_carlo, model, threads="two")
        self.assertRaisesText(ValueError, "checkpoint_seconds: nan: must be", sp.monte_carlo, model, checkpoint_seconds=float("nan"))
        self.assertRaisesText(ValueError, "realization: -1: must be 0 or more", sp.trajectories, model, -1)
        self.assertRaisesText(ValueError, "output: '': must be a folder", sp.monte_carlo, model, output="")
        self.assertRaisesText(OSError, "/dev/null/run: cannot be made", sp.monte_carlo, model, output="/dev/null/run")

    def test_results_survive_a_folder_that_is_gone_at_the_end(self):
        output = self.path("gone")

        def progress(done, of):
            if done == of:
                shutil.rmtree(output)

        with self.assertRaises(OSError) as caught:
            sp.monte_carlo(sp.Model.load(), output=output, progress=progress, **self.SETTINGS)
        self.assertIn(output + "/checkpoint.cbor.part: cannot be written: No such file or directory", str(caught.exception))
        self.assertSameTables(caught.exception.results, sp.monte_carlo(sp.Model.load(), **self.SETTINGS))


class ResultFiles(ModuleTest):
    def setUp(self):
        super().setUp()
        self.run_folder = self.path("run")
        sp.monte_carlo(sp.Model.load(), followers=2, steps=5, realizations=50, output=self.run_folder)

    def test_damage_is_found(self):
        table = os.path.join(self.run_folder, "statistics.csv")
        with open(table) as file:
            text = file.read()
        with open(table, "w") as file:
            file.write(text.replace("1,0,50", "1,0,51", 1))
        self.assertRaisesText(ValueError, "statistics.csv: is not as it was written", sp.Results.load, self.run_folder)
        os.remove(table)
        self.assertRaisesText(FileNotFoundError, "statistics.csv", sp.Results.load, self.run_folder)

    def test_folders_that_hold_no_run_are_rejected(self):
        self.assertRaisesText(FileNotFoundError, "no such folder", sp.Results.load, self.path("none"))
        self.assertRaisesText(FileNotFoundError, "summary.json", sp.Results.load, self.folder)
        self.assertRaisesText(ValueError, "must be a run's folder", sp.Results.load, os.path.join(self.run_folder, "summary.json"))
        results = sp.Results.load(self.run_folder)
        self.assertRaisesText(KeyError, "gaps.csv: no such file: run with signals:=gap", lambda: results.gaps)
        self.assertRaisesText(KeyError, "has no table gaps: must be one of statistics", results.table, "gaps")
        self.assertEqual(results.signals, {})

    def test_tables_with_quotes_and_texts_are_read(self):
        self.write("sweep.csv", 'point,"the, ""leader""",' + ",".join(sp.Sweep.MEASURED[1:]) + "\n" + '0,"a,b"' + ",1" * 11 + "\r\n1,c" + "," * 11 + "\n")
        sweep = sp.Sweep.load(self.path("sweep.csv"))
        self.assertEqual(sweep.varied, ['the, "leader"'])
        self.assertEqual(sweep.columns['the, "leader"'], ["a,b", "c"])
        self.write("signals.csv", "point,h," + ",".join(sp.Sweep.MEASURED[1:]) + ",gap_mean,collisions\n0,2" + ",1" * 13 + "\n1,3" + ",1" * 13 + "\n")
        self.assertEqual(sp.Sweep.load(self.path("signals.csv")).varied, ["h"])
        np.testing.assert_array_equal(sweep.columns["mean"], [1.0, np.nan])
        with open(self.path("sweep.csv"), "a") as file:
            file.write("2,d,1\n")
        self.assertRaisesText(ValueError, "line 4 has 3 values instead of 13", sp.Sweep.load, self.path("sweep.csv"))

    def test_what_is_no_number_is_named_with_its_line(self):
        heading = ",".join(("h",) + sp.Sweep.MEASURED)
        for cell in ("0x10", "1_0", " 1", "1\0", "\u0661"):
            self.write("sweep.csv", heading + "\n1" + ",1" * 12 + "\n2," + cell + ",1" * 11 + "\n")
            self.assertRaisesText(ValueError, "line 3: point: " + cell + ": must be a number", sp.Sweep.load, self.path("sweep.csv"))

    def test_only_regular_files_are_read(self):
        fifo = self.path("fifo")
        os.mkfifo(fifo)
        for load in (sp.Model.load, sp.Analysis.load, sp.StabilityMap.load, sp.Sweep.load, sp.Trajectories.load):
            for path, kind in ((fifo, "a FIFO"), ("/dev/zero", "a device")):
                with self.assertRaises((OSError, ValueError)) as caught:
                    load(path)
                self.assertIn("must be a regular file of at most", str(caught.exception))
                self.assertIn(kind, str(caught.exception))
        self.assertRaisesText(ValueError, "must be a bag, a regular file", sp.Recording, fifo)
        shutil.rmtree(self.run_folder)
        os.mkdir(self.run_folder)
        os.mkfifo(os.path.join(self.run_folder, "summary.json"))
        self.assertRaisesText(OSError, "summary.json: must be a regular file", sp.Results.load, self.run_folder)


class Recordings(ModuleTest):
    SMALL = live_platoon.shared("test", "data", "small.bag")

    def test_positions_are_those_of_the_messages(self):
        recording = sp.Recording(self.SMALL)
        run = recording.configuration.run
        with rosbag.Bag(self.SMALL) as bag:
            for read, vehicle, topic in ((recording.positions, 0, "position"), (recording.positions, 1, "position"),
                                         (recording.predecessor_positions, 1, "predecessor_position")):
                positions = read(vehicle=vehicle)
                self.assertEqual(positions.shape, (run["realizations"], run["steps"] + 1))
                self.assertTrue(np.isfinite(positions).all())
                for _, message, _ in bag.read_messages(["/platoon/vehicle_{}/{}".format(vehicle, topic)]):
                    rows = slice(message.first_realization, message.first_realization + len(message.position))
                    np.testing.assert_array_equal(positions[rows, message.step + 1], message.position)

    def test_results_have_the_bits_of_the_run(self):
        program("bag_statistics", self.SMALL, output=self.path("results"))
        self.assertSameTables(sp.Results.load(self.path("results")), sp.Recording([self.SMALL]).results())
        self.assertIn("gap", sp.Recording(self.SMALL).results(signals=["gap"]).signals)
        for none in ([], (), ""):
            self.assertEqual(dict(sp.Recording(self.SMALL).results(signals=none).signals), {})
        self.assertRaisesText(ValueError, "signals: gap,gap: must be", sp.Recording(self.SMALL).results, signals=["gap", "gap"])

    def test_bad_recordings_and_names_raise(self):
        recording = sp.Recording(self.SMALL)
        self.assertRaisesText(FileNotFoundError, "none.bag: no such file", sp.Recording, self.path("none.bag"))
        self.assertRaises(IndexError, recording.positions, 1000)
        for read, vehicle in ((recording.inputs, 1), (recording.predecessor_inputs, 1), (recording.predecessor_positions, 0)):
            self.assertRaises(IndexError, read, vehicle)
        for first, count, reason in ((-1, 1, "first: -1: must be from 0 to 5"), (6, 1, "first: 6: must be from 0 to 5"),
                                     (0, 7, "count: 7: must be from 1 to 6, as"), (4, 3, "count: 3: must be from 1 to 2, as"),
                                     (5, 0, "count: 0: must be from 1 to 1, as"), (0, -1, "count: -1: must be from 1 to 6, as")):
            self.assertRaisesText(IndexError, reason, list, recording.trajectories(first, count))
        self.assertEqual([len(list(recording.trajectories(*chosen))) for chosen in ((), (3,), (0, 6), (4, 2))], [1, 1, 6, 2])
        with open(self.SMALL, "rb") as file:
            content = file.read()
        with open(self.path("cut.bag"), "wb") as file:
            file.write(content[:len(content) // 2])
        self.assertRaises(ValueError, sp.Recording(self.path("cut.bag"), partial=True).results)
        self.assertRaises(ValueError, lambda: sp.Recording(self.path("cut.bag")).results())


if __name__ == "__main__":
    unittest.main()
