#!/usr/bin/python3
"""Measures runs of violent sloshing against what must hold: energy never rises, the bulk keeps its volume, spray is slow."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

CELL = 5  # spacings, of the cells that the bulk's density is counted in: 3 in space


def gravity(run):
    return np.array(run.case["fluid"]["gravity"])


def tank(run):
    """The tank's sides [m], from its corner at the origin."""
    wall = run.case["wall"][0]
    return np.array(wall["high"] if wall["shape"] == "box" else np.max(wall["points"], axis=0))


def bulk(run, x):
    """The mean number of particles over that at rest, of the cells whose neighbours are full, too; walls count as full."""
    dimension, sides = x.shape[1], tank(run)
    width = CELL if dimension == 2 else 3
    edges = [np.arange(0, side + 0.5 * width * run.spacing, width * run.spacing) for side in sides]
    count, _ = np.histogramdd(x, edges)
    full = width**dimension
    around = np.pad(count, 1, constant_values=full)
    around[(..., -1)] = 0  # air above
    inside = np.ones(count.shape, dtype=bool)
    for place in np.ndindex(*(3,) * dimension):
        inside &= around[tuple(slice(k, k + n) for k, n in zip(place, count.shape))] > 0.75 * full
    return count[inside].mean() / full if inside.any() else np.nan


def energies(run):
    """t, and kinetic and total energy over the mass [m^2/s^2], of the snapshots; the bulk's density over that at rest."""
    found = []
    for snapshot in run.snapshots:
        x, v, _ = c.fluid(snapshot)
        kinetic = (v**2).sum(1).mean() / 2
        found.append((snapshot.time, kinetic, kinetic - (x @ gravity(run)).mean(), bulk(run, x)))
    return np.array(found).T


def rows(run):
    t, kinetic, total, density = energies(run)
    rise = (total - np.minimum.accumulate(total)) / kinetic.max()
    first = t <= 0.5
    late = np.minimum.accumulate(total[~first])
    fall = np.sqrt(2 * np.linalg.norm(gravity(run)) * np.linalg.norm(tank(run)))
    fastest = run.history["max_speed"].max()
    lost = run.history["lost"][-1] / run.history["in"][-1]
    return [
        c.row("energy above an earlier value over the largest kinetic energy", rise.max(), (0.0, 0.002), scale=1.0, source="bar"),
        c.row("the same from 0.5 s on", (total[~first] - late).max() / kinetic.max(), (0.0, 0.002), scale=1.0, source="bar"),
        c.row("volume of the bulk, mean from 2 s on", 1 / np.nanmean(density[t >= 2]), (0.985, 1.015), scale=1.0, source="bar"),
        c.row("fastest particle over sqrt(2 g d), d the tank's diagonal", fastest / fall, (0.0, 1.3), scale=1.0, source="bar"),
        c.row("particles lost over the rim", lost, 0.0, scale=1.0, source="bar"),
    ]


def draw(runs, figure):
    *shapes, curve, speed = figure.subplots(1, 5, width_ratios=(1, 1, 1, 1.6, 1.6))
    run = runs[-1]
    for axes, when in zip(shapes, (0.4, 1.2, 3.0)):
        snapshot = run.snapshot(time=when)
        if snapshot.dimension == 2:
            c.show_fluid(axes, snapshot, run.spacing, color="tab:cyan")
        else:
            x, _, _ = c.fluid(snapshot)
            axes.plot(x[:, 0], x[:, -1], ".", ms=3, color="tab:cyan")
            axes.set_aspect("equal")
        axes.set(title=f"t = {when:g} s", xlabel="x [m]", xlim=(0, tank(run)[0]), ylim=(0, tank(run)[-1]))
    for run, colour in zip(runs, c.COLOURS):
        t, kinetic, total, _ = energies(run)
        name = c.label(run, SIZE)
        curve.plot(t, (total - total[0]) / kinetic.max(), color=colour, label=name)
        fall = np.sqrt(2 * np.linalg.norm(gravity(run)) * np.linalg.norm(tank(run)))
        speed.plot(run.history["t"], run.history["max_speed"] / fall, lw=0.4, color=colour)
    curve.set(title="energy / largest kinetic", xlabel="t [s]")
    curve.legend(fontsize=8)
    speed.axhline(1.3, color="black", lw=0.8)
    speed.set(title="fastest / sqrt(2 g d)", xlabel="t [s]", ylim=(0, 1.5))


def SIZE(run):
    return "depth/dp", run.case["fluid"]["region"][0]["high"][-1]


if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE)
