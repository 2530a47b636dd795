#!/usr/bin/python3
"""Compares the waves of a piston or of a flap with Biesel's and Stokes' theory."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402


def of(run):
    """Depth, stroke at the surface, frequency, wave number, and whether the maker is a flap."""
    depth, motion = run.case["fluid"]["region"][0]["high"][1], run.case["motion"][0]
    is_flap = motion["angle"] != 0
    stroke = 2 * (depth * np.tan(np.radians(abs(motion["angle"]))) if is_flap else motion["amplitude"][0])
    square = (2 * np.pi * motion["frequency"]) ** 2 * depth / -run.case["fluid"]["gravity"][1]
    kh = np.sqrt(square)
    for _ in range(100):  # k h tanh k h = w^2 h / g, by Newton
        kh -= (kh * np.tanh(kh) - square) / (np.tanh(kh) + kh / np.cosh(kh) ** 2)
    return depth, stroke, motion["frequency"], kh / depth, is_flap


def theory(run):
    """Amplitude of the waves far from the maker (Biesel, 1951), and that of Stokes' second harmonic [m]."""
    depth, stroke, _, k, is_flap = of(run)
    kh = k * depth
    part = 4 * np.sinh(kh) / (np.sinh(2 * kh) + 2 * kh)
    ratio = part / kh * (kh * np.sinh(kh) - np.cosh(kh) + 1) if is_flap else part * np.sinh(kh)
    a = ratio * stroke / 2
    return a, k * a**2 / 4 * np.cosh(kh) * (2 + np.cosh(2 * kh)) / np.sinh(kh) ** 3


def rows(run):
    depth, stroke, frequency, _, is_flap = of(run)
    a, second = theory(run)
    t, level = run.gauges["t"], run.gauges["near"] - depth
    late = t >= t[-1] - 3.0 / frequency
    t, level = t[late], level[late]
    name = "flap" if is_flap else "piston"
    crests = c.maxima(t, level, 0.7 / frequency)[1]
    troughs = -c.maxima(t, -level, 0.7 / frequency)[1]
    stokes = "Stokes, second order"
    return [
        c.row(f"{name}: wave height / stroke", 2 * c.harmonic(t, level, frequency)[0] / stroke, 2 * a / stroke,
              beat="1 to 2 % (measured, CIEM)", source="Biesel"),
        c.row(f"{name}: crest / depth", crests.mean() / depth, (a + second) / depth, source=stokes),
        c.row(f"{name}: trough / depth", troughs.mean() / depth, (second - a) / depth, source=stokes),
    ]


def draw(runs, figure):
    levels, lines = figure.subplots(2, 1, height_ratios=(1, 1.3))
    run = runs[-1]
    c.show_fluid(levels, run.snapshot(), run.spacing, facecolors="tab:blue")
    levels.set(title="piston or flap at the left, damping from x = 3.5 m on", ylabel="y [m]")
    for kind in (False, True):
        for run, colour in zip([run for run in runs if of(run)[4] is kind], c.COLOURS[2 * kind:]):
            depth, _, frequency, _, _ = of(run)
            name = ("flap" if kind else "piston") + ", " + c.label(run, SIZE)
            lines.plot(run.gauges["t"] * frequency, (run.gauges["near"] - depth) / depth, lw=0.9, color=colour, label=name)
            a, second = theory(run)
            for value in (a + second, second - a):
                lines.axhline(value / depth, color=colour, ls="--", lw=0.8)
    lines.set(xlabel="t / period", ylabel="level / depth, 3 depths away")
    lines.legend(loc="upper left", title="dashed: Stokes")


SIZE = ("h/dp", 0.4)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, height=4.5)
