#!/usr/bin/env python3
"""Draws a run.

impinge-plot DIR draws a snapshot in DIR, the last or the one that --step or --time names, and the tables of the run:
pressure.png, speed.png, surface.png, and history.png, probes.png, gauges.png, sections.png, forces.png, outlets.png where
there is such a table, into DIR/<case>_figures. In three dimensions these show a slice, and free_surface.png and
wall_pressure.png show the fluid among the walls, and the pressure on them, in space.

impinge-plot --scene FILE draws the scene that impinge --check has written, <case>_scene.vtkhdf, as <case>_scene.png.

impinge-plot DIR --animate draws the pressure of all snapshots as a film instead: pressure.mp4 where ffmpeg is at hand, else
pressure.gif.

If DIR/validation holds what impinge-validate wrote of a jet, it also draws the jet beside the analytic one:
pressure.png, wall_pressure.png, film_thickness.png and ranks.png in DIR/validation; of a wedge or a cup
wall_pressure.png; of a round jet wall_pressure.png, film_thickness.png and wall_map.png.

Needs h5py and matplotlib: of the first python3 on the PATH, else of the system's. Exit code 3: neither has them. The
pictures in space need scikit-image, too; without it the others are drawn.
"""

import argparse
import os
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "share/impinge"))
sys.dont_write_bytecode = True  # an installation is removed whole

try:
    import h5py
    import matplotlib
    import numpy as np

    import impinge

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.animation import FFMpegWriter, PillowWriter
    from matplotlib.collections import EllipseCollection
except ImportError as error:
    SYSTEM = "/usr/bin/python3"
    if sys.executable != SYSTEM and os.path.exists(SYSTEM):
        os.execv(SYSTEM, [SYSTEM, *sys.argv])
    print(f"impinge-plot: {error}; {sys.executable} needs the packages h5py and matplotlib", file=sys.stderr)
    sys.exit(3)

from impinge import FLUID, GHOST, INLET, WALL

COMPUTED, ANALYTIC = "#1f5fa8", "#c0392b"
FILM_RATE = 12  # snapshots per second
LABELLED_CP = (0.1, 0.3, 0.5, 0.7, 0.9)

plt.rcParams.update({"figure.dpi": 160, "font.size": 10, "axes.grid": False, "legend.frameon": False})


class JetRun:
    """The comparison of impinge-validate; lengths in widths of the jet, of a round one in diameters."""

    def __init__(self, run):
        self.validation = run.validation
        self.folder, self.report = self.validation.folder, self.validation.report
        parameters = self.report["parameters"]
        self.width = parameters["width"]
        self.spacing = parameters["spacing"] / self.width
        self.dynamic_pressure = self.report["analytic"]["stagnation_pressure"]
        self.plate = np.array([parameters["plate_begin"], parameters["plate_end"]]) / self.width
        self.is_round = self.report["target"] == "flat_wall"
        self.unit = "D" if self.is_round else "H"
        self.has_field = self.report["target"] in ("plate", "jet")
        self.plots = ((plot_wall_pressure, plot_film_thickness, plot_wall_map) if self.is_round else
                      (plot_pressure, plot_wall_pressure, plot_film_thickness, plot_ranks) if self.has_field else
                      (plot_wall_pressure,))
        if self.has_field:
            self.read_field(run.directory)

    def read_field(self, directory):
        """The analytic lines and the last snapshot, in the frame of the analytic jet."""
        surface, isobars = self.validation.surface, self.validation.isobars
        lines = np.column_stack((surface["x"], surface["y"])) / self.width
        self.surface = [lines[surface["sheet"] == sheet] for sheet in (1, 2)]
        lines = np.column_stack((isobars["x"], isobars["y"])) / self.width
        self.isobars = {cp: lines[isobars["cp"] == cp] for cp in np.unique(isobars["cp"])}

        snapshot = impinge.Snapshot(directory / self.report["last_snapshot"])
        position = self.validation.to_frame(snapshot.position[:, : self.validation.origin.size]) / self.width
        self.type, self.rank, pressure = snapshot.type, snapshot.rank, snapshot.pressure
        finite = snapshot.finite
        self.not_drawn = np.count_nonzero(~(finite & np.isfinite(pressure)))
        corners = np.vstack((*self.surface, np.column_stack((self.plate, [0, 0]))))
        margin = 0.15 + 6 * self.spacing  # the inlet buffer and the ghosts of the wall
        self.low, self.high = corners.min(axis=0) - margin, corners.max(axis=0) + margin
        near = finite & (np.where(finite[:, None], np.abs(position), np.inf) < 100).all(axis=1)
        if self.report["parameters"].get("depth"):
            near &= (self.type != WALL) | (np.abs(position[:, 1]) < self.spacing)  # the plate, not the walls beside the jet
        self.position = np.where(near[:, None], position, np.nan)
        self.pressure = pressure

    def height_of_panel(self, width):
        return width * (self.high[1] - self.low[1]) / (self.high[0] - self.low[0])

    def title(self):
        parameters, report = self.report["parameters"], self.report
        return (
            f"{report['case']}: {report['target'].replace('_', ' ')}, {parameters['angle']:.6g}°, ${self.unit}/d_p$ = {parameters['width_over_spacing']:g}, "
            + (f"paper's scheme, $\\gamma$ = {parameters['gamma']:g}" if parameters["scheme"] == "paper" else "consistent scheme")
            + f", t = {report['time']:.3f} s"
            + (f" ({report['status']})" if report["status"] != "finished" else "")
        )

    def save(self, figure, name):
        path = self.folder / name
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)
        print(f"figure     {path}")


