#!/usr/bin/python3
"""Solves the round jet that meets an infinite plate at a right angle, and prints the table of src/validation/round_jet.cpp.

    jobs/round_jet.py                  # the table, and what tells its error
    jobs/round_jet.py --panels 60      # coarser; default 240

The jet is inviscid and weightless; lengths are in its radius R, speeds in its speed U. The air is at rest: the free
surface is a sheet of ring vortices of strength U, and the plate is a mirror. A sheet is the free surface if the Stokes
stream function that it makes is R^2 U / 2 all along it; then the air is at rest and the fluid has the speed U at its
surface. Lamb, Hydrodynamics, art. 161, has the stream function of a ring. The surface is a cubic spline through nodes,
which Newton's method moves along the normals of a first guess. Above the first node it goes on as a cylinder, beyond the
last as a thin film.
"""

import argparse

import numpy as np

LENGTH = 7.0  # of the jet that is solved for; what disturbs it falls as exp(-2.405 z) [R]
REACH = 8.0  # radius of the film that is solved for [R]
DECAY = 2.404825557695773  # first zero of J0
FAR = 1e4  # where the cylinder and the outer film end [R]
GROWTH = 1.3  # of their panels
BEGIN, END, STEP = 1.2, 4.0, 0.05  # of the table; the film from BEGIN on [R]


def elliptic(m1):
    """K and E of the complementary parameter m1 = 1 - k^2, by the arithmetic-geometric mean."""
    a, b, total, power = np.ones_like(m1), np.sqrt(m1), 0.5 * (1.0 - m1), 0.5
    for _ in range(6):
        a, b, c = 0.5 * (a + b), np.sqrt(a * b), 0.5 * (a - b)
        power *= 2.0
        total = total + power * c * c
    K = 0.5 * np.pi / a
    return K, K * (1.0 - total)


def stream(r, z, s, y):
    """Stream function at (r, z) of a ring vortex of strength 1, radius s and height y and of its image in the plate."""

    def ring(height):
        far = (r + s) ** 2 + height**2
        K, E = elliptic(np.maximum((r - s) ** 2 + height**2, 1e-200) / far)
        return np.sqrt(far) * ((1.0 - 2.0 * r * s / far) * K - E) / (2.0 * np.pi)

    return ring(z - y) - ring(z + y)


def slopes(r, z, s, y):
    """Derivatives of `stream` by r and z: -r u_z and r u_r."""

    def ring(height):
        far, near = (r + s) ** 2 + height**2, np.maximum((r - s) ** 2 + height**2, 1e-200)
        K, E = elliptic(near / far)
        root = 2.0 * np.pi * np.sqrt(far)
        return r * (K + (s**2 - r**2 - height**2) / near * E) / root, height * (K - (r**2 + s**2 + height**2) / near * E) / root

    (r1, z1), (r2, z2) = ring(z - y), ring(z + y)
    return r1 - r2, z1 - z2


def guess(r):
    """The height of a first surface; far up and far out as the last one."""
    return 0.5 / r - np.log(-np.expm1(-2.0 * (r - 1.0))) / DECAY


def far_film(r, derivative=0):
    """The height of the film where it is thin, and its slope: from irrotational flow to the second order in h/r."""
    return -0.5 / r**2 - 25.0 / 48.0 / r**6 if derivative else 0.5 / r + 5.0 / 48.0 / r**5


def spline(nodes, places):
    """Matrices that give a not-a-knot cubic spline and its slope at places from its values at 0, 1, ..., nodes - 1."""
    A, B = np.zeros((nodes, nodes)), np.zeros((nodes, nodes))
    for k in range(1, nodes - 1):
        A[k, k - 1 : k + 2] = 1.0, 4.0, 1.0
        B[k, k - 1], B[k, k + 1] = -3.0, 3.0
    A[0, :2], B[0, :3] = (1.0, 2.0), (-2.5, 2.0, 0.5)
    A[-1, -2:], B[-1, -3:] = (2.0, 1.0), (-0.5, -2.0, 2.5)
    at_node = np.linalg.solve(A, B)
    k = np.clip(np.floor(places).astype(int), 0, nodes - 2)
    x, row = places - k, np.arange(len(places))
    value, slope = np.zeros((len(places), nodes)), np.zeros((len(places), nodes))
    value[row, k], value[row, k + 1] = (1 + 2 * x) * (1 - x) ** 2, x * x * (3 - 2 * x)
    slope[row, k], slope[row, k + 1] = 6 * x * (x - 1), 6 * x * (1 - x)
    value += (x * (1 - x) ** 2)[:, None] * at_node[k] + (x * x * (x - 1))[:, None] * at_node[k + 1]
    slope += ((1 - x) * (1 - 3 * x))[:, None] * at_node[k] + (x * (3 * x - 2))[:, None] * at_node[k + 1]
    return value, slope


