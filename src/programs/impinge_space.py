"""Pictures of a run in space, in perspective: the free surface among the walls, and the pressure on the walls.

    for name, figure in impinge_space.figures(run, run.snapshot()):   # free_surface, wall_pressure
        figure.savefig(f"{name}.png")

Walls are seen from their wet side; those that you look through from their dry side are glass. NumPy draws the triangles:
no display and no graphics card is needed. Needs scikit-image, which brings SciPy (Debian's python3-skimage).
"""

import itertools

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree
from skimage.measure import marching_cubes

import impinge

# A particle is a Gaussian of this width [spacings]. The density of a lattice is even within 4 %, and still a particle
# alone or a sheet of one layer has a surface.
WIDTH = 0.45
MOST_NODES = 24e6  # of the grid that has the density
MOST_TRIANGLES = 300_000  # of the walls, where they have colours

PIXELS = np.array([1000, 760])  # of a picture at most
MARGINS = (95, 35, 85, 10)  # left, right, below and above it, for the scales [pixels]
SAMPLES = 2  # of a pixel along each axis
MOST_FRAGMENTS = 4_000_000  # at a time
ELEVATION, AZIMUTHS = np.radians(25), np.radians([-60, 30, 120, 210])  # of the eye
DISTANCE = 2.4  # of the eye [diagonals of what is seen]
LIGHT = np.array([-0.45, 0.55, 0.7])  # from where it comes: right, up, towards the eye
WALL, GLASS, LINE = np.array([0.84, 0.84, 0.82]), np.array([0.62, 0.70, 0.76]), "0.25"
CREASE = np.cos(np.radians(30))  # between facets: a line is drawn


