#!/usr/bin/env python3
"""Draws a run of a jet case beside the analytic jet.

impinge-plot DIR reads DIR/validation (what impinge-validate wrote) and the last snapshot in DIR, and writes
pressure.png, wall_pressure.png, film_thickness.png and ranks.png into DIR/validation. Needs h5py and matplotlib: of the
first python3 on the PATH, else of the system's. Exit code 3: neither has them.
"""

import argparse
import csv
import json
import os
import pathlib
import sys

try:
    import h5py
    import matplotlib
    import numpy as np

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import EllipseCollection
except ImportError as error:
    SYSTEM = "/usr/bin/python3"
    if sys.executable != SYSTEM and os.path.exists(SYSTEM):
        os.execv(SYSTEM, [SYSTEM, *sys.argv])
    print(f"impinge-plot: {error}; {sys.executable} needs the packages h5py and matplotlib", file=sys.stderr)
    sys.exit(3)

FLUID, INLET, WALL, GHOST = range(4)
COMPUTED, ANALYTIC = "#1f5fa8", "#c0392b"
LABELLED_CP = (0.1, 0.3, 0.5, 0.7, 0.9)

plt.rcParams.update({"figure.dpi": 160, "font.size": 10, "axes.grid": False, "legend.frameon": False})


def read_table(path):
    """Columns of a CSV file by name, as arrays."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = np.array(rows[1:], dtype=float).reshape(-1, len(rows[0]))
    return dict(zip(rows[0], values.T))


class Run:
    """The report, the analytic lines and the last snapshot of a run; x and y in jet widths."""

    def __init__(self, directory):
        self.folder = directory / "validation"
        self.report = json.loads((self.folder / "validation.json").read_text())
        parameters = self.report["parameters"]
        self.width = parameters["width"]
        self.spacing = parameters["spacing"] / self.width
        self.dynamic_pressure = self.report["analytic"]["stagnation_pressure"]
        self.plate = np.array([parameters["plate_begin"], parameters["plate_end"]]) / self.width

        surface = read_table(self.folder / "surface.csv")
        self.surface = [
            np.column_stack((surface["x_m"], surface["y_m"]))[surface["sheet"] == sheet] / self.width for sheet in (1, 2)
        ]
        isobars = read_table(self.folder / "isobars.csv")
        line = np.column_stack((isobars["x_m"], isobars["y_m"])) / self.width
        self.isobars = {cp: line[isobars["cp"] == cp] for cp in np.unique(isobars["cp"])}

        with h5py.File(directory / self.report["last_snapshot"], "r") as file:
            data = file["VTKHDF/PointData"]
            position = file["VTKHDF/Points"][:, :2] / self.width
            self.type, self.rank = data["type"][:], data["rank"][:]
            pressure = data["pressure"][:]
        finite = np.isfinite(position).all(axis=1)
        self.not_drawn = np.count_nonzero(~(finite & np.isfinite(pressure)))
        corners = np.vstack((*self.surface, np.column_stack((self.plate, [0, 0]))))
        margin = 0.15 + 6 * self.spacing  # the inlet buffer and the ghosts of the wall
        self.low, self.high = corners.min(axis=0) - margin, corners.max(axis=0) + margin
        near = finite & (np.where(finite[:, None], np.abs(position), np.inf) < 100).all(axis=1)
        self.position = np.where(near[:, None], position, np.nan)
        self.pressure = pressure

    def height_of_panel(self, width):
        return width * (self.high[1] - self.low[1]) / (self.high[0] - self.low[0])

    def title(self):
        parameters, report = self.report["parameters"], self.report
        return (
            f"{report['case']}: {parameters['angle']:g}°, $H/d_p$ = {parameters['width_over_spacing']:g}, "
            + (f"paper's scheme, $\\gamma$ = {parameters['gamma']:g}" if parameters["scheme"] == "paper" else "consistent scheme")
            + f", t = {report['time']:.3f} s"
            + (f" ({report['status']})" if report["status"] != "finished" else "")
        )

    def save(self, figure, name):
        path = self.folder / name
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)
        print(f"figure     {path}")


def draw_particles(axes, run, chosen, **colours):
    """Discs of area dp^2 at the chosen particles."""
    size = np.full(np.count_nonzero(chosen), run.spacing * 2 / np.sqrt(np.pi))
    discs = EllipseCollection(
        size, size, np.zeros_like(size), units="xy", offsets=run.position[chosen], offset_transform=axes.transData,
        linewidths=0, **colours,
    )
    return axes.add_collection(discs)


def draw_surface(axes, run, colour):
    for k, line in enumerate(run.surface):
        axes.plot(*line.T, color=colour, lw=1.1, label="analytic free surface" if k == 0 else None)


def frame(axes, run):
    axes.set(xlim=(run.low[0], run.high[0]), ylim=(run.low[1], run.high[1]), aspect="equal", ylabel="y / H")
    axes.set_facecolor("white")


def draw_isobars(axes, run):
    for cp in LABELLED_CP:
        nearest = min(run.isobars, key=lambda level: abs(level - cp))
        axes.plot(*run.isobars[nearest].T, color="white", lw=0.8)


def plot_pressure(run):
    """The last snapshot above the analytic field, with the same isobars drawn in both."""
    figure, (computed, analytic) = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(8, 2 * run.height_of_panel(6.2) + 1.2))
    norm, colours = plt.Normalize(0, run.dynamic_pressure), plt.get_cmap("turbo")
    moving = np.isin(run.type, (FLUID, INLET)) & np.isfinite(run.position).all(axis=1) & np.isfinite(run.pressure)
    draw_particles(computed, run, np.isin(run.type, (WALL, GHOST)) & np.isfinite(run.position[:, 0]), facecolors="0.75")
    discs = draw_particles(computed, run, moving, array=run.pressure[moving], cmap=colours, norm=norm)

    fluid = np.vstack((run.surface[0], run.surface[1][::-1], [[run.plate[0], 0], [run.plate[1], 0]]))
    analytic.fill(*fluid.T, color=colours(norm(0)), lw=0)
    for cp in sorted(run.isobars):
        analytic.fill(*run.isobars[cp].T, color=colours(cp), lw=0)
    analytic.plot(run.plate, [0, 0], color="0.4", lw=2)

    for axes, name in ((computed, "computed"), (analytic, "analytic")):
        frame(axes, run)
        draw_surface(axes, run, "black")
        draw_isobars(axes, run)
        axes.text(0.98, 0.95, name, transform=axes.transAxes, ha="right", va="top", fontsize=12)
    analytic.set_xlabel("x / H")
    values = run.pressure[moving & (run.type == FLUID)]
    range_text = f"computed {values.min():.4g} to {values.max():.4g} Pa" if values.size else "no finite pressure"
    missing = f"; {run.not_drawn} particles not finite" if run.not_drawn else ""
    computed.set_title(f"{run.title()}\n{range_text}{missing}", fontsize=10)
    levels = ", ".join(f"{cp:g}" for cp in LABELLED_CP)
    figure.colorbar(
        discs, ax=[computed, analytic], extend="both", shrink=0.7,
        label=f"pressure [Pa], clipped to 0..$\\rho U^2/2$; white: analytic $C_p$ = {levels}",
    )
    run.save(figure, "pressure.png")


def plot_profile(run, table, computed, analytic, y_label, name, note):
    """A profile along the plate, computed and analytic."""
    figure, axes = plt.subplots(layout="constrained", figsize=(8, 4))
    x = table["x_m"] / run.width
    # Lines stop at the gap between the two sheets.
    gap = np.flatnonzero(np.diff(x) > 1.5 * np.diff(x).min()) + 1 if x.size > 1 else []
    for column, style in (
        (computed, dict(color=COMPUTED, marker=".", ms=4, lw=0.8, label="computed")),
        (analytic, dict(color=ANALYTIC, lw=1.4, label="analytic")),
    ):
        for xs, values in zip(np.split(x, gap), np.split(table[column], gap)):
            axes.plot(xs, values, **style)
            style["label"] = None
    axes.axhline(0, color="0.7", lw=0.8, zorder=0)
    axes.set(xlim=tuple(run.plate), xlabel="x / H from the stagnation point", ylabel=y_label)
    axes.set_title(f"{run.title()}\n{note}", fontsize=10)
    axes.legend()
    if not np.isfinite(table[computed]).any():
        axes.text(0.5, 0.5, "nothing to draw", transform=axes.transAxes, ha="center", color="0.4")
    run.save(figure, name)


def plot_wall_pressure(run):
    window = run.report["window"]
    note = f"averaged over {window['begin']:.3f}..{window['end']:.3f} s" if window else "no time average yet"
    table = read_table(run.folder / "wall_pressure.csv")
    plot_profile(run, table, "pressure_Pa", "analytic_Pa", "wall pressure [Pa]", "wall_pressure.png", note)


def plot_film_thickness(run):
    times = run.report["snapshots"]
    note = f"mean of {times['count']} snapshot(s), {times['first_time']:.3f}..{times['last_time']:.3f} s"
    table = read_table(run.folder / "film_thickness.csv")
    plot_profile(run, table, "thickness_m", "analytic_m", "film thickness [m]", "film_thickness.png", note)


def plot_ranks(run):
    """Which rank has which particle."""
    figure, axes = plt.subplots(layout="constrained", figsize=(8, run.height_of_panel(6.6) + 0.8))
    drawn = np.isfinite(run.position).all(axis=1)
    ranks = int(run.rank.max()) + 1 if run.rank.size else 1
    palette = matplotlib.colors.ListedColormap([plt.get_cmap("tab20")(rank % 20) for rank in range(ranks)])
    norm = plt.Normalize(-0.5, ranks - 0.5)
    discs = draw_particles(axes, run, drawn, array=run.rank[drawn].astype(float), cmap=palette, norm=norm)
    frame(axes, run)
    axes.set_xlabel("x / H")
    axes.set_title(run.title(), fontsize=10)
    ticks = np.unique(np.linspace(0, ranks - 1, min(ranks, 10)).round())
    figure.colorbar(discs, ax=axes, ticks=ticks, shrink=0.7, label="rank")
    run.save(figure, "ranks.png")


def main():
    parser = argparse.ArgumentParser(
        prog="impinge-plot", description="Draws a run that impinge-validate has measured; figures go to DIR/validation."
    )
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path, help="output directory of the run")
    try:
        run = Run(parser.parse_args().directory)
        for plot in (plot_pressure, plot_wall_pressure, plot_film_thickness, plot_ranks):
            plot(run)
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"impinge-plot: {error}")


if __name__ == "__main__":
    main()
