#!/usr/bin/python3
"""Compares runs of a block that hits a floor with the exact loss of energy and pressure impulse."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

ODD = np.arange(1, 4001, 2)


def of(run):
    """rho, L, H and U of a run's block."""
    region = run.case["fluid"]["region"][0]
    length, height = np.subtract(region["high"], region["low"])
    return run.case["fluid"]["density"], length, height, -region["velocity"][1]


def exact_loss(length, height):
    """The share of the kinetic energy that is lost."""
    return 8 / np.pi**3 * length / height * (np.tanh(ODD * np.pi * height / length) / ODD**3).sum()


def exact_impulse(run, x):
    """The pressure impulse on the floor at x from the middle of the block [Pa s]."""
    rho, L, H, U = of(run)
    part = 4 * L / (ODD * np.pi) ** 2 * (1 - (ODD - 1) % 4) * np.tanh(ODD * np.pi * H / L)
    return np.where(np.abs(x) < L / 2, rho * U * np.cos(np.outer(x, ODD * np.pi / L)) @ part, 0.0)


def impulse(run):
    """x and the pressure impulse of the floor's particles [m, Pa s]."""
    walls = run.snapshot().walls
    begin, end = walls["window"]
    order = np.argsort(walls["position"][:, 0])
    return walls["position"][order, 0], walls["mean_pressure"][order] * (end - begin)


def rows(run):
    rho, L, H, U = of(run)
    name = f"L/H = {L / H:g}: "
    energy = run.history["kinetic_energy"]
    x, measured = impulse(run)
    exact = exact_impulse(run, x)
    below = np.abs(x) < L / 2
    scale = exact.max()
    return [
        c.row(name + "energy lost / energy", 1 - energy[-1] / energy[0], exact_loss(L, H)),
        c.row(name + "impulse on the floor / rho U L²", measured.sum() * run.spacing / (rho * U * L**2),
              exact[below].sum() * run.spacing / (rho * U * L**2)),
        c.row(name + "pressure impulse in the middle / rho U L", measured[below].max() / (rho * U * L), scale / (rho * U * L)),
        c.row(name + "rms error of the pressure impulse, over its largest",
              np.sqrt(((measured - exact)[below] ** 2).mean()) / scale, 0.0, scale=1.0),
    ]


def draw(runs, figure):
    losses, curves = figure.subplots(1, 2)
    heights = np.geomspace(0.2, 2.5, 100)
    losses.plot(1 / heights, [exact_loss(1.0, height) for height in heights], "k", lw=0.9, label="exact")
    finest = min(run.spacing for run in runs)
    for spacing, colour in zip(sorted({run.spacing for run in runs}), c.COLOURS):
        of_spacing = [run for run in runs if run.spacing == spacing]
        share = [1 - run.history["kinetic_energy"][-1] / run.history["kinetic_energy"][0] for run in of_spacing]
        losses.plot([of(run)[1] / of(run)[2] for run in of_spacing], share, "o", color=colour, label=c.label(of_spacing[0], SIZE))
    for run, colour in zip([run for run in runs if run.spacing == finest], c.COLOURS):
        rho, L, H, U = of(run)
        x, measured = impulse(run)
        curves.plot(x / L, measured / (rho * U * L), ".", ms=3, color=colour, label=f"L/H = {L / H:g}")
        curves.plot(x / L, exact_impulse(run, x) / (rho * U * L), color="black", lw=0.8)
    losses.set(title="energy lost / energy", xlabel="L / H")
    curves.set(title="pressure impulse / rho U L; line: exact", xlabel="x / L", xlim=(-0.7, 0.7))
    losses.legend()
    curves.legend()


SIZE = ("L/dp", 1.0)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE)
