#!/usr/bin/python3
"""Pictures of runs in three dimensions: the module impinge_space, impinge-plot and impinge-report.

Usage: space_test.py BIN_DIRECTORY [unittest options]."""

import base64
import io
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(BIN.parent / "share/impinge"))
import impinge  # noqa: E402
import impinge_space  # noqa: E402

# Water falls onto the floor of a box that turns, beside a sill that turns with it.
CASE = """
geometry = "scene"
dimension = 3
fluid.gravity = [0.0, 0.0, -9.81]
particles.spacing = 0.05
time = {end = 0.02, dt = 2e-3}
output.interval = 0.01
domain = {low = [-0.5, -0.5, -0.5], high = [1.3, 1.0, 1.1]}
[[fluid.region]]
shape = "box"
low = [0.0, 0.0, 0.0]
high = [0.3, 0.4, 0.3]
[[wall]]
name = "box"
shape = "box"
low = [0.0, 0.0, 0.0]
high = [0.8, 0.4, 0.5]
wet = "inside"
motion = "turn"
[[wall]]
name = "sill"
shape = "box"
low = [0.5, 0.1, 0.0]
high = [0.6, 0.3, 0.1]
motion = "turn"
[[motion]]
name = "turn"
type = "constant"
center = [0.4, 0.2, 0.0]
axis = [0.0, 1.0, 0.0]
spin = 1.0
velocity = [0.5, 0.0, 0.0]
"""


def call(*words, environment=None):
    return subprocess.run([*map(str, words)], capture_output=True, text=True, timeout=300, check=False, env=environment)


def lattice(*counts, spacing=1.0):
    return spacing * (np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3) + 0.5)


def volume(corners):
    """What triangles enclose whose corners turn left, seen from outside."""
    return np.linalg.det(corners).sum() / 6


class Surface(unittest.TestCase):
    def test_encloses_the_volume_of_a_sphere(self):
        for spacing in (1.0, 0.01):
            points = lattice(24, 24, 24, spacing=spacing) - 12 * spacing
            points = points[np.linalg.norm(points, axis=1) < 10 * spacing]
            corners, normals = impinge_space.isosurface(points, spacing)
            self.assertAlmostEqual(volume(corners) / (len(points) * spacing**3), 1, delta=0.03)
            out = corners / np.linalg.norm(corners, axis=2, keepdims=True)
            self.assertGreater(np.einsum("nij,nij->ni", out, normals).min(), 0.8)

    def test_lies_half_a_spacing_outside(self):
        corners, _ = impinge_space.isosurface(lattice(12, 12, 12), 1.0)
        face = corners[(np.abs(corners[..., :2] - 6) < 3).all(axis=(1, 2))][..., 2]  # below and above
        self.assertLess(np.minimum(np.abs(face), np.abs(face - 12)).max(), 0.15)
        self.assertLess(np.abs(corners - 6).max(), 6.15)  # no wall is flooded

    def test_shows_films_and_drops(self):
        corners, _ = impinge_space.isosurface(lattice(20, 20, 1), 1.0)
        self.assertAlmostEqual(volume(corners) / 400, 1, delta=0.2)
        self.assertGreater(volume(impinge_space.isosurface(lattice(1, 1, 1), 1.0)[0]), 0.1)
        self.assertEqual(len(impinge_space.isosurface(np.empty((0, 3)), 1.0)[0]), 0)

    def test_a_far_drop_does_not_fill_the_memory(self):
        points = np.concatenate((lattice(8, 8, 8), [[5000.0, 5000.0, 5000.0]]))
        corners, _ = impinge_space.isosurface(points, 1.0)
        self.assertLess(len(corners), 100_000)