def unit(vectors):
    """Vectors of length 1; zeros stay."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)


def areas(corners):
    """Of triangles."""
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)


def isosurface(points, spacing):
    """The surface around particles, half a spacing outside of the outermost ones: corners and normals of triangles."""
    nothing = np.empty((0, 3, 3))
    if not len(points):
        return nothing, nothing
    low, size = points.min(axis=0) - 2 * spacing, np.ptp(points, axis=0) + 4 * spacing
    step = max(0.5 * spacing, np.cbrt(size.prod() / MOST_NODES))
    shape = np.ceil(size / step).astype(int) + 1
    node, rest = np.divmod((points - low) / step, 1)
    density = np.zeros(shape.prod())
    for corner in itertools.product((0, 1), repeat=3):
        weight = np.where(corner, rest, 1 - rest).prod(axis=1)
        density += np.bincount(np.ravel_multi_index((node.astype(int) + corner).T, shape), weight, density.size)
    # The shares of the nodes have spread a particle by step^2 / 6 before the filter.
    width = np.sqrt((WIDTH * max(spacing / step, 2)) ** 2 - 1 / 6)
    density = gaussian_filter((density * (spacing / step) ** 3).reshape(shape).astype(np.float32), width, truncate=3)
    if density.max() <= 0.5:
        return nothing, nothing
    places, triangles, _, _ = marching_cubes(density, 0.5, allow_degenerate=False)
    # Smoother than the surface: its bumps are those of single particles.
    slope = np.stack(np.gradient(gaussian_filter(density, width)), axis=-1)
    normals = -unit(slope[tuple(np.round(places).astype(int).T)].astype(float))
    corners = (low + places * step)[triangles]
    outside = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), normals[triangles[:, 0]])
    flip = np.sum(outside < 0) > np.sum(outside > 0)
    return (corners[:, ::-1], normals[triangles][:, ::-1]) if flip else (corners, normals[triangles])


def values_near(points, values, places, spacing):
    """Values of particles at other places: weighted means of the nearest ones; NaN where none is within two spacings."""
    if not len(points):
        return np.full(places.shape[:-1], np.nan)
    distance, nearest = cKDTree(points).query(places, k=8, distance_upper_bound=2 * spacing)
    weight = np.exp(-0.5 * (distance / (0.6 * spacing)) ** 2)
    total = weight.sum(axis=-1)
    return (weight * np.append(values, 0)[nearest]).sum(axis=-1) / np.where(total > 0, total, np.nan)


def split(corners, normals, longest):
    """Halves triangles until no side is longer."""
    while True:
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        large = sides.max(axis=1) > longest
        if not large.any():
            return corners, normals
        first = sides[large].argmax(axis=1)
        a, b, c = (corners[large, (first + k) % 3] for k in range(3))
        middle = (a + b) / 2
        corners = np.concatenate((corners[~large], np.stack((a, middle, c), axis=1), np.stack((middle, b, c), axis=1)))
        normals = np.concatenate((normals[~large], normals[large], normals[large]))


def rigid_motion(before, after):
    """Rotation and shift that carry points to where they are afterwards."""
    middle, moved = before.mean(axis=0), after.mean(axis=0)
    left, _, right = np.linalg.svd((before - middle).T @ (after - moved))
    rotation = right.T @ np.diag([1, 1, np.sign(np.linalg.det(right.T @ left.T))]) @ left.T
    return rotation, moved - rotation @ middle


class Walls:
    """The facets of a run's walls where they are in a snapshot, with the directions out of their wet sides."""

    def __init__(self, run, snapshot):
        self.corners, self.normals, number = self.of_scene(run)
        sides = run.case.get("wall", [])
        moving = {wall["motion"] for wall in sides} - {"none"}
        for motion in moving if len(number) else ():
            self.move(run, snapshot, np.isin(number, [k for k, wall in enumerate(sides, start=1) if wall["motion"] == motion]))
        self.edges = self.creases()
        both = np.isin(number, [k for k, wall in enumerate(sides, start=1) if wall["wet"] == "both"])
        self.corners = np.concatenate((self.corners, self.corners[both]))
        self.normals = np.concatenate((self.normals, -self.normals[both]))

    def of_scene(self, run):
        """Corners, normals and numbers of the facets at the start."""
        if run.case["geometry"] == "tank":  # open at the top
            x, y, z = run.case["tank"]["size"]
            points = np.array(list(itertools.product((0, x), (0, y), (0, z))))
            faces = [((0, 4, 6, 2), (0, 0, 1)), ((0, 2, 3, 1), (1, 0, 0)), ((4, 5, 7, 6), (-1, 0, 0)),
                     ((0, 1, 5, 4), (0, 1, 0)), ((2, 6, 7, 3), (0, -1, 0))]
            corners = np.array([points[[face[0], *pair]] for face, _ in faces for pair in (face[1:3], face[2:4])])
            return corners, np.repeat(np.array([normal for _, normal in faces], dtype=float), 2, axis=0), np.zeros(10, int)
        scene = run.scene
        if scene is None:
            return np.empty((0, 3, 3)), np.empty((0, 3)), np.empty(0, int)
        facets = (scene.item == "wall") & (scene.end - scene.begin == 3)
        corners = scene.points[scene.begin[facets, None] + np.arange(3)]
        return corners, unit(scene.normal[facets]), scene.number[facets]

    def move(self, run, snapshot, facets):
        """Moves facets as the particles on them have moved since the first snapshot."""
        first = run.snapshot(run.steps[0])
        on_walls = first.type == impinge.WALL
        pieces, of = split(self.corners, np.arange(len(self.corners)), 2 * run.spacing)
        nearest = of[cKDTree(pieces.mean(axis=1)).query(first.position[on_walls])[1]]
        ids, before, after = np.intersect1d(first.id[on_walls][facets[nearest]], snapshot.id, return_indices=True)
        if len(ids) < 3:
            return
        before, after = first.position[on_walls][facets[nearest]][before], snapshot.position[after]
        for _ in range(2):  # again without particles of another wall that stands there
            rotation, shift = rigid_motion(before, after)
            off = np.linalg.norm(before @ rotation.T + shift - after, axis=1)
            stay = off <= max(np.median(off), 0.01 * run.spacing)
            before, after = before[stay], after[stay]
        self.corners[facets] = self.corners[facets] @ rotation.T + shift
        self.normals[facets] = self.normals[facets] @ rotation.T

    def creases(self):
        """Where the walls have rims and edges: lines, two ends each."""
        if not len(self.corners):
            return np.empty((0, 2, 3))
        grain = 1e-6 * np.ptp(self.corners.reshape(-1, 3), axis=0).max()
        _, points = np.unique(np.round(self.corners.reshape(-1, 3) / grain), axis=0, return_inverse=True)
        points = points.reshape(-1, 3)
        sides = np.stack((points, np.roll(points, -1, axis=1)), axis=2).reshape(-1, 2)
        normals = np.repeat(self.normals, 3, axis=0)
        _, first, side, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True)
        side = side.ravel()
        alike = np.bincount(side, np.einsum("ij,ij->i", normals, normals[first][side])) / count
        places = np.stack((self.corners, np.roll(self.corners, -1, axis=1)), axis=2).reshape(-1, 2, 3)
        return places[first[(count == 1) | (alike < (1 + CREASE) / 2)]]


