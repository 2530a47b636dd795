#!/usr/bin/python3
"""Compares runs of the shallow bore with the experiment: the level near the left wall over a period, late in the run.

--data FILE: the measured level over that at rest, columns t_over_T, eta [periods, m]."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "Bouscasse et al. 2013"
DEPTH, AMPLITUDE, PERIOD, GAUGE = 0.03, 0.07, 2.9993, 0.05  # [m, m, s, m]
# The measured level over that at rest [m] after a share of the period since the bore passes 0.03 m (figure 19, the mean of
# two periods); band of its crests, its shoulder and its trough.
LEVEL = np.array([[0.03, 0.057], [0.05, 0.050], [0.10, 0.037], [0.15, 0.033], [0.20, 0.026], [0.30, 0.011], [0.40, 0.001],
                  [0.50, -0.005], [0.60, -0.008], [0.70, -0.011], [0.80, -0.010], [0.90, -0.007]])
CRESTS, SHOULDER, TROUGH = (0.056, 0.060), (0.033, 0.038), -0.011
FIRST = 8.0  # periods, from which on it repeats itself


def level(run):
    """t / T and the level over that at rest where the gauge on the tank is, between those of fixed gauges."""
    t = run.gauges["t"]
    gauges = run.case["gauge"]
    levels = np.stack([run.gauges[gauge["name"]] for gauge in gauges], 1)
    rise = np.clip(t / 3.0, 0, 1)
    ramp = rise**3 * (10 - 15 * rise + 6 * rise**2)
    gauge = GAUGE + AMPLITUDE * ramp * np.sin(2 * np.pi * 0.333411 * t)
    return t / PERIOD, np.array([np.interp(x, [g["point"][0] for g in gauges], row) for x, row in zip(gauge, levels)]) - DEPTH


def by_period(run):
    """Share of a period since the bore passes, and the level, of all samples from FIRST on."""
    t, eta = level(run)
    use = t >= min(FIRST, t[-1] - 2)
    t, eta = t[use], eta[use]
    mean = np.array([eta[np.abs((t - s + 0.5) % 1 - 0.5) < 0.02].mean() for s in np.arange(100) / 100])
    steepest = np.argmax(np.roll(mean, -5) - np.roll(mean, 10))
    start = next(k for k in range(steepest - 10, steepest + 20) if mean[k % 100] > 0.03) / 100
    return (t - start) % 1, eta


def measurements(data):
    """The measured level by the share of a period: of the table above, or that of `data` since its first bore."""
    if not data:
        return LEVEL
    t, eta = data["t_over_T"], data["eta"]
    k = np.flatnonzero((eta[:-1] <= 0.03) & (eta[1:] > 0.03))[0]
    start = t[k] + (0.03 - eta[k]) / (eta[k + 1] - eta[k]) * (t[k + 1] - t[k])
    return np.stack([(t - start) % 1, eta], 1)


def rows(run, data):
    share, eta = by_period(run)
    measured = measurements(data)
    mine = np.array([eta[np.abs((share - s + 0.5) % 1 - 0.5) < 0.02].mean() for s in measured[:, 0]])
    shoulder = (share > 0.08) & (share < 0.16)
    return [
        c.row("crest [m], 95th percentile of its first tenth", np.percentile(eta[share < 0.1], 95), CRESTS, source=SOURCE),
        c.row("shoulder [m]", eta[shoulder].mean(), SHOULDER, source=SOURCE),
        c.row("trough [m]", np.percentile(eta, 2), TROUGH, source=SOURCE),
        c.row("level, mean error over the crest", np.abs(mine - measured[:, 1]).mean(), 0.0, scale=0.058, source=SOURCE),
    ]


def draw(runs, figure, data):
    axes = figure.subplots()
    for run, colour in zip(runs, c.COLOURS):
        axes.plot(*by_period(run), ".", ms=2, color=colour, label=c.label(run, SIZE))
    axes.plot(*measurements(data).T, "ko", ms=3 if data else 5, label="measured")
    axes.set(title="level over that at rest [m]", xlabel="t / T since the bore passes", xlim=(0, 1))
    axes.legend()


SIZE = ("h/dp", DEPTH)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured level: t_over_T, eta")