class RoundJet:
    """The surface: r and z of the nodes, from the jet to the film."""

    def __init__(self, panels):
        # Panels as long as a part of the film's thickness or of R, by a smooth measure along the guess.
        r = 1.0 + np.exp(np.linspace(np.log(1e-8), np.log(REACH - 1.0), 200001))
        z = guess(r)
        r, z = r[z <= LENGTH], z[z <= LENGTH]
        middle = 0.5 * (r[1:] + r[:-1])
        index = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(r), np.diff(z)) * np.hypot(3.0, middle))))
        nodes = np.interp(np.linspace(0.0, index[-1], panels + 1), index, np.arange(r.size))
        self.r, self.z = (np.interp(nodes, np.arange(r.size), x) for x in (r, z))
        self.panels = panels
        points = np.arange(panels + 1.0)
        tangent = spline(panels + 1, points)[1] @ np.column_stack((self.r, self.z))
        self.normal = np.column_stack((-tangent[:, 1], tangent[:, 0])) / np.linalg.norm(tangent, axis=1)[:, None]
        self.normal[0], self.normal[-1] = (1.0, 0.0), (0.0, 1.0)
        self.residuals = []
        for _ in range(12):
            self.residuals.append(self.improve())
            if self.residuals[-1] < 1e-8:
                break

    def sources(self, places):
        """Of places along the surface, by the nodes' number: position and slope, and their derivatives by the nodes'
        displacements. Below 0 and beyond the last number they are of the cylinder and of the outer film."""
        n, last = self.panels + 1, self.panels
        up, out = places < 0.0, places > last
        value, slope = spline(n, np.clip(places, 0.0, last))
        Vr, Vz = value * self.normal[:, 0], value * self.normal[:, 1]
        Sr, Sz = slope * self.normal[:, 0], slope * self.normal[:, 1]
        r, z, r1, z1 = value @ self.r, value @ self.z, slope @ self.r, slope @ self.z
        for M in (Sr, Vz, Sz, Vr):
            M[up] = 0.0
            M[out] = 0.0
        if up.any():
            first = self.z[0] - self.z[1]
            Vr[up, 0] = 1.0
            r[up], r1[up] = self.r[0], 0.0
            z[up], z1[up] = self.z[0] - first * places[up], -first
        if out.any():
            first = self.r[-1] - self.r[-2]
            r[out], r1[out] = self.r[-1] + first * (places[out] - last), first
            share, slope = (far_film(r[out], derivative) / far_film(self.r[-1]) for derivative in (0, 1))
            z[out], z1[out] = self.z[-1] * share, self.z[-1] * slope * first
            Vz[out, -1], Sz[out, -1] = share, slope * first
        return (r, z, r1, z1), (Vr, Vz, Sr, Sz)

    def panel_ends(self):
        """Ends of all panels by the nodes' number."""
        def grown(first):
            ends = [0.0, 1.0]
            while ends[-1] * first < FAR:
                ends.append(ends[-1] + (ends[-1] - ends[-2]) * GROWTH)
            return np.array(ends)

        up, out = grown(self.z[0] - self.z[1]), grown(self.r[-1] - self.r[-2])
        return np.concatenate((-up[:0:-1], np.arange(self.panels + 1.0), self.panels + out[1:]))

    def quadrature(self):
        """Gauss-Legendre places and weights on all panels, and the panel of each place."""
        x, w = np.polynomial.legendre.leggauss(8)
        ends = self.panel_ends()
        begin, size = ends[:-1], np.diff(ends)
        places = begin[:, None] + size[:, None] * 0.5 * (x + 1.0)
        weights = size[:, None] * 0.5 * w
        return places.ravel(), weights.ravel(), np.repeat(ends[:-1], x.size)

    def improve(self):
        """One step of Newton; the largest error of the stream function before it."""
        n = self.panels + 1
        places, weights, panel = self.quadrature()
        value, matrix = self.sum(np.arange(n), places, weights, panel)
        x, w = np.polynomial.legendre.leggauss(16)
        u, w = 0.5 * (x + 1.0), 0.5 * w
        for i in range(n):  # the panels beside a node, where the sum has a logarithm: graded towards the node
            near = np.concatenate((i - u**4, i + u**4))
            v, m = self.sum(np.array([i]), near, np.tile(4.0 * u**3 * w, 2))
            value[i] += v[0]
            matrix[i] += m[0]
        error = value - 0.5
        step = np.linalg.solve(matrix, -error)
        self.r, self.z = self.r + step * self.normal[:, 0], self.z + step * self.normal[:, 1]
        return np.abs(error).max()

    def sum(self, targets, places, weights, panel=None):
        """The stream function at nodes, and its derivatives by the displacements; without the panels beside the node."""
        (s, y, s1, y1), (Vr, Vz, Sr, Sz) = self.sources(places)
        length = np.hypot(s1, y1)
        r, z = self.r[targets, None], self.z[targets, None]
        weights = np.broadcast_to(weights, (len(targets), places.size))
        if panel is not None:
            weights = weights * ((panel != targets[:, None]) & (panel != targets[:, None] - 1))
        kernel = stream(r, z, s, y)
        by_r, by_z = slopes(r, z, s, y)
        by_s, by_y = slopes(s, y, r, z)  # the kernel is symmetric
        value = (kernel * length * weights).sum(axis=1)
        matrix = (by_s * length * weights) @ Vr + (by_y * length * weights) @ Vz
        stretch = kernel * weights
        matrix += (stretch * (s1 / length)) @ Sr + (stretch * (y1 / length)) @ Sz
        own = (by_r * length * weights).sum(axis=1) * self.normal[targets, 0]
        own += (by_z * length * weights).sum(axis=1) * self.normal[targets, 1]
        matrix[np.arange(len(targets)), targets] += own
        return value, matrix

    def velocity(self, r, z):
        """u_r and u_z inside the fluid, not nearer to its surface than a panel; r > 0."""
        places, weights, _ = self.quadrature()
        (s, y, s1, y1), _ = self.sources(places)
        by_r, by_z = slopes(np.asarray(r)[:, None], np.asarray(z)[:, None], s, y)
        strength = np.hypot(s1, y1) * weights
        return (by_z @ strength) / r, -(by_r @ strength) / r

    def film(self, r):
        """Height of the surface at a radius beyond the jet."""
        from_end = np.interp(-r, -self.r[::-1], np.arange(self.panels, -1.0, -1.0))
        for _ in range(20):
            value, slope = spline(self.panels + 1, from_end)
            from_end = np.clip(from_end - (value @ self.r - r) / (slope @ self.r), 0.0, self.panels)
        return spline(self.panels + 1, from_end)[0] @ self.z


