#!/usr/bin/python3
"""The plane jet by Impinge and by OpenFOAM's interFoam: accuracy against CPU time, both measured alike.

Usage: peers.py BIN DIR ANGLE[,ANGLE...] H/DX...
  BIN    directory of impinge and impinge-validate
  DIR    where the runs go: DIR/<program>-<angle>-<H/dx>/; one that is finished is not run again

A jet, H = 0.4 m wide, U = 1 m/s fast, of 1000 kg/m^3, without gravity or viscosity, is about to meet a smooth plate at
t = 0. The measures are means over t = 4..5 s:
  wall   relative L2 error of the mean wall pressure where the exact one is above 0.001 rho U^2/2
  force  of the mean wall pressure, over rho U^2 H sin(angle)
  field  relative L2 error of the pressure in 11 snapshots, over the particles or cells in the exact jet that are deeper
         than dx/2 below its surface, -2 H < x < 4 H from the stagnation point and nearer than 3 H to the plate
  CPU    user and system time of the run on one core, start and output included
Prints a table (Markdown) and draws DIR/peers.png.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import matplotlib
import numpy as np
from scipy.spatial import cKDTree

matplotlib.use("Agg")
import matplotlib.pyplot as plt

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src" / "programs"))
import impinge

H, U, RHO = 0.4, 1.0, 1000.0
DYNAMIC = 0.5 * RHO * U * U
START, END, SNAPSHOTS = 4.0, 5.0, 11  # of the means [s]

# What an experienced user sets; "tuned" has a larger step, fewer pressure corrections, a looser tolerance.
FOAM = {
    "interFoam, Co 0.5": dict(courant=0.5, correctors=3, tolerance="1e-7"),
    "interFoam, Co 1": dict(courant=1.0, correctors=3, tolerance="1e-7"),
    "interFoam, tuned": dict(courant=1.0, correctors=2, tolerance="1e-6"),
}
COLOURS = {"Impinge": "#0072B2", "interFoam, Co 0.5": "#D55E00", "interFoam, Co 1": "#E69F00", "interFoam, tuned": "#000000"}


class ExactJet:
    """Free-streamline theory (Milne-Thomson). q is u - i v over U, in the upper half of the unit disc; the plate is y = 0,
    the stagnation point the origin."""

    def __init__(self, angle):
        self.angle = np.radians(angle)
        self.sheets = H * (1 + np.cos(self.angle)) / 2, H * (1 - np.cos(self.angle)) / 2
        self.force = RHO * U * U * H * np.sin(self.angle)
        turn = np.exp(1j * self.angle)
        # Where the jet's axis, far off, would meet the plate.
        far = (H * turn * np.log(1 - turn * turn) - 2 * self.sheets[0] * np.log(1 - turn)
               + 2 * self.sheets[1] * np.log(1 + turn)) / np.pi
        self.foot = far.real + far.imag / np.tan(self.angle)

    def place(self, q):
        down, up = np.exp(-1j * self.angle), np.exp(1j * self.angle)
        return (H * down * np.log(1 - q * down) + H * up * np.log(1 - q * up) - 2 * self.sheets[0] * np.log(1 - q)
                + 2 * self.sheets[1] * np.log(1 + q)) / np.pi

    def slope(self, q):
        down, up = np.exp(-1j * self.angle), np.exp(1j * self.angle)
        return (-H * down**2 / (1 - q * down) - H * up**2 / (1 - q * up) + 2 * self.sheets[0] / (1 - q)
                + 2 * self.sheets[1] / (1 + q)) / np.pi

    def wall_pressure(self, x):
        q = np.tanh(np.linspace(-15, 15, 40001))
        return np.interp(x, self.place(q * (1 - 1e-13) + 0j).real, DYNAMIC * (1 - q * q))

    def surface(self):
        """Points of the free surface, one piece for each sheet."""
        share = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0, 1, 20000))
        phases = [1e-9 + (self.angle - 2e-9) * share, self.angle + 1e-9 + (np.pi - self.angle - 2e-9) * share]
        points = np.concatenate([self.place((1 - 1e-12) * np.exp(1j * phase)) for phase in phases])
        return np.column_stack([points.real, points.imag])

    def pressure(self, points):
        """At points, and which of them are in the jet: Newton's method from the nearest of a lattice in q."""
        radius, phase = np.meshgrid(1 - np.geomspace(1e-7, 1, 200), np.linspace(1e-4, np.pi - 1e-4, 400))
        lattice = (radius * np.exp(1j * phase)).ravel()
        places, target = self.place(lattice), points @ [1, 1j]
        q = lattice[cKDTree(np.column_stack([places.real, places.imag])).query(points)[1]]
        for _ in range(60):
            step = (self.place(q) - target) / self.slope(q)
            shorter = (abs(q - step) >= 1) | ((q - step).imag < 0)
            q = q - np.where(shorter, 0.2 * step, step)
            q = np.where(abs(q) >= 1, q / abs(q) * (1 - 1e-9), q)
        return DYNAMIC * (1 - abs(q) ** 2), abs(self.place(q) - target) < 1e-6 * H


