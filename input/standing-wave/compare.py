#!/usr/bin/python3
"""Compares runs of a standing wave with theory: its period, and the energy that it loses."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

DEPTH, AMPLITUDE = 1.0, 0.05  # of the case [m]; the wave number is pi / DEPTH


def growth(gravity, viscosity):
    """The complex rate s of a free wave exp(s t) over a bottom that slips [1/s] (Lamb, Hydrodynamics, art. 349):

    (s + 2 nu k^2)^2 + g k tanh(k H) = 4 nu^2 k^3 m tanh(k H) / tanh(m H),  m^2 = k^2 + s / nu. By secants.
    """
    k = np.pi / DEPTH
    square = gravity * k * np.tanh(k * DEPTH)
    if viscosity == 0:
        return 1j * np.sqrt(square)

    def off(s):
        m = np.sqrt(k**2 + s / viscosity)
        return (s + 2 * viscosity * k**2) ** 2 + square - 4 * viscosity**2 * k**3 * m * np.tanh(k * DEPTH) / np.tanh(m * DEPTH)

    old, new = 1j * np.sqrt(square), 1j * np.sqrt(square) - 2 * viscosity * k**2
    for _ in range(30):
        if off(new) == off(old):
            break
        old, new = new, new - off(new) * (new - old) / (off(new) - off(old))
    return new


def of(run):
    """Gravity, viscosity and the complex rate of a run's wave."""
    fluid = run.case["fluid"]
    return -fluid["gravity"][1], fluid["viscosity"], growth(-fluid["gravity"][1], fluid["viscosity"])


def maxima(run):
    """Times and values of the maxima of the kinetic energy: two in a period."""
    return c.maxima(run.history["t"], run.history["kinetic_energy"], 0.8 * np.pi / of(run)[2].imag)


def rows(run):
    g, viscosity, rate = of(run)
    t, energy = maxima(run)
    slope = np.polyfit(t, np.log(energy), 1)[0]
    T = 2 * np.pi / rate.imag
    words = "inviscid" if viscosity == 0 else f"Re {DEPTH * np.sqrt(g * DEPTH) / viscosity:.0f}"
    lines = [c.row(f"{words}: period sqrt(g/H)", 2 * c.period(t) * np.sqrt(g / DEPTH),
                   T * np.sqrt(g / DEPTH) * (1 + (np.pi * AMPLITUDE / DEPTH) ** 2 / 8 * (viscosity == 0)),
                   source="linear theory" if viscosity else "theory to second order")]
    if viscosity == 0:
        lines.append(c.row(f"{words}: energy lost in a period", 1 - np.exp(slope * T), 0.0, scale=1.0,
                           beat="9 % (lattice Boltzmann, 330 cells in a wave)"))
        lines.append(c.row(f"{words}: nu of as much loss / H sqrt(g H)", -slope / (4 * (np.pi / DEPTH) ** 2) / np.sqrt(g * DEPTH**3)))
    else:
        span = 20 * np.sqrt(DEPTH / g)
        lines.append(c.row(f"{words}: energy left after t sqrt(g/H) = 20", np.exp(slope * span), np.exp(2 * rate.real * span),
                           source="linear theory"))
    return lines


def draw(runs, figure):
    shape, inviscid, viscous = figure.subplots(1, 3, width_ratios=(0.8, 1.2, 1.2))
    run = runs[-1]
    discs = c.show_fluid(shape, run.snapshot(run.steps[0]), run.spacing, limits=(0.0, 1000 * of(run)[0] * DEPTH))
    discs.set_array(None)
    discs.set_facecolor("tab:blue")
    shape.set(title="start", xlabel="x [m]", ylabel="y [m]")
    for panel, chosen in ((inviscid, [run for run in runs if of(run)[1] == 0]), (viscous, [run for run in runs if of(run)[1] > 0])):
        for run, colour in zip(chosen, c.COLOURS):
            g, _, rate = of(run)
            t, energy = maxima(run)
            unit = np.sqrt(DEPTH / g)
            panel.plot(run.history["t"] / unit, run.history["kinetic_energy"] / energy[0], lw=0.7, color=colour, label=c.label(run, SIZE))
            panel.plot(t / unit, np.exp(2 * rate.real * (t - t[0])), "k--", lw=0.9)
        panel.set(xlabel="t sqrt(g/H)", ylim=(0, None))
        panel.legend(loc="upper right")
    inviscid.set_title("kinetic energy / first maximum")
    viscous.set_title("Re 250; dashed: exact decay")


SIZE = ("H/dp", DEPTH)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE)
