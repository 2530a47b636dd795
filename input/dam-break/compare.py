#!/usr/bin/python3
"""Compares runs of the dam break with the experiment: levels at four gauges, impact and pressures at four sensors.

Several runs of one spacing that differ by chance, such as by a slightly other time.dt, have the medians of their peaks in
the rows of the last of them."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "Lobovsky et al. 2014"
H = 0.3  # height of the column [m]; times below are t* = t sqrt(g / H), levels over H, pressures over rho g H

# Levels at H1 to H4, read from the paper's figure 16, the mean of its two runs.
LEVELS_AT = np.arange(1, 12)
LEVELS = np.array([
    [0.931, 0.011, 0.000, 0.000], [0.783, 0.214, 0.149, 0.000], [0.632, 0.260, 0.171, 0.135],
    [0.500, 0.290, 0.225, 0.156], [0.402, 0.294, 0.241, 0.211], [0.325, 0.270, 0.236, 0.382],
    [0.265, 0.238, 0.564, 0.777], [0.231, 0.647, 0.548, 0.649], [0.221, 0.550, 0.506, 0.520],
    [0.358, 0.431, 0.510, 0.487], [0.424, 0.417, 0.546, 0.418],
])
# Sensors 3, 15, 30 and 80 mm up the end wall: when the pressure passes 0.1 (figure 18); median, 2.5 and 97.5 % of the
# largest pressures of 100 runs (table 2); when they came in figure 18.
IMPACTS = (2.44, 2.46, 2.51, 2.75)
PEAKS = ((3.12, 2.56, 4.46), (1.96, 1.82, 2.16), (1.49, 1.36, 1.69), (1.03, 0.82, 1.24))
PEAKS_AT = (2.45, 2.64, 2.67, 5.96)
RECORD = 7.2  # t* at which the record of the pressures ends
SECOND = 5.5  # t* from which the water that falls back hits the rest

earlier = {}  # spacing -> the peaks of the runs so far


def scales(run):
    """sqrt(g / H) and rho g H of a run."""
    g = -run.case["fluid"]["gravity"][1]
    return np.sqrt(g / H), run.case["fluid"]["density"] * g * H


def pressures(run):
    """t* and the four pressures over rho g H, of every step."""
    rate, unit = scales(run)
    return run.probes["t"] * rate, [run.probes[f"p_{k}"] / unit for k in range(1, 5)]


def mean_over(t, p, width):
    """The running mean of a pressure over `width`, by its impulse: a step's pressure holds since the step before."""
    impulse = np.concatenate([[0.0], np.cumsum(p[1:] * np.diff(t))])
    return (np.interp(t + width / 2, t, impulse) - np.interp(t - width / 2, t, impulse)) / width


def level_error(run, gauge, at, measured, until=np.inf):
    """Mean of the level's absolute error over H, at the times at <= until."""
    rate, _ = scales(run)
    use = (at <= until) & np.isfinite(measured)
    return np.abs(np.interp(at[use], run.gauges["t"] * rate, run.gauges[gauge] / H) - measured[use]).mean()


def rows(run, data):
    lines = []
    series = {name: column for name, column in (data or {}).items() if name.startswith("H")}
    for k in range(4):
        gauge, at, measured = f"H{k + 1}", LEVELS_AT, LEVELS[:, k]
        if series:
            at = data["tstar"]
            measured = np.nanmean([column for name, column in series.items() if name.startswith(gauge)], axis=0)
        for until in (SECOND, np.inf):
            lines.append(c.row(f"level {gauge}, mean error over H until t* = {min(until, at[-1]):.3g}",
                               level_error(run, gauge, at, measured, until), 0.0, scale=1.0, source=SOURCE))
    t, p = pressures(run)
    for k in range(4):
        lines.append(c.row(f"impact at sensor {k + 1}, t*", t[(p[k] > 0.1).argmax()], IMPACTS[k], source=SOURCE))
    width = run.spacing / np.sqrt(2 * 9.81 * H) * scales(run)[0]
    mine = [[(value if steps else mean_over(t, value, width))[t < RECORD].max() for value in p] for steps in (True, False)]
    peaks = earlier.setdefault(run.spacing, [])
    peaks.append(mine)
    word = f"median of {len(peaks)} runs: " if len(peaks) > 1 else ""
    for steps, name in ((0, "largest mean over dp/sqrt(2 g H)"), (1, "largest of a step")):
        for k in range(4):
            lines.append(c.row(f"{word}pressure at sensor {k + 1}, {name}", np.median([peak[1 - steps][k] for peak in peaks]),
                               PEAKS[k][1:], source=SOURCE))
    after = t > SECOND
    jumps = [np.abs(np.diff(value[after])).max() for value in p]
    lines.append(c.row("largest jump of a step after the second impact", max(jumps), (0.0, 0.3), scale=1.0, source="bar"))
    if data and "p2_median" in data:
        use = (data["tstar"] > 2.3) & (data["tstar"] < t[-1])
        signal = np.interp(data["tstar"][use], t, mean_over(t, p[1], width))
        inside = (signal >= data["p2_low"][use]) & (signal <= data["p2_high"][use])
        lines.append(c.row("share of the time that sensor 2 is in the 95 % band", inside.mean(), 1.0, source=SOURCE))
    return lines


def draw(runs, figure, data):
    axes = figure.subplots(2, 4, sharex=True)
    colours = dict(zip(sorted({run.spacing for run in runs}, reverse=True), c.COLOURS))
    for run in runs:
        rate, _ = scales(run)
        t, p = pressures(run)
        width = run.spacing / np.sqrt(2 * 9.81 * H) * rate
        first = run.spacing not in [other.spacing for other in runs[: runs.index(run)]]
        style = {"lw": 0.7, "color": colours[run.spacing], "label": c.label(run, SIZE) if first else None}
        for k in range(4):
            axes[0, k].plot(run.gauges["t"] * rate, run.gauges[f"H{k + 1}"] / H, **style)
            axes[1, k].plot(t, mean_over(t, p[k], width), **style)
    for k in range(4):
        axes[0, k].plot(LEVELS_AT, LEVELS[:, k], "ko", ms=4, label="measured")
        axes[0, k].set(title=f"level / H at H{k + 1}", ylim=(0, 1.3))
        axes[1, k].plot([PEAKS_AT[k]] * 2, PEAKS[k][1:], "k", lw=3, alpha=0.6)
        axes[1, k].plot(PEAKS_AT[k], PEAKS[k][0], "ko", ms=4, label="peak, 95 % band")
        axes[1, k].set(title=f"p / rho g H, sensor {k + 1}", xlabel="t sqrt(g/H)", xlim=(0, 11.4), ylim=(-0.3, 4.6))
        for name, column in (data or {}).items():
            if name.startswith((f"H{k + 1}_", f"p{k + 1}")):
                axes[int(name[0] == "p"), k].plot(data["tstar"], column, "k", lw=0.7)
    axes[0, 1].legend(fontsize=8)
    axes[1, 1].legend(fontsize=8)


SIZE = ("H/dp", H)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "levels, an event's pressures or percentiles of sensor 2, over t*", height=5.0)
