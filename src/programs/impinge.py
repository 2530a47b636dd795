"""Reads the runs of Impinge into NumPy arrays: impinge.Run(DIR).

    run = impinge.Run("output/jet60-quick")          # name="..." where the directory has several cases
    run.name, run.steps, run.times                   # the case, and its snapshots
    run.case["particles"]["spacing"]                 # the resolved case file: every key, SI units
    snapshot = run.snapshot()                        # the last; step=... that one, time=... the nearest
    snapshot.pressure[snapshot.fluid]                # also position, velocity, id, type, rank, free_surface ...
    snapshot.units["pressure"]                       # "Pa"
    run.history["max_speed"], run.history.units      # also run.probes, gauges, sections, forces, outlets
    snapshot.walls["mean_pressure"]                  # time-averaged pressure on the walls; None before the average
    run.validation.report["metrics"]["force_ratio"]  # the comparison of impinge-validate; None where there is none
    run.validation.wall_pressure["analytic"]         # also film_thickness, surface, isobars, wall_map

A run that goes on can be read at any time: a file under its final name is complete. Nothing is written. Raises
FileNotFoundError, OSError, KeyError or ValueError, with the path or the name that is wrong in the text.
"""

import csv
import functools
import json
import os
import pathlib
import re
import socket
import time

import h5py
import numpy as np

try:
    import tomllib
except ImportError:  # before Python 3.11
    import tomli as tomllib

# Of each table, the curves that belong together: prefix and unit (None: any) of their columns, and what they show.
PANELS = {
    "history": [("kinetic_energy", None, "kinetic energy"), ("max_speed", None, "largest speed"),
                ("plate_force", None, "force on plate or floor")],
    "probes": [("p_", "Pa", "pressure"), ("ux_", "m/s", "u_x"), ("uy_", "m/s", "u_y"), ("uz_", "m/s", "u_z")],
    "gauges": [("", "m", "level")],
    "sections": [("", "m^2/s", "discharge"), ("total_", "m^2", "total"), ("", "m^3/s", "discharge"), ("total_", "m^3", "total")],
    "outlets": [("", "1", "particles")],
    "forces": [("fx_", "N/m", "F_x"), ("fy_", "N/m", "F_y"), ("torque_", "N", "torque"),
               ("fx_", "N", "F_x"), ("fy_", "N", "F_y"), ("fz_", "N", "F_z"), ("torque_", "N m", "torque")],
}

OLDEST_BEAT = 120.0  # of a run that lives on another host or in another container: the age of its lock [s]

FLUID, INLET, WALL, GHOST = range(4)  # the values of Snapshot.type

# Units of the history's columns, which its header does not tell; in two dimensions J and N are J/m and N/m.
HISTORY_UNITS = {
    "t": "s", "dt": "s", "seconds": "s", "kinetic_energy": "J", "max_speed": "m/s", "max_pressure": "Pa", "plate_force": "N",
}


def text_of(attribute):
    """An attribute of an HDF5 file as a string."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


def number(cell):
    """A cell's number; NaN for a word."""
    try:
        return float(cell)
    except ValueError:
        return np.nan


def colour_range(values):
    """The range that a colour scale shows of these values: without the outermost 0.2 % on either side, and with 0."""
    values = values[np.isfinite(values)]
    low, high = (min(0.0, np.quantile(values, 0.002)), np.quantile(values, 0.998)) if values.size else (0.0, 1.0)
    return float(low), float(high if high > low else low + 1.0)


def bounds_of(points):
    """The corners of the box around points, without the outermost 0.3 % on each side: drops that fly off."""
    return np.quantile(points, 0.003, axis=0), np.quantile(points, 0.997, axis=0)


def upright(case):
    """The direction against gravity; without gravity that of z, in two dimensions of y."""
    gravity = np.array(case["fluid"]["gravity"], dtype=float)
    return -gravity / np.linalg.norm(gravity) if gravity.any() else np.eye(gravity.size)[-1]


class Cut:
    """The upright plane through the middle of fluid in space, along the longer horizontal side of fluid and walls.

    `seen` are the axes to the right and up, `across` is the third one, and the plane is at `place` on it [m].
    """

    def __init__(self, fluid, points, case):
        up = int(np.abs(upright(case)).argmax())
        low, high = bounds_of(points) if len(points) else np.zeros((2, 3))
        first, second = (axis for axis in range(3) if axis != up)
        along, self.across = (first, second) if (high - low)[first] > 0.95 * (high - low)[second] else (second, first)
        self.spacing = float(case["particles"]["spacing"])
        grain = 0.1 * self.spacing
        low, high = bounds_of(fluid) if len(fluid) else (low, high)
        self.seen, self.place = [along, up], grain * round(float((low + high)[self.across]) / 2 / grain)

    def holds(self, points):
        """True for the particles in the plane; both layers next to it where it is in the middle between two."""
        return np.abs(points[:, self.across] - self.place) <= 0.501 * self.spacing

    @property
    def words(self):
        return f"at {'xyz'[self.across]} = {self.place:.4g} m"


