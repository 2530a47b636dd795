#!/usr/bin/python3
"""Compares runs of the dam break against a column with the experiment: the force on the column.

--data FILE: the measured series, columns series, t, value; that of the force [s, N] has the word F."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "Yeh & Petroff"
# The force on the column along the tank [N] at times since it passes 2 N [s], read from the figures of Raad & Bidoae 2005;
# its first peak, its plateau 0.15 to 0.25 s behind.
FORCE = np.array([[0.0, 2], [0.053, 33.1], [0.081, 31.0], [0.255, 18.7], [0.586, 11.4], [0.847, 5.8], [1.086, -6.0],
                  [1.212, -9.2], [1.349, -6.0], [1.506, -4.4]])
PEAK, PLATEAU = 33.1, 19.0
WIDTH = 0.12  # of the column [m]


def force(run):
    """Time since the force passes 2 N and the force, as its mean over dp/sqrt(2 g 0.3 m), in which the front passes one."""
    t, f = run.forces["t"], run.forces["fx_column"]
    width = run.spacing / np.sqrt(2 * 9.81 * 0.3)
    impulse = np.concatenate([[0.0], np.cumsum(f[1:] * np.diff(t))])
    f = (np.interp(t + width / 2, t, impulse) - np.interp(t - width / 2, t, impulse)) / width
    return t - t[(f > 2.0).argmax()], f


def measurements(data):
    """The measured force by the time since it passes 2 N: of the table above, or that of `data`."""
    if not data:
        return FORCE
    t, f = data.of(("t", "value"), series="F").T
    return np.stack([t - t[(f > 2.0).argmax()], f], 1)


def rows(run, data):
    t, f = force(run)
    plateau = (t > 0.15) & (t < 0.25)
    measured = measurements(data)
    use = (measured[:, 0] >= 0) & (measured[:, 0] <= t[-1])
    difference = np.interp(measured[use, 0], t, f) - measured[use, 1]
    kinetic = run.history["kinetic_energy"]
    return [
        c.row("first peak of the force [N], mean over dp/sqrt(2 g h)", f[(t > 0) & (t < 0.15)].max(), PEAK, source=SOURCE),
        c.row("plateau, 0.15 to 0.25 s behind its beginning [N]", f[plateau].mean(), PLATEAU, source=SOURCE),
        c.row(f"force, mean error to {measured[use, 0].max():.2g} s, over its first peak", np.abs(difference).mean(), 0.0,
              scale=PEAK, source=SOURCE),
        c.row("largest rise of the kinetic energy in a step, over itself", (kinetic[50:] / kinetic[49:-1]).max() - 1, 0.0,
              scale=1.0),
    ]


def draw(runs, figure, data):
    axes = figure.subplots()
    for run, colour in zip(runs, c.COLOURS):
        axes.plot(*force(run), lw=0.8, color=colour, label=c.label(run, SIZE))
    axes.plot(*measurements(data).T, "ko", ms=2 if data else 4, label="measured")
    axes.set(title="force on the column [N]", xlabel="t since the bore meets the column [s]", xlim=(-0.1, 1.7), ylim=(-25, 60))
    axes.legend()


SIZE = ("width of the column/dp", WIDTH)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured series: series, t, value")
