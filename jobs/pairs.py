#!/usr/bin/python3
"""Sets the keys of the consistent scheme off their defaults, two at a time, in water at rest and in a coarse jet, and
prints what comes of it as a matrix. Some twenty minutes on one core.

Usage: pairs.py BIN_DIRECTORY [OUTPUT_DIRECTORY]
Above the diagonal: input/hydrostatic.toml, the largest speed over sqrt(g h) in percent. Below: input/jet60-quick.toml
at H/dp = 10 to 3 s, the root mean square error of the force in the last second in percent. X: ended before its time or
lost more than 1 % of the fluid; refused: exit 2. A run that is in the output directory's results.csv is not made again.
"""

import csv
import math
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
KEYS = ("kernel.type=singular", "kernel.radius=2.1", "kernel.laplacian_radius=4.01", "pressure.gamma=0.01",
        "pressure.density_rate=0.3", "pressure.packing=false", "pressure.corrected_divergence=false",
        "pressure.corrected_gradient=false", "pressure.tolerance=1e-9", "pressure.clamp_negative=true",
        "walls.model=particles", "free_surface.surface_density=0.9", "free_surface.interior_density=1.1",
        "free_surface.asymmetry=0.7", "free_surface.zero_outside=false", "shifting.coefficient=0",
        "shifting.least_distance=0", "shifting.correct_velocity=false", "smoothing.rate=0", "collision.distance=0",
        "collision.restitution=0.8", "time.cfl=0.5", "time.mean_velocity=false")
TANK = ("hydrostatic", ())
JET = ("jet60-quick", ("particles.spacing=0.04", "time.dt=6.4e-3", "time.end=3", "output.average_start=2"))


def history(path):
    with open(path, encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items() if key != "limit"} for row in csv.DictReader(file)]


def tank_error(rows):
    return max(row["max_speed"] for row in rows) / math.sqrt(9.81 * 0.2)


def jet_error(rows):
    exact = 1000 * 0.4 * math.sin(math.radians(60))  # rho U^2 H sin(angle) [N/m], U = 1 m/s
    last = [row["plate_force"] / exact - 1 for row in rows if row["t"] > 2]
    return math.sqrt(sum(error**2 for error in last) / len(last))


def run(binary, output, case, settings, error):
    name, own = case
    directory = output / "run"
    shutil.rmtree(directory, ignore_errors=True)
    words = [word for setting in (*own, *settings, f"output.directory={directory}", "output.interval=10")
             for word in ("--set", setting)]
    done = subprocess.run([binary / "impinge", ROOT / "input" / f"{name}.toml", *words], capture_output=True,
                          check=False)
    if done.returncode == 2:
        return "refused"
    if done.returncode:
        return "X"
    rows = history(directory / f"{name}_history.csv")
    return "X" if rows[-1]["lost"] > 0.01 * rows[-1]["in"] else f"{100 * error(rows):.2g}"


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    binary = pathlib.Path(sys.argv[1]).resolve()
    output = pathlib.Path(sys.argv[2] if len(sys.argv) == 3 else "output/pairs").resolve()
    output.mkdir(parents=True, exist_ok=True)
    known = output / "results.csv"
    results = {}
    if known.exists():
        with open(known, encoding="utf-8") as file:
            results = {tuple(row[:3]): row[3] for row in csv.reader(file)}

    def result(case, error, first, second=""):
        at = (case[0], first, second)
        if at not in results:
            settings = [key for key in (first, second) if key]
            results[at] = run(binary, output, case, settings, error)
            with open(known, "a", encoding="utf-8") as file:
                csv.writer(file).writerow([*at, results[at]])
        return results[at]

    keys = ("", *KEYS)
    for k, key in enumerate(KEYS):
        print(f"{k + 1:2}  {key}")
    print("|   | " + " | ".join(str(k) for k in range(len(keys))) + " |")
    print("|---" * (len(keys) + 1) + "|")
    for row, of_row in enumerate(keys):
        cells = []
        for column, of_column in enumerate(keys):
            first, second = (of_row, of_column) if row < column else (of_column, of_row)
            cells.append("" if row == column else
                         result(TANK, tank_error, first, second) if row < column else
                         result(JET, jet_error, first, second))
        print(f"| {row} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
