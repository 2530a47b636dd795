#!/usr/bin/python3
"""Writes bucket.stl, the shell of a Pelton bucket of unit jet radius.

Two half ellipsoids stand side by side and meet in the splitter, a sharp edge along y. The jet comes along -z. The
bucket is cut at the rim, z = 0, where its walls still lean outwards by about 15 degrees: the water leaves there, clear
of the jet. The outside is a larger pair of ellipsoids; a flat rim joins both.

Usage: make_bucket.py [FILE]   (python3-numpy)
"""

import struct
import sys

import numpy as np

OFFSET = 2.2              # of an ellipsoid's middle from the splitter's plane
INSIDE = (2.6, 3.4, 2.1)  # semi-axes along x (across the splitter), y, z
THICKNESS = 0.5
CUT = 0.55                # the rim lies below the ellipsoids' middles by this much
RIM, SPLITTER, DEEP = 36, 12, 10  # facets along the rim and the splitter of a half, and from them to the bottom


def outline(axes):
    """The points of a half along its rim, from y < 0 around to y > 0, and back along the splitter's plane."""
    a, b, d = axes
    shrink = np.sqrt(1 - (CUT / d) ** 2)
    corner = np.arccos(-OFFSET / (a * shrink))
    around = np.linspace(-corner, corner, RIM + 1)
    rim = np.stack([OFFSET + a * shrink * np.cos(around), b * shrink * np.sin(around), np.zeros_like(around)], axis=1)
    rim[[0, -1], 0] = 0
    y = np.linspace(rim[-1, 1], rim[0, 1], SPLITTER + 1)[1:-1]
    splitter = np.stack([0 * y, y, CUT - d * np.sqrt(1 - (OFFSET / a) ** 2 - (y / b) ** 2)], axis=1)
    return np.concatenate([rim, splitter])


def half(axes):
    """Rings of points from the outline to the bottom, and the facets between them, that face up."""
    a, b, d = axes
    edge = outline(axes)
    rings = [edge]
    for k in range(1, DEEP):
        # Steps along the ellipsoid shrink towards the bottom, as the rings do.
        plan = (edge[:, :2] - [OFFSET, 0]) * (1 - k / DEEP)
        depth = d * np.sqrt(1 - (plan[:, 0] / a) ** 2 - (plan[:, 1] / b) ** 2)
        rings.append(np.column_stack([plan[:, 0] + OFFSET, plan[:, 1], CUT - depth]))
    bottom = np.array([OFFSET, 0, CUT - d])
    facets = []
    for outer, inner in zip(rings, rings[1:]):
        for k in range(len(edge)):
            l = (k + 1) % len(edge)
            facets += [(outer[k], outer[l], inner[l]), (outer[k], inner[l], inner[k])]
    facets += [(rings[-1][k], rings[-1][(k + 1) % len(edge)], bottom) for k in range(len(edge))]
    return facets


def bucket():
    outside = tuple(axis + THICKNESS for axis in INSIDE)
    inner, outer = outline(INSIDE)[: RIM + 1], outline(outside)[: RIM + 1]
    facets = half(INSIDE)
    facets += [(a, c, b) for a, b, c in half(outside)]
    for k in range(RIM):
        facets += [(outer[k], outer[k + 1], inner[k + 1]), (outer[k], inner[k + 1], inner[k])]
    facets = np.array(facets)
    other = facets[:, ::-1] * [-1, 1, 1]
    return np.concatenate([facets, other])


def write(path, facets):
    normals = np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    with open(path, "wb") as file:
        file.write(b"A Pelton bucket, written by make_bucket.py".ljust(80) + struct.pack("<I", len(facets)))
        for normal, corners in zip(normals, facets):
            file.write(struct.pack("<12fH", *normal, *corners.ravel(), 0))


if __name__ == "__main__":
    write(sys.argv[1] if len(sys.argv) > 1 else "bucket.stl", bucket())
