#!/usr/bin/python3
"""Compares the level in a tank that sways with linear theory."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402


def of(run):
    """Length and depth of the water, amplitude and angular frequency of the tank, gravity."""
    region, motion = run.case["fluid"]["region"][0], run.case["motion"][0]
    length, depth = np.subtract(region["high"], region["low"])
    return length, depth, motion["amplitude"][0], 2 * np.pi * motion["frequency"], -run.case["fluid"]["gravity"][1]


def exact(run, t):
    """The level above the depth at the gauge: eta = sum of b_n cos(n pi x/L), n odd, x from the left wall, with

    b_n'' + w_n^2 b_n = (4/(n pi)) tanh(n pi h/L) X'',  w_n^2 = g (n pi/L) tanh(n pi h/L),  X = A cos(w t), b_n = b_n' = 0 at first.
    """
    L, h, A, w, g = of(run)
    n = np.arange(1, 40, 2)
    thick = np.tanh(n * np.pi * h / L)
    own = np.sqrt(g * n * np.pi / L * thick)
    size = 4 / (n * np.pi) * thick * -A * w**2 / (own**2 - w**2)
    x = run.case["gauge"][0]["point"][0] - A * np.cos(w * t)
    return ((np.cos(w * t[:, None]) - np.cos(np.outer(t, own))) * size * np.cos(np.outer(x, n * np.pi / L))).sum(axis=1)


def rows(run):
    _, h, _, _, _ = of(run)
    t, level = run.gauges["t"], run.gauges["left"] - h
    theory = exact(run, t)
    crest = theory.max()
    k = theory.argmax()
    near = np.abs(t - t[k]) < 0.3
    source = "linear theory"
    return [
        c.row("highest level over the depth [mm]", 1000 * level.max(), 1000 * crest, source=source),
        c.row("its time [s]", t[near][level[near].argmax()], t[k], source=source),
        c.row("rms error of the level / highest level", np.sqrt(((level - theory) ** 2).mean()) / crest, 0.0, scale=1.0, source=source),
    ]


def draw(runs, figure):
    axes = figure.subplots()
    for run, colour in zip(runs, c.COLOURS):
        t = run.gauges["t"]
        axes.plot(t, 1000 * (run.gauges["left"] - of(run)[1]), lw=0.9, color=colour, label=c.label(run, size))
    axes.plot(t, 1000 * exact(run, t), "k--", lw=0.9, label="linear theory")
    axes.set(xlabel="t [s]", ylabel="level 0.05 m from the wall [mm]")
    axes.legend(loc="upper right", ncols=3)


def size(run):
    return "h/dp", of(run)[1]


if __name__ == "__main__":
    c.main(__doc__, rows, draw, size, height=2.8)
