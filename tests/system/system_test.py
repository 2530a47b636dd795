#!/usr/bin/python3
"""The programs as a user calls them: exit codes, messages, files. Usage: system_test.py BIN_DIRECTORY [unittest options]"""

import csv
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import h5py
import numpy as np
from vtkmodules.vtkIOHDF import vtkHDFReader

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
QUICK = ROOT / "input/jet60-quick.toml"
POINT_DATA = {
    "velocity": ("float64", "m/s"),
    "pressure": ("float64", "Pa"),
    "number_density": ("float64", "1"),
    "type": ("uint8", "1"),
    "free_surface": ("uint8", "1"),
    "id": ("int64", "1"),
    "rank": ("int32", "1"),
}


def call(*words, cwd=None, ranks=0, environment=None):
    launcher = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks else []
    return subprocess.run(
        [*launcher, *map(str, words)], cwd=cwd, capture_output=True, text=True, timeout=300, check=False, env=environment
    )


def impinge(*words, cwd=None, ranks=0):
    return call(BIN / "impinge", *words, cwd=cwd, ranks=ranks)


class System(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.directory = pathlib.Path(temporary.name)

    def case(self, text):
        path = self.directory / "case.toml"
        path.write_text(f'include = "{QUICK}"\n{text}')
        return path


class CommandLine(System):
    def test_texts(self):
        for words, part in (
            (["--help"], "CASE.toml"),
            (["--version"], "impinge "),
            (["--describe"], "particles.spacing"),
            ([QUICK, "--plan", "16"], "planned for 16 ranks"),
        ):
            done = impinge(*words, cwd=self.directory)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(part, done.stdout)
        self.assertEqual(list(self.directory.iterdir()), [])
        done = impinge(ROOT / "input/hydrostatic.toml", "--plan", "100", "--set", "particles.spacing=8e-5", cwd=self.directory)
        self.assertRegex(done.stderr, r"^impinge: planning \S+ particles takes some \S+ s\n$")
        self.assertRegex(done.stdout, r"partition   by curve; .*\nrepartition \d+ sums of 0.792 kB over the ranks\n")
        hall = ("--set", "plate.begin=-2e4", "--set", "parallel.partitioner=curve")  # 10^7 cells, few with particles
        done = impinge(QUICK, "--plan", "2", *hall, cwd=self.directory)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        done = impinge(QUICK, "--check", cwd=self.directory)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("bytes per particle", done.stdout)

    def test_wrong_input_is_exit_2_with_file_and_line(self):
        for text, message in (
            ("speed = 1", 'case.toml:2: speed = 1: unknown key'),
            ("jet.speed = 'fast'", "case.toml:2: jet.speed = \"fast\": not a number"),
            ("pressure.gamma = 1.5", "case.toml:2: pressure.gamma = 1.5: out of range; allowed: [0, 1]"),
            ("particles.spacing = -0.02", "case.toml:2: particles.spacing = -0.02: out of range; allowed: > 0 (m)"),
            ("plate.begin = 0.5\nplate.end = 0.8", "case.toml:2: plate.begin = 0.5"),
            ("output.directory = '/proc/nowhere'", 'case.toml:2: output.directory = "/proc/nowhere": cannot write there'),
            ("[time\nend = 1", "case.toml:2: not TOML: "),
            ("name = '\x01'", "case.toml:2: not TOML: "),
        ):
            for ranks in (0, 2):
                done = impinge(self.case(text), cwd=self.directory, ranks=ranks)
                self.assertEqual(done.returncode, 2, f"{text}: {done.stderr}")
                self.assertEqual(done.stderr.count(message), 1, f"{text}: {done.stderr}")

    def test_files_that_are_no_case(self):
        empty, binary = self.directory / "empty.toml", self.directory / "binary.toml"
        empty.write_bytes(b"")
        binary.write_bytes(bytes(range(256)) * 16)
        for path, message in (
            (empty, f"{empty}: geometry: required key is missing"),
            (binary, f"{binary}:1: not TOML: "),
            (self.directory, "is a directory"),
            ("/dev/zero", "larger than 1048576 bytes"),
            (self.directory / ("x" * 300), "File name too long"),
        ):
            for ranks in (0, 2):
                done = impinge(path, ranks=ranks)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(done.stderr.count(message), 1, done.stderr)

    def test_all_mistakes_at_once(self):
        done = impinge(self.case("speed = 1\npressure.gamma = 7"), "--set", "time.dt=-1")
        self.assertEqual(done.returncode, 2)
        for part in ("case.toml:2:", "case.toml:3:", "--set: time.dt"):
            self.assertIn(part, done.stderr)

    def test_plan_refuses_what_is_no_number_of_ranks_and_petsc_options(self):
        for words, part in ((["0"], "--plan"), (["2.5"], "--plan"), (["4", "--check"], "--plan"),
                            (["4", "-ppe_pc_type", "jacobi"], "-ppe_pc_type")):
            done = impinge(QUICK, "--plan", *words)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn(part, done.stderr)

    def test_plan_is_what_a_run_writes(self):
        plan = impinge(QUICK, "--plan", "3").stdout
        self.assertEqual(impinge(QUICK, "--plan", "3", ranks=2).stdout, plan)
        done = impinge(QUICK, "--set", "time.end=8e-4", "--set", "output.directory=out", cwd=self.directory, ranks=3)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.directory / "out/jet60-quick_00000000.vtkhdf") as file:
            counts = file["VTKHDF/NumberOfPoints"][:]
        self.assertIn(f"most {max(counts)}, {sum(counts)} in all", plan)

    def test_missing_file_and_unused_petsc_option(self):
        done = impinge("nowhere.toml", ranks=2)
        self.assertEqual(done.returncode, 2)
        self.assertIn("nowhere.toml", done.stderr)
        done = impinge(QUICK, "-ppe_pc_tpye", "jacobi", "--check", cwd=self.directory, ranks=2)
        self.assertEqual(done.returncode, 2)
        self.assertIn("-ppe_pc_tpye", done.stderr)
        done = impinge(QUICK, "-ppe_pc_type", "nonsense", "--check", cwd=self.directory)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("nonsense", done.stderr)


    @unittest.skipIf("sanitize" in BIN.parts, "AddressSanitizer reserves more addresses than any limit leaves")
    def test_a_case_beyond_the_memory_is_refused_with_figures(self):
        limited = lambda *words: subprocess.run(
            ["bash", "-c", 'ulimit -v 3000000; exec "$@"', "bash", BIN / "impinge", *words], cwd=self.directory,
            capture_output=True, text=True, timeout=300, check=False)
        tank = ROOT / "input/hydrostatic.toml"
        large = ("--set", "particles.spacing=2e-5", "--set", "output.directory=out")
        for words in (["--check"], []):
            done = limited(tank, *large, *words)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertRegex(done.stderr, r"^impinge: --set: particles.spacing = 2e-05: not enough memory: some \S+ "
                             r"particles need \S+ GB on a rank, \S+ GB are free for it; allowed: from about \S+ \(m\)")
        self.assertFalse((self.directory / "out").exists())
        # What is free here does not bound the plan of a cluster, but for the cells of the case itself.
        self.assertEqual(limited(tank, "--set", "particles.spacing=2e-4", "--plan", "64").returncode, 0)
        for columns in (12500, 37000):  # 12500: the cells alone would fit, the graph that is partitioned does not
            done = limited(tank, "--set", f"particles.spacing={0.2 / columns!r}", "--plan", "64",
                           "--set", "parallel.partitioner=metis")
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn("not enough memory", done.stderr)
        done = limited(tank, "--check")
        self.assertRegex(done.stdout, r"memory .* free for a rank\n")

    def test_texts_need_no_working_mpi(self):
        broken = {**os.environ, "OMPI_MCA_pml": "none"}
        self.assertNotEqual(call(BIN / "impinge", QUICK, "--check", cwd=self.directory, environment=broken).returncode, 0)
        for word in ("--help", "--version", "--describe"):
            done = call(BIN / "impinge", word, environment=broken)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(call(BIN / "impinge", word, ranks=3).stdout, done.stdout)
        for word in ("--help", "--version"):
            self.assertEqual(call(BIN / "impinge-validate", word, environment=broken).returncode, 0)

    def test_a_text_that_cannot_be_written_is_an_error(self):
        for words in (["--new", "dam-break"], ["--describe"], ["--help"], [QUICK, "--plan", "2"], [QUICK, "--check"]):
            words = " ".join(shlex.quote(str(word)) for word in (BIN / "impinge", *words))
            done = call("bash", "-c", f"{words} >/dev/full", cwd=self.directory)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn("impinge: cannot write to standard output: No space left on device\n", done.stderr)
        self.assertEqual(call("bash", "-c", f"'{BIN}/impinge-validate' --help >/dev/full").returncode, 1)

    def test_processes_of_another_mpi_are_refused(self):
        for variables, text in (
            ({"PMI_SIZE": "4", "PMI_RANK": "2"}, "process 2 of 4 (PMI_SIZE) is alone for its MPI (Open MPI "),
            ({"SLURM_STEP_NUM_TASKS": "8", "SLURM_PROCID": "0"}, "process 0 of 8 (SLURM_STEP_NUM_TASKS) is alone"),
        ):
            done = call(BIN / "impinge", QUICK, "--set", "output.directory=out", cwd=self.directory,
                        environment={**os.environ, **variables})
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertIn(text, done.stderr)
        self.assertFalse((self.directory / "out").exists())
        for variables in ({"PMI_SIZE": "1", "PMI_RANK": "0"}, {"SLURM_NTASKS": "8", "SLURM_PROCID": "0"},
                          {"PMI_SIZE": "x"}):
            done = call(BIN / "impinge", QUICK, "--check", cwd=self.directory, environment={**os.environ, **variables})
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_petsc_options_with_two_dashes_are_told(self):
        for words in (["--ppe_pc_type", "hypre"], ["--log_view"], ["--ppe_ksp_rtol=1e-3"]):
            done = impinge(QUICK, *words)
            self.assertEqual(done.returncode, 2)
            self.assertEqual(done.stderr, f"impinge: command line: {words[0]}: options of PETSc have a single dash: "
                                          f"{words[0][1:]}\n")

    def test_petsc_options_of_other_programs_are_told(self):
        environment = {**os.environ, "PETSC_OPTIONS": "-snes_monitor"}
        done = call(BIN / "impinge", QUICK, "--check", cwd=self.directory, environment=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("PETSC_OPTIONS or .petscrc: -snes_monitor\n", done.stdout)
        done = call(BIN / "impinge", QUICK, "--check", "-snes_monitor", cwd=self.directory, environment=environment)
        self.assertEqual(done.returncode, 2)

    def test_an_earlier_run_is_kept(self):
        words = [self.case("time.end = 2e-3\nname = 'short'\noutput.directory = 'out'\n")]
        out = self.directory / "out"
        self.assertEqual(impinge(*words, cwd=self.directory).returncode, 0)
        first = {path.name: path.read_bytes() for path in out.iterdir()}
        self.assertEqual(len(first), 6)  # two snapshots, checkpoint, two series, history
        # One that cannot start touches nothing.
        for refused in (["-ppe_ksp_typ", "cg"], ["--set", "time.max_speed=1e-3"]):
            self.assertNotEqual(impinge(*words, *refused, cwd=self.directory).returncode, 0)
            self.assertEqual({path.name: path.read_bytes() for path in out.iterdir()}, first)
        done = impinge(*words, cwd=self.directory)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the earlier run of this case is now in out/short_before_", done.stdout)
        (aside,) = out.glob("short_before_*")
        self.assertEqual({path.name: path.read_bytes() for path in aside.iterdir()}, first)
        # A third run at the same second finds another name.
        self.assertEqual(impinge(*words, cwd=self.directory).returncode, 0)
        self.assertEqual(len(list(out.glob("short_before_*"))), 2)
        # A history alone is a run, too.
        for path in (*out.glob("*.vtkhdf"), *out.glob("*.checkpoint")):
            path.unlink()
        self.assertIn("the earlier run of this case is now in", impinge(*words, cwd=self.directory).stdout)
        self.assertEqual(len(list(out.glob("short_before_*/short_history.csv"))), 3)


SCENE = """geometry = "scene"
particles.spacing = 0.05
fluid.gravity = [0, -9.81]
time = {end = 0.3, dt = 2e-3}
domain = {low = [-2, -2], high = [4, 3]}
[[fluid.region]]
name = "water"
shape = "box"
low = [0, 0]
high = [2, 0.5]
[[wall]]
name = "flume"
shape = "polyline"
points = [[-0.5, 0], [2, 0], [2, 1]]
wet = "left"
[[wall]]
name = "piston"
shape = "polyline"
points = [[0, 0], [0, 1]]
motion = "stroke"
[[wall]]
name = "post"
shape = "circle"
center = [1.5, 0.6]
radius = 0.1
[[motion]]
name = "stroke"
type = "harmonic"
amplitude = [0.1, 0]
frequency = 1
[[inlet]]
name = "nozzle"
center = [0.5, 0.8]
direction = [1, 0]
width = 0.2
speed = 2
[[outlet]]
name = "drain, left"
shape = "box"
low = [0.9, 0]
high = [1.1, 0.2]
[[outlet]]
name = "far"
shape = "circle"
center = [3, 0]
radius = 0.3
[[probe]]
name = "rider"
wall = "piston"
position = [0, 0.2]
[[gauge]]
point = [1, 0]
length = 0.8
[[section]]
name = "gate"
begin = [0.5, 0]
end = [0.5, 1]
[[damping]]
low = [1.6, 0]
high = [2, 1]
strength = 1
"""


class Check(System):
    def setUp(self):
        super().setUp()
        self.path = self.directory / "flume.toml"
        self.path.write_text(SCENE)
        self.out = self.directory / "output/flume"

    def scene(self):
        with h5py.File(self.out / "flume_scene.vtkhdf") as file:
            words = file.attrs["items"].decode().split("\n")
            names = {item: text.decode().split("\n") for item, text in file["names"].attrs.items()}
            return np.array(words)[file["VTKHDF/CellData/item"][:]], names

    def test_tells_and_shows_the_scene_on_any_number_of_ranks(self):
        texts = []
        for ranks in (0, 3):
            done = impinge(self.path, "--check", cwd=self.directory, ranks=ranks)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            texts.append([line for line in done.stdout.splitlines() if not line.startswith(("ranks", "memory"))])
            self.assertEqual(sorted(file.name for file in self.out.iterdir()), ["flume_scene.png", "flume_scene.vtkhdf"])
            self.assertEqual((self.out / "flume_scene.png").read_bytes()[:4], b"\x89PNG")
            self.assertGreater((self.out / "flume_scene.png").stat().st_size, 20000)
            items, names = self.scene()
            counted = {item: int(np.sum(items == item)) for item in set(items)}
            # Two sides of the piston; a circle in pieces of five degrees; 4 rows of 4 particles and the inlet's line;
            # two ends of the piston with a path each.
            self.assertEqual(counted, {"fluid": counted["fluid"], "wall": 2 + 2 + 72, "inlet": 16 + 1, "outlet": 2,
                                       "probe": 1, "gauge": 1, "section": 1, "damping": 1, "path": 2, "domain": 1})
            self.assertEqual(names["wall"], ["flume", "piston", "post"])
            self.assertEqual(names["outlet"], ["drain, left", "far"])
            reader = vtkHDFReader()
            reader.SetFileName(str(self.out / "flume_scene.vtkhdf"))
            reader.Update()
            grid = reader.GetOutput()
            self.assertEqual(grid.GetNumberOfCells(), len(items))
            self.assertEqual(grid.GetBounds(), (-2, 4, -2, 3, 0, 0))
            particles = next(line for line in done.stdout.splitlines() if line.startswith("particles"))
            self.assertIn(f": {counted['fluid']} fluid, 16 inlet, ", particles)
        self.assertEqual(texts[0], texts[1])
        for line in ("wall        piston: 1 m long, 1 face, wet both, moves by stroke, ",
                     "motion      stroke: harmonic, t = 0 to 0.3 s, x from 0 to 0.1 m, moves piston",
                     "outlet      far: 0.282743 m^2", "probe       rider: at (0, 0.2) m, rides on piston",
                     "gauge       gauge_1: from (1, 0) m on 0.8 m along (0, 1)",
                     "section     gate: from (0.5, 0) to (0.5, 1) m", "scene       output/flume/flume_scene.vtkhdf",
                     "picture     output/flume/flume_scene.png"):
            self.assertTrue(any(told.startswith(line) for told in texts[0]), f"{line}: {texts[0]}")
        self.assertTrue(any(told.startswith("fluid       water: 1 m^2, ") and " particles, their volume " in told
                            for told in texts[0]))

    def test_a_scheme_that_does_not_hold_is_a_warning(self):
        tank = [ROOT / "input/hydrostatic.toml", "--set", "output.directory=out", "--set", "time.end=2e-3",
                "--set", "output.average_start=0"]
        settings = ("walls.model=particles", "free_surface.zero_outside=false", "shifting.coefficient=0",
                    "collision.distance=0")
        words = [word for setting in settings for word in ("--set", setting)]
        for more in ([], ["--check"]):
            done = impinge(*tank, *words, *more, cwd=self.directory)
            self.assertEqual(done.returncode, 0, done.stderr)
            for setting in settings:
                self.assertIn(f"impinge: warning: {setting.partition('=')[0]} = ", done.stderr)
        self.assertNotIn("warning", impinge(*tank, *words, "--set", "scheme=paper", cwd=self.directory).stderr)
        self.assertNotIn("warning", impinge(*tank, cwd=self.directory).stderr)

    def test_a_narrow_gap_is_a_warning(self):
        done = impinge(self.path, "--set", "wall[3].center=[1.84,0.6]", "--check", cwd=self.directory)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r'^impinge: warning: the gap between the walls "flume" and "post" is 1.2 dp wide at '
                                      r"\(1.97, 0.6\) m; fluid needs 2 dp to pass\n$")

    def test_shows_a_scene_in_space(self):
        done = impinge(ROOT / "input/hydrostatic-3d.toml", "--check", cwd=self.directory, ranks=2)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.out = self.directory / "output/hydrostatic-3d"
        shutil.copy(self.out / "hydrostatic-3d_scene.vtkhdf", self.out / "flume_scene.vtkhdf")
        items, _ = self.scene()
        self.assertEqual(np.sum(items == "domain"), 12)
        self.assertEqual(np.sum(items == "fluid"), 1000)

    def test_shows_openings_in_space(self):
        place = "center = [0, 0, %d]\ndirection = [0, 1, 1]\nspeed = 1\n[[inlet]]\n"
        self.path.write_text('geometry = "scene"\ndimension = 3\nparticles.spacing = 0.1\ntime = {end = 1, dt = 1e-3}\n[[inlet]]\n'
                             + 'section = "circle"\nradius = 0.5\n' + place % 0
                             + 'section = "annulus"\nradius = 0.5\ninner_radius = 0.3\n' + place % 2
                             + 'section = "rectangle"\nwidth = 0.6\nheight = 0.3\nacross = [1, 0, 0]\n'
                             + (place % 4).replace("[[inlet]]", "[[outlet]]")
                             + 'shape = "box"\nlow = [-1, 2, 0]\nhigh = [1, 3, 9]\n')
        done = impinge(self.path, "--check", cwd=self.directory)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for line in ("inlet_1: round, radius 0.5 m, ", "inlet_2: a ring, radii 0.3 and 0.5 m, ", "inlet_3: 0.6 m x 0.3 m, "):
            self.assertIn(f"inlet       {line}", done.stdout)
        items, names = self.scene()
        self.assertEqual(names["inlet"], ["inlet_1", "inlet_2", "inlet_3"])
        with h5py.File(self.out / "flume_scene.vtkhdf") as file:
            points, begin = file["VTKHDF/Points"][:], file["VTKHDF/Offsets"][:]
            numbers, normals = file["VTKHDF/CellData/number"][:], file["VTKHDF/CellData/normal"][:]
        self.assertEqual(np.sum(items == "outlet"), 12)
        rims = [k for k in np.flatnonzero(items == "inlet") if numbers[k] > 0]
        self.assertEqual(list(numbers[rims]), [1, 2, 2, 3])
        for k, size in zip(rims, (0.5, 0.5, 0.3, np.hypot(0.3, 0.15))):
            rim = points[begin[k]:begin[k + 1]] - [0, 0, 2 * (numbers[k] - 1)]
            np.testing.assert_allclose(np.linalg.norm(rim, axis=1), size, atol=1e-12)
            np.testing.assert_allclose(rim @ normals[k], 0, atol=1e-12)
            np.testing.assert_array_equal(rim[0], rim[-1])

    def test_leaves_a_run_as_it_is(self):
        quick = ["--set", "time.end=4e-3"]
        self.assertEqual(impinge(self.path, *quick, cwd=self.directory).returncode, 0)
        (self.out / "flume.lock").write_text("other 1\n")  # as if a run were under way
        files = {file.name: file.read_bytes() for file in self.out.iterdir()}
        done = impinge(self.path, "--check", cwd=self.directory, ranks=2)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for name, content in files.items():
            self.assertEqual((self.out / name).read_bytes(), content, name)
        self.assertEqual({file.name for file in self.out.iterdir()} - set(files), {"flume_scene.png", "flume_scene.vtkhdf"})
        # It stays with the case when a run is set aside, and is no snapshot.
        (self.out / "flume.lock").unlink()
        self.assertEqual(impinge(self.path, *quick, cwd=self.directory).returncode, 0)
        self.assertTrue((self.out / "flume_scene.png").exists())
        self.assertEqual(call(BIN / "impinge-plot", self.out).returncode, 0)

    def test_needs_no_python_packages(self):
        self.assertEqual(impinge(self.path, "--check", cwd=self.directory).returncode, 0)
        packages = self.directory / "packages"
        packages.mkdir()
        (packages / "matplotlib.py").write_text("raise ImportError('no matplotlib')")
        done = call(BIN / "impinge", self.path, "--check", cwd=self.directory,
                    environment={**os.environ, "PYTHONPATH": str(packages)})
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"^impinge-plot: no matplotlib; .*\n$")
        self.assertIn("picture     none\n", done.stdout)
        self.assertEqual([file.name for file in self.out.iterdir()], ["flume_scene.vtkhdf"])

    def test_refuses_a_directory_that_a_run_cannot_write_to(self):
        done = impinge(self.path, "--check", "--set", "output.directory=/proc/nowhere", ranks=2)
        self.assertEqual(done.returncode, 2)
        self.assertIn("cannot write there", done.stderr)

    def test_each_outlet_has_its_count_over_restarts(self):
        words = ["--set", "checkpoint.steps=50", "--set", "output.sample_steps=10", "--set", "time.end=0.2"]
        self.assertEqual(impinge(self.path, *words, cwd=self.directory, ranks=2).returncode, 0)
        table = self.out / "flume_outlets.csv"
        whole = table.read_text()
        self.assertEqual(whole.splitlines()[0], "step,t [s],drain_ left [1],far [1]")
        last = whole.splitlines()[-1].split(",")
        with open(self.out / "flume_history.csv", encoding="utf-8") as file:
            history = list(csv.DictReader(file))[-1]
        self.assertEqual(int(last[2]) + int(last[3]), int(history["out"]))
        self.assertEqual(int(history["in"]) - int(history["out"]) - int(history["lost"]), int(history["fluid"]))
        self.assertGreater(int(last[2]), 10)
        checkpoints = sorted(self.out.glob("*.checkpoint"))
        checkpoints[-1].unlink()
        done = impinge("--restart", self.out, cwd=self.directory, ranks=2)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(table.read_text(), whole)
        self.assertIn(f"outlet drain, left: {last[2]} particles\n", done.stdout)
        self.assertEqual(call(BIN / "impinge-plot", self.out).returncode, 0)
        self.assertTrue((self.out / "flume_figures/outlets.png").exists())


