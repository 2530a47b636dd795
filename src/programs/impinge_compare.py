"""What the cases' compare.py share: rows of a comparison, the table, maxima and periods, the style of figures.

A compare.py hands two functions to main():

    rows(run)            # or rows(run, data): the list of rows of one run, an impinge.Run
    draw(runs, figure)   # or draw(runs, figure, data): fills an empty Matplotlib figure; the last run is the finest

and the command line is

    compare.py RUN [RUN...] [--data FILE] [--figure FILE] [--json]

data is the Series of --data, None without it; compare.py has the option where main() is told what the file holds.
"""

import argparse
import dataclasses
import inspect
import io
import json
import pathlib
import numpy as np

import impinge

EXACT = "exact"
WIDTH = 9.5  # of a figure [inch]
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:purple")  # of the runs; the reference is black


@dataclasses.dataclass
class Row:
    """A metric. reference is a number, or (low, high) of a band; error a share, 0.01 is one percent."""

    metric: str
    measured: float
    reference: object = None
    error: float = None
    beat: str = ""
    source: str = EXACT


def row(metric, measured, reference=None, scale=None, beat="", source=EXACT):
    """A row with its error: measured less reference, over `scale`, by default the reference.

    Beside a band the error is 0 inside of it, and counts from the nearer bound outside. Without a reference there is none.
    """
    measured, error = float(measured), None
    if reference is not None:
        nearest = np.clip(measured, *reference) if isinstance(reference, tuple) else reference
        error = float((measured - nearest) / (scale or abs(nearest)))
    return Row(metric, measured, reference, error, beat, source if reference is not None else "")


def cell(value):
    """A number of a table, to four digits; a band with both bounds."""
    if isinstance(value, (tuple, list)):
        return " to ".join(map(cell, value))
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def percent(error):
    """An error in percent, with its sign, to two digits."""
    return "" if error is None else "-" if not np.isfinite(error) else f"{100 * error:+.2g} %"


def print_table(heads, lines):
    """A table that reads well as text and as Markdown."""
    widths = [max(len(line[k]) for line in [heads, *lines]) for k in range(len(heads))]
    for line in [heads, ["-" * width for width in widths], *lines]:
        print("| " + " | ".join(text.ljust(width) for text, width in zip(line, widths)) + " |")


class Series(dict):
    """The columns of a CSV file by name, as arrays; lines that start with # are its comments. Gaps are NaN.

    A column that begins with a word is one of words: it tells the series that a row is of.
    """

    def __init__(self, path):
        lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
        head, *rows = [line.split(",") for line in lines if line.strip() and not line.startswith("#")]
        super().__init__(zip(head, map(self.column, zip(*rows))))

    @staticmethod
    def column(texts):
        numbers = np.array([impinge.number(text) for text in texts])
        return np.array(texts) if texts[0].strip() and np.isnan(numbers[0]) and texts[0] != "nan" else numbers

    def of(self, names, **words):
        """The columns `names` of the rows whose columns of words begin with these, as an array of rows."""
        use = np.logical_and.reduce([np.char.startswith(self[column], word) for column, word in words.items()])
        return np.stack([self[name][use] for name in names], 1)


def maxima(t, y, apart):
    """The maxima of a curve that are the largest within +- apart / 2, by parabolas over +- apart / 8: (times, values)."""
    t, y = np.asarray(t), np.asarray(y)
    found = []
    for i in range(1, t.size - 1):
        if t[i] - t[0] < apart / 8 or t[-1] - t[i] < apart / 8 or y[i] < y[np.abs(t - t[i]) <= apart / 2].max():
            continue
        near = np.abs(t - t[i]) <= apart / 8
        if found and t[i] - found[-1][0] < apart / 2 or near.sum() < 3:
            continue
        bend, slope, value = np.polyfit(t[near] - t[i], y[near], 2)
        off = np.clip(-slope / (2 * bend), -apart / 8, apart / 8) if bend < 0 else 0.0
        found.append((t[i] + off, value + slope * off + bend * off * off))
    return np.array(found).reshape(-1, 2).T


def period(times):
    """The mean distance of maxima, by a straight line through all of them."""
    return np.polyfit(np.arange(len(times)), times, 1)[0] if len(times) > 1 else np.nan


def harmonic(t, y, frequency):
    """Amplitude and phase [rad] of a curve's part a sin(2 pi frequency t + phase), by least squares with a mean."""
    angle = 2 * np.pi * frequency * np.asarray(t)
    _, sine, cosine = np.linalg.lstsq(np.stack([np.ones_like(angle), np.sin(angle), np.cos(angle)], 1), y, rcond=None)[0]
    return np.hypot(sine, cosine), np.arctan2(cosine, sine)


