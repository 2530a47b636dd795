#!/usr/bin/python3
"""Compares the first pressure of a column of water that is let go with the exact one."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

ODD = np.arange(1, 4001, 2)


def of(run):
    """Length and height of a run's column [m], and rho g H [Pa]."""
    a, H = run.case["fluid"]["region"][0]["high"]
    return a, H, -run.case["fluid"]["density"] * run.case["fluid"]["gravity"][1] * H


def exact(a, H, x, y):
    """The pressure over rho g H: of zero Laplacian, with p_y = -rho g on the floor, p_x = 0 on the wall, else p = 0."""
    rate = ODD * np.pi / (2 * a)
    # sinh(l (H - y)) / cosh(l H), which does not overflow
    fall = np.exp(-np.outer(y, rate)) * -np.expm1(-2 * np.outer(H - np.asarray(y), rate)) / (1 + np.exp(-2 * rate * H))
    part = 8 * a / (ODD * np.pi) ** 2 * (1 - (ODD - 1) % 4) / H
    return (fall * np.cos(np.outer(x, rate))) @ part


def rows(run):
    a, H, unit = of(run)
    lines = []
    for name, words, x, y in (("corner", "the corner", 0, 0), ("floor", "mid-floor", a / 2, 0), ("wall", "mid-wall", 0, H / 2)):
        lines.append(c.row(f"a/H = {a / H:g}: pressure / rho g H in {words}", run.probes[f"p_{name}"][0] / unit,
                           exact(a, H, [x], [y])[0]))
    snapshot = run.snapshot()
    x, _, p = c.fluid(snapshot)
    difference = p / unit - exact(a, H, *x.T)
    lines.append(c.row(f"a/H = {a / H:g}: rms error in the column / rho g H", np.sqrt((difference**2).mean()), 0.0, scale=1.0))
    return lines


def draw(runs, figure):
    field, floor, wall = figure.subplots(1, 3)
    finest = min(run.spacing / of(run)[1] for run in runs)
    runs = [run for run in runs if run.spacing / of(run)[1] <= 1.01 * finest]
    run = max(runs, key=lambda run: of(run)[0] / of(run)[1])
    a, H, unit = of(run)
    discs = c.show_fluid(field, run.snapshot(), run.spacing, limits=(0.0, unit))
    x, y = np.meshgrid(np.linspace(0, a, 60), np.linspace(0, H, 60))
    field.contour(x, y, exact(a, H, x.ravel(), y.ravel()).reshape(x.shape), np.arange(0.1, 1, 0.1), colors="white", linewidths=0.8)
    figure.colorbar(discs, ax=field, label="pressure [Pa]; lines: exact", location="bottom")
    field.set(title=f"a/H = {a / H:g}", xlabel="x [m]")
    for run, colour in zip(runs, c.COLOURS):
        a, H, unit = of(run)
        x, _, p = c.fluid(run.snapshot())
        for axes, along, across, length in ((floor, 0, 1, a), (wall, 1, 0, H)):
            row = x[:, across] < 0.75 * run.spacing
            order = np.argsort(x[row, along])
            axes.plot(x[row, along][order] / length, p[row][order] / unit, ".", ms=3, color=colour, label=f"a/H = {a / H:g}")
            places = np.linspace(0, length, 200)
            depth = np.full(200, run.spacing / 2)
            axes.plot(places / length, exact(a, H, *((places, depth) if along == 0 else (depth, places))), "k", lw=0.8)
    floor.set(title="p / rho g H, lowest row", xlabel="x / a")
    wall.set(title="p / rho g H, row at the wall", xlabel="y / H")
    wall.legend()


def size(run):
    return "H/dp", of(run)[1]


if __name__ == "__main__":
    c.main(__doc__, rows, draw, size)
