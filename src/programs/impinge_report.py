#!/usr/bin/env python3
"""Writes a page about a run: DIR/<case>_report.html, one file that any browser shows without a network.

The page tells what was computed and how far the run is, plays the snapshots, coloured by pressure, speed or rank, draws
the tables as curves to zoom and read off, compares with the exact flow where impinge-validate has, warns, and says how to
go on. A run that goes on can be looked at: the page shows what there is, and is replaced when impinge-report is called
again.

Needs h5py and matplotlib, of the first python3 on the PATH, else of the system's; and Debian's libjs-dygraphs and
libjs-three, whose code the page holds. Exit code 3: one of these is missing. The pictures of a run in space need
scikit-image, too.
"""

import argparse
import base64
import datetime
import html
import io
import json
import os
import pathlib
import re
import shlex
import sys

SHARE = pathlib.Path(__file__).resolve().parents[1] / "share/impinge"
sys.path.insert(0, str(SHARE))
sys.dont_write_bytecode = True  # an installation is removed whole

try:
    import matplotlib
    import numpy as np

    import impinge
except ImportError as error:
    SYSTEM = "/usr/bin/python3"
    if sys.executable != SYSTEM and os.path.exists(SYSTEM):
        os.execv(SYSTEM, [SYSTEM, *sys.argv])
    print(f"impinge-report: {error}; {sys.executable} needs the packages h5py and matplotlib", file=sys.stderr)
    sys.exit(3)

JAVASCRIPT = pathlib.Path("/usr/share/javascript")
LIBRARIES = ("dygraphs/dygraph.min.js", "dygraphs/extras/synchronizer.js", "three/three.min.js",
             "three/examples/js/controls/OrbitControls.js")
LICENCES = ("libjs-dygraphs", "libjs-three")

MOST_FRAMES = 150
MOST_PARTICLES = 200_000  # of a frame, that it plays smoothly
MOST_BYTES = 12_000_000  # of all frames together; text of the page is a third more
MOST_ROWS = 1500  # of a curve, with two rows for each line of it

# Of the metrics of impinge-validate: what they are, their exact value, and whether it is a relative error.
METRICS = {
    "wall_l2": ("wall pressure, averaged: error", 0, True),
    "wall_l2_near": ("the same within 1.5 radii of a round jet", 0, True),
    "force_ratio": ("force / exact force", 1, False),
    "force_scatter": ("force / exact force: scatter over the snapshots", 0, False),
    "stagnation_mean": ("pressure in the stagnation point [Pa]", "stagnation_pressure", False),
    "centre_x": ("centre of pressure along the incline [diameters]", 0, False),
    "centre_y": ("centre of pressure across the incline [diameters]", 0, False),
    "field_l2": ("pressure in a snapshot: error", 0, True),
    "mean_field_l2": ("pressure field, averaged: error", 0, True),
    "velocity_rms": ("velocity in a snapshot: error", 0, True),
    "surface_rms_dp": ("free surface: distance from the exact one [spacings]", 0, False),
    "film_h1": ("thick sheet / exact thickness far away", "film_h1", False),
    "film_h2": ("thin sheet / exact thickness far away", "film_h2", False),
    "film_at_d": ("film / exact film, one diameter from the stagnation point", 1, False),
    "film_at_1_5_d": ("film / exact film, 1.5 diameters from it", 1, False),
    "film_flux": ("flux of the film / flux of the jet", 1, False),
    "film_momentum": ("momentum of the film along the incline / exact one", 1, False),
    "film_law_rms": ("film: distance from the approximate law", None, True),
    "sheet_speed": ("speed of the sheets / speed of the jet", 1, False),
    "plane_x": ("place of the stagnation point between the jets [m]", 0, False),
    "plane_drift": ("its speed [m/s]", 0, False),
}


class MissingLibrary(Exception):
    """A library of the page that is not installed."""