def draw_particles(axes, run, chosen, scale=1.0, **colours):
    """Discs of area dp^2 at the chosen particles, or larger by a factor."""
    size = np.full(np.count_nonzero(chosen), scale * run.spacing * 2 / np.sqrt(np.pi))
    discs = EllipseCollection(
        size, size, np.zeros_like(size), units="xy", offsets=run.position[chosen], offset_transform=axes.transData,
        linewidths=0, **colours,
    )
    discs.set_visible(size.size > 0)  # Matplotlib draws an empty collection as one large disc
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
    norm, colours = plt.Normalize(0, run.dynamic_pressure), plt.get_cmap("viridis")
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
    place = next(iter(table))
    is_length = table.units[place] == "m"
    x = table[place] / (run.width if is_length else 1)
    gap = impinge.sheet_ends(x)  # where lines stop
    for column, style in (
        (computed, dict(color=COMPUTED, marker=".", ms=4, lw=0.8, label="computed")),
        (analytic, dict(color=ANALYTIC, lw=1.4, label="analytic")),
    ):
        if column == analytic and not np.isfinite(table[column]).any():
            continue  # there is no exact solution
        for xs, values in zip(np.split(x, gap), np.split(table[column], gap)):
            axes.plot(xs, values, **style)
            style["label"] = None
    axes.axhline(0, color="0.7", lw=0.8, zorder=0)
    limits = {"x": tuple(run.plate), "azimuth": (-180, 180)}.get(place, (0, max(x, default=1)))
    axes.set(xlim=limits, ylabel=y_label, xlabel=f"{place} / {run.unit} from the stagnation point" if is_length else f"{place} [°]")
    axes.set_title(f"{run.title()}\n{note}", fontsize=10)
    axes.legend()
    if not np.isfinite(table[computed]).any():
        axes.text(0.5, 0.5, "nothing to draw", transform=axes.transAxes, ha="center", color="0.4")
    run.save(figure, name)


def averaged(run):
    window = run.report["window"]
    return f"averaged over {window['begin']:.3f}..{window['end']:.3f} s" if window else "no time average yet"


def plot_wall_pressure(run):
    table = run.validation.wall_pressure
    plot_profile(run, table, "pressure", "analytic", "wall pressure [Pa]", "wall_pressure.png", averaged(run))


def plot_film_thickness(run):
    times = run.report["snapshots"]
    note = f"mean of {times['count']} snapshot(s), {times['first_time']:.3f}..{times['last_time']:.3f} s"
    table = run.validation.film_thickness
    plot_profile(run, table, "thickness", "analytic", "film thickness [m]", "film_thickness.png", note)


