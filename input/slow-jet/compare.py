#!/usr/bin/python3
"""Measures runs of the slow jet on a plate against free fall, Bernoulli and the momentum of the water above the plate."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

G = 9.81
FILM = (0.1, 0.3)  # distances from the axis [m] between which the film is measured


def flow(run):
    """rho, width, speed at the inlet, height of the inlet [m], speed at the plate, of a run's jet."""
    jet = run.case["jet"]
    height = jet["inlet_distance"] * jet["width"]
    return run.case["fluid"]["density"], jet["width"], jet["speed"], height, np.sqrt(jet["speed"] ** 2 + 2 * G * height)


def film(run, start):
    """Speed along the plate and discharge to both sides of the film, means of the snapshots from `start` on."""
    speeds, total = [], []
    for snapshot in run.snapshots:
        if snapshot.time < start:
            continue
        x, v, _ = c.fluid(snapshot)
        here = (np.abs(x[:, 0]) > FILM[0]) & (np.abs(x[:, 0]) < FILM[1]) & (x[:, 1] < 0.03)
        outward = v[here, 0] * np.sign(x[here, 0])
        speeds.append(outward.mean())
        total.append(outward.sum() * run.spacing**2 / (FILM[1] - FILM[0]))
    return np.mean(speeds), np.mean(total)


def rows(run):
    rho, width, speed, _, fall = flow(run)
    history = run.history
    t = history["t"]
    start = run.case["output"]["average_start"]
    late = t >= start
    dt = np.diff(t, prepend=0.0)[late]
    force = (history["plate_force"][late] * dt).sum() / dt.sum()
    mass = rho * run.spacing**2 * (history["fluid"][late] * dt).sum() / dt.sum()
    along, discharge = film(run, start)
    return [
        c.row("fastest particle over that in free fall", history["max_speed"].max() / fall, (0.0, 1.2), scale=1.0, source="bar"),
        c.row("share of the steps in which one is faster than 1.2", (history["max_speed"] > 1.2 * fall).mean(), 0.0, scale=1.0),
        c.row("force on the plate [N/m], by the momentum of all water", force, rho * width * speed**2 + G * mass),
        c.row("speed of the film [m/s], Bernoulli", along, fall),
        c.row("discharge of the film [m²/s]", discharge, width * speed),
    ]


def draw(runs, figure):
    shape, speed = figure.subplots(1, 2)
    run = runs[-1]
    c.show_fluid(shape, run.snapshot(), run.spacing, color="tab:blue")
    shape.set(title=f"t = {run.snapshot().time:g} s, {c.label(run, SIZE)}", xlabel="x [m]", ylabel="height [m]")
    for run, colour in zip(runs, c.COLOURS):
        speed.plot(run.history["t"], run.history["max_speed"] / flow(run)[-1], lw=0.6, color=colour, label=c.label(run, SIZE))
    speed.axhline(1.2, color="black", lw=0.8)
    speed.set(title="fastest particle / free fall", xlabel="t [s]", ylim=(0, 2.5))
    speed.legend()


SIZE = ("H/dp", 0.1)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE)