class Drawing(unittest.TestCase):
    def setUp(self):
        box = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
        self.camera = impinge_space.Camera(box, np.array([[0.0, 0.0, 1.0]]), np.ones(1), np.array([0.0, 0.0, 1.0]))
        self.normals = np.tile(self.camera.axes[:, 2], (1, 3, 1))

    def triangle(self, depth):
        """A large one across the picture, towards the eye by a depth."""
        right, up, back = self.camera.axes.T
        return np.array([[-0.5 * right - 0.5 * up, 0.5 * right - 0.5 * up, 0.7 * up]]) + depth * back

    def middle(self, canvas):
        height, width, _ = canvas.picture().shape
        return canvas.picture()[height // 2, width // 2]

    def test_the_nearer_triangle_hides_the_other(self):
        for order in (0.3, -0.3), (-0.3, 0.3):
            canvas = impinge_space.Canvas(self.camera)
            for depth in order:
                canvas.add(self.triangle(depth), self.normals, np.broadcast_to([1.0, 0, 0] if depth > 0 else [0, 0, 1.0], (1, 3, 3)), 0.0)
            self.assertEqual(self.middle(canvas).tolist(), [1, 0, 0, 1])
            self.assertEqual(canvas.picture()[0, 0, 3], 0)

    def test_you_look_through_glass(self):
        for depth, seen in ((0.3, True), (-0.3, False)):
            canvas = impinge_space.Canvas(self.camera)
            canvas.add(self.triangle(0), self.normals, np.broadcast_to([1.0, 0, 0], (1, 3, 3)), 0.0)
            canvas.add_glass(self.triangle(depth), self.normals[:, 0])
            red, green, _, opacity = self.middle(canvas)
            self.assertEqual((opacity, green > 0), (1, seen))
            self.assertGreater(red, 0.9)

    def test_covers_each_sample_of_a_square_once(self):
        right, up, _ = self.camera.axes.T
        square = np.array([-0.4 * right - 0.4 * up, 0.4 * right - 0.4 * up, 0.4 * right + 0.4 * up, -0.4 * right + 0.4 * up])
        canvas = impinge_space.Canvas(self.camera)
        samples = np.concatenate([sample for _, sample, _ in canvas.fragments(*canvas.planes(square[[[0, 1, 2], [0, 2, 3]]]))])
        self.assertEqual(len(np.unique(samples)), len(samples))
        places = self.camera.project(square)[:, :2] * impinge_space.SAMPLES
        self.assertAlmostEqual(len(samples) / np.linalg.norm(places[1] - places[0]) / np.linalg.norm(places[2] - places[1]), 1, delta=0.01)

    def test_looks_at_the_wet_side(self):
        box = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
        for up in np.eye(3):
            for normal in (*np.eye(3), *-np.eye(3)):
                camera = impinge_space.Camera(box, normal[None], np.ones(1), up)
                self.assertGreater(camera.axes[:, 2] @ normal, 0.4 if abs(up @ normal) else 0.7)
                self.assertGreater(camera.axes[:, 1] @ up, 0.9)

    def test_finds_how_walls_have_moved(self):
        points, (c, s) = lattice(4, 3, 2), (np.cos(0.4), np.sin(0.4))
        turned = points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [1, 2, 3]
        rotation, shift = impinge_space.rigid_motion(points, turned)
        self.assertTrue(np.allclose(points @ rotation.T + shift, turned))
        self.assertAlmostEqual(np.linalg.det(rotation), 1)


class Cut(unittest.TestCase):
    def test_is_upright_along_the_longer_side(self):
        for gravity, counts, seen, across in (([0, 0, -9.81], (9, 4, 5), [0, 2], 1), ([0, 0, -9.81], (4, 9, 5), [1, 2], 0),
                                              ([0, 0, 0], (5, 5, 5), [0, 2], 1), ([0, 9.81, 0], (4, 5, 9), [2, 1], 0)):
            case = {"fluid": {"gravity": gravity}, "particles": {"spacing": 1.0}}
            cut = impinge.Cut(lattice(*counts), lattice(*counts), case)
            self.assertEqual((cut.seen, cut.across), (seen, across))
            held = lattice(*counts)[cut.holds(lattice(*counts))]
            layers = 2 - counts[across] % 2  # the middle one, or both beside the middle
            self.assertEqual(len(held), layers * len(lattice(*counts)) // counts[across])
        walls, case["fluid"]["gravity"] = np.array([[0.0, 0.0, 0.0], [9.0, 5.0, 1.0]]), [0, 0, -9.81]
        cut = impinge.Cut(lattice(2, 4, 4), walls, case)  # a column in a long tank
        self.assertEqual((cut.seen, cut.place), ([0, 2], 2.0))


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.root = pathlib.Path(temporary.name)
        cls.run_of("box", CASE)
        cls.run_of("tank", (ROOT / "input/hydrostatic-3d.toml").read_text(), "--set", "time.end=0.02", "--set", "output.interval=0.01")

    @classmethod
    def run_of(cls, name, text, *words):
        path = cls.root / f"{name}.toml"
        path.write_text(text)
        done = call(BIN / "impinge", path, "--set", f"output.directory={cls.root / name}", *words)
        assert done.returncode == 0, done.stderr

    def test_the_sides_of_a_plate_have_pressures_of_their_own(self):
        self.run_of("plate", """
            geometry = "scene"
            dimension = 3
            fluid.gravity = [0.0, 0.0, -9.81]
            particles.spacing = 0.05
            time = {end = 4e-3, dt = 2e-3}
            domain = {low = [-0.4, -0.4, -0.4], high = [0.8, 0.8, 0.8]}
            [[fluid.region]]
            shape = "box"
            low = [0.0, 0.0, 0.0]
            high = [0.4, 0.4, 0.4]
            [[wall]]
            name = "plate"
            shape = "polygon"
            points = [[-0.2, -0.2, 0.0], [0.6, -0.2, 0.0], [0.6, 0.6, 0.0], [-0.2, 0.6, 0.0]]
            wet = "both"
            """)
        run = impinge.Run(self.root / "plate")
        space = impinge_space.Space(run, run.snapshot())
        middle = np.linalg.norm(space.parts.mean(axis=1) - [0.2, 0.2, 0.0], axis=1) < 0.1
        above = space.part_normals[:, 2] > 0
        self.assertGreater(space.pressure[middle & above].min(), 100)
        self.assertEqual(np.abs(space.pressure[~above]).max(), 0)
        self.assertGreater(space.camera.axes[2, 2], 0)

    def plot(self, name, *words, environment=None):
        """What impinge-plot says on its error stream, and the pictures that it has drawn."""
        folder = self.root / name / f"{name}_figures"
        shutil.rmtree(folder, ignore_errors=True)
        done = call(BIN / "impinge-plot", self.root / name, *words, environment=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr, {path.stem: matplotlib.image.imread(path)[..., :3] for path in folder.glob("*.png")}

    def share(self, picture, *colour):
        """The share of pixels that are near to a colour, without the scale at the right."""
        picture = picture[:, : 3 * picture.shape[1] // 4]
        return np.mean(np.abs(picture - np.array(colour)).max(axis=-1) < 0.12)

    def test_draws_surface_and_walls(self):
        for name in ("box", "tank"):
            with self.subTest(name):
                errors, pictures = self.plot(name)
                self.assertEqual(errors, "")
                self.assertLessEqual({"pressure", "speed", "surface", "free_surface", "wall_pressure"}, set(pictures))
                for picture in (pictures["free_surface"], pictures["wall_pressure"]):
                    self.assertLess(self.share(picture, 1, 1, 1), 0.85)
                    self.assertGreater(min(picture.shape[:2]), 500)
                self.assertGreater(self.share(pictures["wall_pressure"], 0.8, 0.75, 0.2), 0.005)  # the floor, yellow
                self.assertGreater(self.share(pictures["wall_pressure"], 0.25, 0.05, 0.3), 0.03)  # dry walls, violet
                self.assertGreater(self.share(pictures["free_surface"], 0.72, 0.72, 0.71), 0.03)  # dry walls, grey

    def test_walls_stand_where_they_have_moved(self):
        run = impinge.Run(self.root / "box")
        last = run.snapshot()
        walls = impinge_space.Walls(run, last)
        self.assertEqual(len(walls.corners), 24)
        self.assertEqual(len(walls.edges), 24)  # 12 of each box
        particles = last.position[last.type == impinge.WALL]
        start = impinge_space.Walls(run, run.snapshot(step=0))
        self.assertGreater(np.abs(walls.corners - start.corners).max(), 0.2 * run.spacing)
        for corners, tolerance in ((walls.corners, 1e-4), (start.corners, 1.0)):
            away = np.abs(np.einsum("nk,pnk->pn", walls.normals if tolerance < 1 else start.normals, particles[:, None] - corners[:, 0])).min(axis=1)
            self.assertLess(away.max(), tolerance * run.spacing)
        self.assertGreater(away.max(), 0.1 * run.spacing)

    def test_slices_have_the_pictures_of_another_snapshot_beside_them(self):
        _, pictures = self.plot("box", "--step", 0)
        self.assertIn("free_surface_00000000", pictures)

    def test_tells_what_is_missing_and_draws_the_rest(self):
        packages = self.root / "packages"
        (packages / "skimage").mkdir(parents=True)
        (packages / "skimage/__init__.py").write_text("raise ImportError('no skimage')")
        without = {**os.environ, "PYTHONPATH": str(packages)}
        errors, pictures = self.plot("box", environment=without)
        self.assertRegex(errors, r"^impinge-plot: no skimage; .*python3-skimage.*\n$")
        self.assertLessEqual({"pressure", "speed", "surface", "history"}, set(pictures))
        self.assertNotIn("free_surface", pictures)
        done = call(BIN / "impinge-report", self.root / "tank", environment=without)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"^impinge-report: no skimage; .*python3-skimage.*\n$")

        scene = self.root / "box/box_scene.vtkhdf"
        kept = scene.rename(scene.with_suffix(".kept"))
        self.addCleanup(kept.rename, scene)
        errors, pictures = self.plot("box")
        self.assertRegex(errors, r"^impinge-plot: there is no .*box_scene.vtkhdf of this run; .*\n$")
        self.assertIn("free_surface", pictures)
        self.assertNotIn("wall_pressure", pictures)
        # Of a later --check with other walls.
        (self.root / "other").mkdir()
        (self.root / "other/box.toml").write_text(CASE.replace("high = [0.6, 0.3, 0.1]", "high = [0.65, 0.3, 0.1]"))
        done = call(BIN / "impinge", self.root / "other/box.toml", "--check", "--set", f"output.directory={self.root / 'box'}")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIsNone(impinge.Run(self.root / "box").scene)

    def test_the_page_has_the_pictures(self):
        done = call(BIN / "impinge-report", self.root / "box")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        page = (self.root / "box/box_report.html").read_text()
        for name in ("free surface", "wall pressure"):
            data = re.search(f'alt="{name}" src="data:image/png;base64,([^"]*)"', page)[1]
            picture = matplotlib.image.imread(io.BytesIO(base64.b64decode(data)))[..., :3]
            self.assertLess(self.share(picture, 1, 1, 1), 0.85)


if __name__ == "__main__":
    unittest.main()
