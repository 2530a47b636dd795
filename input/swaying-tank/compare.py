#!/usr/bin/python3
"""Compares runs of the swaying tank with the experiment and with the linear theory: the level near the left wall.

--data FILE: the measured level over that at rest, columns t, eta [s, m]."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "Faltinsen et al. 2000"
LENGTH, DEPTH, AMPLITUDE, PERIOD, GAUGE = 1.73, 0.6, 0.032, 1.3, 0.05  # [m, m, m, s, m]
# The measured level over that at rest [m] every 0.25 s, read from the paper's figure 7; crests and its first trough.
AT = np.arange(1, 40) * 0.25
LEVEL = np.array([
    -0.014, -0.031, 0.001, 0.058, 0.070, -0.011, -0.078, -0.081, 0.021, 0.135, 0.101, -0.021, -0.091, -0.045, 0.038, 0.105,
    0.051, -0.027, -0.042, -0.014, 0.010, 0.008, 0.003, 0.022, 0.038, 0.020, -0.040, -0.067, -0.030, 0.062, 0.118, 0.043,
    -0.072, -0.072, 0.002, 0.109, 0.131, -0.015, -0.067,
])
CREST, TROUGH, TROUGH_AT = 0.142, -0.088, 1.93


def level(run):
    """t and the level over that at rest where the gauge on the tank is, between those of three fixed gauges."""
    t = run.gauges["t"]
    places = [gauge["point"][0] for gauge in run.case["gauge"]]
    levels = np.stack([run.gauges[gauge["name"]] for gauge in run.case["gauge"]], 1)
    gauge = GAUGE + AMPLITUDE * np.cos(2 * np.pi * t / PERIOD)
    return t, np.array([np.interp(x, places, row) for x, row in zip(gauge, levels)]) - DEPTH


def theory(t):
    """The linear modes of a tank that sways from rest, each a driven oscillator: the level at the gauge."""
    omega, eta = 2 * np.pi / PERIOD, np.zeros_like(t)
    for n in range(1, 20, 2):
        k = n * np.pi / LENGTH
        own = np.sqrt(9.81 * k * np.tanh(k * DEPTH))
        drive = -4 / (n * np.pi) * np.tanh(k * DEPTH) * AMPLITUDE * omega**2
        eta += drive / (own**2 - omega**2) * (np.cos(omega * t) - np.cos(own * t)) * np.cos(k * GAUGE)
    return eta


def first_trough(t, eta):
    """The time of the trough before the first large crest."""
    near = (t > 1.5) & (t < 2.3)
    return t[near][eta[near].argmin()]


def rows(run, data):
    t, eta = level(run)
    lag = TROUGH_AT - first_trough(t, eta)
    at, measured = (np.sort(data["t"]), data["eta"][np.argsort(data["t"])]) if data else (AT, LEVEL)
    use = at <= t[-1]
    difference = np.interp(at[use] - lag, t, eta) - measured[use]
    near = (t > 2.2) & (t < 3.0)
    modes = theory(t)
    return [
        c.row("level, rms error over the crest, first trough aligned", np.sqrt((difference**2).mean()), 0.0, scale=CREST,
              source=SOURCE),
        c.row("shift of the clock [s]", lag),
        c.row("first large crest [m]", eta[near].max(), CREST, source=SOURCE),
        c.row("first large trough [m]", eta[(t > 1.5) & (t < 2.3)].min(), TROUGH, source=SOURCE),
        c.row("level, rms difference from the linear theory to 2.2 s, over the crest",
              np.sqrt(((eta - modes)[t < 2.2] ** 2).mean()), 0.0, scale=CREST),
    ]


def draw(runs, figure, data):
    axes = figure.subplots()
    for run, colour in zip(runs, c.COLOURS):
        axes.plot(*level(run), color=colour, lw=1, label=c.label(run, SIZE))
    t = np.linspace(0, 10, 1001)
    axes.plot(t, theory(t), "0.6", lw=0.8, label="linear theory")
    axes.plot(AT, LEVEL, "ko", ms=4, label="measured")
    if data:
        axes.plot(data["t"], data["eta"], "k.", ms=2)
    axes.set(title="level over that at rest [m]", xlabel="t [s]", xlim=(0, 10), ylim=(-0.16, 0.24))
    axes.legend(fontsize=8, ncols=2)


SIZE = ("depth/dp", DEPTH)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured level: t, eta")
