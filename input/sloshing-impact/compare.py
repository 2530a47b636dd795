#!/usr/bin/python3
"""Compares runs of the rolling tank with SPHERIC test 10: times and pressures of four impacts of the water on a wall.

--data FILE: the measured pressure's smallest and largest values, columns t, p_min, p_max [s, Pa, Pa]."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "SPHERIC test 10"
DEPTH = 0.093  # [m]
# When the pressure is largest in the published record [s]; mean and standard deviation of the largest pressures in 100
# repeats, and the smallest and the largest of them [Pa].
TIMES = (2.375, 4.067, 5.672, 7.303)
PEAKS = ((3710.0, 730.0, 2210.0, 5930.0), (4820.0, 1500.0, 2940.0, 12980.0), (4690.0, 1710.0, 2510.0, 13120.0),
         (4640.0, 1320.0, 2480.0, 10440.0))
# The smooth part before the first impact, and behind each: t [s] and p [Pa] of the published record.
SMOOTH = np.array([[0.5, 134], [0.8, 324], [1.0, 340], [1.2, 176], [2.6, 708], [2.7, 840], [4.3, 474], [4.4, 654], [5.9, 603],
                   [6.0, 733], [7.6, 524], [7.65, 651]])
BEAT = "DualSPHysics: 4 of 4 peaks, mean error 23 %"


def pressure(run):
    """t and the pressure, as its mean over dp/sqrt(g depth): the time in which the bore passes a spacing."""
    t, p = run.probes["t"], run.probes["p_1"]
    width = run.spacing / np.sqrt(9.81 * DEPTH)
    impulse = np.concatenate([[0.0], np.cumsum(p[1:] * np.diff(t))])  # a step's pressure holds since the step before
    return t, (np.interp(t + width / 2, t, impulse) - np.interp(t - width / 2, t, impulse)) / width


def rows(run, data):
    t, p = pressure(run)
    lines, errors = [], []
    for k, (when, (mean, deviation, *_)) in enumerate(zip(TIMES, PEAKS), 1):
        near = np.abs(t - when) < 0.3
        largest = np.flatnonzero(near)[p[near].argmax()]
        lines.append(c.row(f"impact {k}, time less the measured [s]", t[largest] - when, (-0.03, 0.03), scale=1.0,
                           source=SOURCE))
        lines.append(c.row(f"impact {k}, largest pressure [Pa], mean over dp/sqrt(g h); +- 2 sd", p[largest],
                           (mean - 2 * deviation, mean + 2 * deviation), source=SOURCE))
        lines.append(c.row(f"impact {k}, largest pressure of a step [Pa]", run.probes["p_1"][near].max(),
                           (mean - 2 * deviation, mean + 2 * deviation), source=SOURCE))
        errors.append(abs(p[largest] / mean - 1))
    lines.append(c.row("largest pressures, mean over dp/sqrt(g h), mean error", np.mean(errors), 0.0, scale=1.0, beat=BEAT,
                       source=SOURCE))
    at, measured = SMOOTH.T
    mine = np.array([p[np.abs(t - when) < 0.025].mean() for when in at])
    for name, use in (("before the first impact", at < 2), ("behind the impacts", at > 2)):
        lines.append(c.row(f"pressure {name}, mean error over 840 Pa", np.abs(mine - measured)[use].mean(), 0.0, scale=840.0,
                           source=SOURCE))
    if data:
        near = np.interp(data["t"], t, p)
        outside = np.maximum(0, np.maximum(data["p_min"] - near, near - data["p_max"]))[data["t"] <= t[-1]]
        lines.append(c.row("mean distance from the measured envelope [Pa]", outside.mean(), 0.0, scale=840.0, source=SOURCE))
    return lines


def draw(runs, figure, data):
    whole, *near = figure.subplot_mosaic([["whole"] * 4, ["1", "2", "3", "4"]]).values()
    for run, colour in zip(runs, c.COLOURS):
        t, p = pressure(run)
        for axes in (whole, *near):
            axes.plot(t, p / 1000, lw=0.8, color=colour, label=c.label(run, SIZE))
    for k, (axes, when, (mean, deviation, *_)) in enumerate(zip(near, TIMES, PEAKS), 1):
        axes.set(xlim=(when - 0.15, when + 0.45), title=f"impact {k}", xlabel="t [s]")
        for here in (whole, axes):
            here.errorbar(when, mean / 1000, 2 * deviation / 1000, fmt="ko", ms=4, capsize=3,
                          label="largest, mean and two deviations of 100 repeats" if k == 1 else None)
    for axes in (whole, *near):
        axes.plot(SMOOTH[:, 0], SMOOTH[:, 1] / 1000, "k+", label="the published record")
        axes.set_ylim(-0.4, 8.5)
        if data:
            axes.fill_between(data["t"], data["p_min"] / 1000, data["p_max"] / 1000, color="black", alpha=0.3, lw=0)
    whole.set(title="pressure [kPa] at the sensor", xlim=(0, 7.8))
    whole.legend(fontsize=8, loc="upper left")


SIZE = ("h/dp", DEPTH)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured pressure: t, p_min, p_max", height=5.0)
