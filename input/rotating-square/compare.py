#!/usr/bin/python3
"""Compares runs of the rotating square with the exact flow: the pressure in its middle, its corners, its energy."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

# Pressure in the middle over rho omega^2 L^2 at omega t: a potential flow with uniform vorticity, fitted on the surface and
# followed by Runge-Kutta steps. The first is that of the square, -32/pi^4 sum sin sin/(m n (m^2 + n^2)), m and n odd.
MIDDLE = np.array([[0.0, -0.14734], [0.2, -0.14488], [0.5, -0.13296], [1.0, -0.10383], [1.2, -0.09250]])


def of(run):
    """rho, L and omega of a run's square."""
    region = run.case["fluid"]["region"][0]
    return run.case["fluid"]["density"], region["high"][0] - region["low"][0], region["spin"]


def middle(run):
    """omega t and the pressure in the middle over rho omega^2 L^2, of every sample."""
    rho, L, omega = of(run)
    return omega * run.probes["t"], run.probes["p_middle"] / (rho * (omega * L) ** 2)


def corners(run, snapshot):
    """The largest distance of the corners' particles from their straight ways, over L."""
    _, L, omega = of(run)
    start = run.snapshot(run.steps[0])
    first, last = (s.position[np.argsort(s.id)][:, :2] for s in (start, snapshot))
    ids, now = np.sort(start.id), np.sort(snapshot.id)
    errors = []
    for sign in ([1, 1], [1, -1], [-1, 1], [-1, -1]):
        k = (first @ np.array(sign)).argmax()
        x = first[k]
        exact = x + omega * snapshot.time * np.array([-x[1], x[0]])
        errors.append(np.linalg.norm(last[np.searchsorted(now, ids[k])] - exact))
    return max(errors) / L


def energy(run):
    """omega t and the kinetic energy over that at the start."""
    rho, L, omega = of(run)
    t, value = run.history["t"], run.history["kinetic_energy"]
    return omega * t, value / value[0]


def rows(run):
    omega = of(run)[2]
    t, p = middle(run)
    t_energy, kinetic = energy(run)
    lines = []
    for when, exact in MIDDLE[1:]:
        near = np.abs(t - when) <= 0.1
        lines.append(c.row(f"pressure in the middle at omega t = {when:g}", p[near].mean(), exact))
    near = np.abs(t - 0.5) <= 0.1
    lines.append(c.row("its scatter there", p[near].std(), 0.0, scale=0.13296))
    for when in (1, 2, 4):
        snapshot = run.snapshot(time=when / omega)
        lines.append(c.row(f"corners off their ways at omega t = {when}, over L", corners(run, snapshot), 0.0, scale=1.0))
    for when in (2, 4):
        lost = 1 - np.interp(when, t_energy, kinetic)
        beat = "delta-SPH less 25 to 32 % (De Courcy et al. 2024)" if when == 4 else ""
        lines.append(c.row(f"kinetic energy lost until omega t = {when}", lost, 0.0, scale=1.0, beat=beat))
    return lines


def draw(runs, figure):
    *shapes, pressure, loss = figure.subplots(1, 4, width_ratios=(1, 1, 0.9, 0.9))
    run = runs[-1]
    rho, L, omega = of(run)
    for axes, when in zip(shapes, (1, 2)):
        discs = c.show_fluid(axes, run.snapshot(time=when / omega), run.spacing, limits=(-0.12 * rho * (omega * L) ** 2, 0.0))
        corner = L / 2 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        axes.plot(*(corner + when * np.stack([-corner[:, 1], corner[:, 0]], 1)).T, "r+", ms=9)
        axes.set(title=f"omega t = {when}", xlabel="x [m]")
    figure.colorbar(discs, ax=shapes, label="pressure [Pa]", location="bottom", shrink=0.6)
    for run, colour in zip(runs, c.COLOURS):
        name = c.label(run, SIZE)
        pressure.plot(*middle(run), lw=0.7, color=colour, label=name)
        t, value = energy(run)
        loss.plot(t, 100 * (1 - value), color=colour, label=name)
    pressure.plot(*MIDDLE.T, "ko", ms=4, label="exact")
    pressure.set(title="p / rho omega² L², middle", xlabel="omega t", xlim=(0, 4), ylim=(-0.17, 0.01))
    loss.set(title="kinetic energy lost [%]", xlabel="omega t", xlim=(0, 4))
    pressure.legend()
    loss.legend()


SIZE = ("L/dp", 1.0)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE)