def short(value):
    """A number to four digits, a list, or a word, as text."""
    if isinstance(value, (list, tuple)):
        return "(" + ", ".join(map(short, value)) + ")"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def table(rows, head=()):
    """An HTML table; the first cell of a row names it."""
    def row(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"

    return f"<table>{row(head, 'th') if head else ''}{''.join(row(cells, 'td') for cells in rows)}</table>"


class Frames:
    """The snapshots as the page plays them: positions in 16 bits, pressure and speed in 8 bits of their range."""

    def __init__(self, run, warnings):
        chosen = np.unique(np.linspace(0, len(run.steps) - 1, min(len(run.steps), MOST_FRAMES)).round().astype(int))
        self.dimension = run.case["dimension"]
        counts = {}
        for step in np.array(run.steps)[chosen]:
            try:
                counts[step] = run.snapshot(step).count
            except (OSError, KeyError) as error:
                warnings.append(f"The snapshot of step {step} cannot be read and is left out: {error}.")
        if not counts:
            raise ValueError(f"{run.directory} has no snapshot that can be read")
        self.all, self.total = len(run.steps), max(counts.values())
        particle_bytes = 2 * self.dimension + 4
        self.share = min(1.0, MOST_PARTICLES / max(self.total, 1), MOST_BYTES / (particle_bytes * max(sum(counts.values()), 1)))
        parts, not_finite = [], 0
        for step in counts:
            snapshot = run.snapshot(step)
            finite = snapshot.finite
            not_finite = max(not_finite, np.count_nonzero(~finite))
            # The same particles in all frames: a hash of the id decides.
            keep = finite & ((snapshot.id.astype(np.uint64) * np.uint64(2654435761) % np.uint64(1 << 32)) < self.share * (1 << 32))
            part = {name: getattr(snapshot, name)[keep] for name in ("position", "pressure", "speed", "rank", "type", "fluid")}
            parts.append({**part, "step": snapshot.step, "time": snapshot.time})
        if not_finite:
            warnings.append(f"In a snapshot, {not_finite} particles have no finite position; they are not drawn.")
        positions = np.concatenate([part["position"] for part in parts])
        if not positions.size:
            raise ValueError(f"{run.directory} has no particle to draw")
        margin = run.spacing
        self.low, self.high = positions.min(axis=0) - margin, positions.max(axis=0) + margin
        self.seen = self.view(parts)
        self.range = {
            name: impinge.colour_range(np.concatenate([part[name][part["fluid"]] for part in parts])) for name in ("pressure", "speed")
        }
        self.ranks = 1 + max((int(part["rank"].max()) for part in parts if part["rank"].size), default=0)
        self.times = [part["time"] for part in parts]
        self.steps = [part["step"] for part in parts]
        self.counts = [len(part["type"]) for part in parts]
        self.packed = [self.pack(part) for part in parts]

    def view(self, parts):
        """The corners of what the page shows at first: the fluid of all frames without the outermost drops of each."""
        fluid = [part["position"][part["fluid"]] for part in parts if part["fluid"].any()]
        if not fluid:
            return self.low, self.high
        low = np.min([np.quantile(points, 0.003, axis=0) for points in fluid], axis=0)
        high = np.max([np.quantile(points, 0.997, axis=0) for points in fluid], axis=0)
        margin = 0.04 * np.max(high - low)
        return np.maximum(low - margin, self.low), np.minimum(high + margin, self.high)

    def pack(self, part):
        """A frame in base 64: positions of all particles, then pressures, speeds, ranks, types."""
        axes = slice(0, self.dimension)
        place = (part["position"][:, axes] - self.low[axes]) / (self.high - self.low)[axes]
        pieces = [np.round(place * 65535).astype("<u2").tobytes()]
        for name, (low, high) in self.range.items():
            values = np.nan_to_num(part[name], nan=low, posinf=high, neginf=low)
            pieces.append(np.round(255 * np.clip((values - low) / (high - low), 0, 1)).astype(np.uint8).tobytes())
        pieces += [(part["rank"] % 256).astype(np.uint8).tobytes(), part["type"].astype(np.uint8).tobytes()]
        return base64.b64encode(b"".join(pieces)).decode()

    @property
    def note(self):
        """What is left out."""
        notes = []
        if len(self.times) < self.all:
            notes.append(f"{len(self.times)} of the {self.all} snapshots are shown.")
        if self.share < 1:
            notes.append(f"The picture is thinned: it shows {100 * self.share:.2g} % of the particles "
                         f"(up to {max(self.counts):,} of {self.total:,}), drawn larger.")
        return " ".join(notes)


def exact_surface(validation):
    """The lines of the exact free surface, in the run's frame."""
    lines = validation.surface if validation else None
    if lines is None:
        return []
    points = validation.from_frame(np.column_stack((lines["x"], lines["y"])))
    return [{"kind": "exact", "name": "", "points": points[lines["sheet"] == sheet].round(6).tolist()} for sheet in np.unique(lines["sheet"])]


def chart(kind, label, x_label, x, lines):
    """A chart's data: of many rows those with the smallest and the largest value of each line in each interval."""
    rows = np.arange(x.size)
    if x.size > MOST_ROWS:
        kept = {0, x.size - 1}
        for part in np.array_split(rows, MOST_ROWS // 2):
            for values in lines.values():
                if np.isfinite(values[part]).any():
                    kept |= {part[np.nanargmin(values[part])], part[np.nanargmax(values[part])]}
        rows = np.array(sorted(kept))
    columns = [x, *lines.values()]
    data = [[float(f"{column[row]:.6g}") if np.isfinite(column[row]) else None for column in columns] for row in rows]
    return {"kind": kind, "label": label, "x": x_label, "names": list(lines), "rows": data}


def charts(run):
    """The curves of the run's tables, and the profiles of impinge-validate."""
    result = [chart(kind, label, "t [s]", time, lines) for kind, label, time, lines in impinge.panels(run)]
    validation = run.validation
    for title, label, profile in (
        ("wall pressure against the exact one", "pressure", validation and validation.wall_pressure),
        ("sheets against the exact ones", "thickness", validation and validation.film_thickness),
    ):
        if profile:
            lines = {name: profile[column] for name, column in (("exact", "analytic"), ("computed", label)) if np.isfinite(profile[column]).any()}
            place, x = next(iter(profile.items()))
            gaps = impinge.sheet_ends(x)  # where lines stop
            lines = {name: np.insert(values, gaps, np.nan) for name, values in lines.items()}
            result.append(chart("validation", f"{title} [{profile.units[label]}]", f"{place} [{profile.units[place]}]", np.insert(x, gaps, x[gaps]), lines))
    return result


def computed(run, snapshot):
    """What was computed: rows of a table."""
    case = run.case
    rows = [("geometry", f"{case['geometry']}, {case['dimension']}D"), ("scheme", case["scheme"]),
            ("particle spacing", f"{run.spacing:.4g} m"), ("particles", f"{snapshot.count:,}")]
    if case["geometry"] == "jet":
        jet = case["jet"]
        rows.append(("jet", f"{jet['width']:.4g} m wide (H/dp = {jet['width'] / run.spacing:.4g}), {jet['speed']:.4g} m/s, "
                            f"{jet['angle']:.4g}° to the plate"))
    if "tank" in case:
        rows.append(("tank", " × ".join(short(float(size)) for size in case["tank"]["size"]) + " m"))
    fluid = case["fluid"]
    rows += [("density", f"{fluid['density']:.4g} kg/m³"), ("gravity", f"{short(fluid['gravity'])} m/s²")]
    if fluid.get("viscosity"):
        rows.append(("viscosity", f"{fluid['viscosity']:.4g} m²/s"))
    for key, items in (("fluid regions", fluid.get("region", [])), *((f"{kind}s", case.get(kind, [])) for kind in
                       ("wall", "motion", "inlet", "outlet", "probe", "gauge", "section"))):
        if items:
            rows.append((key, ", ".join(item.get("name") or str(k) for k, item in enumerate(items, start=1))))
    return rows


def duration(seconds):
    """A duration in words."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def progress(run, snapshot, history):
    """How far the run is: its status in a word, the share that is done, and rows of a table."""
    end = run.case["time"]["end"]
    time = history.time[-1] if history else snapshot.time
    status = snapshot.status
    if status == "running":
        status = "running" if run.is_living else "stopped"
    rows = [("time", f"{time:.4g} of {end:.4g} s"), ("snapshots", f"{len(run.steps)}, the last at t = {snapshot.time:.4g} s")]
    if history:
        seconds = history["seconds"].sum()
        rows += [("steps", f"{int(history['step'][-1]):,}, dt = {history['dt'][-1]:.3g} s (limited by: {history['limit'][-1]})"),
                 ("computing time", f"{duration(seconds)} on {snapshot.rank.max() + 1 if snapshot.count else 1} rank(s), {history.rows / max(seconds, 1e-9):.3g} steps a second"),
                 ("pressure solver", f"{history['iterations'].mean():.3g} iterations a step")]
        if status == "running":
            recent = max(1, history.rows // 10)
            rate = history["seconds"][-recent:].sum() / max(history["dt"][-recent:].sum(), 1e-300)
            rows.append(("time left", f"about {duration((end - time) * rate)}"))
    return status, min(1.0, time / end), rows


def find_warnings(run, snapshot, history, status):
    """What a reader should know before she trusts the run."""
    warnings = []
    if status == "failed":
        warnings.append(f"The run failed: {snapshot.attributes['message']}.")
    if status == "stopped":
        warnings.append("The run has not come to its end, and no program continues it.")
    if history:
        lost, halvings = int(history["lost"][-1]), int(history["halvings"].sum())
        if lost:
            warnings.append(f"{lost} fluid particles ({100 * lost / max(history['in'][-1], 1):.2g} % of all) left the bounds and were removed.")
        if halvings:
            warnings.append(f"{halvings} steps were repeated with half their dt.")
        repeated = int(history["cold_solves"].sum())
        if repeated:
            warnings.append(f"{repeated} pressure solves were repeated from zero.")
        largest = history["max_speed"].max()
        if largest > 0.5 * run.case["time"]["max_speed"]:
            warnings.append(f"The largest speed, {largest:.3g} m/s, is more than half of time.max_speed; look for spray.")
        unbalanced = history["in"] - history["out"] - history["lost"] - history["fluid"]
        if unbalanced[-1]:
            warnings.append(f"Particles in - out - lost - stored = {unbalanced[-1]:.0f}; it should be 0.")
    validation = run.validation
    for difference in validation.report["differences"] if validation else []:
        warnings.append(f"The exact flow differs from the case: {difference}.")
    return warnings


def metrics(validation):
    """The table of the comparison with the exact flow, or how to get it."""
    if not validation:
        return ("<p>This run has not been compared with an exact flow. <code>impinge-validate</code> does that for a plane jet on a "
                "plate, a wedge, a cup, or against another jet, and for a round jet on a flat wall.</p>")
    report = validation.report
    rows = []
    for key, (words, exact, is_error) in METRICS.items():
        value = report["metrics"].get(key)
        if value is not None:
            exact = report["analytic"].get(exact) if isinstance(exact, str) else exact
            rows.append((words, f"{100 * value:.2g} %" if is_error else short(float(value)), "-" if exact is None else short(exact), key))
    times = report["snapshots"]
    words = (f"<p>Compared with the exact flow (target: {html.escape(report['target'])}) over {times['count']} snapshot(s), "
             f"t = {times['first_time']:.4g} to {times['last_time']:.4g} s.</p>")
    measured = table(rows, ("", "this run", "exact", "metric"))
    drawn = picture(validation.folder / "pressure.png", "computed and exact pressure") or picture(
        validation.folder / "wall_map.png", "pressure on the wall")
    return f'<div class="pair"><div>{words}{measured}</div>{drawn}</div>'


def image(data, words):
    """A PNG picture in the page."""
    return f'<img alt="{html.escape(words)}" src="data:image/png;base64,{base64.b64encode(data).decode()}">'


def picture(path, words):
    """An image in the page; nothing where there is no file."""
    return image(path.read_bytes(), words) if path.exists() else ""


def pictures_in_space(run, snapshot):
    """The section of the pictures in space; nothing where there are none."""
    images = []
    for name, figure in impinge.pictures_in_space(run, snapshot, lambda text: print(f"impinge-report: {text}", file=sys.stderr)):
        file = io.BytesIO()
        figure.savefig(file, format="png", bbox_inches="tight")
        images.append(f"<div>{image(file.getvalue(), name.replace('_', ' '))}</div>")
    return f'<section><h2>In space</h2><div class="pair">{"".join(images)}</div></section>' if images else ""


def onward(run, snapshot):
    """How to restart, to draw and to cite."""
    directory = shlex.quote(str(run.directory))
    checkpoints = sorted(path.name for path in run.directory.glob("*.checkpoint") if re.fullmatch(re.escape(run.name) + r"_\d{8,18}", path.stem))
    lines = [("Go on from the last checkpoint" + (f", {checkpoints[-1]}" if checkpoints else " (there is none yet)"),
              f"mpirun -n RANKS impinge --restart {directory}"),
             ("Prolong a finished run", f"mpirun -n RANKS impinge --restart {directory} --set time.end=SECONDS"),
             ("Figures, and a film", f"impinge-plot {directory}\nimpinge-plot {directory} --animate"),
             ("This page again, from what there is then", f"impinge-report {directory}")]
    text = "".join(f"<p>{html.escape(words)}:</p><pre>{html.escape(command)}</pre>" for words, command in lines)
    about = snapshot.attributes
    scheme = "the scheme of Tang &amp; Wan" if run.case["scheme"] == "paper" else "the consistent scheme"
    text += (f"<p>To cite: {html.escape(about['code_version'].capitalize())}, an MPS (moving particle semi-implicit) solver for free-surface "
             f"flow, {scheme}; the method is due to Koshizuka &amp; Oka, Nucl. Sci. Eng. 123 (1996). Add the case file below.</p>")
    versions = ", ".join((about["code_version"], f"PETSc {about['petsc_version']}", f"HDF5 {about['hdf5_version']}", about["mpi_version"]))
    return text + f"<p>Computed with {html.escape(versions)}.</p>"


def library(name):
    """A library's code, as it can stand in a page."""
    path = JAVASCRIPT / name
    if not path.exists():
        raise MissingLibrary(f"there is no {path}; install Debian's libjs-dygraphs and libjs-three")
    code = re.sub(r"(?m)^//# sourceMappingURL.*$", "", path.read_text(encoding="utf-8"))
    return code.replace("</script", "<\\/script")


def licence(package):
    return pathlib.Path(f"/usr/share/doc/{package}/copyright").read_text(encoding="utf-8")


def colours(name):
    """A colour map of 256 colours, each three bytes, in base 64."""
    table_of = np.round(255 * matplotlib.colormaps[name](np.arange(256))[:, :3]).astype(np.uint8)
    return base64.b64encode(table_of.tobytes()).decode()


def write_page(run):
    """Writes the page and returns its path."""
    snapshot, history = run.snapshot(), run.history
    history = history if history and history.rows else None
    status, done, progress_rows = progress(run, snapshot, history)
    warnings = find_warnings(run, snapshot, history, status)
    frames = Frames(run, warnings)
    data = {
        "dimension": frames.dimension, "spacing": run.spacing, "share": frames.share, "low": frames.low.tolist(),
        "high": frames.high.tolist(), "seen": [corner.tolist() for corner in frames.seen], "times": frames.times, "steps": frames.steps, "counts": frames.counts, "ranks": frames.ranks,
        "range": frames.range, "colours": {"pressure": colours("viridis"), "speed": colours("cividis")},
        "marks": run.observers + exact_surface(run.validation), "charts": charts(run),
    }
    scene = picture(run.file("_scene.png"), "the scene at the start")
    scene = f"<section><h2>Scene at the start</h2>{scene}</section>" if scene else ""
    now = datetime.datetime.now().strftime("%Y-%m-%d %H:%M")
    values = {
        "title": html.escape(run.name), "status": status, "percent": f"{100 * done:.3g}", "written": now,
        "computed": table(computed(run, snapshot)), "progress": table(progress_rows),
        "warnings": "".join(f"<li>{html.escape(text)}</li>" for text in warnings) or "<li class=none>None.</li>",
        "note": html.escape(frames.note), "metrics": metrics(run.validation), "onward": onward(run, snapshot),
        "scene": scene, "space": pictures_in_space(run, snapshot),
        "hint": "" if scene else '<p class="quiet"><code>impinge CASE --check</code> draws walls, inlets, outlets and what is observed.</p>',
        "case": html.escape(snapshot.attributes["case"]),
        "libraries": "".join(f"<script>{library(name)}</script>\n" for name in LIBRARIES),
        "style": (JAVASCRIPT / "dygraphs/dygraph.min.css").read_text(encoding="utf-8").split("/*#")[0],
        "licences": html.escape("\n\n".join(f"{package}\n\n{licence(package)}" for package in LICENCES)),
        "data": json.dumps(data, allow_nan=False).replace("</", "<\\/"),
        "frames": "".join(f'<script type="text/plain" class="frame">{text}</script>\n' for text in frames.packed),
    }
    template = (SHARE / "report.html").read_text(encoding="utf-8")
    page = re.sub(r"@([a-z]+)@", lambda match: values[match[1]], template)
    path = run.file("_report.html")
    partial = path.with_name(path.name + ".partial")
    partial.write_text(page, encoding="utf-8")
    partial.replace(path)
    return path


def main():
    parser = argparse.ArgumentParser(
        prog="impinge-report", description="Writes a page about a run, DIR/<case>_report.html, for any browser, without a network."
    )
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path, help="output directory of the run")
    parser.add_argument("--name", help="case, where the directory has several")
    arguments = parser.parse_args()
    try:
        path = write_page(impinge.Run(arguments.directory, arguments.name))
    except MissingLibrary as error:
        print(f"impinge-report: {error}", file=sys.stderr)
        sys.exit(3)
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"impinge-report: {error}")
    print(f"page       {path}  ({path.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    main()
