#!/usr/bin/python3
"""Compares the speed and the height of a solitary wave with theory."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

HEIGHT = 0.3  # that the paddle is to make [m]


def of(run):
    """Depth and gravity of a run."""
    return run.case["fluid"]["region"][0]["high"][1], -run.case["fluid"]["gravity"][1]


def speed(height, depth, g):
    """Of a wave of this height [m/s] (Grimshaw, J. Fluid Mech. 46 (1971) 611)."""
    e = height / depth
    return np.sqrt(g * depth * (1 + e - e**2 / 20 - 3 * e**3 / 70))


def profile(x, height, depth):
    """The level of the wave at x from its crest, to the first order [m]."""
    return height / np.cosh(np.sqrt(3 * height / (4 * depth**3)) * x) ** 2


def crests(run):
    """Places, times and heights of the crest as it passes the gauges, by a parabola through levels above 0.95 of it."""
    depth, _ = of(run)
    found = []
    for gauge in run.case["gauge"]:
        t, level = run.gauges["t"], run.gauges[gauge["name"]] - depth
        top = level.argmax()
        near = (level > 0.95 * level[top]) & (np.abs(t - t[top]) < 0.5)
        bend, slope, value = np.polyfit(t[near] - t[top], level[near], 2)
        found.append((gauge["point"][0], t[top] - slope / (2 * bend), value - slope**2 / (4 * bend)))
    return np.array(found).T


def rows(run):
    depth, g = of(run)
    x, t, height = crests(run)
    exact = speed(height[[0, -1]].mean(), depth, g)
    return [
        c.row("speed of the crest over 20 h / sqrt(g h)", (x[-1] - x[0]) / (t[-1] - t[0]) / np.sqrt(g * depth),
              exact / np.sqrt(g * depth), beat="-0.2 % (REEF3D)", source="theory to third order, of the mean height"),
        c.row("height of the crest after 20 h, over that before", height[-1] / height[0], 1.0, beat="-1.1 % (REEF3D)"),
        c.row("height of the crest 8 h from the paddle / h", height[0] / depth, HEIGHT / depth, source="of the paddle's motion, first order"),
    ]


def draw(runs, figure):
    axes = figure.subplots()
    for run, colour in zip(runs, c.COLOURS):
        depth, g = of(run)
        x, t, height = crests(run)
        for k, gauge in enumerate(run.case["gauge"]):
            axes.plot(run.gauges["t"], run.gauges[gauge["name"]] - depth, lw=0.9, color=colour, label=None if k else c.label(run, SIZE))
            times = np.linspace(t[k] - 1.5, t[k] + 1.5, 100)
            way = speed(height[k], depth, g) * (times - t[k])
            axes.plot(times, profile(way, height[0], depth), "k--", lw=0.8,
                      label="theory, height at the first gauge" if run is runs[-1] and k == 0 else None)
    axes.set(xlabel="t [s]", ylabel="level at x = 8, 18, 28 h [m]", xlim=(0, None))
    axes.legend(loc="upper left")


SIZE = ("h/dp", 1.0)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, height=2.8)
