#!/usr/bin/python3
"""Compares runs of Taylor-Green vortices with the exact solution: the kinetic energy that viscosity leaves."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

L, SPEED = 1.0, 1.0  # of the case [m, m/s]


def exact(run, t):
    """Kinetic energy over that at the start at a time [s]."""
    return np.exp(-16 * np.pi**2 * run.case["fluid"]["viscosity"] * np.asarray(t) / L**2)


def energies(run):
    """Times [s] and kinetic energies over the exact one at the start, of all snapshots."""
    means = [(c.fluid(snapshot)[1] ** 2).sum(axis=1).mean() for snapshot in run.snapshots]
    return run.times, np.array(means) / (SPEED**2 / 2)


def words(run):
    """What a run has beside the scheme's defaults."""
    return "no density term: " if run.case["pressure"]["gamma"] == run.case["pressure"]["density_rate"] == 0 else ""


def rows(run):
    t, energy = energies(run)
    one = np.abs(t - L / SPEED).argmin()
    late = (t > 0.39 * L / SPEED) & (t < 1.01 * L / SPEED)
    rate = np.polyfit(t[late], np.log(energy[late]), 1)[0]
    return [
        c.row(f"{words(run)}E / E0 at t V / L = 1", energy[one], exact(run, t[one])),
        c.row(f"{words(run)}rate of decay L / V, t V / L = 0.4 to 1", -rate * L / SPEED, -np.log(exact(run, 1.0)) * L / SPEED),
    ]


def draw(runs, figure):
    flow, curve, error = figure.subplots(1, 3, width_ratios=(0.9, 1, 1))
    run = runs[-1]
    discs = c.show_fluid(flow, run.snapshot(time=0.5 * L / SPEED), run.spacing, limits=(0.0, 1.0))
    discs.set_array(np.hypot(*c.fluid(run.snapshot(time=0.5 * L / SPEED))[1].T) / np.sqrt(exact(run, 0.5 * L / SPEED)))
    flow.set(title="speed, t V/L = 0.5", xlabel="x [m]", ylabel="y [m]")
    for run, colour in zip(runs, c.COLOURS):
        t, energy = energies(run)
        curve.plot(t * SPEED / L, energy, color=colour, label=words(run) + c.label(run, SIZE))
        error.plot(t * SPEED / L, 100 * (energy / exact(run, t) - 1), color=colour)
    curve.plot(t * SPEED / L, exact(run, t), "k--", lw=0.9, label="exact")
    curve.set(title="kinetic energy / that at the start", xlabel="t V/L", ylim=(0, 1.05))
    curve.legend(fontsize=8)
    error.axhline(0.0, color="k", lw=0.9)
    error.set(title="its error [%]", xlabel="t V/L")


SIZE = ("L/dp", L)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE)