class Run(System):
    def run_case(self, *words, ranks=2, code=0):
        done = impinge(QUICK, "--set", "output.directory=out", *words, cwd=self.directory, ranks=ranks)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def history(self):
        with open(self.directory / "out/jet60-quick_history.csv", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def snapshots(self):
        return sorted((self.directory / "out").glob("*_????????.vtkhdf"))

    def test_writes_snapshots_series_and_history(self):
        done = self.run_case("--set", "time.end=0.05", "--set", "output.interval=0.02", "--set",
                             "output.average_start=0.01", ranks=3)
        self.assertIn("iterations", done.stdout)
        self.assertIn("in - out - lost - stored = 0", done.stdout)
        history = self.history()
        self.assertEqual([int(row["step"]) for row in history], list(range(1, len(history) + 1)))
        self.assertEqual(float(history[-1]["t"]), 0.05)
        for row in history:
            self.assertEqual(int(row["in"]) - int(row["out"]) - int(row["fluid"]), 0)
            self.assertLessEqual(float(row["residual"]), 1e-6)
        snapshots = self.snapshots()
        self.assertEqual(len(snapshots), 4)
        self.assertEqual(snapshots[0].name, "jet60-quick_00000000.vtkhdf")
        with h5py.File(snapshots[-1]) as file:
            self.assertEqual(file.attrs["step"], int(history[-1]["step"]))
            self.assertEqual(file.attrs["time"], float(history[-1]["t"]))
            self.assertEqual(file.attrs["status"], b"finished")
            self.assertEqual(file.attrs["format_version"], 1)
            for name in ("dt", "case", "code_version", "petsc_version", "hdf5_version", "mpi_version"):
                self.assertIn(name, file.attrs)
            self.assertEqual(len(file["VTKHDF/NumberOfPoints"]), 3)
            points = file["VTKHDF/Points"]
            self.assertEqual(points.shape, (int(history[-1]["particles"]), 3))
            for name, (kind, unit) in POINT_DATA.items():
                data = file["VTKHDF/PointData"][name]
                self.assertEqual((data.dtype, data.attrs["unit"]), (kind, unit.encode()), name)
                self.assertEqual(len(data), len(points))
            self.assertEqual(len(np.unique(file["VTKHDF/PointData/id"])), len(points))
            self.assertEqual(set(file["VTKHDF/PointData/rank"][:]), {0, 1, 2})
            wall = file["wall"]
            self.assertAlmostEqual(wall.attrs["window_begin"], 0.01, delta=1e-12)
            self.assertEqual(wall.attrs["window_end"], file.attrs["time"])
            self.assertEqual(len(wall["mean_pressure"]), np.sum(file["VTKHDF/PointData/type"][:] == 2))
            # The case text in the file is a case by itself: it runs again.
            (self.directory / "again.toml").write_bytes(file.attrs["case"])
        self.assertEqual(impinge("again.toml", "--check", cwd=self.directory).returncode, 0)

        series = xml.etree.ElementTree.parse(self.directory / "out/jet60-quick.xmf")
        times = [float(time.get("Value")) for time in series.iter("Time")]
        self.assertEqual(len(times), 4)
        for item in series.iter("DataItem"):
            name, path = item.text.split(":")
            with h5py.File(self.directory / "out" / name) as file:
                shape = tuple(int(n) for n in item.get("Dimensions").split())
                self.assertEqual(file[path].shape, shape)

        listed = json.loads((self.directory / "out/jet60-quick.vtkhdf.series").read_text())
        self.assertEqual(listed["file-series-version"], "1.0")
        self.assertEqual([entry["time"] for entry in listed["files"]], times)
        self.assertEqual([entry["name"] for entry in listed["files"]], [path.name for path in snapshots])
        for entry in listed["files"]:
            reader = vtkHDFReader()
            reader.SetFileName(str(self.directory / "out" / entry["name"]))
            reader.Update()
            with h5py.File(self.directory / "out" / entry["name"]) as file:
                self.assertEqual(entry["time"], file.attrs["time"])
                self.assertEqual(reader.GetOutput().GetNumberOfPoints(), len(file["VTKHDF/Points"]))

        # A second run replaces the first.
        self.run_case("--set", "time.end=0.008")
        self.assertEqual(len(self.snapshots()), 2)

    @unittest.skipUnless(shutil.which("pvpython"), "needs ParaView (Debian's excludes the VTK of the other tests)")
    def test_paraview_opens_the_file_series(self):
        self.run_case("--set", "time.end=0.03", "--set", "output.interval=0.007")
        script = self.directory / "series.py"
        script.write_text(
            "import sys\n"
            "from paraview.simple import VTKHDFReader\n"
            "from paraview.servermanager import Fetch\n"
            "reader = VTKHDFReader(FileName=sys.argv[1])\n"
            "reader.UpdatePipelineInformation()\n"
            "for time in reader.TimestepValues:\n"
            "    reader.UpdatePipeline(time)\n"
            "    pressure = Fetch(reader).GetPointData().GetArray('pressure')\n"
            "    print(repr(time), pressure.GetNumberOfTuples(), repr(pressure.GetRange()[1]))\n"
        )
        done = call("pvpython", script, self.directory / "out/jet60-quick.vtkhdf.series")
        expected = []
        for path in self.snapshots():
            with h5py.File(path) as file:
                pressure = file["VTKHDF/PointData/pressure"][:]
                expected.append(f"{float(file.attrs['time'])!r} {len(pressure)} {float(pressure.max())!r}")
        self.assertEqual(len(expected), 6)
        self.assertEqual(done.stdout.splitlines(), expected, done.stderr)

    def test_output_falls_on_its_times(self):
        done = self.run_case("--set", "time.end=0.06", "--set", "output.interval=0.014", "--set",
                             "output.average_start=0.0333", "--set", "checkpoint.interval=0.025")
        self.assertIn("t 0.06/0.06 s (100 %)", done.stdout)

        def times_of(paths):
            for path in paths:
                with h5py.File(path) as file:
                    yield file.attrs["time"]

        self.assertEqual(list(times_of(self.snapshots())), [*(k * 0.014 for k in range(5)), 0.06])
        self.assertEqual(list(times_of(sorted((self.directory / "out").glob("*.checkpoint")))), [0.05, 0.06])
        with h5py.File(self.snapshots()[-1]) as file:
            self.assertAlmostEqual(file["wall"].attrs["window_begin"], 0.0333, delta=1e-12)
        # Between two times of output, the steps are equal.
        steps = [float(row["dt"]) for row in self.history() if 0.0333 < float(row["t"]) <= 3 * 0.014]
        for dt in steps:
            self.assertAlmostEqual(dt, (3 * 0.014 - 0.0333) / len(steps), delta=1e-12)
        self.assertEqual(self.history()[-1]["limit"], "target")
        # An end before the first whole step.
        done = self.run_case("--set", "time.end=3e-6")
        self.assertIn("(100 %)", done.stdout)
        self.assertEqual(float(self.history()[-1]["t"]), 3e-6)

    def test_vtk_reads_snapshots_also_with_an_empty_rank(self):
        tank = ROOT / "input/hydrostatic.toml"
        done = impinge(tank, "--set", "time.end=0.01", "--set", "output.average_start=0",
                       "--set", "output.directory=out", "--set", "tank.size=[0.06,0.06]",
                       "--set", "tank.fluid_height=0.04", cwd=self.directory, ranks=12)
        self.assertEqual(done.returncode, 0, done.stderr)
        path = self.snapshots()[-1]
        with h5py.File(path) as file:
            counts = file["VTKHDF/NumberOfPoints"][:]
            pressure = file["VTKHDF/PointData/pressure"][:]
        self.assertIn(0, counts)
        reader = vtkHDFReader()
        self.assertTrue(reader.CanReadFile(str(path)))
        reader.SetFileName(str(path))
        reader.Update()
        grid = reader.GetOutput()
        self.assertEqual(grid.GetNumberOfPoints(), sum(counts))
        self.assertEqual(grid.GetNumberOfCells(), sum(counts))
        data = grid.GetPointData()
        for name in POINT_DATA:
            self.assertTrue(data.HasArray(name), name)
        array = data.GetArray("pressure")
        self.assertEqual([array.GetValue(i) for i in range(len(pressure))], list(pressure))

    def test_long_paths(self):
        tank = ROOT / "input/hydrostatic.toml"
        words = ("--set", "tank.size=[0.06,0.06]", "--set", "tank.fluid_height=0.04", "--set", "checkpoint.steps=1",
                 "--set", "output.average_start=0", "--set", "time.end=1e-3")

        def path(length):
            text = "/".join(["d" * 200] * (length // 201 + 1))[:length]
            return text if text[-1] != "/" else text[:-1] + "d"

        for length, ranks in ((214, 0), (256, 2), (1000, 0), (3000, 2)):
            done = impinge(tank, *words, "--set", f"output.directory={path(length)}", cwd=self.directory, ranks=ranks)
            self.assertEqual(done.returncode, 0, f"{length}: {done.stderr}")
            done = impinge("--restart", path(length), "--set", "time.end=2e-3", cwd=self.directory, ranks=ranks)
            self.assertEqual(done.returncode, 0, f"{length}: {done.stderr}")
            self.assertEqual(len(list((self.directory / path(length)).glob("*.checkpoint"))), 2)
        for length in (4060, 4090):  # for the files, or for the directory itself
            done = impinge(tank, *words, "--set", f"output.directory={path(length)}", cwd=self.directory, ranks=2)
            self.assertEqual(done.returncode, 2, f"{length}: {done.stderr}")
            self.assertIn("File name too long", done.stderr)

    def test_the_series_is_xml_whatever_the_name(self):
        tank = ROOT / "input/hydrostatic.toml"
        for name in ("A&B <1>", 'a"b\'c', "&amp;", "]]>"):
            done = impinge(tank, "--set", "tank.size=[0.06,0.06]", "--set", "tank.fluid_height=0.04", "--set",
                           "output.average_start=0", "--set", "time.end=1e-3", "--set", "output.directory=out",
                           "--set", f"name={json.dumps(name)}", cwd=self.directory)
            self.assertEqual(done.returncode, 0, done.stderr)
            series = xml.etree.ElementTree.parse(self.directory / f"out/{name}.xmf")
            self.assertEqual({grid.get("Name") for grid in series.iter("Grid")}, {None, name})
            for item in series.iter("DataItem"):
                file, path = item.text.split(":")
                with h5py.File(self.directory / "out" / file) as snapshot:
                    self.assertIn(path, snapshot)

    def test_names_that_cannot_be_read_back_are_refused_at_the_start(self):
        def run(*words):
            done = subprocess.run([BIN / "impinge", *words], cwd=self.directory, capture_output=True, check=False)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(done.stderr.count(b"\n"), 1, done.stderr)
            return done.stderr

        case = self.case("time.end = 2e-3")
        latin = os.fsencode(self.directory) + b"/K\xfcvette.toml"
        os.rename(case, latin)
        self.assertIn(b"not UTF-8", run(latin))
        self.assertIn(b"not UTF-8", run(latin, "--set", "name=x", "--set", b"output.directory=\xe9t\xe9"))
        self.assertIn(b"no shell", run(latin, "--set", "name=x", "--set", "output.directory=~/out"))
        self.assertEqual([os.fsencode(path.name) for path in self.directory.iterdir()], [b"K\xfcvette.toml"])
        # With a name of its own, such a case file runs, and goes on.
        for words in ([latin, "--set", "name=x", "--set", "output.directory=out"],
                      ["--restart", "out", "--set", "time.end=4e-3", "--set", "output.average_start=0"]):
            done = subprocess.run([BIN / "impinge", *words], cwd=self.directory, capture_output=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        os.rename(self.directory / "out", os.fsencode(self.directory) + b"/\xe9t\xe9")
        self.assertIn(b"not UTF-8", run("--restart", b"\xe9t\xe9"))

    def test_divergence_is_exit_3_with_a_last_state_that_the_post_processing_opens(self):
        done = impinge(ROOT / "input/paper/jet60-A1.toml", "--set", "particles.spacing=0.02", "--set", "time.dt=8e-4",
                       "--set", "time.max_speed=6", "--set", "output.directory=out", cwd=self.directory, ranks=2)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertRegex(done.stderr, r"the run failed at step \d+, phase [\w ]+: ")
        with h5py.File(self.snapshots()[-1]) as file:
            self.assertEqual(file.attrs["status"], b"failed")
            self.assertIn(b"phase", file.attrs["message"])
        with open(self.directory / "out/jet60-A1_history.csv", encoding="utf-8") as file:
            steps = [int(row["step"]) for row in csv.DictReader(file)]
        self.assertIn(f"step {steps[-1]},", done.stderr)
        validated = call(BIN / "impinge-validate", "out", cwd=self.directory)
        self.assertEqual(validated.returncode, 0, validated.stderr)
        report = json.loads((self.directory / "out/validation/validation.json").read_text())
        self.assertEqual(report["status"], "failed")

    def test_an_iteration_limit_is_a_failed_solve(self):
        done = self.run_case("-ppe_ksp_max_it", "1", code=3)
        self.assertRegex(done.stderr, r"step 1, phase PPE solve: DIVERGED_ITS after 1 iterations")

    def test_petsc_options_choose_the_solver(self):
        for words in (["-ppe_pc_type", "jacobi"], ["-ppe_ksp_type", "gmres", "-ppe_pc_type", "bjacobi"],
                      ["-ppe_pc_type", "gamg", "-ppe_ksp_monitor"]):
            done = self.run_case("--set", "time.end=0.004", *words)
            self.assertEqual("KSP Residual norm" in done.stdout, "-ppe_ksp_monitor" in words)

    def test_a_petsc_option_may_concern_some_ranks_only(self):
        self.run_case("--set", "time.end=0.004", "-ppe_coarse_rows_per_rank", "1", "-ppe_coarse_pc_type", "telescope",
                      "-ppe_coarse_pc_telescope_reduction_factor", "2", "-ppe_coarse_telescope_pc_type", "hypre")

    def test_partitioner_and_log_stages(self):
        done = self.run_case("--set", "time.end=0.004", "--set", "parallel.partitioner=ptscotch", "-log_view")
        for stage in ("Predict", "Redistribute", "Neighbours", "Density", "PPE assembly", "PPE solve", "Correct"):
            self.assertIn(stage, done.stdout)

    def test_validation_measures_a_run(self):
        # The force swings between 2.7 and 0.4 of its value after such a start: average from its beginning.
        self.run_case("--set", "time.end=0.2", "--set", "jet.start=steady", "--set", "output.interval=0.05",
                      "--set", "output.average_start=0")
        done = call(BIN / "impinge-validate", "out", cwd=self.directory)
        self.assertEqual(done.returncode, 0, done.stderr)
        validation = self.directory / "out/validation"
        report = json.loads((validation / "validation.json").read_text())
        metrics = report["metrics"]
        self.assertEqual(metrics["particle_balance"], 0)
        self.assertLess(abs(metrics["force_ratio"] - 1), 0.5)
        self.assertLess(abs(metrics["film_h1"] - 1), 0.1)
        for name in ("wall_l2", "peak_pressure", "peak_x", "field_l2", "mean_field_l2", "velocity_rms",
                     "surface_rms_dp", "film_h2"):
            self.assertTrue(np.isfinite(metrics[name]), name)
        for name in ("pressure.png", "wall_pressure.png", "film_thickness.png", "ranks.png", "wall_pressure.csv",
                     "film_thickness.csv"):
            self.assertTrue((validation / name).stat().st_size > 0, name)

    def test_validation_measures_jets_of_scenes(self):
        # A quarter of the shipped cases' resolution, and the start alone: that all is found, finite and drawn.
        of_round_jets = {"wall_l2_near", "centre_x", "centre_y", "film_at_d", "film_at_1_5_d", "film_flux", "film_momentum",
                         "film_law_rms"}
        for name, target, none in (
            ("tilted-plate", "plate", {"sheet_speed", "plane_x", "plane_drift"}),
            ("wedge", "wedge", {"field_l2", "mean_field_l2", "velocity_rms", "surface_rms_dp", "plane_x", "plane_drift"}),
            ("opposed-jets", "jet", {"sheet_speed"}),
        ):
            out = self.directory / name
            done = impinge(ROOT / f"input/{name}/{name}.toml", "--set", "particles.spacing=0.02", "--set", "time.dt=1.6e-3",
                           "--set", "time.end=0.5", "--set", "output.average_start=0.4", "--set",
                           f"output.directory={out}")
            self.assertEqual(done.returncode, 0, done.stderr)
            done = call(BIN / "impinge-validate", out)
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads((out / "validation/validation.json").read_text())
            self.assertEqual(report["target"], target)
            metrics = report["metrics"]
            self.assertEqual({key for key, value in metrics.items() if value is None} - {"film_h1", "film_h2"},
                             none | of_round_jets, name)
            self.assertLess(abs(metrics["force_ratio"] - 1), 0.3)
            self.assertEqual(metrics["particle_balance"], 0)
            self.assertTrue((out / "validation/wall_pressure.png").stat().st_size > 0)
            self.assertEqual((out / "validation/pressure.png").exists(), target != "wedge")

    def test_validation_measures_a_round_jet(self):
        # Coarse, and the start alone: that all is found, finite and drawn.
        out = self.directory / "out"
        settings = ("particles.spacing=0.02", "time.dt=2e-3", "time.end=0.5", "output.average_start=0.3",
                    "output.interval=0.05", "domain.high=[0.42, 0.42, 0.4]", f"output.directory={out}")
        done = impinge(ROOT / "input/round-jet/round-jet.toml", *(word for text in settings for word in ("--set", text)))
        self.assertEqual(done.returncode, 0, done.stderr)
        done = call(BIN / "impinge-validate", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("flat_wall, 90 deg, D/dp = 5", done.stdout)
        report = json.loads((out / "validation/validation.json").read_text())
        self.assertEqual(report["target"], "flat_wall")
        self.assertEqual(len(report["frame"]["z"]), 3)
        metrics = report["metrics"]
        given = {"wall_l2", "wall_l2_near", "force_ratio", "force_scatter", "peak_pressure", "peak_x", "stagnation_mean",
                 "stagnation_scatter", "stagnation_ratio", "centre_x", "centre_y", "film_at_d", "film_at_1_5_d", "film_flux",
                 "particle_balance"}
        self.assertEqual({key for key, value in metrics.items() if value is not None}, given)
        self.assertEqual(metrics["particle_balance"], 0)
        for name in ("force_ratio", "stagnation_ratio", "film_at_d", "film_flux"):
            self.assertLess(abs(metrics[name] - 1), 0.4, name)
        for name in ("wall_pressure.png", "film_thickness.png", "wall_map.png", "wall_pressure.csv", "film_thickness.csv",
                     "wall_map.csv"):
            self.assertTrue((out / "validation" / name).stat().st_size > 0, name)
        self.assertEqual(call(BIN / "impinge-report", out).returncode, 0)
        self.assertIn("film_flux", (out / "round-jet_report.html").read_text())

    def test_validation_tells_which_jets_it_measures(self):
        out = self.directory / "out"
        done = impinge(ROOT / "input/drop/drop.toml", "--set", "time.end=0.01", "--set", f"output.directory={out}")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = call(BIN / "impinge-validate", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("it has 0 inlets. Measured are: ", done.stderr)

    def test_what_is_observed_goes_on_after_a_restart_and_is_drawn(self):
        path = ROOT / "tests/system/column.toml"
        names = [f"column_{kind}.csv" for kind in ("history", "probes", "gauges", "sections")]

        def run(*words):
            done = impinge(*words, cwd=self.directory, ranks=2)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

        def tables(out):
            return {name: (self.directory / out / name).read_text() for name in names[1:]}

        sampled = ["--set", "output.sample_interval=0.03", "--set", "checkpoint.steps=50"]
        run(path, "--set", "output.directory=whole", *sampled)
        # As if it had been killed after its last row.
        shutil.copytree(self.directory / "whole", self.directory / "parts")
        (self.directory / "parts/column_00000100.checkpoint").unlink()
        run("--restart", "parts")
        whole = tables("whole")
        steps = [int(line.split(",")[0]) for line in whole["column_sections.csv"].splitlines()[1:]]
        self.assertEqual(steps, [15, 30, 45, 50, 60, 75, 90, 100])
        self.assertTrue(whole["column_probes.csv"].startswith("step,t [s],p_floor [Pa],ux_floor [m/s],uy_floor [m/s]\n"))
        self.assertEqual(len(whole["column_probes.csv"].splitlines()), 7)
        self.assertGreater(float(whole["column_sections.csv"].split(",")[-1]), 0.01)
        self.assertEqual(tables("parts"), whole)
        # A restart does not change what is observed.
        refused = impinge("--restart", "parts", "--set", "time.end=0.3", "--set", "gauge[1].length=0.5", cwd=self.directory)
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn("gauge[1].length = 0.5: a restart cannot change this key", refused.stderr)

        done = call(BIN / "impinge-plot", "parts", cwd=self.directory)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        figures = ["gauges.png", "history.png", "pressure.png", "probes.png", "sections.png", "speed.png", "surface.png"]
        self.assertEqual(sorted(file.name for file in (self.directory / "parts/column_figures").iterdir()), figures)
        done = call(BIN / "impinge-plot", "parts", "--time", "0.01", cwd=self.directory)
        self.assertIn("column_figures/speed_00000000.png", done.stdout)
        for words, message in ((["--step", "3"], "no snapshot of step 3"), (["--name", "other"], "no snapshot of other")):
            done = call(BIN / "impinge-plot", "parts", *words, cwd=self.directory)
            self.assertEqual(done.returncode, 1)
            self.assertIn(message, done.stderr)
        # A new run sets all of it aside.
        self.assertEqual(call(BIN / "impinge-report", "parts", cwd=self.directory).returncode, 0)
        run(path, "--set", "output.directory=parts", "--set", "time.end=0.01")
        (aside,) = (self.directory / "parts").glob("column_before_*")
        for name in [*names, "column_figures", "column_report.html"]:
            self.assertTrue((aside / name).exists(), name)
        self.assertFalse((self.directory / "parts/column_figures").exists())
        self.assertEqual(len((self.directory / "parts/column_gauges.csv").read_text().splitlines()), 6)

    def test_a_report_without_figures_is_complete(self):
        self.run_case("--set", "time.end=0.01")
        for module in ("h5py", "matplotlib"):
            packages = self.directory / module
            packages.mkdir()
            (packages / f"{module}.py").write_text(f"raise ImportError('no {module}')")
            shutil.rmtree(self.directory / "out/validation", ignore_errors=True)
            done = call(BIN / "impinge-validate", "out", cwd=self.directory,
                        environment={**os.environ, "PYTHONPATH": str(packages)})
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"impinge-plot: no {module}; ", done.stderr)
            self.assertIn("failed; the report is complete\n", done.stderr)
            self.assertTrue((self.directory / "out/validation/validation.json").exists())
        # Another python3 on the PATH, without the packages, is no obstacle.
        empty = self.directory / "empty/bin"
        empty.mkdir(parents=True)
        (empty / "python3").symlink_to("/usr/bin/python3")
        (empty.parent / "pyvenv.cfg").write_text("home = /usr/bin\ninclude-system-site-packages = false\n")
        done = call(BIN / "impinge-validate", "out", cwd=self.directory,
                    environment={**os.environ, "PATH": f"{empty}:{os.environ['PATH']}"})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue((self.directory / "out/validation/pressure.png").exists())
        # A figure that cannot be drawn is an error.
        (self.directory / "out/validation/ranks.png").unlink()
        (self.directory / "out/validation/ranks.png").mkdir()
        done = call(BIN / "impinge-validate", "out", cwd=self.directory)
        self.assertEqual(done.returncode, 1, done.stderr)

    def test_of_several_processes_the_first_validates(self):
        self.run_case("--set", "time.end=0.01")
        alone = call(BIN / "impinge-validate", "out", "--no-figures", cwd=self.directory)
        together = call(BIN / "impinge-validate", "out", "--no-figures", cwd=self.directory, ranks=3)
        self.assertEqual((together.returncode, together.stdout), (0, alone.stdout))
        for rank, expected in (("0", alone.stdout), ("2", "")):
            done = call(BIN / "impinge-validate", "out", "--no-figures", cwd=self.directory,
                        environment={**os.environ, "PMI_SIZE": "4", "PMI_RANK": rank})
            self.assertEqual((done.returncode, done.stdout), (0, expected))

    def test_validation_names_a_snapshot_that_it_cannot_read(self):
        self.run_case("--set", "time.end=0.004")
        last = self.snapshots()[-1]
        sound = last.read_bytes()
        with h5py.File(self.directory / "foreign.h5", "w") as file:
            file["data"] = [1.0]
        with h5py.File(last, "r+") as file:
            del file["VTKHDF/PointData/velocity"]
        for text, reason in (
            (last.read_bytes(), "/VTKHDF/PointData/velocity"),
            (b"", "not an HDF5 file"),
            (b"x" * 1000, "not an HDF5 file"),
            (sound[:100], ""),
            (sound[: len(sound) // 2], ""),
            (sound[:-1], ""),
            ((self.directory / "foreign.h5").read_bytes(), "not a file of Impinge"),
        ):
            last.write_bytes(text)
            done = call(BIN / "impinge-validate", "out", "--no-figures", cwd=self.directory)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn(f"cannot read out/{last.name}: ", done.stderr)
            self.assertIn(reason, done.stderr)

    def test_files_of_the_first_version_are_read(self):
        old, new = self.directory / "old", self.directory / "new"
        shutil.copytree(ROOT / "tests/system/format_1", old)
        done = impinge("--restart", old, "--set", "time.end=0.03")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = impinge(ROOT / "tests/system/column.toml", "--set", "time.end=0.03", "--set", f"output.directory={new}")
        self.assertEqual(done.returncode, 0, done.stderr)
        places = []
        for run in (old, new):
            with h5py.File(sorted(run.glob("*.vtkhdf"))[-1]) as file:
                places.append(file["VTKHDF/Points"][:])
        np.testing.assert_allclose(*places, atol=2e-4)  # dp / 100: the scheme has changed since
        with open(old / "column_history.csv", newline="") as file:
            steps = [int(row["step"]) for row in csv.DictReader(file)]
        self.assertEqual(steps, list(range(1, len(steps) + 1)))
        self.assertGreater(len(steps), 10)

    def test_validation_refuses_what_is_no_run(self):
        done = call(BIN / "impinge-validate", self.directory)
        self.assertEqual(done.returncode, 2)
        self.assertIn(str(self.directory), done.stderr)


if __name__ == "__main__":
    if os.geteuid() == 0:
        os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    unittest.main(verbosity=2)
