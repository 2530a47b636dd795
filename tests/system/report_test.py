#!/usr/bin/python3
"""The Python module impinge, impinge-plot --animate and impinge-report on small runs.

Usage: report_test.py BIN_DIRECTORY [unittest options]. page_test.py opens the page in a browser."""

import base64
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(BIN.parent / "share/impinge"))
import impinge  # noqa: E402

COLUMN = (ROOT / "tests/system/column.toml").read_text()


def call(*words, environment=None):
    return subprocess.run([*map(str, words)], capture_output=True, text=True, timeout=300, check=False, env=environment)


def compute(path, text, directory, *words):
    path.write_text(text)
    done = call(BIN / "impinge", path, "--set", f"output.directory={directory}", *words)
    assert done.returncode == 0, done.stdout + done.stderr


class Page:
    """What stands in a page."""

    def __init__(self, path):
        self.text = path.read_text(encoding="utf-8")
        self.data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', self.text, re.S)[1])
        self.frames = re.findall(r'<script type="text/plain" class="frame">(.*?)</script>', self.text)
        self.warnings = re.findall(r"<li>(.*?)</li>", self.text)
        self.status = re.search(r'<span class="status (\w+)">', self.text)[1]

    def values(self, k):
        """Positions, pressures, speeds, ranks and types of a frame."""
        data, count, axes = base64.b64decode(self.frames[k]), self.data["counts"][k], self.data["dimension"]
        place = np.frombuffer(data, "<u2", axes * count).reshape(count, axes) / 65535
        low, high = np.array(self.data["low"][:axes]), np.array(self.data["high"][:axes])
        bytes_of = np.frombuffer(data, np.uint8, 4 * count, 2 * axes * count).reshape(4, count)
        assert len(data) == (2 * axes + 4) * count
        scaled = [r[0] + bytes_of[n] / 255 * (r[1] - r[0]) for n, r in enumerate((self.data["range"]["pressure"], self.data["range"]["speed"]))]
        return low + place * (high - low), *scaled, bytes_of[2], bytes_of[3]


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.root = pathlib.Path(temporary.name)
        cls.column = cls.root / "column"
        compute(cls.root / "column.toml", COLUMN, cls.column, "--set", "output.interval=0.05", "--set", "output.average_start=0.1")

    def copy_of_column(self):
        directory = pathlib.Path(tempfile.mkdtemp(dir=self.root))
        return shutil.copytree(self.column, directory / "run")

    def report(self, directory, code=0):
        done = call(BIN / "impinge-report", directory)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stderr == "", code == 0, done.stderr)
        return Page(next(directory.glob("*_report.html"))) if code == 0 else done.stderr