def numbers(jet):
    """What must come out: force / (rho U^2 A), the velocity gradient at the stagnation point / (U/D), and the largest
    deviation from the film's thickness beyond r = 5 R."""
    r = np.linspace(0.0, REACH, 3201)
    r[0] = 1e-3
    u = jet.velocity(r, np.zeros_like(r))[0]
    weight = np.ones_like(r)
    weight[1:-1:2], weight[2:-1:2] = 4.0, 2.0
    beyond = 0.25 / REACH**2  # of the pressure of a thin film, rho U^2/2 / (2 r^4)
    force = (weight * (1.0 - u**2) * r).sum() * (r[3] - r[2]) / 3.0 + beyond
    far = np.linspace(5.0, 7.5, 20)
    gradient = 2.0 * (8.0 * u[8] / r[8] - 2.0 * u[16] / r[16]) / 6.0  # u is odd
    return force, gradient, np.abs(jet.film(far) / far_film(far) - 1.0).max()


def rows(values):
    return "\n".join("    " + " ".join(f"{value:.6f}," for value in values[k : k + 10]) for k in range(0, len(values), 10))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--panels", type=int, default=240, help="of the surface (default: %(default)s)")
    jet = RoundJet(parser.parse_args().panels)
    r = STEP * np.arange(round(END / STEP) + 1)
    film = r[r > BEGIN - 1e-9]
    pressure = 1.0 - jet.velocity(np.maximum(r, 1e-6), np.zeros_like(r))[0] ** 2
    force, gradient, far = numbers(jet)
    print(f"stream function to {jet.residuals[-1]:.1e}; force {force:.7f}; du/dr {gradient:.5f} U/D; far film to {far:.1e}")
    print(f"\nwall pressure / (rho U^2/2) at r/R = 0 to {END:g} by {STEP:g}\n{rows(pressure)}")
    print(f"\n2 r h/R^2 at r/R = {BEGIN:g} to {END:g}\n{rows(2.0 * film * jet.film(film))}")


if __name__ == "__main__":
    main()