class Table(dict):
    """The columns of a CSV file by name, as arrays; `units` has their units, "1" where there is none.

    A column's name is its head without the unit, which stands there as in `p_end [Pa]` or `x_m`. Columns of words hold
    strings. A last line that was broken off is left out.
    """

    def __init__(self, path, units=None):
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        if not rows:
            raise ValueError(f"{path} has no header")
        self.path, self.units = pathlib.Path(path), {}
        rows = [row for row in rows if len(row) == len(rows[0])]
        for k, head in enumerate(rows[0]):
            match = re.fullmatch(r"(.+?)(?: \[(.+)\]|_(m|Pa|deg))", head)
            name, unit = (match[1], match[2] or match[3]) if match else (head, (units or {}).get(head, "1"))
            cells = [row[k] for row in rows[1:]]
            values = np.array([number(cell) for cell in cells], dtype=float)
            is_words = cells and np.isnan(values).all() and any(cell.lower() != "nan" for cell in cells)
            name = name if name not in self else head  # a section and its total, or one name with two units
            self[name], self.units[name] = np.array(cells) if is_words else values, unit

    @property
    def rows(self):
        return len(next(iter(self.values())))

    @property
    def time(self):
        """The column of the time [s]."""
        return self["t"]


def sheet_ends(x):
    """Where the columns of a profile along a plate pass the gap between its two sheets: the first row beyond."""
    return np.flatnonzero(np.diff(x) > 1.5 * np.median(np.diff(x))) + 1 if x.size > 1 else np.array([], int)


def smooth_discharge(table):
    """The discharges from the totals over a twentieth of the run, since a row counts single particles; that time [s]."""
    time = table["t"]
    window = (time[-1] - time[0]) / 20 if time.size else 0.0
    begin, end = np.clip(time - window / 2, time[:1], time[-1:]), np.clip(time + window / 2, time[:1], time[-1:])
    smooth = {}
    for name, values in table.items():
        if table.units[name] in ("m^2/s", "m^3/s") and window > 0:
            unit = table.units[name].removesuffix("/s")
            total = next(table[other] for other in (f"total_{name}", f"total_{name} [{unit}]") if table.units.get(other) == unit)
            values = (np.interp(end, time, total) - np.interp(begin, time, total)) / (end - begin)
        smooth[name] = values
    return smooth, window


def panels(run):
    """The curves of a run's tables that belong together: a list of (kind of table, label, time [s], values by name)."""
    result = []
    for kind, rows in PANELS.items():
        table = run.table(kind)
        if table is None or not table.rows:
            continue
        for prefix, unit, label in rows:
            columns, note = table, ""
            if unit in ("m^2/s", "m^3/s"):
                columns, window = smooth_discharge(table)
                note = f", over {window:.2g} s"
            names = [name for name in table if name not in ("step", "t") and name.startswith(prefix)]
            names = [name for name in names if unit in (None, table.units[name]) and np.isfinite(columns[name]).any()]
            if kind == "history":
                names = [name for name in names if columns[name].any()]
            if names:
                lines = {name.removeprefix(prefix) or label: columns[name] for name in names}
                result.append((kind, f"{label}{note} [{table.units[names[0]]}]", table["t"], lines))
    return result


