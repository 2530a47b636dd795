#!/usr/bin/python3
"""Compares the last snapshots of two runs, particle by particle. Usage: same_results.py DIR DIR

Prints "same" if positions, velocities, pressures and number densities agree bit for bit; otherwise the largest
differences, and exits with 1.
"""

import pathlib
import sys

import h5py
import numpy as np

UNITS = {"position": " m", "velocity": " m/s", "pressure": " Pa", "number_density": ""}


def last_snapshot(directory):
    """Name, ids and fields of the last snapshot, in the order of the ids."""
    path = max(pathlib.Path(directory).glob("*.vtkhdf"))
    with h5py.File(path) as file:
        group = file["VTKHDF"]
        ids = group["PointData/id"][:]
        order = np.argsort(ids, kind="stable")
        fields = {name: group["Points" if name == "position" else f"PointData/{name}"][:][order] for name in UNITS}
    return path.name, ids[order], fields


def comparison(old, new):
    name, ids, fields = last_snapshot(old)
    other_name, other_ids, others = last_snapshot(new)
    if name != other_name:
        return f"the last snapshots are {name} and {other_name}"
    if not np.array_equal(ids, other_ids):
        return f"other particles: {len(ids)} and {len(other_ids)}, {len(np.intersect1d(ids, other_ids))} of them in both"
    if all(fields[field].tobytes() == others[field].tobytes() for field in UNITS):
        return "same"
    differences = (f"{field} {np.abs(fields[field] - others[field]).max():.3g}{unit}" for field, unit in UNITS.items())
    return "largest differences: " + ", ".join(differences)


if __name__ == "__main__":
    result = comparison(*sys.argv[1:3])
    print(result)
    sys.exit(0 if result == "same" else 1)