def timed(command, directory, log):
    """User and system time of a command [s]."""
    with open(log, "w") as out:
        process = subprocess.Popen(command, cwd=directory, stdout=out, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"peers.py: {command[0]} failed, see {log}")
    return usage.ru_utime + usage.ru_stime


def measures(exact, spacing, wall, snapshots):
    """wall: x, widths and mean pressures; snapshots: points and pressures of each, in the exact jet's frame."""
    x, width, pressure = wall
    right = exact.wall_pressure(x)
    wet = right > 1e-3 * DYNAMIC
    error = np.sum(width[wet] * (pressure - right)[wet] ** 2) / np.sum(width[wet] * right[wet] ** 2)
    surface = cKDTree(exact.surface())
    squares = []
    for points, found in snapshots:
        near = (points[:, 0] > -2 * H) & (points[:, 0] < 4 * H) & (points[:, 1] > 0) & (points[:, 1] < 3 * H)
        near[near] = surface.query(points[near])[0] > 0.5 * spacing
        should, inside = exact.pressure(points[near])
        squares.append(np.sum((found[near] - should)[inside] ** 2) / np.sum(should[inside] ** 2))
    return {"wall": float(np.sqrt(error)), "force": float(np.sum(width * pressure) / exact.force),
            "field": float(np.sqrt(np.mean(squares)))}


def run_impinge(programs, directory, angle, n):
    settings = [f"jet.angle={angle}", f"particles.spacing={H / n!r}", f"time.dt={0.16 * H / n / U!r}", f"time.end={END}",
                f"output.interval={(END - START) / (SNAPSHOTS - 1)}", f"output.average_start={START}",
                f"output.directory={directory}"]
    command = [programs / "impinge", "input/jet.toml", *(word for one in settings for word in ("--set", one))]
    cpu = timed(command, ".", directory.with_name(directory.name + ".log"))
    subprocess.run([programs / "impinge-validate", directory], check=True, stdout=subprocess.DEVNULL)
    run = impinge.Run(directory)
    frame, profile = run.validation, run.validation.wall_pressure
    x, pressure = np.array(profile["x"]), np.array(profile["pressure"])
    order = np.argsort(x)
    snapshots = []
    for step, time in zip(run.steps, run.times):
        if time > START - 1e-9:
            state = run.snapshot(step=step)
            snapshots.append((frame.to_frame(state.position[state.fluid, :2]), state.pressure[state.fluid]))
    return cpu, (x[order], np.gradient(x[order]), pressure[order]), snapshots


def put(directory, name, text, kind="dictionary"):
    path = directory / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"FoamFile\n{{\n version 2.0; format ascii; class {kind}; object {path.name};\n}}\n{text}")


def foam_box(angle):
    return (-1.0, 1.8, 1.2) if angle > 45 else (-1.8, 2.4, 0.9)  # left, right, top [m]


def foam_columns(exact, angle, n):
    """Where the blocks of the mesh end, and their cells along x."""
    left, right, top = foam_box(angle)
    middle, half = exact.foot - top / np.tan(exact.angle), H / 2 / np.sin(exact.angle)
    ends = [left, middle - half, middle + half, right]
    return ends, [max(1, round((b - a) * n / H)) for a, b in zip(ends, ends[1:])]