def plot_wall_map(run):
    """The averaged wall pressure as seen from above, in the frame of the wall."""
    table = run.validation.wall_map
    figure, axes = plt.subplots(layout="constrained", figsize=(8, 6))
    run.position, chosen = np.column_stack((table["x"], table["y"])) / run.width, np.isfinite(table["pressure"])
    colours = dict(array=table["pressure"][chosen], cmap="viridis", norm=plt.Normalize(0, run.dynamic_pressure))
    discs = draw_particles(axes, run, chosen, 1.2, **colours)
    azimuth, angle = np.linspace(0, 2 * np.pi, 361), np.radians(run.report["parameters"]["angle"])
    edge = 0.5 * np.sin(angle) / (1 - np.cos(angle) * np.cos(azimuth))
    axes.plot(edge * np.cos(azimuth), edge * np.sin(azimuth), color="white", lw=1)
    axes.update_datalim(run.position)
    axes.autoscale_view()
    axes.set(xlabel="x / D, along the incline", ylabel="y / D", aspect="equal")
    axes.set_title(f"{run.title()}\n{averaged(run)}; white: edge of the jet, continued to the wall", fontsize=10)
    figure.colorbar(discs, ax=axes, extend="both", shrink=0.8, label="wall pressure [Pa], clipped to 0..$\\rho U^2/2$")
    run.save(figure, "wall_map.png")


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


class Slice:
    """The particles of a snapshot, in metres; of three dimensions those that a cut holds."""

    def __init__(self, snapshot, spacing, cut):
        self.time, self.step, self.when, self.spacing = snapshot.time, snapshot.step, snapshot.when, spacing
        points, drawn = snapshot.position, snapshot.finite
        self.not_drawn = np.count_nonzero(~drawn)
        self.seen, self.slice = [0, 1], ""
        if cut:
            drawn = drawn & cut.holds(points)
            self.seen, self.slice = cut.seen, f", slice {cut.words}"
        self.axes, points = tuple("xyz"[axis] for axis in self.seen), points[:, self.seen]
        self.position = points[drawn]
        for name in ("pressure", "type", "free_surface", "speed", "fluid"):
            setattr(self, name, getattr(snapshot, name)[drawn])
        if not self.position.size:
            raise ValueError(f"{snapshot.path} has no particle to draw")
        margin = 3 * self.spacing
        self.low, self.high = self.position.min(axis=0) - margin, self.position.max(axis=0) + margin


