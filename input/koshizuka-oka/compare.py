#!/usr/bin/python3
"""Compares runs of the collapsing column with the experiment and with the first MPS code: the front on the floor.

--data FILE: the measured front, columns series, T, Z, of the series whose word begins with "experiment"; or outlines of the
experiment, columns t, x, z [s, m, m], which are drawn over snapshots."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "Koshizuka & Oka 1996"
L = 0.146  # width of the column [m]
# T = t sqrt(2 g / L), the measured front Z = x / L; and by how much the front of the paper's MPS and of SOLA-VOF (Hirt &
# Nichols 1981) leads, at four of them.
FRONT = np.array([[0.381, 1.111], [0.769, 1.252], [1.153, 1.505], [1.537, 1.892], [1.935, 2.241], [2.323, 2.615],
                  [2.719, 3.003], [3.096, 3.624]])
LEADS = {1.153: (0.20, 0.22), 1.935: (0.31, 0.35), 2.323: (0.45, 0.48), 2.719: (0.63, 0.70)}
LARGEST_SHIFT = 0.35  # of the clock: the gate opens in a finite time
# Outlines in the experiment's photographs at times [s]: x and height [m].
OUTLINES = {
    0.2: [[0.000, 0.168], [0.049, 0.169], [0.097, 0.166], [0.143, 0.154], [0.182, 0.126], [0.222, 0.098], [0.259, 0.067],
          [0.303, 0.050], [0.351, 0.046], [0.399, 0.040], [0.406, 0.005]],
    0.4: [[0.000, 0.085], [0.087, 0.081], [0.159, 0.074], [0.213, 0.065], [0.298, 0.047], [0.385, 0.038], [0.473, 0.032],
          [0.546, 0.068], [0.561, 0.154], [0.572, 0.241], [0.583, 0.326]],
    0.6: [[0.000, 0.039], [0.074, 0.040], [0.152, 0.038], [0.229, 0.039], [0.306, 0.034], [0.384, 0.029], [0.461, 0.035],
          [0.511, 0.084], [0.526, 0.160], [0.521, 0.235], [0.581, 0.284]],
    0.8: [[0.002, 0.042], [0.063, 0.040], [0.124, 0.039], [0.183, 0.041], [0.237, 0.059], [0.294, 0.059], [0.351, 0.064],
          [0.401, 0.099], [0.459, 0.117], [0.520, 0.125], [0.581, 0.127]],
}


def front(run):
    """T and the front over L."""
    return run.gauges["t"] * np.sqrt(2 * 9.81 / L), run.gauges["front"] / L


def measurements(data):
    """The measured front in T: of the table above, or that of `data`, if it has one."""
    return data.of(("T", "Z"), series="experiment") if data and "Z" in data else FRONT


def shift(t, z, measured):
    """The shift of the clock for which the front differs least, by the mean of its relative error; and that error."""
    shifts = np.linspace(-LARGEST_SHIFT, LARGEST_SHIFT, 141)
    errors = [np.abs(np.interp(measured[:, 0] - s, t, z) / measured[:, 1] - 1).mean() for s in shifts]
    return shifts[np.argmin(errors)], min(errors)


def rows(run, data):
    t, z = front(run)
    measured = measurements(data)
    lag, error = shift(t, z, measured)
    lines = [c.row("front, mean error, clock shifted", error, 0.0, scale=1.0, source=SOURCE),
             c.row("shift of the clock in T", lag)]
    for when, (mps, vof) in LEADS.items():
        ahead = np.interp(when, t, z) - np.interp(when, *measured.T)
        lines.append(c.row(f"lead of the front over the measured, T = {when:.4g}, over L", ahead, (0.0, mps), scale=1.0,
                           beat=f"first MPS {mps:.2f}, SOLA-VOF {vof:.2f}", source=SOURCE))
    return lines


def draw(runs, figure, data):
    grid = figure.add_gridspec(2, 3)
    curve = figure.add_subplot(grid[:, 0])
    for run, colour in zip(runs, c.COLOURS):
        t, z = front(run)
        curve.plot(t, z, color=colour, label=c.label(run, SIZE))
    curve.plot(*measurements(data).T, "ko", ms=4, label="measured")
    at = np.array(list(LEADS))
    curve.plot(at, np.interp(at, *FRONT.T) + np.array(list(LEADS.values()))[:, 0], "k+", label="first MPS code")
    curve.set(title="front / L", xlabel="t sqrt(2g/L)", xlim=(0, 3.3), ylim=(0.9, 4.1))
    curve.legend()
    run = runs[-1]
    for k, (when, outline) in enumerate(OUTLINES.items()):
        axes = figure.add_subplot(grid[k // 2, 1 + k % 2])
        c.show_fluid(axes, run.snapshot(time=when), run.spacing, color="tab:cyan")
        if data and "z" in data:
            use = np.abs(data["t"] - when) < 1e-6
            axes.plot(data["x"][use], data["z"][use], "k.", ms=2)
        else:
            axes.plot(*np.array(outline).T, "ko", ms=4, mfc="none")
        axes.set(title=f"t = {when:g} s", xlim=(-0.01, 0.594), ylim=(-0.01, 0.45))


SIZE = ("L/dp", L)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured front: series, T, Z; or outlines: t, x, z", height=4.5)