class Module(Runs):
    def test_reads_snapshots_with_units(self):
        run = impinge.Run(self.column)
        self.assertEqual((run.name, run.steps[0], run.spacing), ("column", 0, 0.04))
        self.assertTrue(np.allclose(run.times, [0, 0.05, 0.1, 0.15, 0.2]))
        last = run.snapshot()
        self.assertEqual((last.step, last.status, last.dimension), (run.steps[-1], "finished", 2))
        self.assertEqual((last.position.shape, np.count_nonzero(last.fluid)), ((last.count, 3), 80))
        units = {"position": "m", "velocity": "m/s", "pressure": "Pa", "id": "1"}
        self.assertEqual({name: last.units[name] for name in units}, units)
        with h5py.File(last.path) as file:
            self.assertTrue(np.array_equal(last.pressure, file["VTKHDF/PointData/pressure"][:]))
        self.assertAlmostEqual(float(np.max(last.speed[last.fluid])), run.history["max_speed"][-1], delta=1e-6)
        self.assertEqual(run.snapshot(time=0.11).step, run.steps[2])
        self.assertEqual(run.snapshot(step=run.steps[1]).time, run.times[1])
        self.assertEqual([snapshot.step for snapshot in run.snapshots], run.steps)
        self.assertEqual(run.case["gauge"][0]["length"], 0.6)
        with self.assertRaisesRegex(ValueError, "no snapshot of step 7; there are 0, "):
            run.snapshot(step=7)
        with self.assertRaisesRegex(AttributeError, "no field colour"):
            last.colour
        with self.assertRaisesRegex(ValueError, "has no snapshot of other"):
            impinge.Run(self.column, "other")

    def test_reads_walls_and_their_average(self):
        run = impinge.Run(self.column)
        self.assertIsNone(run.snapshot(time=0).walls)
        walls = run.snapshot().walls
        self.assertTrue(np.allclose(walls["window"], (0.1, 0.2)))
        self.assertEqual(walls["position"].shape, (walls["mean_pressure"].size, 3))
        self.assertGreater(walls["mean_pressure"].max(), 500)

    def test_reads_tables_with_names_and_units(self):
        run = impinge.Run(self.column)
        self.assertEqual((run.history.units["t"], run.history.units["kinetic_energy"]), ("s", "J/m"))
        self.assertEqual(run.history["limit"][0], "case")
        self.assertEqual(run.probes.units, {"step": "1", "t": "s", "p_floor": "Pa", "ux_floor": "m/s", "uy_floor": "m/s"})
        self.assertEqual(run.sections.units["total_gate"], "m^2")
        self.assertEqual(len(run.gauges.time), run.history.rows)
        self.assertIsNone(run.forces)
        self.assertIsNone(run.validation)
        # The last line was broken off.
        copy = self.copy_of_column()
        with open(copy / "column_gauges.csv", "a") as file:
            file.write("101,0.2")
        self.assertEqual(impinge.Run(copy).gauges.rows, run.gauges.rows)

    def test_history_units_are_those_that_the_program_tells(self):
        told = {}
        for line in call(BIN / "impinge", "--describe").stdout.split("Columns of the history")[1].splitlines()[1:]:
            unit = re.search(r"\[([^;\]]+)", line)
            told[line.split()[0]] = unit[1] if unit else "1"
        self.assertEqual({name: unit for name, unit in told.items() if unit != "1"}, impinge.HISTORY_UNITS)
        self.assertLessEqual(set(impinge.Run(self.column).history), set(told))

    def test_discharge_is_smoothed_from_the_totals(self):
        time = np.linspace(0, 2, 201)
        table = impinge.Table.__new__(impinge.Table)
        table.update({"t": time, "gate": np.where(np.arange(201) % 10 == 0, 30.0, 0.0), "total_gate": 3 * time})
        table.units = {"t": "s", "gate": "m^2/s", "total_gate": "m^2"}
        smooth, window = impinge.smooth_discharge(table)
        self.assertAlmostEqual(window, 0.1)
        self.assertTrue(np.allclose(smooth["gate"], 3))


