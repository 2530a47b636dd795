#!/usr/bin/python3
"""Compares runs of a drop in a central force, or in none, with the exact ellipse: semi-axes, energy, pressure."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402


def of(run):
    """rho, R, the first rate of strain A0 and B of the central force of a run."""
    region = run.case["fluid"]["region"][0]
    return run.case["fluid"]["density"], region["radius"], region["gradient"][0], run.case["fluid"]["central_force"]


def exact(run, times):
    """Semi-axes a, b over R, the rate of strain and the pressure at the centre [Pa], at times from 0 on (README.md)."""
    rho, R, A0, B = of(run)

    def slope(state):
        a, b, A = state
        return np.array([A * a, -A * b, (A**2 + B**2) * (b**2 - a**2) / (a**2 + b**2)])

    times = np.asarray(times, dtype=float)
    a, b, A = c.runge_kutta(slope, (1.0, 1.0, A0), np.concatenate(([0.0], times)), 1e-3 / max(A0, B))[1:].T
    return a, b, A, rho * R**2 * (A**2 + B**2) * (a * b) ** 2 / (a**2 + b**2)


def period(run):
    """The exact period [s]: twice the time from one circle to the next."""
    _, _, A0, B = of(run)
    times = np.linspace(0.0, 10.0 / B, 10001)
    a, b, _, _ = exact(run, times)
    back = np.flatnonzero((a[:-1] > b[:-1]) & (a[1:] <= b[1:]))[0]
    gap = a - b
    return 2 * (times[back] + (times[1] - times[0]) * gap[back] / (gap[back] - gap[back + 1]))


def measured(run):
    """Of each snapshot: semi-axes over R by second moments, and kinetic energy with that of the force per mass.

    R is that of the first snapshot by the same moments: the particles of a lattice do not fill exactly a circle.
    """
    _, _, _, B = of(run)
    found = []
    for snapshot in run.snapshots:
        x, u, _ = c.fluid(snapshot)
        found.append((*2 * np.sqrt((x**2).mean(axis=0)), 0.5 * ((u**2).sum(axis=1) + B**2 * (x**2).sum(axis=1)).mean()))
    a, b, energy = np.array(found).T
    R = np.sqrt(a[0] * b[0])
    return a / R, b / R, energy


def rows(run):
    rho, R, A0, B = of(run)
    times = run.times
    a, b, energy = measured(run)
    a_exact, b_exact, _, _ = exact(run, times)
    lines = []
    if B == 0:
        for when in (0.08, 0.38, 0.76):
            k = np.abs(A0 * times - when).argmin()
            lines.append(c.row(f"a / R at A t = {when}", a[k], a_exact[k]))
            lines.append(c.row(f"b / R at A t = {when}", b[k], b_exact[k]))
        lines.append(c.row("energy lost until A t = 0.76", 1 - energy[k] / energy[0], 0.0, scale=1.0))
        for when in (0.5, 0.76):
            near = np.abs(A0 * run.probes["t"] - when) < 0.03
            lines.append(c.row(f"pressure at the centre / rho A² R², A t = {when}",
                               run.probes["p_center"][near].mean() / (rho * (A0 * R) ** 2),
                               exact(run, [when / A0])[3][0] / (rho * (A0 * R) ** 2)))
        return lines
    T = period(run)
    after = np.abs(times - T).argmin()
    beat = "1.7e-4 of R (TrixiParticles)"
    lines.append(c.row("semi-axis a / R after one period", a[after], a_exact[after], scale=1.0, beat=beat))
    lines.append(c.row("semi-axis b / R after one period", b[after], b_exact[after], scale=1.0))
    first = times <= T * 1.001
    worst = np.abs(np.stack([a - a_exact, b - b_exact]))[:, first].max()
    lines.append(c.row("largest error of a semi-axis in a period, over R", worst, 0.0, scale=1.0))
    for count in range(1, 11):
        if count in (1, 10) and times[-1] > 0.999 * count * T:
            k = np.abs(times - count * T).argmin()
            lines.append(c.row(f"energy lost in {count} period{'s'[:count - 1]}", 1 - energy[k] / energy[0], 0.0, scale=1.0))
    if times[-1] > 1.9 * T:
        found, _ = c.maxima(times, a, 0.6 * T)
        lines.append(c.row("period B", B * c.period(found), B * T))
    return lines


def draw(runs, figure):
    # Lines that are black are exact.
    shapes, axes, energies, stretched = figure.subplots(1, 4, width_ratios=(1, 1.1, 1.1, 1))
    pulled, free = ([run for run in runs if (of(run)[3] > 0) is force] for force in (True, False))
    angle = np.linspace(0, 2 * np.pi, 200)
    for share, colour in ((0.25, "tab:blue"), (0.75, "tab:cyan")):
        run = runs[-1] if not pulled else pulled[-1]
        snapshot = run.snapshot(time=share * (period(run) if pulled else 1 / of(run)[2]))
        c.show_fluid(shapes, snapshot, run.spacing, facecolors=colour, alpha=0.6)
        a, b, _, _ = exact(run, [snapshot.time])
        shapes.plot(of(run)[1] * a * np.cos(angle), of(run)[1] * b * np.sin(angle), "k", lw=0.8)
    shapes.set(title="line: exact", xlabel="x [m]")
    for chosen, panel in ((pulled, axes), (free, stretched)):
        if not chosen:
            continue
        for run, colour in zip(chosen, c.COLOURS):
            unit = period(run) if of(run)[3] else 1 / of(run)[2]
            a, b, energy = measured(run)
            panel.plot(run.times / unit, a, color=colour, label=c.label(run, SIZE))
            panel.plot(run.times / unit, b, color=colour)
            if panel is axes:
                energies.plot(run.times / unit, 100 * (1 - energy / energy[0]), color=colour, label=c.label(run, SIZE))
        times = np.linspace(0, min(2 * unit, chosen[-1].times[-1]), 500)
        for curve in exact(chosen[-1], times)[:2]:
            panel.plot(times / unit, curve, "k--", lw=0.9)
    axes.set(title="semi-axes / R", xlabel="t / period", xlim=(0, 2))
    energies.set(title="energy lost [%]", xlabel="t / period")
    stretched.set(title="the same, no force", xlabel="A t")
    energies.legend()


SIZE = ("R/dp", 1.0)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE)
