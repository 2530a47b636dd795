#!/usr/bin/python3
"""Compares a jet on a short plate with the exact one: the force, and the angle at which the sheets leave."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402


def of(run):
    """rho, width and speed of the jet, width of the plate, and the start of the average."""
    inlet, (low, high) = run.case["inlet"][0], run.case["wall"][0]["points"]
    width = np.linalg.norm(np.subtract(high, low))
    return run.case["fluid"]["density"], inlet["width"], inlet["speed"], width, run.case["output"]["average_start"]


def width_of(angle):
    """The plate's width over the jet's whose sheets leave at an angle [rad] to the jet."""
    turn = np.exp(-1j * angle)
    return 4 / np.pi * (np.pi / 4 - (turn * np.arctan(turn)).real)


def leaving_angle(ratio):
    """The angle [rad] at which the sheets leave a plate of this width over the jet's, by bisection."""
    low, high = 1e-6, np.pi / 2 - 1e-6
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if width_of(middle) < ratio else (low, middle)
    return low


def measured_angle(run):
    """That of the momentum of the fluid from 2 H to 3 H outside of the plate's edges [rad], the mean over the snapshots."""
    _, H, _, B, begin = of(run)
    flux = np.zeros(2)
    for snapshot in run.snapshots:
        if snapshot.time >= begin:
            x, u, _ = c.fluid(snapshot)
            away = np.abs(x[:, 1]) - B / 2
            flux += np.abs(u[(away > 2 * H) & (away < 3 * H)]).sum(axis=0)
    return np.arctan2(flux[1], flux[0])


def rows(run):
    rho, H, U, B, begin = of(run)
    angle = leaving_angle(B / H)
    name = f"B/H = {B / H:.4g}: "
    late = run.forces["t"] >= begin
    force = run.forces["fx_plate"][late] / (rho * U**2 * H)
    return [
        c.row(name + "force / rho U² H", force.mean(), 1 - np.cos(angle)),
        c.row(name + "its standard deviation from step to step / rho U² H", force.std(), 0.0, scale=1.0),
        c.row(name + "angle at which the sheets leave [deg]", np.degrees(measured_angle(run)), np.degrees(angle)),
    ]


def draw(runs, figure):
    flow, forces = figure.subplots(1, 2)
    rho, H, U, B, begin = of(runs[-1])
    run = runs[-1]
    discs = c.show_fluid(flow, run.snapshot(), run.spacing, limits=(0.0, rho * U**2 / 2))
    figure.colorbar(discs, ax=flow, label="pressure [Pa]")
    angle = leaving_angle(B / H)
    for sign in (1, -1):
        way = np.array([[0.0, sign * B / 2], [0.3 * np.cos(angle), sign * (B / 2 + 0.3 * np.sin(angle))]])
        flow.plot(*way.T, "r--", lw=0.9)
    flow.plot([0, 0], [-B / 2, B / 2], "k", lw=2)
    flow.set(title="red: exact angle", xlabel="x [m]", ylabel="y [m]", xlim=(-0.4, 0.3), ylim=(-0.45, 0.45))
    angles = np.radians(np.linspace(5, 89.5, 200))
    forces.plot([width_of(a) for a in angles], 1 - np.cos(angles), "k", lw=0.9, label="exact")
    for spacing, colour in zip(sorted({run.spacing for run in runs}, reverse=True), c.COLOURS):
        chosen = [run for run in runs if run.spacing == spacing]
        forces.plot([of(run)[3] / of(run)[1] for run in chosen], [rows(run)[0].measured for run in chosen], "o", color=colour,
                    label=c.label(chosen[0], SIZE))
    forces.set(title="force / rho U² H", xlabel="B / H", xlim=(0, 4))
    forces.legend()


SIZE = ("H/dp", 0.1)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, height=4.0)
