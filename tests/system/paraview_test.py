#!/usr/bin/python3
"""Draws small runs by pvbatch with impinge_paraview.py. Usage: paraview_test.py BIN_DIRECTORY [unittest options]

Needs ParaView, and xvfb-run where ParaView cannot draw without a display, as Debian's."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
SCRIPT = BIN.parent / "share/impinge/impinge_paraview.py"
DISPLAY = ["xvfb-run", "-a"] if shutil.which("xvfb-run") else []


def call(*words):
    return subprocess.run([*map(str, words)], capture_output=True, text=True, timeout=200, check=False)


class ParaView(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def picture_of(self, case):
        directory, path = self.folder / "run", self.folder / "picture.png"
        settings = ("time.end=0.05", "output.average_start=0", f"output.directory={directory}")
        done = call(BIN / "impinge", ROOT / case, *(word for setting in settings for word in ("--set", setting)))
        self.assertEqual(done.returncode, 0, done.stderr)
        done = call(*DISPLAY, "pvbatch", SCRIPT, directory, path)
        self.assertEqual(done.returncode, 0, done.stderr)
        picture = matplotlib.image.imread(path)[..., :3]
        self.assertEqual(picture.shape, (800, 1280, 3))
        return picture

    def share(self, picture, red, green, blue):
        """Share of the pixels that are near to a colour."""
        return np.mean(np.abs(picture - np.array([red, green, blue])).max(axis=-1) < 0.1)

    def test_a_plane_run_shows_pressure_and_surface(self):
        picture = self.picture_of("input/hydrostatic.toml")
        self.assertGreater(self.share(picture, 0.99, 0.91, 0.14), 0.005)  # the bright end of viridis, at the bottom
        self.assertGreater(self.share(picture, 0.13, 0.57, 0.55), 0.005)  # its middle
        self.assertGreater(self.share(picture, 0.84, 0.37, 0.0), 0.002)  # the free surface

    def test_a_run_in_space_shows_the_pressure_inside_and_on_the_walls(self):
        red, green, blue = np.moveaxis(self.picture_of("input/hydrostatic-3d.toml"), -1, 0)
        self.assertGreater(np.mean((green > red + 0.05) & (blue > red + 0.05)), 0.02)  # teal, the middle, also in the shade
        self.assertGreater(np.mean((red > green + 0.1) & (blue > green + 0.15) & (blue < 0.5)), 0.02)  # violet, the dry walls

    def test_a_directory_without_a_run_is_told(self):
        done = call(*DISPLAY, "pvbatch", SCRIPT, self.folder, self.folder / "picture.png")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("has 0 .xmf files; 1 is needed", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
