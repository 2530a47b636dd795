#!/usr/bin/python3
"""Compares runs of the dam break against a box with the experiment: levels at two gauges, pressures at two sensors.

--data FILE: the measured levels, columns t, H1 to H4 [s, m], or pressures, columns t, P1 to P8 [s, Pa]."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/programs"))
import impinge_compare as c  # noqa: E402

SOURCE = "Kleefsman et al. 2005"
DEPTH = 0.55  # [m]
# Levels at H2 and H4 [m] at times [s], of the test's published record.
AT = np.array([0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0])
LEVELS = {
    "H2": np.array([0.001, 0.046, 0.099, 0.120, 0.131, 0.147, 0.166, 0.179, 0.186, 0.196, 0.206, 0.201, 0.237,
                    0.286, 0.281, 0.203, 0.136, 0.251, 0.214]),
    "H4": np.array([0.511, 0.459, 0.427, 0.395, 0.363, 0.332, 0.303, 0.279, 0.254, 0.233, 0.214, 0.197, 0.182,
                    0.130, 0.104, 0.202, 0.331, 0.233, 0.186]),
}
LARGEST = {"H2": 0.341, "H4": 0.550}
# Sensors: the time when the pressure passes 300 Pa [s], its largest value [Pa], its impulse from 0.35 to 0.8 s [Pa s], its
# mean from 1 to 1.5 s [Pa].
PRESSURES = {"P1": (0.393, 11240.0, 2209.0, 2830.0), "P2": (0.410, 8130.0, 1884.0, 2210.0)}
FIRST_WATER = 0.358  # at H2 [s]
BEATS = {"H2": "interFoam, 0.04 m: 3.0 %", "H4": "interFoam, 0.04 m: 1.8 %", "P2": "interFoam, 0.04 m: -15.5 %"}


def pressure(run, name):
    """t and a sensor's pressure, as its mean over dp/sqrt(2 g h): the time in which the front passes a spacing."""
    t, p = run.probes["t"], run.probes[f"p_{name}"]
    width = run.spacing / np.sqrt(2 * 9.81 * DEPTH)
    impulse = np.concatenate([[0.0], np.cumsum(p[1:] * np.diff(t))])  # a step's pressure holds since the step before
    return t, (np.interp(t + width / 2, t, impulse) - np.interp(t - width / 2, t, impulse)) / width


def rows(run, data):
    lines = []
    end = run.gauges["t"][-1]
    for name, measured in LEVELS.items():
        at = AT
        if data and name in data:
            at, measured = data["t"], data[name]
        for until in [1.5, 6.0]:
            if end < until - 0.01:
                continue
            use = at <= until
            error = np.abs(np.interp(at[use], run.gauges["t"], run.gauges[name]) - measured[use]).mean()
            lines.append(c.row(f"level {name} to {until:g} s, mean error over its largest", error, 0.0, scale=LARGEST[name],
                               beat=BEATS[name] if until == 1.5 else "", source=SOURCE))
    t, level = run.gauges["t"], run.gauges["H2"]
    lines.append(c.row("first water at H2 [s]", t[(level > 0.01).argmax()], FIRST_WATER, source=SOURCE))
    for name, (arrival, largest, impulse, mean) in PRESSURES.items():
        t, p = run.probes["t"], run.probes[f"p_{name}"]
        lines.append(c.row(f"arrival at {name} [s]", t[(p > 300).argmax()], arrival, source=SOURCE,
                           beat="interFoam, 0.04 m: +2.4 %" if name == "P1" else ""))
        first = t < 0.9
        lines.append(c.row(f"largest pressure at {name} [Pa], mean over dp/sqrt(2 g h)", pressure(run, name)[1][first].max(),
                           largest, beat=BEATS.get(name, ""), source=SOURCE))
        lines.append(c.row(f"largest pressure at {name} of a step [Pa]", p[first].max(), largest, source=SOURCE))
        use = (t > 0.35) & (t <= 0.8)
        lines.append(c.row(f"impulse at {name}, 0.35 to 0.8 s [Pa s]", (p[1:] * np.diff(t))[use[1:]].sum(), impulse,
                           source=SOURCE))
        late = (t > 1.0) & (t <= 1.5)
        lines.append(c.row(f"mean pressure at {name}, 1 to 1.5 s [Pa]", p[late].mean(), mean, source=SOURCE))
    lines.append(c.row("volume lost", run.history["lost"][-1] / run.history["in"][-1], 0.0, scale=1.0, source=SOURCE))
    return lines


def draw(runs, figure, data):
    axes = figure.subplots(2, 2, sharex=True)
    for run, colour in zip(runs, c.COLOURS):
        for here, name in zip(axes[0], PRESSURES):
            t, p = pressure(run, name)
            here.plot(t, p / 1000, lw=0.8, color=colour, label=c.label(run, SIZE))
        for here, name in zip(axes[1], LEVELS):
            here.plot(run.gauges["t"], run.gauges[name], lw=0.8, color=colour)
    for here, (name, (arrival, largest, impulse, mean)) in zip(axes[0], PRESSURES.items()):
        here.plot([arrival] * 2, [0, largest / 1000], "k--", lw=1, label="measured: arrival, largest, mean from 1 s")
        here.plot(arrival, largest / 1000, "ko", ms=4)
        here.plot([1.0, 1.5], [mean / 1000] * 2, "k")
        here.set(title=f"pressure at {name} [kPa]", ylim=(-0.5, 13))
    for here, (name, measured) in zip(axes[1], LEVELS.items()):
        here.plot(AT, measured, "ko", ms=4)
        here.set(title=f"level at {name} [m]", xlabel="t [s]", xlim=(0, runs[-1].gauges["t"][-1]))
    for here, name in [*zip(axes[0], PRESSURES), *zip(axes[1], LEVELS)]:
        if data and name in data:
            here.plot(data["t"], data[name] / (1000 if name in PRESSURES else 1), "k", lw=0.7)
    axes[0, 0].legend(fontsize=8)


SIZE = ("depth/dp", DEPTH)

if __name__ == "__main__":
    c.main(__doc__, rows, draw, SIZE, "the measured levels: t, H1 to H4; or pressures: t, P1 to P8", height=5.0)
