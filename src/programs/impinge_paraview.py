"""Shows a run in ParaView: the fluid coloured by pressure, the free surface and the walls.

In the window of ParaView 5.11 or newer: open <case>.xmf of the run, then Macros > Import new macro, this file.
Without a window, draw the last snapshot: pvbatch impinge_paraview.py DIR PICTURE.png

In three dimensions fluid and walls are cut in the middle, so that you see the pressure inside and on the walls.
"""

import pathlib
import statistics
import sys

import numpy as np
from paraview import simple
from paraview.servermanager import Fetch
from vtkmodules.vtkCommonCore import vtkIdList
from vtkmodules.vtkCommonDataModel import vtkStaticPointLocator
from vtkmodules.util.numpy_support import vtk_to_numpy

FLUID, WALL = (0, 1), (2, 2)  # ranges of the field `type`; 1 are the rows of an inlet
SAMPLES = 200  # particles of which the nearest is sought
SIZE = [1280, 800]  # of the picture


def spacing_of(data):
    """The median distance from a particle to the nearest other one [m]."""
    locator, distances = vtkStaticPointLocator(), []
    locator.SetDataSet(data)
    for k in range(0, data.GetNumberOfPoints(), max(1, data.GetNumberOfPoints() // SAMPLES)):
        nearest = vtkIdList()
        locator.FindClosestNPoints(2, data.GetPoint(k), nearest)
        ends = [data.GetPoint(nearest.GetId(n)) for n in range(2)]
        distances.append(sum((a - b) ** 2 for a, b in zip(*ends)) ** 0.5)
    return statistics.median(distances)


def part_of(source, field, low, high, name):
    """The particles whose field is in a range."""
    part = simple.Threshold(Input=source, Scalars=["POINTS", field], LowerThreshold=low, UpperThreshold=high)
    simple.RenameSource(name, part)
    return part


def balls(source, view, radius, preset, **properties):
    """Draws particles with a radius [m]."""
    return simple.Show(source, view, Representation="Point Gaussian", GaussianRadius=radius, ShaderPreset=preset, **properties)


def half_of(source, middle, name):
    """The particles behind a plane through the middle, as the eye sees them."""
    half = simple.Clip(Input=source, ClipType="Plane", Invert=0)
    half.ClipType.Origin, half.ClipType.Normal = middle, [0, 1, 0]
    simple.RenameSource(name, half)
    return half


def show(source):
    """Shows the run that `source` reads in the active view, and gives the view."""
    view = simple.GetActiveViewOrCreate("RenderView")
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.GoToLast()
    simple.Hide(source, view)
    fluid = part_of(source, "type", *FLUID, "fluid")
    surface = part_of(fluid, "free_surface", 1, 1, "free surface")
    walls = part_of(source, "type", *WALL, "walls")
    data = Fetch(simple.ForceTime(Input=fluid, ForcedTime=view.ViewTime))  # else that of the first time
    simple.Delete()
    low, high = data.GetBounds()[::2], data.GetBounds()[1::2]
    spacing, is_plane = spacing_of(data), low[2] == high[2]
    preset = "Plain circle" if is_plane else "Sphere"

    middle = [(a + b) / 2 for a, b in zip(low, high)]
    display = balls(fluid if is_plane else half_of(fluid, middle, "half of the fluid"), view, 0.5 * spacing, preset)
    simple.ColorBy(display, ("POINTS", "pressure"))
    colours = simple.GetColorTransferFunction("pressure")
    pressure = vtk_to_numpy(data.GetPointData().GetArray("pressure"))
    colours.AutomaticRescaleRangeMode = "Never"
    colours.ApplyPreset("Viridis (matplotlib)", True)
    colours.RescaleTransferFunction(min(0.0, np.quantile(pressure, 0.002)), np.quantile(pressure, 0.998))
    display.SetScalarBarVisibility(view, True)
    bar = simple.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = "pressure [Pa]", ""
    bar.RangeLabelFormat = "%.3g"
    bar.TitleColor = bar.LabelColor = [0, 0, 0]

    # In a plane the surface stands before the fluid, towards the eye; in space you look through it.
    look = {"Position": [0, 0, spacing]} if is_plane else {"Opacity": 0.2}
    balls(surface, view, 0.5 * spacing, preset, DiffuseColor=[0.84, 0.37, 0.0], ColorArrayName=["POINTS", ""], **look)
    if is_plane:
        balls(walls, view, 0.25 * spacing, preset, DiffuseColor=[0.4, 0.4, 0.4], ColorArrayName=["POINTS", ""])
    else:
        simple.ColorBy(balls(half_of(walls, middle, "half of the walls"), view, 0.6 * spacing, preset), ("POINTS", "pressure"))
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = int(not is_plane)
    if is_plane:
        view.InteractionMode = "2D"
    else:
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [-1, -2, 1], [0, 0, 0], [0, 0, 1]
    view.ResetCamera(True)
    simple.Render(view)
    return view


def main(words):
    if not words:
        source = simple.GetActiveSource()
        if source is None:
            sys.exit("impinge_paraview.py: no run is open; open its .xmf file first")
        show(source)
        return
    found = sorted(pathlib.Path(words[0]).glob("*.xmf"))
    if len(words) != 2 or len(found) != 1:
        sys.exit(f"impinge_paraview.py: {__doc__.splitlines()[3]}" if len(words) != 2 else
                 f"impinge_paraview.py: {words[0]} has {len(found)} .xmf files; 1 is needed")
    simple.GetActiveViewOrCreate("RenderView").ViewSize = SIZE
    view = show(simple.XDMFReader(FileNames=[str(found[0])]))
    simple.SaveScreenshot(words[1], view, ImageResolution=SIZE)


main(sys.argv[1:])