class Snapshot:
    """The particles of a snapshot or checkpoint: an attribute for each field, NumPy arrays over the particles.

    `position` and `velocity` have three columns, also in two dimensions. `units` has each field's unit. Fields are read
    when they are asked for.
    """

    def __init__(self, path):
        self.path = pathlib.Path(path)
        with h5py.File(path, "r") as file:
            self.attributes = {name: text_of(value) if isinstance(value, bytes) else value for name, value in file.attrs.items()}
            fields = file["VTKHDF/PointData"]
            self.units = {"position": "m", **{name: text_of(fields[name].attrs["unit"]) for name in fields}}
            self.count = file["VTKHDF/Points"].shape[0]
        self.step, self.dimension = int(self.attributes["step"]), int(self.attributes["dimension"])
        self.time, self.status = float(self.attributes["time"]), self.attributes["status"]

    def __getattr__(self, name):
        if name.startswith("_") or name not in self.__dict__.get("units", {}):
            raise AttributeError(f"{type(self).__name__} has no field {name}")
        with h5py.File(self.path, "r") as file:
            values = file["VTKHDF/Points" if name == "position" else f"VTKHDF/PointData/{name}"][:]
        values = values.astype(bool) if name == "free_surface" else values
        setattr(self, name, values)
        return values

    @property
    def when(self):
        """Time and step in words, and how the run has ended where that is not well."""
        status = "" if self.status in ("finished", "running") else f" ({self.status})"
        return f"t = {self.time:.4g} s, step {self.step}{status}"

    @property
    def fluid(self):
        """True for fluid particles, those of an inlet's rows among them."""
        return np.isin(self.type, (FLUID, INLET))

    @property
    def speed(self):
        """Absolute velocity [m/s]."""
        return np.linalg.norm(self.velocity, axis=1)

    @property
    def finite(self):
        """True where a particle's position is finite."""
        return np.isfinite(self.position).all(axis=1)

    @functools.cached_property
    def case(self):
        """The resolved case file: its tables and keys."""
        return tomllib.loads(self.attributes["case"])

    @functools.cached_property
    def walls(self):
        """The walls' particles: position [m], id, mean_pressure [Pa], averaged over `window` [s]; None before that."""
        with h5py.File(self.path, "r") as file:
            if "wall" not in file:
                return None
            group = file["wall"]
            window = (float(group.attrs["window_begin"]), float(group.attrs["window_end"]))
            return {"window": window, **{name: group[name][:] for name in group}}


class Scene:
    """The scene at the start, <case>_scene.vtkhdf: cells, each of some `points` from `begin` to `end`.

    Of each cell `item` says what it is (wall, inlet, outlet, fluid ...), `number` its place in its list of the case and
    `normal` the direction out of a wall's wet side, or that of an inlet's flow. `names` has the names of each item.
    """

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            grid = file["VTKHDF"]
            pieces = np.stack([grid[f"NumberOf{name}"][:] for name in ("Points", "Cells")], axis=1)
            offsets = grid["Offsets"][:]
            self.points, cells = grid["Points"][:], {name: grid["CellData"][name][:] for name in ("item", "number", "normal")}
            words = text_of(file.attrs["items"]).split("\n")
            self.names = {word: text_of(names).split("\n") for word, names in file["names"].attrs.items()}
            self.name, self.dimension = text_of(file.attrs["name"]), int(file.attrs["dimension"])
            self.spacing = float(file.attrs["spacing"])
            self.case = tomllib.loads(text_of(file.attrs["case"]))
        # Each piece counts its points and cells from 0, and has one offset more than cells.
        begin, end, first = [], [], 0
        for k, (_, count) in enumerate(pieces):
            own = offsets[first : first + count + 1] + pieces[:k, 0].sum()
            begin.append(own[:-1])
            end.append(own[1:])
            first += count + 1
        self.begin, self.end = np.concatenate(begin), np.concatenate(end)
        self.item, self.number, self.normal = np.array(words)[cells["item"]], cells["number"], cells["normal"]


class Validation:
    """What impinge-validate wrote: `report`, and its tables, in the frame of the analytic flow, lengths in metres."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.report = json.loads((self.folder / "validation.json").read_text(encoding="utf-8"))
        frame = self.report["frame"]
        self.origin, self.axes = np.array(frame["origin"]), np.column_stack([frame[axis] for axis in "xyz" if axis in frame])

    def table(self, name):
        """wall_pressure, film_thickness, surface, isobars or wall_map; None where the target has none.

        The first column of the first two is the place: x, and of a round jet r at 90 degrees, the film's azimuth else.
        """
        path = self.folder / f"{name}.csv"
        return Table(path) if path.exists() else None

    wall_pressure = property(lambda self: self.table("wall_pressure"))
    film_thickness = property(lambda self: self.table("film_thickness"))
    surface = property(lambda self: self.table("surface"))
    isobars = property(lambda self: self.table("isobars"))
    wall_map = property(lambda self: self.table("wall_map"))

    def to_frame(self, points):
        """Points of the run [m] in the frame of the analytic flow."""
        return (points - self.origin) @ self.axes

    def from_frame(self, points):
        """Points of the analytic flow's frame in that of the run [m]."""
        return points @ self.axes.T + self.origin