class Camera:
    """An eye that sees all points, upright, from where triangles with these normals and weights are seen best."""

    def __init__(self, points, normals, weights, up):
        self.up = up
        ahead = unit(np.eye(3)[np.argmin(np.abs(up))] - up[np.argmin(np.abs(up))] * up)
        basis = np.column_stack((ahead, np.cross(up, ahead), up))
        ways = [basis @ (np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)) for e in (ELEVATION, -ELEVATION) for a in AZIMUTHS]
        seen = np.array([(weights * np.maximum(normals @ way, 0)).sum() for way in ways])
        back = ways[int(np.argmax(seen >= 0.9 * seen.max()))]  # the first of those that are about as good
        right = unit(np.cross(up, back))
        self.axes = np.column_stack((right, np.cross(back, right), back))
        low, high = points.min(axis=0), points.max(axis=0)
        self.eye = (low + high) / 2 + DISTANCE * np.linalg.norm(high - low) * back
        self.scale, self.corner = 1.0, np.zeros(2)
        places = self.project(points)[:, :2]
        low, high = places.min(axis=0), places.max(axis=0)
        self.scale = (PIXELS / (high - low)).min()
        self.corner = low * self.scale
        self.size = np.ceil((high - low) * self.scale).astype(int)

    def project(self, points):
        """Places in the picture [pixels, from its lower left], and the reciprocal of the distance ahead of the eye."""
        points = (points - self.eye) @ self.axes
        near = -1 / points[..., 2:]
        return np.concatenate((points[..., :2] * near * self.scale - self.corner, near), axis=-1)

    def facing(self, corners, normals):
        """The cosines between the normals of triangles and the ways to the eye."""
        return np.einsum("ij,ij->i", normals, unit(self.eye - corners.mean(axis=1)))


