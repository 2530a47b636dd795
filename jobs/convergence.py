#!/usr/bin/python3
"""Table (Markdown) and figures of the convergence study. Usage: convergence.py DIR

Reads DIR/<scheme>-<start>-<angle>-<H/dp>/ (validation and history), prints the table, writes DIR/error.png and, of the
60 degree jet, DIR/force.png, the force on the plate step by step. Film thicknesses are over those of the exact jet
measured alike.
"""

import csv
import json
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

METRICS = {
    "wall": lambda m, a: m["wall_l2"],
    "force": lambda m, a: m["force_ratio"],
    "field": lambda m, a: m["field_l2"],
    "mean field": lambda m, a: m["mean_field_l2"],
    "velocity": lambda m, a: m["velocity_rms"],
    "surface [dp]": lambda m, a: m["surface_rms_dp"],
    "film h1": lambda m, a: m["film_h1"] / a["film_h1"],
    "film h2": lambda m, a: m["film_h2"] / a["film_h2"],
}
COLOURS = ("#0072B2", "#D55E00", "#000000")  # Okabe & Ito: told apart by colour-blind readers, too
ERRORS = {"wall": "wall pressure", "field": "pressure in a snapshot", "velocity": "velocity"}


def read(root):
    runs = {}
    for path in root.glob("*/validation/validation.json"):
        parts = path.parent.parent.name.split("-")
        if len(parts) != 4:
            continue
        report = json.loads(path.read_text())
        values = {}
        for name, value in METRICS.items():
            try:
                values[name] = value(report["metrics"], report["analytic"])
            except TypeError:  # a metric is null
                values[name] = None
        runs[(*parts[:2], float(parts[2]), int(parts[3]))] = {"status": report["status"], **values}
    return dict(sorted(runs.items()))


def print_table(runs):
    print("| scheme | start | angle | H/dp | " + " | ".join(METRICS) + " |")
    print("|" + "---|" * (4 + len(METRICS)))
    for (scheme, start, angle, resolution), values in runs.items():
        cells = ["-" if values[name] is None else f"{values[name]:.3f}" for name in METRICS]
        if values["status"] != "finished":
            cells[0] = values["status"]
        print(f"| {scheme} | {start} | {angle:g} | {resolution} | " + " | ".join(cells) + " |")


def slope(points):
    """Of log error over log spacing, least squares."""
    x = [-math.log(n) for n, _ in points]
    y = [math.log(e) for _, e in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def draw(runs, path):
    figure, panels = plt.subplots(1, len(ERRORS), layout="constrained", figsize=(13, 4.5), dpi=110)
    for axes, (metric, title) in zip(panels, ERRORS.items()):
        for scheme, line in (("consistent", "-"), ("paper", ":")):
            for k, angle in enumerate(sorted({key[2] for key in runs if key[1] == "impact"})):
                points = [
                    (key[3], values[metric])
                    for key, values in runs.items()
                    if key[:3] == (scheme, "impact", angle) and values[metric] and values["status"] == "finished"
                ]
                if not points:
                    continue
                label = f"{scheme}, {angle:g}°" + (f", slope {slope(points):.1f}" if len(points) > 1 else "")
                axes.loglog([1 / n for n, _ in points], [e for _, e in points], line, color=COLOURS[k % 3], marker="os^"[k % 3], label=label)
        ticks = sorted({key[3] for key in runs})
        axes.set_xticks([1 / n for n in ticks], [f"1/{n}" for n in ticks], minor=False)
        axes.minorticks_off()
        axes.set(xlabel="dp / H", title=f"relative error of the {title}")
        axes.grid(alpha=0.3)
        if axes.lines:
            axes.legend(fontsize=7)
    figure.savefig(path)


def draw_force(root, runs, path):
    """The last half second of both schemes at the finest resolution that both have."""
    common = [key[3] for key in runs if key[:3] == ("paper", "impact", 60) and ("consistent", *key[1:]) in runs]
    if not common:
        return
    figure, axes = plt.subplots(layout="constrained", figsize=(9, 3.5), dpi=110)
    for scheme, colour in (("paper", "tab:orange"), ("consistent", "tab:blue")):
        folder = root / f"{scheme}-impact-60-{max(common)}"
        force = json.loads((folder / "validation/validation.json").read_text())["analytic"]["force"]
        with open(next(folder.glob("*_history.csv")), newline="") as file:
            lines = [(float(line["t"]), float(line["plate_force"]) / force) for line in csv.DictReader(file)]
        lines = [line for line in lines if line[0] > lines[-1][0] - 0.5]
        axes.plot(*zip(*lines), lw=0.7, color=colour, label=scheme)
    axes.axhline(1.0, color="0.3", lw=0.8, ls="--", label="analytic")
    axes.set(xlabel="t [s]", ylabel="force on the plate / analytic", title=f"60°, H/dp = {max(common)}, every step")
    axes.legend()
    figure.savefig(path)


def main():
    root = pathlib.Path(sys.argv[1])
    runs = read(root)
    if not runs:
        sys.exit(f"{sys.argv[0]}: no validation.json below {root}")
    print_table(runs)
    draw(runs, root / "error.png")
    draw_force(root, runs, root / "force.png")


if __name__ == "__main__":
    main()