class Run:
    """What a run has written into its directory so far."""

    def __init__(self, directory, name=None):
        self.directory = pathlib.Path(directory)
        found = {}
        for path in self.directory.glob("*.vtkhdf"):
            match = re.fullmatch(r"(.+)_(\d{8,18})\.vtkhdf", path.name)
            if match and name in (None, match[1]):
                found.setdefault(match[1], {})[int(match[2])] = path
        if len(found) > 1:
            raise ValueError(f"{directory} has runs of several cases: {', '.join(sorted(found))}; choose one by --name")
        if not found:
            raise ValueError(f"{directory} has no snapshot" + (f" of {name}" if name else ""))
        ((self.name, paths),) = found.items()
        self.paths = dict(sorted(paths.items()))

    @property
    def steps(self):
        """The steps of the snapshots."""
        return list(self.paths)

    @functools.cached_property
    def times(self):
        """The times of the snapshots [s]."""
        return np.array([self.snapshot(step).time for step in self.paths])

    @property
    def snapshots(self):
        """The snapshots, one after the other, by step."""
        return (Snapshot(path) for path in self.paths.values())

    @property
    def is_living(self):
        """Whether a program is writing the run: its lock has an owner that lives, by the rules of src/io/run_lock.cpp."""
        lock = self.file(".lock")
        try:
            host, process, started, _, space = lock.read_text(encoding="utf-8", errors="replace").split()
            if (host, space) != (socket.gethostname(), os.readlink("/proc/self/ns/pid")):
                return time.time() - lock.stat().st_mtime < OLDEST_BEAT
            state, *fields = pathlib.Path(f"/proc/{int(process)}/stat").read_bytes().rpartition(b")")[2].decode().split()
            return state not in "ZX" and fields[18] == started
        except (OSError, ValueError):
            return False

    def snapshot(self, step=None, time=None):
        """The snapshot of a step, the one nearest to a time [s], or the last."""
        if step is not None and step not in self.paths:
            raise ValueError(f"no snapshot of step {step}; there are {', '.join(map(str, self.paths))}")
        if step is None:
            step = self.steps[-1 if time is None else int(np.abs(self.times - time).argmin())]
        return Snapshot(self.paths[step])

    @functools.cached_property
    def case(self):
        """The resolved case file of the last snapshot: its tables and keys."""
        return self.snapshot().case

    @property
    def spacing(self):
        """The particle spacing [m]."""
        return float(self.case["particles"]["spacing"])

    def file(self, ending):
        """The path <directory>/<case><ending>."""
        return self.directory / f"{self.name}{ending}"

    def table(self, kind):
        """A table of the run, one of PANELS; None where the run has none."""
        path = self.file(f"_{kind}.csv")
        if not path.exists():
            return None
        per_length = "/m" if self.case["dimension"] == 2 else ""
        units = {name: unit + (per_length if unit in ("J", "N") else "") for name, unit in HISTORY_UNITS.items()}
        return Table(path, units if kind == "history" else None)

    history = property(lambda self: self.table("history"))
    probes = property(lambda self: self.table("probes"))
    gauges = property(lambda self: self.table("gauges"))
    sections = property(lambda self: self.table("sections"))
    forces = property(lambda self: self.table("forces"))
    outlets = property(lambda self: self.table("outlets"))

    @property
    def observers(self):
        """Fixed probes, gauges and sections: kind, name and points, in the run's frame."""
        marks = []
        for kind in ("probe", "gauge", "section"):
            for item in self.case.get(kind, []):
                if kind == "probe" and item["wall"] == "none":
                    points = [item["position"]]
                elif kind == "gauge":
                    way = np.array(item["direction"]) / np.linalg.norm(item["direction"])
                    points = [item["point"], list(np.array(item["point"]) + item["length"] * way)]
                elif kind == "section":
                    points = [item["begin"], item["end"]]
                    if len(item["begin"]) == 3:
                        begin, end, side = (np.array(item[key]) for key in ("begin", "end", "side"))
                        points = [point.tolist() for point in (begin, end, end + side, begin + side, begin)]
                else:
                    continue
                marks.append({"kind": kind, "name": item["name"], "points": points})
        return marks

    @functools.cached_property
    def scene(self):
        """The scene at the start; None where the directory has none, or a later --check's of other walls."""
        path = self.file("_scene.vtkhdf")
        scene = Scene(path) if path.exists() else None
        is_own = scene and all(scene.case.get(key) == self.case.get(key) for key in ("geometry", "wall", "motion"))
        return scene if is_own else None

    @functools.cached_property
    def validation(self):
        """What impinge-validate has written of the run; None where it has not."""
        folder = self.directory / "validation"
        return Validation(folder) if (folder / "validation.json").exists() else None


def pictures_in_space(run, snapshot, tell):
    """The figures of impinge_space, each with its name; none of a plane run. Calls tell(text) for what is missing."""
    if snapshot.dimension != 3:
        return
    try:
        import impinge_space
    except ImportError as error:
        tell(f"{error}; without scikit-image (Debian's python3-skimage) there are no pictures in space")
        return
    if run.case.get("wall") and run.scene is None:
        tell(f"there is no {run.file('_scene.vtkhdf')} of this run; without it the pictures in space have no walls")
    yield from impinge_space.figures(run, snapshot)