def make_foam_case(directory, exact, angle, n, courant, correctors, tolerance):
    """Square cells in a box, air included; the jet enters through the top, the plate is the bottom."""
    spacing, top = H / n, foam_box(angle)[2]
    ends, cells = foam_columns(exact, angle, n)
    rows = round(top / spacing)
    axis, across = np.array([-np.cos(exact.angle), np.sin(exact.angle)]), np.array([np.sin(exact.angle), np.cos(exact.angle)])
    corner = np.array([exact.foot, 0.0]) + axis * H / 2 / np.tan(exact.angle) - across * H / 2
    velocity = f"({U * np.cos(exact.angle)} {-U * np.sin(exact.angle)} 0)"
    vertices = "\n".join(f"({x} {y} {z})" for z in (0, spacing) for y in (0, top) for x in ends)
    blocks = "\n".join(f"hex ({i} {i + 1} {i + 5} {i + 4} {i + 8} {i + 9} {i + 13} {i + 12}) ({cells[i]} {rows} 1) "
                       "simpleGrading (1 1 1)" for i in range(3))
    plate = " ".join(f"({i} {i + 1} {i + 9} {i + 8})" for i in range(3))
    lid = [f"({i + 4} {i + 12} {i + 13} {i + 5})" for i in range(3)]
    sides = " ".join(f"({i} {i + 4} {i + 5} {i + 1}) ({i + 8} {i + 9} {i + 13} {i + 12})" for i in range(3))
    put(directory, "system/blockMeshDict", f"""convertToMeters 1;
vertices ( {vertices} );
blocks ( {blocks} );
edges ();
boundary (
 plate {{ type wall; faces ({plate}); }}
 inlet {{ type patch; faces ({lid[1]}); }}
 open {{ type patch; faces ({lid[0]} {lid[2]} (0 8 12 4) (3 7 15 11)); }}
 sides {{ type empty; faces ({sides}); }}
);
""")
    put(directory, "system/setFieldsDict", f"""
defaultFieldValues ( volScalarFieldValue alpha.water 0 volVectorFieldValue U (0 0 0) );
regions ( rotatedBoxToCell {{
 origin ({corner[0]} {corner[1]} -1); i ({across[0] * H} {across[1] * H} 0); j ({axis[0] * 3} {axis[1] * 3} 0); k (0 0 3);
 fieldValues ( volScalarFieldValue alpha.water 1 volVectorFieldValue U {velocity} );
}} );
""")
    empty = "sides { type empty; }"
    put(directory, "0/U", f"""dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0);
boundaryField {{ plate {{ type slip; }} inlet {{ type fixedValue; value uniform {velocity}; }}
 open {{ type pressureInletOutletVelocity; value uniform (0 0 0); }} {empty} }}
""", "volVectorField")
    put(directory, "0/p_rgh", f"""dimensions [1 -1 -2 0 0 0 0]; internalField uniform 0;
boundaryField {{ plate {{ type fixedFluxPressure; value uniform 0; }} inlet {{ type fixedFluxPressure; value uniform 0; }}
 open {{ type totalPressure; p0 uniform 0; value uniform 0; }} {empty} }}
""", "volScalarField")
    put(directory, "0/alpha.water", f"""dimensions [0 0 0 0 0 0 0]; internalField uniform 0;
boundaryField {{ plate {{ type zeroGradient; }} inlet {{ type fixedValue; value uniform 1; }}
 open {{ type inletOutlet; inletValue uniform 0; value uniform 0; }} {empty} }}
""", "volScalarField")
    put(directory, "constant/g", "dimensions [0 1 -2 0 0 0 0]; value (0 0 0);\n", "uniformDimensionedVectorField")
    put(directory, "constant/turbulenceProperties", "simulationType laminar;\n")
    put(directory, "constant/dynamicMeshDict", "dynamicFvMesh staticFvMesh;\n")
    put(directory, "constant/transportProperties", f"""phases (water air);
water {{ transportModel Newtonian; nu 1e-9; rho {RHO}; }}
air {{ transportModel Newtonian; nu 1.48e-5; rho 1; }}
sigma 0;
""")
    interval = (END - START) / (SNAPSHOTS - 1)
    put(directory, "system/controlDict", f"""application interFoam;
startFrom startTime; startTime 0; stopAt endTime; endTime {END}; deltaT {0.1 * spacing};
writeControl adjustable; writeInterval {interval}; purgeWrite {SNAPSHOTS}; writeFormat ascii; writePrecision 8;
writeCompression off; timeFormat general; timePrecision 6; runTimeModifiable no;
adjustTimeStep yes; maxCo {courant}; maxAlphaCo {courant}; maxDeltaT 1;
functions {{ means {{
 type fieldAverage; libs ("libfieldFunctionObjects.so"); writeControl writeTime; timeStart {START}; timeEnd {END};
 fields ( p {{ mean on; prime2Mean off; base time; }} );
}} }}
""")
    put(directory, "system/fvSchemes", """ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes { div(rhoPhi,U) Gauss limitedLinearV 1; div(phi,alpha) Gauss vanLeer; div(phirb,alpha) Gauss linear;
 div(((rho*nuEff)*dev2(T(grad(U))))) Gauss linear; }
laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; }
snGradSchemes { default corrected; }
fluxRequired { default no; p_rgh; pcorr; alpha.water; }
""")
    put(directory, "system/fvSolution", f"""solvers {{
 "alpha.water.*" {{ nAlphaSubCycles 1; cAlpha 1; nAlphaCorr 2; MULESCorr yes; nLimiterIter 5; solver smoothSolver;
  smoother symGaussSeidel; tolerance 1e-8; relTol 0; }}
 "pcorr.*" {{ solver PCG; preconditioner DIC; tolerance 1e-5; relTol 0; }}
 p_rgh {{ solver GAMG; smoother DICGaussSeidel; tolerance {tolerance}; relTol 0.05; }}
 p_rghFinal {{ $p_rgh; relTol 0; }}
 U {{ solver smoothSolver; smoother symGaussSeidel; tolerance 1e-6; relTol 0; }}
}}
PIMPLE {{ momentumPredictor no; nOuterCorrectors 1; nCorrectors {correctors}; nNonOrthogonalCorrectors 0; }}
""")