class Figures:
    """Draws a run whatever its scene, into DIR/<case>_figures."""

    def __init__(self, run, step, time):
        self.run = run
        self.whole, self.cut = run.snapshot(step, time), None
        if self.whole.dimension == 3:
            finite = self.whole.finite
            self.cut = impinge.Cut(self.whole.position[finite & self.whole.fluid], self.whole.position[finite], run.case)
        self.snapshot = Slice(self.whole, run.spacing, self.cut)
        self.ending = "" if step is None and time is None else f"_{self.snapshot.step:08}"
        self.folder = run.file("_figures")
        self.folder.mkdir(exist_ok=True)

    def draw(self):
        self.field("pressure", self.snapshot.pressure, "pressure [Pa]", "viridis")
        self.field("speed", self.snapshot.speed, "speed [m/s]", "cividis")
        self.surface()
        self.space()
        self.tables()

    def save(self, figure, name):
        path = self.folder / name
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)
        print(f"figure     {path}")

    def panel(self):
        """A figure of the scene's shape, with the walls drawn."""
        width, height = self.snapshot.high - self.snapshot.low
        figure, axes = plt.subplots(layout="constrained", figsize=(8, min(9, max(2, 7 * height / width)) + 0.8))
        axes.set(xlim=(self.snapshot.low[0], self.snapshot.high[0]), ylim=(self.snapshot.low[1], self.snapshot.high[1]),
                 aspect="equal", xlabel=f"{self.snapshot.axes[0]} [m]", ylabel=f"{self.snapshot.axes[1]} [m]")
        self.walls(axes, self.snapshot)
        return figure, axes

    def walls(self, axes, snapshot):
        """The walls and the title of a snapshot."""
        walls = np.isin(snapshot.type, (WALL, GHOST))
        # Without ghosts, wall particles stand on the surface.
        draw_particles(axes, snapshot, walls, 1.0 if np.any(snapshot.type == GHOST) else 0.6, facecolors="0.35")
        missing = f"; {snapshot.not_drawn} particles not finite" if snapshot.not_drawn else ""
        axes.set_title(f"{self.run.name}: {snapshot.when}{snapshot.slice}{missing}", fontsize=10)

    def field(self, name, values, label, colours):
        figure, axes = self.panel()
        chosen = self.snapshot.fluid & np.isfinite(values)
        inside, norm = values[chosen], plt.Normalize(*impinge.colour_range(values[self.snapshot.fluid]))
        discs = draw_particles(axes, self.snapshot, chosen, array=inside, cmap=colours, norm=norm)
        largest = f", {inside.min():.4g} to {inside.max():.4g}" if inside.size else ", no fluid"
        figure.colorbar(discs, ax=axes, shrink=0.8, extend="both", label=label + largest)
        self.save(figure, f"{name}{self.ending}.png")

    def film(self):
        """The pressure of all snapshots, with one scale: an mp4 where ffmpeg is at hand, else a gif."""
        def slices():
            return (Slice(snapshot, self.run.spacing, self.cut) for snapshot in self.run.snapshots)

        lows, highs, samples = [], [], []
        for piece in slices():
            lows.append(piece.low)
            highs.append(piece.high)
            pressure = piece.pressure[piece.fluid]
            samples.append(pressure[:: 1 + pressure.size // 10_000])
        norm = plt.Normalize(*impinge.colour_range(np.concatenate(samples)))
        self.snapshot.low, self.snapshot.high = np.min(lows, axis=0), np.max(highs, axis=0)
        figure, axes = self.panel()
        figure.colorbar(matplotlib.cm.ScalarMappable(norm, "viridis"), ax=axes, shrink=0.8, extend="both", label="pressure [Pa]")
        with_ffmpeg = shutil.which("ffmpeg")
        # H.264 takes even numbers of pixels.
        even = ["-pix_fmt", "yuv420p", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"]
        writer = FFMpegWriter(FILM_RATE, extra_args=even) if with_ffmpeg else PillowWriter(FILM_RATE)
        path = self.folder / f"pressure.{'mp4' if with_ffmpeg else 'gif'}"
        with writer.saving(figure, path, dpi=120):
            for piece in slices():
                for drawn in list(axes.collections):
                    drawn.remove()
                chosen = piece.fluid & np.isfinite(piece.pressure)
                draw_particles(axes, piece, chosen, array=piece.pressure[chosen], cmap="viridis", norm=norm)
                self.walls(axes, piece)
                writer.grab_frame()
        plt.close(figure)
        print(f"film       {path}")

    def surface(self):
        figure, axes = self.panel()
        snapshot = self.snapshot
        on_surface = snapshot.fluid & snapshot.free_surface
        draw_particles(axes, snapshot, snapshot.fluid & ~on_surface, facecolors="#b8d4ee")
        draw_particles(axes, snapshot, on_surface, facecolors=ANALYTIC)
        for colour, label in (("#b8d4ee", "fluid"), (ANALYTIC, "free surface"), ("0.35", "walls")):
            axes.plot([], [], "o", color=colour, label=label)
        self.mark_observers(axes)
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
        self.save(figure, f"surface{self.ending}.png")

    def space(self):
        """The pictures of a run in space."""
        for name, figure in impinge.pictures_in_space(self.run, self.whole, lambda text: print(f"impinge-plot: {text}", file=sys.stderr)):
            self.save(figure, f"{name}{self.ending}.png")

    def mark_observers(self, axes):
        """Fixed probes, gauges and sections."""
        styles = {"probe": dict(marker="x", ls="", ms=7, mew=1.5), "gauge": dict(ls="--", lw=1), "section": dict(ls=":", lw=1)}
        for mark in self.run.observers:
            axes.plot(*np.array(mark["points"], dtype=float)[:, self.snapshot.seen].T, color="black", **styles[mark["kind"]])
        for kind, style in (("probe", "x"), ("gauge", "--"), ("section", ":")):
            if self.run.case.get(kind):
                axes.plot([], [], style, color="black", label=kind)

    def tables(self):
        """The curves of each table in a figure of its own, those of one quantity in a panel."""
        panels = impinge.panels(self.run)
        for kind in dict.fromkeys(kind for kind, *_ in panels):
            own = [panel for panel in panels if panel[0] == kind]
            figure, all_axes = plt.subplots(len(own), 1, sharex=True, squeeze=False, layout="constrained", figsize=(8, 1 + 2.4 * len(own)))
            all_axes[0, 0].set_title(self.run.name, fontsize=10)
            all_axes[-1, 0].set_xlabel("t [s]")
            for axes, (_, label, time, lines) in zip(all_axes[:, 0], own):
                for name, values in lines.items():
                    axes.plot(time, values, lw=1, label=name)
                axes.set_ylabel(label)
                if kind != "history":
                    axes.legend(loc="upper left", bbox_to_anchor=(1, 1), fontsize=8)
            self.save(figure, f"{kind}.png")


class SceneFigure:
    """Draws the scene that impinge --check has written: of three dimensions the particles of a slice, and boxes."""

    LINES = {  # of each item: colour, style and width of its lines, and what it is
        "domain": ("0.7", "--", 0.8, "bounds"),
        "damping": ("#e8b84a", "-", 0.8, "damping"),
        "outlet": ("#c0392b", "-", 1.0, "outlet"),
        "wall": ("black", "-", 1.8, "wall; ticks: its wet sides"),
        "path": ("#8e44ad", "-", 1.0, "path of a wall"),
        "inlet": ("#1e8449", "-", 2.2, "inlet"),
        "gauge": ("#d35400", "--", 1.2, "gauge"),
        "section": ("#d35400", ":", 1.6, "section"),
        "probe": ("#d35400", "x", 1.6, "probe"),
    }
    DISCS = {"fluid": ("#b8d4ee", "fluid"), "inlet": ("#8fd0a5", "rows of an inlet"), "wall": ("black", "wall")}
    AREAS = ("damping", "outlet")

    def __init__(self, path):
        scene = impinge.Scene(path)
        self.case, self.spacing, self.names = scene.name, scene.spacing, scene.names
        self.begin, self.end, self.item, self.number = scene.begin, scene.end, scene.item, scene.number
        self.is_particle = (self.end - self.begin == 1) & (self.item != "probe")
        seen, self.slice = [0, 1], ""
        if scene.dimension == 3:
            places = scene.points[self.begin]
            particles = places[self.is_particle & np.isin(self.item, ("fluid", "inlet"))]
            inside = np.repeat(self.item != "domain", self.end - self.begin)
            cut = impinge.Cut(particles, scene.points[inside], scene.case)
            self.is_particle &= cut.holds(places)
            seen, self.slice = cut.seen, f", particles of a slice {cut.words}" if self.is_particle.any() else ""
        self.axes = tuple("xyz"[axis] for axis in seen)
        self.points, self.normal = scene.points[:, seen], scene.normal[:, seen]
        shown = [self.points[a:b] for a, b, item, one in zip(self.begin, self.end, self.item, self.is_particle)
                 if item != "domain" and (one or b - a > 1 or item == "probe")]
        shown = np.vstack(shown or [self.points])
        margin = 0.04 * max(np.ptp(shown, axis=0).max(), self.spacing)
        self.low, self.high = shown.min(axis=0) - margin, shown.max(axis=0) + margin
        self.tick = 0.012 * (self.high - self.low).max()
        self.position = self.points[self.begin]

    def draw(self, path):
        width, height = self.high - self.low
        figure, axes = plt.subplots(layout="constrained", figsize=(9, min(9, max(2, 7 * height / width)) + 0.8))
        axes.set(xlim=(self.low[0], self.high[0]), ylim=(self.low[1], self.high[1]), aspect="equal",
                 xlabel=f"{self.axes[0]} [m]", ylabel=f"{self.axes[1]} [m]")
        axes.set_title(f"{self.case}: the scene at the start{self.slice}", fontsize=10)
        for item, (colour, label) in self.DISCS.items():
            chosen = self.is_particle & (self.item == item)
            if chosen.any():
                draw_particles(axes, self, chosen, 0.6 if item == "wall" else 1.0, facecolors=colour)
                axes.plot([], [], "o", color=colour, label=label)
        for item, (colour, style, line_width, label) in self.LINES.items():
            chosen = np.flatnonzero((self.item == item) & ((self.end - self.begin > 1) | (item == "probe")))
            if item == "domain" and not self.shows_bounds(chosen):
                continue
            for k in chosen:
                line = self.points[self.begin[k] : self.end[k]]
                if item in self.AREAS and len(line) > 2:
                    axes.fill(*line.T, color=colour, alpha=0.2, lw=0)
                axes.plot(*line.T, style, color=colour, lw=line_width, ms=6, mew=1.5)
            if chosen.size:
                axes.plot([], [], style, color=colour, lw=line_width, label=label)
                self.arrows(axes, item, chosen, colour)
                self.label(axes, item, chosen, colour)
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1), fontsize=8)
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)
        print(f"picture     {path}")

    def shows_bounds(self, chosen):
        """True where an edge of the bounds is in the picture."""
        corners = np.vstack([self.points[self.begin[k] : self.end[k]] for k in chosen])
        return np.any(corners.min(axis=0) > self.low) or np.any(corners.max(axis=0) < self.high)

    def arrows(self, axes, item, chosen, colour):
        """Ticks into the fluid along the walls, and the flow of the inlets."""
        if item == "wall":
            ticks, way = [], self.tick  # to the next tick
            for k in chosen:
                begin, end = self.points[self.begin[k]], self.points[self.end[k] - 1]
                length = np.linalg.norm(end - begin)
                while way <= length:
                    foot = begin + way / length * (end - begin)
                    ticks.append((foot, foot + self.tick * self.normal[k]))
                    way += 2 * self.tick
                way -= length
            axes.add_collection(matplotlib.collections.LineCollection(ticks, colors=COMPUTED, linewidths=0.7))
        if item == "inlet":
            middle = np.array([self.points[self.begin[k] : self.end[k]].mean(axis=0) for k in chosen])
            axes.quiver(*middle.T, *self.normal[chosen].T, color=colour, angles="xy", scale=18, width=0.005, zorder=4)

    def label(self, axes, item, chosen, colour):
        """The name of each element once, at the middle of its longest line."""
        for number in np.unique(self.number[chosen]):
            own = [self.points[self.begin[k] : self.end[k]] for k in chosen if self.number[k] == number]
            if number == 0 or item == "path":
                continue
            longest = max(own, key=lambda line: np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
            place = longest[:-1].mean(axis=0) if item in self.AREAS else longest[[0, -1]].mean(axis=0)
            place = np.clip(place, self.low + 3 * self.tick, self.high - 3 * self.tick)
            axes.annotate(self.names[item][number - 1], place, xytext=(4, 4), textcoords="offset points", fontsize=7,
                          color=colour, zorder=5,
                          bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "alpha": 0.6, "linewidth": 0})