class Canvas:
    """A picture of triangles, with the nearest one of each sample."""

    def __init__(self, camera):
        self.camera, self.size = camera, SAMPLES * camera.size
        self.near = np.zeros(self.size.prod())  # reciprocal of the distance of what is seen
        self.limit = self.near.copy()  # of what may cover that
        self.colour = np.zeros((self.size.prod(), 4))

    def planes(self, corners):
        """Of triangles, what gives the corners' weights w and the nearness n at a sample: (w, w, w, n) = planes (x, y, 1)."""
        places = self.camera.project(corners) * (SAMPLES, SAMPLES, 1) - (0.5, 0.5, 0)
        (x, y), near = np.moveaxis(places[..., :2], -1, 0), places[..., 2]
        (bx, cx), (by, cy) = ((np.roll(z, -1, axis=1), np.roll(z, -2, axis=1)) for z in (x, y))
        weights = np.stack((by - cy, cx - bx, bx * cy - by * cx), axis=2)
        whole = weights[..., 2].sum(axis=1)
        is_area = np.abs(whole) > 1e-9
        weights /= np.where(is_area, whole, np.nan)[:, None, None]
        low = np.where(is_area, np.clip(np.ceil(y.min(axis=1)), 0, self.size[1]), 0).astype(int)
        high = np.where(is_area, np.clip(np.floor(y.max(axis=1)) + 1, 0, self.size[1]), 0).astype(int)
        return np.concatenate((weights, (weights * near[..., None]).sum(axis=1, keepdims=True)), axis=1), low, high

    def fragments(self, planes, low, high):
        """Triangle, sample and nearness of the samples in triangles that lie between rows; in parts."""
        rows = np.maximum(high - low, 0)
        triangle = np.repeat(np.arange(len(planes)), rows)
        y = np.arange(triangle.size) - np.repeat(np.cumsum(rows) - rows - low, rows)
        slope, rest = planes[triangle, :, 0], planes[triangle, :, 1] * y[:, None] + planes[triangle, :, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            bound = -rest[:, :3] / slope[:, :3]
        outside = (slope[:, :3] == 0) & (rest[:, :3] < 0)
        begin = np.where(slope[:, :3] > 0, bound, np.where(outside, np.inf, -np.inf)).max(axis=1)
        end = np.where(slope[:, :3] < 0, bound, np.inf).min(axis=1)
        begin = np.ceil(np.clip(begin, 0, self.size[0])).astype(int)
        count = np.maximum(np.floor(np.clip(end, -1, self.size[0] - 1)).astype(int) - begin + 1, 0)
        near, sample = slope[:, 3] * begin + rest[:, 3], y * self.size[0] + begin
        ends = np.cumsum(count)
        parts = np.searchsorted(ends, np.arange(MOST_FRAGMENTS, ends[-1] if ends.size else 0, MOST_FRAGMENTS))
        for part in np.split(np.arange(ends.size), parts):
            span = np.repeat(part, count[part])
            k = np.arange(span.size) - np.repeat(np.cumsum(count[part]) - count[part], count[part])
            yield triangle[span], sample[span] + k, near[span] + slope[span, 3] * k

    def add(self, corners, normals, colours, shade, gloss=0.0, slack=0.0):
        """Draws triangles, coloured at their corners. The light takes away up to a share of the colour and adds a gloss.

        Glass covers them that is not farther by more than a slack [m].
        """
        planes, low, high = self.planes(corners)
        owner = np.full(self.near.size, -1)
        for triangle, sample, near in self.fragments(planes, low, high):
            chosen = np.flatnonzero(near > self.near[sample])
            chosen = chosen[np.argsort(near[chosen])]  # of several triangles at a sample the nearest is the last
            self.near[sample[chosen]], owner[sample[chosen]] = near[chosen], triangle[chosen]
        sample = np.flatnonzero(owner >= 0)
        triangle = owner[sample]
        place = np.stack((sample % self.size[0], sample // self.size[0], np.ones(sample.size)), axis=1)
        weights = np.einsum("nij,nj->ni", planes[triangle, :3], place)
        normal = unit(np.einsum("ni,nij->nj", weights, normals[triangle]))
        light, back = self.camera.axes @ unit(LIGHT), self.camera.axes[:, 2]
        dark = shade * (1 - np.maximum(normal @ light, 0))
        shine = gloss * np.maximum(normal @ unit(light + back), 0) ** 40
        colour = np.einsum("ni,nij->nj", weights, colours[triangle])
        self.colour[sample, :3] = np.clip(colour * (1 - dark)[:, None] + shine[:, None], 0, 1)
        self.colour[sample, 3] = 1
        self.limit[sample] = self.near[sample] / (1 + slack * self.near[sample])

    def add_glass(self, corners, normals):
        """Draws triangles that you look through."""
        slant = 1 - np.abs(self.camera.facing(corners, normals))
        opacity = 0.10 + 0.35 * slant**3
        thickness = np.zeros(self.near.size)
        for triangle, sample, near in self.fragments(*self.planes(corners)):
            seen = near > self.limit[sample]
            thickness += np.bincount(sample[seen], -np.log(1 - opacity[triangle[seen]]), thickness.size)
        clear = np.exp(-thickness)[:, None]
        below, alpha = self.colour[:, :3], self.colour[:, 3:]
        total = alpha * clear + 1 - clear
        self.colour[:, :3] = (below * alpha * clear + GLASS * (1 - clear)) / np.where(total > 0, total, 1)
        self.colour[:, 3:] = total

    def visible(self, lines, slack):
        """The pieces of lines that nothing hides by more than a slack [m]: two ends each in the picture."""
        begin, end = np.moveaxis(self.camera.project(lines), 1, 0)
        count = np.ceil(np.linalg.norm((end - begin)[:, :2], axis=1) / 3).astype(int)
        line = np.repeat(np.arange(count.size), count)
        k = np.arange(line.size) - np.repeat(np.cumsum(count) - count, count)
        first, middle, last = (begin[line] + ((k + part) / count[line])[:, None] * (end - begin)[line] for part in (0, 0.5, 1))
        column, row = np.clip((SAMPLES * middle[:, :2]).astype(int), 0, self.size - 1).T
        hidden = self.near[row * self.size[0] + column]
        return np.stack((first, last), axis=1)[middle[:, 2] > hidden / (1 + slack * hidden)][..., :2]

    def picture(self):
        """Red, green, blue and opacity of the pixels."""
        width, height = self.camera.size
        opaque = np.concatenate((self.colour[:, :3] * self.colour[:, 3:], self.colour[:, 3:]), axis=1)
        mean = opaque.reshape(height, SAMPLES, width, SAMPLES, 4).mean(axis=(1, 3))
        mean[..., :3] /= np.where(mean[..., 3:] > 0, mean[..., 3:], 1)
        return mean


def axes_of_box(axes, camera, low, high):
    """Scales along three edges of a box: the lowest ones in the picture, and the leftmost upright one."""
    upright = int(np.argmax(np.abs(camera.up)))
    middle = camera.project((low + high) / 2)[:2]
    for axis in np.flatnonzero(high > low):
        starts = [np.where(np.arange(3) == axis, low, np.where(pick, high, low)) for pick in itertools.product((0, 1), repeat=3) if not pick[axis]]
        centres = [camera.project(start + (high - low)[axis] / 2 * np.eye(3)[axis])[:2] for start in starts]
        start = starts[int(np.argmin([centre[0] if axis == upright else centre[1] for centre in centres]))]
        ends = camera.project(start + np.outer((0, high[axis] - low[axis]), np.eye(3)[axis]))[:, :2]
        along = unit(ends[1] - ends[0])
        out = np.array([along[1], -along[0]])
        out *= np.sign(out @ (ends.mean(axis=0) - middle)) or 1
        axes.plot(*ends.T, color="0.5", lw=0.6, zorder=0)
        ticks = MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]).tick_values(low[axis], high[axis])
        grain = 1e-9 * (high[axis] - low[axis])
        style = dict(ha="center", va="center", fontsize=8, color="0.25")
        for tick in ticks[(ticks >= low[axis] - grain) & (ticks <= high[axis] + grain)]:
            place = camera.project(np.where(np.arange(3) == axis, tick, start))[:2]
            axes.plot(*np.stack((place, place + 7 * out), axis=1), color="0.5", lw=0.6)
            axes.text(*(place + 24 * out), f"{tick:.4g}", **style)
        axes.text(*(ends.mean(axis=0) + 72 * out), f"{'xyz'[axis]} [m]", **style)


class Space:
    """A snapshot in space: its fluid's surface, its walls, and the eye."""

    def __init__(self, run, snapshot):
        self.run, self.snapshot, self.spacing = run, snapshot, run.spacing
        self.walls = Walls(run, snapshot)
        fluid = snapshot.fluid & snapshot.finite
        low, high = impinge.bounds_of(snapshot.position[fluid]) if fluid.any() else np.zeros((2, 3))
        corners = self.walls.corners.reshape(-1, 3)
        if len(corners):
            corners = np.concatenate((corners, [low, high])) if fluid.any() else corners
            low, high = corners.min(axis=0), corners.max(axis=0)
        self.low, self.high = low, np.where(np.any(high > low), high, low + self.spacing)
        margin = max(0.04 * np.max(high - low), self.spacing)
        near = np.abs(np.nan_to_num(snapshot.position) - (low + high) / 2) <= (high - low) / 2 + margin
        self.fluid = fluid & near.all(axis=1)
        self.read_pressure()
        force = self.part_area * np.nan_to_num(np.abs(self.pressure)).mean(axis=1)
        box = np.array(list(itertools.product(*zip(self.low, self.high))))
        self.camera = Camera(box, self.part_normals, force if force.any() else self.part_area, impinge.upright(run.case))

    def read_pressure(self):
        """The walls in parts, with the pressure at their corners: averaged where the snapshot has an average."""
        snapshot, mean, on_walls = self.snapshot, self.snapshot.walls, self.snapshot.type == impinge.WALL
        places, values = (mean["position"], mean["mean_pressure"]) if mean else (snapshot.position[on_walls], snapshot.pressure[on_walls])
        finite = np.isfinite(places).all(axis=1) & np.isfinite(values)
        self.wall_values = values[finite]
        self.pressure_when = f"averaged over t = {mean['window'][0]:.4g} to {mean['window'][1]:.4g} s" if mean else snapshot.when
        longest = max(self.spacing, 2 * np.sqrt(areas(self.walls.corners).sum() / MOST_TRIANGLES))
        self.parts, self.part_normals = split(self.walls.corners, self.walls.normals, longest)
        self.part_area = areas(self.parts)
        # Sides that turn away from each other do not mix, however near they are: the direction counts as a place, too.
        normals = np.repeat(self.part_normals[:, None], 3, axis=1)
        sided = [np.concatenate((points, 2 * self.spacing * directions), axis=-1)
                 for points, directions in ((places[finite], self.normals_at(places[finite])), (self.parts, normals))]
        self.pressure = values_near(sided[0], self.wall_values, sided[1], self.spacing)

    def normals_at(self, places):
        """Out of the wet side that wall particles belong to: they stand a millionth of a spacing before it."""
        if not len(self.parts):
            return np.zeros_like(places)
        middles = self.parts.mean(axis=1)
        nearest = cKDTree(middles).query(places, k=np.arange(1, min(8, len(middles)) + 1))[1]
        rise = np.einsum("nkj,nkj->nk", places[:, None] - middles[nearest], self.part_normals[nearest])
        best = np.abs(rise - 1e-6 * self.spacing).argmin(axis=1)
        return self.part_normals[nearest[np.arange(len(places)), best]]

    def figure(self, canvas, title, label, norm, colours):
        """A canvas as a figure, with edges of walls, scales along the axes and one of the colours."""
        (width, height), (left, right, below, above) = self.camera.size, MARGINS
        shape = (height + below + above) / (width + left + right)
        figure = Figure(figsize=(8, 6.7 * shape + 0.4), dpi=160, layout="constrained")
        axes = figure.add_subplot()
        axes.set_axis_off()
        axes.set_aspect("equal")
        axes_of_box(axes, self.camera, self.low, self.high)
        axes.imshow(canvas.picture(), origin="lower", extent=(0, width, 0, height), interpolation="antialiased")
        axes.add_collection(LineCollection(canvas.visible(self.walls.edges, 0.15 * self.spacing), colors=LINE, linewidths=0.6))
        axes.set(xlim=(-left, width + right), ylim=(-below, height + above))
        axes.set_title(f"{self.run.name}: {title}", fontsize=10)
        figure.colorbar(matplotlib.cm.ScalarMappable(norm, colours), ax=axes, shrink=0.7, extend="both", label=label)
        return figure

    def canvas(self, corners, normals, colours):
        """A picture of the walls' wet sides, in triangles."""
        canvas = Canvas(self.camera)
        ahead = self.camera.facing(corners, normals) > 0
        # Glass covers a wall that stands on it.
        canvas.add(corners[ahead], np.repeat(normals[ahead, None], 3, axis=1), colours[ahead], 0.25, slack=0.02 * self.spacing)
        return canvas

    def add_glass(self, canvas):
        """The walls that are seen from their dry side."""
        behind = self.camera.facing(self.walls.corners, self.walls.normals) <= 0
        canvas.add_glass(self.walls.corners[behind], self.walls.normals[behind])

    def free_surface(self):
        """The fluid among the walls, coloured by its speed."""
        snapshot, walls = self.snapshot, self.walls
        points, speed = snapshot.position[self.fluid], snapshot.speed[self.fluid]
        canvas = self.canvas(walls.corners, walls.normals, np.broadcast_to(WALL, walls.corners.shape))
        norm, colours = matplotlib.colors.Normalize(*impinge.colour_range(speed)), matplotlib.colormaps["cividis"]
        corners, normals = isosurface(points, self.spacing)
        if len(corners):
            canvas.add(corners, normals, colours(norm(values_near(points, speed, corners, self.spacing)))[..., :3], 0.45, 0.25, self.spacing)
        self.add_glass(canvas)
        return self.figure(canvas, f"free surface, {snapshot.when}", "speed [m/s]", norm, colours)

    def wall_pressure(self):
        """The walls, coloured by the pressure on them; grey where no particle measures it. None where there is nothing to draw."""
        if not np.isfinite(self.pressure).any():
            return None
        norm, colours = matplotlib.colors.Normalize(*impinge.colour_range(self.wall_values)), matplotlib.colormaps["viridis"]
        coloured = np.where(np.isfinite(self.pressure)[..., None], colours(norm(self.pressure))[..., :3], WALL)
        canvas = self.canvas(self.parts, self.part_normals, coloured)
        self.add_glass(canvas)
        return self.figure(canvas, f"pressure on the walls, {self.pressure_when}", "pressure [Pa]", norm, colours)


def figures(run, snapshot):
    """The pictures of a snapshot in space, each with its name, one after the other."""
    space = Space(run, snapshot)
    if not space.fluid.any() and not len(space.walls.corners):
        return
    yield "free_surface", space.free_surface()
    figure = space.wall_pressure()
    if figure:
        yield "wall_pressure", figure