def runge_kutta(slope, state, times, largest):
    """The solution of d state/dt = slope(state) at times that rise from the state's own, by steps of at most `largest`."""
    states, now = [np.array(state, dtype=float)], times[0]
    for then in times[1:]:
        count = int(np.ceil((then - now) / largest)) or 1
        dt, s = (then - now) / count, states[-1]
        for _ in range(count):
            k1 = slope(s)
            k2 = slope(s + dt / 2 * k1)
            k3 = slope(s + dt / 2 * k2)
            s = s + dt / 6 * (k1 + 2 * k2 + 2 * k3 + slope(s + dt * k3))
        states.append(s)
        now = then
    return np.array(states)


def fluid(snapshot):
    """Positions, velocities [each particles x 2 or 3] and pressures of a snapshot's fluid."""
    mine, dimension = snapshot.fluid, snapshot.dimension
    return snapshot.position[mine, :dimension], snapshot.velocity[mine, :dimension], snapshot.pressure[mine]


def show_fluid(axes, snapshot, spacing, scale=1.0, limits=None, **style):
    """Discs of a snapshot's fluid particles, lengths times `scale`; coloured by pressure within `limits` [Pa], if given."""
    from matplotlib.collections import EllipseCollection

    x, _, p = fluid(snapshot)
    size = np.full(len(x), scale * spacing * 2 / np.sqrt(np.pi))
    if limits is not None:
        style |= {"array": p, "clim": limits, "cmap": "viridis"}
    discs = EllipseCollection(size, size, np.zeros_like(size), units="xy", offsets=scale * x, lw=0,
                              offset_transform=axes.transData, **style)
    axes.set_aspect("equal")
    axes.update_datalim(scale * x)
    axes.autoscale_view()
    return axes.add_collection(discs)


def save(figure, path):
    """Writes a figure with 128 colours: a third of the bytes."""
    from PIL import Image  # Matplotlib brings it

    data = io.BytesIO()
    figure.savefig(data, dpi=100)
    Image.open(data).convert("RGB").quantize(128).save(path, "png", optimize=True)


def label(run, size):
    """A run's resolution in words, such as "L/dp = 100"; size is the word and the length, or a function of the run."""
    word, length = size(run) if callable(size) else size
    return f"{word} = {length / run.spacing:.4g}"


# How a row becomes cells, and the heads above them.
COLUMNS = {"metric": cell, "measured": cell, "reference": cell, "error": percent, "beat": cell, "source": cell}
HEADS = ["metric", "measured", "reference", "error", "figure to beat", "source"]


def cells(line):
    """The cells of a row that came as JSON."""
    return [text(line[name]) for name, text in COLUMNS.items()]


def main(description, rows, draw, size, data=None, height=3.5):
    """The command line of a compare.py.

    size is (word, length [m]) of what the resolution counts the particles of, as ("L/dp", 1.0), or a function of the run
    that gives it; data says what the file of --data holds; height is that of the figure [inch].
    """
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", metavar="RUN", nargs="+", help="directory of a finished run")
    if data:
        parser.add_argument("--data", metavar="FILE", help=data)
    parser.add_argument("--figure", metavar="FILE", help="draws the comparison into this PNG file")
    parser.add_argument("--json", action="store_true", help="prints JSON in the place of tables")
    arguments = parser.parse_args()
    series = Series(arguments.data) if data and arguments.data else None
    more = [series] if len(inspect.signature(rows).parameters) > 1 else []
    results, runs = [], []
    for directory in arguments.runs:
        try:
            run = impinge.Run(directory)
        except (OSError, ValueError) as error:
            parser.error(str(error))
        last = run.snapshot()
        finished = last.status == "finished"
        runs += [run] if finished else []
        results.append({"run": directory, "resolution": label(run, size), "status": last.status, "time": last.time,
                        "rows": [dataclasses.asdict(line) for line in rows(run, *more)] if finished else []})
    if arguments.figure and runs:
        from matplotlib.figure import Figure

        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        draw(runs, figure, *more)
        save(figure, arguments.figure)
    if arguments.json:
        print(json.dumps(results, indent=1))
        return
    for result in results:
        print(f"{result['run']}: {result['resolution']}, {result['status']} at t = {result['time']:.4g} s")
        if result["rows"]:
            print_table(HEADS, [cells(line) for line in result["rows"]])