def main():
    parser = argparse.ArgumentParser(
        prog="impinge-plot",
        description="Draws a snapshot and the tables of a run into DIR/<case>_figures, and a jet that impinge-validate "
        "has measured beside the analytic one into DIR/validation.",
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("directory", metavar="DIR", nargs="?", type=pathlib.Path, help="output directory of the run")
    what.add_argument("--scene", metavar="FILE", type=pathlib.Path, help="draw what impinge --check has written instead")
    parser.add_argument("--name", help="case, where the directory has several")
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument("--step", type=int, help="step of the snapshot; default: the last")
    chosen.add_argument("--time", type=float, help="time that the snapshot is nearest to [s]")
    chosen.add_argument("--animate", action="store_true", help="draw the pressure of all snapshots as a film instead")
    arguments = parser.parse_args()
    try:
        if arguments.scene:
            SceneFigure(arguments.scene).draw(arguments.scene.with_suffix(".png"))
            return
        run = impinge.Run(arguments.directory, arguments.name)
        if arguments.animate:
            Figures(run, None, None).film()
            return
        if run.validation:
            jet = JetRun(run)
            for plot in jet.plots:
                plot(jet)
        Figures(run, arguments.step, arguments.time).draw()
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"impinge-plot: {error}")


if __name__ == "__main__":
    main()