def foam_numbers(path, patch=None):
    text = path.read_text()
    begin = rf"boundaryField\s*\{{.*?\b{patch}\s*\{{[^}}]*?value" if patch else "internalField"
    found = re.search(begin + r"\s+nonuniform List<scalar>\s*\d+\s*\(([^)]*)\)", text, re.S)
    return np.array(found[1].split(), float)


def run_foam(directory, exact, angle, n, settings):
    os.environ.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")  # where Debian's OpenFOAM has its settings
    make_foam_case(directory, exact, angle, n, **settings)
    for program in ("blockMesh", "setFields"):
        timed([program], directory, directory / f"{program}.log")
    cpu = timed(["interFoam"], directory, directory / "interFoam.log")
    ends, cells = foam_columns(exact, angle, n)
    edges = np.concatenate([np.linspace(a, b, k + 1)[bool(i):] for i, (a, b, k) in enumerate(zip(ends, ends[1:], cells))])
    middle, top = (edges[1:] + edges[:-1]) / 2, foam_box(angle)[2]
    rows = round(top * n / H)
    parts = [np.meshgrid(x, (np.arange(rows) + 0.5) * top / rows) for x in np.split(middle, np.cumsum(cells)[:-1])]
    points = np.concatenate([np.column_stack([x.ravel(), y.ravel()]) for x, y in parts])
    times = sorted((path for path in directory.iterdir() if re.fullmatch(r"[0-9.]+", path.name)), key=lambda p: float(p.name))
    snapshots = [(points, foam_numbers(path / "p")) for path in times if float(path.name) > START - 1e-9]
    return cpu, (middle, np.diff(edges), foam_numbers(times[-1] / "pMean", "plate")), snapshots


def result(programs, root, program, angle, n):
    directory = root / f"{re.sub('[^a-zA-Z0-9.]+', '-', program)}-{angle:g}-{n}"
    known = directory.with_name(directory.name + ".json")
    if known.exists():
        return json.loads(known.read_text())
    print(f"== {directory}", file=sys.stderr, flush=True)
    shutil.rmtree(directory, ignore_errors=True)
    exact = ExactJet(angle)
    cpu, wall, snapshots = (run_impinge(programs, directory, angle, n) if program == "Impinge"
                            else run_foam(directory, exact, angle, n, FOAM[program]))
    values = {"cpu": cpu, **measures(exact, H / n, wall, snapshots)}
    known.write_text(json.dumps(values))
    return values


def draw(rows, angles, path):
    figure, panels = plt.subplots(len(angles), 2, squeeze=False, layout="constrained", figsize=(10, 4 * len(angles)), dpi=110)
    for line, angle in zip(panels, angles):
        for axes, name in zip(line, ("wall", "field")):
            for program, colour in COLOURS.items():
                values = [row for row in rows if row[:2] == (program, angle)]
                axes.loglog([v["cpu"] for *_, v in values], [100 * v[name] for *_, v in values], "o-", color=colour, label=program)
            axes.set(title=f"{angle:g} degrees: {'mean wall pressure' if name == 'wall' else 'pressure in a snapshot'}",
                     xlabel="CPU time [s]", ylabel="relative L2 error [%]")
            axes.grid(True, which="both", alpha=0.3)
    panels[0][0].legend()
    figure.savefig(path)


def main():
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    programs, root = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    angles, resolutions = [float(a) for a in sys.argv[3].split(",")], [int(n) for n in sys.argv[4:]]
    root.mkdir(parents=True, exist_ok=True)
    rows = [(program, angle, n, result(programs, root, program, angle, n))
            for angle in angles for n in resolutions for program in COLOURS]
    print("| angle | program | H/dx | CPU [s] | wall | force | field |\n" + "|---" * 7 + "|")
    for program, angle, n, v in rows:
        print(f"| {angle:g} | {program} | {n} | {v['cpu']:.1f} | {100 * v['wall']:.2f} % | {v['force']:.3f} | {100 * v['field']:.2f} % |")
    draw(rows, angles, root / "peers.png")


if __name__ == "__main__":
    main()
