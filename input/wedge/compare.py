#!/usr/bin/python3
"""Compares a jet that a wedge splits with the exact one: the force, the pressure on the faces, the sheets."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402


def of(run):
    """rho, width and speed of the jet, half-angle of the wedge [rad], and the start of the average."""
    inlet, (apex, one, _) = run.case["inlet"][0], run.case["wall"][0]["points"]
    half = np.arctan2(abs(one[1] - apex[1]), one[0] - apex[0])
    return run.case["fluid"]["density"], inlet["width"], inlet["speed"], half, run.case["output"]["average_start"]


def exact(place, half):
    """The pressure over rho U^2/2 on a face, `place` jet widths from the edge: 1 - q^2, with n = pi / half and

    place = (2 n/pi) sum over k >= 0 of q^m/m, m = n - 1 + 2 n k   (by the hodograph).
    """
    n, q = np.pi / half, np.linspace(0.0, 0.9999, 4000)
    m = n - 1 + 2 * n * np.arange(4000)[:, None]
    s = np.zeros_like(q)
    for part in np.array_split(m, 40):
        s += 2 * n / np.pi * (q**part / part).sum(axis=0)
    return 1 - np.interp(place, s, q) ** 2


def faces(run):
    """Distance from the edge in jet widths, and the mean pressure over rho U^2/2, of the particles of both faces."""
    rho, H, U, half, _ = of(run)
    walls = run.snapshot().walls
    x = walls["position"] - np.array(run.case["wall"][0]["points"][0] + [0.0])[: walls["position"].shape[1]]
    on_face = np.abs(np.abs(x[:, 1]) * np.cos(half) - x[:, 0] * np.sin(half)) < 0.1 * run.spacing
    order = np.argsort(x[on_face, 0])
    return np.hypot(x[on_face, 0], x[on_face, 1])[order] / H, walls["mean_pressure"][on_face][order] / (rho * U**2 / 2)


def rows(run):
    rho, H, U, half, begin = of(run)
    late = run.forces["t"] >= begin
    force = run.forces["fx_wedge"][late] / (rho * U**2 * H)
    place, pressure = faces(run)
    theory = exact(place, half)
    pressed = theory > 1e-3
    name = f"{np.degrees(half):.4g}°: "
    lines = [
        c.row(name + "force along the jet / rho U² H", force.mean(), 1 - np.cos(half)),
        c.row(name + "error of the pressure on the faces, L2",
              np.sqrt(((pressure - theory)[pressed] ** 2).sum() / (theory[pressed] ** 2).sum()),
              0.0, scale=1.0),
    ]
    for where in (0.3, 1.0):
        near = np.abs(place - where) < 1.5 * run.spacing / H
        lines.append(c.row(name + f"pressure / rho U²/2, {where:g} H from the edge", pressure[near].mean(),
                           exact(place[near], half).mean()))
    return lines


def draw(runs, figure):
    flow, curves = figure.subplots(1, 2)
    run = runs[-1]
    rho, H, U, half, _ = of(run)
    discs = c.show_fluid(flow, run.snapshot(), run.spacing, limits=(0.0, rho * U**2 / 2))
    figure.colorbar(discs, ax=flow, label="pressure [Pa]")
    flow.fill(*np.array(run.case["wall"][0]["points"]).T, color="0.85")
    flow.set(xlabel="x [m]", ylabel="y [m]", xlim=(-0.35, 0.35), ylim=(-0.4, 0.4))
    for run, colour in zip(runs, c.COLOURS):
        curves.plot(*faces(run), ".", ms=3, color=colour, label=c.label(run, SIZE))
    place = np.linspace(0, 4, 400)
    curves.plot(place, exact(place, half), "k", lw=0.9, label="exact")
    curves.set(title="pressure on the faces / (rho U²/2)", xlabel="distance from the edge / H", xlim=(0, 4))
    curves.legend()


SIZE = ("H/dp", 0.1)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, height=4.0)
