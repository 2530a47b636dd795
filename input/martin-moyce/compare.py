#!/usr/bin/python3
"""Compares runs of the collapsing column with the experiment: the front on the floor, the height of the column.

--data FILE: the measured series, columns series, quantity, tscaled, value. The word of a series begins with n2_2 or n2_1, by
the column's height over its width; the quantity is Z, the front over T, or H, the height over tau."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "Martin & Moyce 1952"
# For each n2, height over width a of the column: the front x / a at T = t sqrt(n2 g / a), and the column's height over the
# first at tau = t sqrt(g / a). n2 = 2: tables 2 and 6 of the paper; n2 = 1: its figures.
FRONT = {
    2: np.array([[0.41, 1.11], [0.84, 1.22], [1.19, 1.44], [1.43, 1.67], [1.63, 1.89], [1.83, 2.11], [1.98, 2.33],
                 [2.20, 2.56], [2.32, 2.78], [2.51, 3.00], [2.65, 3.22], [2.83, 3.44], [2.98, 3.67], [3.11, 3.89],
                 [3.33, 4.11]]),
    1: np.array([[0.43, 1.11], [0.80, 1.44], [1.14, 1.89], [1.45, 2.33], [1.76, 2.78], [2.07, 3.22], [2.40, 3.67],
                 [2.71, 4.11], [3.04, 4.56], [3.32, 5.00]]),
}
COLUMN = {
    2: np.array([[0.56, 0.94], [0.93, 0.83], [1.28, 0.72], [1.66, 0.61], [2.00, 0.50], [2.45, 0.39], [3.06, 0.28],
                 [4.20, 0.17], [5.25, 0.11], [7.40, 0.06]]),
    1: np.array([[0.80, 0.89], [1.29, 0.78], [1.74, 0.67], [2.15, 0.56], [2.57, 0.44], [3.08, 0.33], [4.27, 0.22]]),
}
LARGEST_SHIFT = 0.25  # of the clock: the paper fitted its origin


def curves(run):
    """n2, T and front, tau and height, each scaled as measured."""
    region, g = run.case["fluid"]["region"][0], -run.case["fluid"]["gravity"][1]
    a, height = region["high"]
    n2, t = round(height / a), run.gauges["t"]
    return n2, t * np.sqrt(n2 * g / a), run.gauges["front"] / a, t * np.sqrt(g / a), run.gauges["column"] / height


def measurements(n2, data):
    """The measured front and height of the column: of the tables above, or those of `data`, in the order of their time."""
    if not data:
        return FRONT[n2], COLUMN[n2]
    found = [data.of(("tscaled", "value"), series=f"n2_{n2}", quantity=quantity) for quantity in "ZH"]
    return [rows[rows[:, 0].argsort()] for rows in found]


def shift(t, front, measured):
    """The shift of the clock for which the front differs least, by the mean of its relative error; and that error."""
    shifts = np.linspace(-LARGEST_SHIFT, LARGEST_SHIFT, 101)
    errors = [np.abs(np.interp(measured[:, 0] - s, t, front) / measured[:, 1] - 1).mean() for s in shifts]
    return shifts[np.argmin(errors)], min(errors)


def rows(run, data):
    n2, t, front, tau, height = curves(run)
    measured, column = measurements(n2, data)
    column = column[column[:, 0] <= tau[-1]]
    lag, error = shift(t, front, measured)
    plain = np.abs(np.interp(measured[:, 0], t, front) / measured[:, 1] - 1).mean()
    late = (t > 1.4) & (t < 3.3)
    arrival = np.interp(measured[2:, 1], np.maximum.accumulate(front) + 1e-9 * t, t) / measured[2:, 0] - 1
    return [
        c.row("front, mean error, clock shifted", error, 0.0, scale=1.0, source=SOURCE),
        c.row("shift of the clock in T", lag),
        c.row("front, mean error, no shift", plain, 0.0, scale=1.0, source=SOURCE),
        c.row("arrival, mean error of the time, no shift", np.abs(arrival).mean(), 0.0, scale=1.0, source=SOURCE,
              beat="REEF3D 7 to 8 %"),
        c.row("speed of the front dZ/dT, T = 1.4 to 3.3", np.polyfit(t[late], front[late], 1)[0], {2: 1.32, 1: 1.40}[n2],
              source=SOURCE),
        c.row("height of the column, mean error over the first height",
              np.abs(np.interp(column[:, 0], tau + lag / np.sqrt(n2), height) - column[:, 1]).mean(), 0.0, scale=1.0,
              source=SOURCE),
    ]


def draw(runs, figure, data):
    fronts, columns = figure.subplots(1, 2)
    for run, colour in zip(runs, c.COLOURS):
        n2, t, front, tau, height = curves(run)
        lag, _ = shift(t, front, measurements(n2, data)[0])
        name = f"height/width {n2}, {c.label(run, SIZE)}"
        fronts.plot(t + lag, front, color=colour, label=f"{name}, clock {lag:+.2f}")
        columns.plot(tau + lag / np.sqrt(n2), height, color=colour, label=name)
    for n2, mark in ((2, "ko"), (1, "k^")):
        front, column = measurements(n2, data)
        fronts.plot(*front.T, mark, ms=4, mfc="none", label=f"measured, height/width {n2}")
        columns.plot(*column.T, mark, ms=4, mfc="none")
    fronts.set(title="front / width a", xlabel="t sqrt(n² g/a)", xlim=(0, 3.6), ylim=(0.9, 5.2))
    columns.set(title="height of the column / first height", xlabel="t sqrt(g/a)", ylim=(0, 1.05))
    fronts.legend(fontsize=8)


def SIZE(run):
    return "a/dp", run.case["fluid"]["region"][0]["high"][0]


if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured series: series, quantity, tscaled, value")