class Report(Runs):
    def test_tells_and_shows_a_run(self):
        page = self.report(self.column)
        run, data = impinge.Run(self.column), page.data
        self.assertEqual((page.status, page.warnings), ("finished", []))
        self.assertEqual((data["steps"], data["share"], len(page.frames)), (run.steps, 1, 5))
        for k, snapshot in enumerate(run.snapshots):
            position, pressure, speed, rank, kind = page.values(k)
            self.assertLess(np.abs(position - snapshot.position[:, :2]).max(), 1e-4)
            self.assertTrue(np.array_equal(kind, snapshot.type))
            fluid, (low, high) = snapshot.fluid, data["range"]["pressure"]
            step = (high - low) / 255
            self.assertLess(np.abs(pressure - np.clip(snapshot.pressure, low, high))[fluid].max(), step)
        self.assertEqual([mark["name"] for mark in data["marks"]], ["floor", "gauge_1", "gate"])
        charts = {(chart["kind"], chart["label"]): chart for chart in data["charts"]}
        self.assertIn(("probes", "pressure [Pa]"), charts)
        level = charts["gauges", "level [m]"]
        self.assertTrue(np.allclose([row[1] for row in level["rows"]], run.gauges[level["names"][0]], rtol=1e-5))
        for text in ("--restart", "Koshizuka", "PETSc", "Permission is hereby granted", "three.js authors", "central_force"):
            self.assertIn(text, page.text)

    def test_needs_nothing_from_elsewhere(self):
        page = self.report(self.column)
        own = re.sub(r"<script>(?!\n\"use strict\").*?</script>", "", page.text, flags=re.S)
        self.assertEqual(re.findall(r"""(?:src|href)=["'](?!data:)[^"']*""", own), [])
        self.assertLess(len(page.text), 20e6)

    def test_a_run_that_goes_on_has_a_page(self):
        copy = self.copy_of_column()
        run = impinge.Run(copy)
        run.paths.popitem()[1].unlink()
        history = copy / "column_history.csv"
        lines = history.read_text().splitlines()[: run.steps[-1] + 5]
        history.write_text("\n".join(lines) + "\n99,0.1")
        page = self.report(copy)
        self.assertEqual(page.status, "stopped")
        self.assertIn("no program continues it", page.warnings[0])
        lock, host, space = copy / "column.lock", socket.gethostname(), os.readlink("/proc/self/ns/pid")
        started = pathlib.Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19]
        ended = subprocess.Popen(["true"])
        ended.wait()
        for text in ("", "far 1", f"{host} {ended.pid} {started} - {space}\n", f"{host} {os.getpid()} 1 - {space}\n",
                     f"{host} x 1 - {space}\n"):
            lock.write_text(text)
            self.assertFalse(run.is_living, text)
        for text in (f"another-host 7 1 - {space}\n", f"{host} 7 1 - of-a-container\n"):
            lock.write_text(text)
            self.assertTrue(run.is_living)
            os.utime(lock, (0, 0))  # its owner has written nothing for long
            self.assertFalse(run.is_living)
        self.assertEqual(self.report(copy).status, "stopped")
        lock.write_text(f"{host} {os.getpid()} {started} - {space}\n")
        page = self.report(copy)
        self.assertEqual((page.status, page.warnings, len(page.frames)), ("running", [], 4))
        self.assertIn("time left", page.text)

    def test_warns(self):
        copy = self.copy_of_column()
        run = impinge.Run(copy)
        history = copy / "column_history.csv"
        lines = history.read_text().splitlines()
        cells = dict(zip(lines[0].split(","), lines[-1].split(",")))
        cells.update(lost="3", halvings="2", cold_solves="4", max_speed="40")
        history.write_text("\n".join([*lines[:-1], ",".join(cells.values())]) + "\n")
        run.paths[run.steps[1]].write_bytes(b"no HDF5")
        with h5py.File(run.paths[run.steps[-1]], "r+") as file:
            file.attrs["status"], file.attrs["message"] = "failed", "the flow <diverged>"
            file["VTKHDF/Points"][0] = np.nan
        page = self.report(copy)
        self.assertEqual(page.status, "failed")
        texts = ("The run failed: the flow &lt;diverged&gt;", "3 fluid particles", "2 steps were repeated", "4 pressure solves",
                 "The largest speed, 40 m/s", "in - out - lost - stored = -3", f"step {run.steps[1]} cannot be read", "1 particles have no finite")
        for text, warning in zip(texts, page.warnings, strict=True):
            self.assertIn(text, warning)
        self.assertEqual(len(page.frames), 4)

    def test_a_large_snapshot_is_thinned(self):
        copy = self.copy_of_column()
        run = impinge.Run(copy)
        times = 1 + 1_000_000 // run.snapshot().count
        with h5py.File(run.paths[run.steps[-1]], "r+") as file:
            for name in ("Points", *(f"PointData/{field}" for field in file["VTKHDF/PointData"])):
                data, attributes = file[f"VTKHDF/{name}"][:], dict(file[f"VTKHDF/{name}"].attrs)
                del file[f"VTKHDF/{name}"]
                file[f"VTKHDF/{name}"] = np.concatenate([data] * times)
                file[f"VTKHDF/{name}"].attrs.update(attributes)
            file["VTKHDF/PointData/id"][:] = np.arange(file["VTKHDF/Points"].shape[0])
        page = self.report(copy)
        self.assertLess(page.data["share"], 0.2)
        self.assertAlmostEqual(page.data["counts"][-1], 200_000, delta=2_000)
        self.assertRegex(page.text, r"The picture is thinned: it shows 20 % of the particles \(up to (1|2)\d\d,\d\d\d of 1,00")
        self.assertLess(len(page.text), 20e6)

    def test_many_snapshots_and_rows_are_thinned(self):
        copy = self.copy_of_column()
        last = impinge.Run(copy).snapshot()
        for step in range(1000, 1200):
            shutil.copy(last.path, copy / f"column_{step:08}.vtkhdf")
        history = copy / "column_history.csv"
        lines = history.read_text().splitlines()
        cells = lines[-1].split(",")
        peak = [*cells[:10], "77", *cells[11:]]
        lines += [",".join([str(step), str(step * 2e-3), *(peak if step == 6543 else cells)[2:]]) for step in range(101, 10_000)]
        history.write_text("\n".join(lines) + "\n")
        page = self.report(copy)
        self.assertIn("150 of the 205 snapshots are shown.", page.text)
        speed = next(chart for chart in page.data["charts"] if chart["label"].startswith("largest speed"))
        self.assertLess(len(speed["rows"]), 2000)
        self.assertIn(77, [row[1] for row in speed["rows"]])

    def test_a_jet_is_shown_beside_the_exact_one(self):
        out = self.root / "jet"
        compute(self.root / "jet.toml", f'include = "{ROOT}/input/jet60-quick.toml"\njet.start = "steady"', out,
                "--set", "time.end=0.02", "--set", "particles.spacing=0.04")
        self.assertIn("impinge-validate", self.report(out).text)
        self.assertEqual(call(BIN / "impinge-validate", out).returncode, 0)
        page, validation = self.report(out), impinge.Run(out).validation
        self.assertIn(f"{validation.report['metrics']['force_ratio']:.4g}</td><td>1</td><td>force_ratio", page.text)
        labels = [chart["label"] for chart in page.data["charts"]]
        self.assertIn("wall pressure against the exact one [Pa]", labels)
        self.assertEqual([mark["kind"] for mark in page.data["marks"]], ["exact", "exact"])
        self.assertEqual(validation.wall_pressure.units, {"x": "m", "pressure": "Pa", "analytic": "Pa"})
        self.assertEqual(set(validation.surface["sheet"]), {1, 2})
        points = np.array([[1.0, 2.0], [0.3, 0.1]])
        self.assertTrue(np.allclose(validation.from_frame(validation.to_frame(points)), points))

    def test_three_dimensions(self):
        out = self.root / "space"
        compute(self.root / "space.toml", (ROOT / "input/hydrostatic-3d.toml").read_text(), out, "--set", "time.end=0.01")
        page = self.report(out)
        position = page.values(0)[0]
        self.assertEqual((page.data["dimension"], position.shape[1]), (3, 3))
        self.assertLess(np.abs(position - impinge.Run(out).snapshot(step=0).position).max(), 1e-4)

    def test_refuses_what_is_no_run(self):
        empty = self.root / "empty"
        empty.mkdir()
        self.assertRegex(self.report(empty, 1), "impinge-report: .*empty has no snapshot\n")
        packages = self.root / "packages"
        packages.mkdir()
        (packages / "h5py.py").write_text("raise ImportError('no h5py')")
        done = call(BIN / "impinge-report", self.column, environment={**os.environ, "PYTHONPATH": str(packages)})
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, r"^impinge-report: no h5py; .*\n$")


class Film(Runs):
    def test_shows_every_snapshot(self):
        done = call(BIN / "impinge-plot", self.column, "--animate")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        path = pathlib.Path(done.stdout.split()[1])
        self.assertEqual(path.suffix, ".mp4" if shutil.which("ffmpeg") else ".gif")
        self.assertGreater(path.stat().st_size, 10_000)

    def test_is_a_gif_without_ffmpeg(self):
        from PIL import Image

        tools = self.root / "tools"
        tools.mkdir()
        done = call("/usr/bin/python3", BIN / "impinge-plot", self.column, "--animate", environment={**os.environ, "PATH": str(tools)})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with Image.open(self.column / "column_figures/pressure.gif") as film:
            self.assertEqual(film.n_frames, 5)


if __name__ == "__main__":
    unittest.main()
