#!/usr/bin/python3
"""Compares runs of the flume with Biesel's theory of a piston, Stokes' second order, and the experiment: the waves.

--data FILE: the measured levels over that at rest, columns t, wg1, wg2, wg3 [s, m]."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "CIEMito flume"
DEPTH, KH = 0.31, 1.40677  # k from omega^2 = g k tanh(k h), period 1 s
# Amplitude of the first harmonic [m] of the measured levels: at wg1 and wg2 from 4 to 8 s, at wg3 from 5 to 8 s; crests and
# troughs at wg1 [m].
AMPLITUDES = {"wg1": (4, 0.0347), "wg2": (4, 0.0352), "wg3": (5, 0.0350)}
CRESTS, TROUGHS = (0.040, 0.042), (-0.032, -0.030)


def theory(run):
    """Amplitude of the waves of a piston, and of their second harmonic [m]."""
    stroke = 2 * run.case["motion"][0]["amplitude"][0]
    a = stroke / 2 * 4 * np.sinh(KH) ** 2 / (np.sinh(2 * KH) + 2 * KH)
    return a, KH / DEPTH * a * a / 4 * np.cosh(KH) * (2 + np.cosh(2 * KH)) / np.sinh(KH) ** 3


def level(run, name):
    """t and the level over that at rest."""
    at = next(gauge["point"][1] for gauge in run.case["gauge"] if gauge["name"] == name)
    return run.gauges["t"], run.gauges[name] + at - DEPTH


def rows(run, data):
    first, second = theory(run)
    lines = []
    for name, (start, measured) in AMPLITUDES.items():
        t, eta = level(run, name)
        use = (t >= start) & (t <= 8)
        amplitude, _ = c.harmonic(t[use], eta[use], 1.0)
        if data:
            when = (data["t"] >= start) & (data["t"] <= 8)
            measured = c.harmonic(data["t"][when], data[name][when], 1.0)[0]
        lines.append(c.row(f"amplitude at {name} [m]", amplitude, measured, source=SOURCE))
        if name == "wg1":
            lines.insert(0, c.row("amplitude at wg1 [m], Biesel", amplitude, first))
            lines.append(c.row("crests at wg1 [m]", np.percentile(eta[use], 98), CRESTS, source=SOURCE))
            lines.append(c.row("troughs at wg1 [m]", np.percentile(eta[use], 2), TROUGHS, source=SOURCE))
    t, eta = level(run, "wg2")
    use = (t >= 4) & (t <= 8)
    lines.append(c.row("second harmonic at wg2 [m], Stokes", c.harmonic(t[use], eta[use], 2.0)[0], second))
    return lines


def draw(runs, figure, data):
    axes = figure.subplots(1, 3, sharey=True)
    for name, here in zip(AMPLITUDES, axes):
        for run, colour in zip(runs, c.COLOURS):
            t, eta = level(run, name)
            here.plot(t, eta, color=colour, label=c.label(run, SIZE))
        if data:
            here.plot(data["t"] - 0.05, data[name], "k", lw=0.7, label="measured, clock -0.05 s")
        start, amplitude = AMPLITUDES[name]
        for side in (-1, 1):
            here.plot([start, 8], [side * amplitude] * 2, "k--", lw=1, label="amplitude, measured" if side == 1 else None)
        here.set(title=f"level over that at rest [m], {name}", xlabel="t [s]", xlim=(0, 8))
    axes[0].legend(fontsize=8, loc="lower left")


SIZE = ("depth/dp", DEPTH)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured levels: t, wg1, wg2, wg3")
