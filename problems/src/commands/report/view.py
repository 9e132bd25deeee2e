"""Opens the fields of this folder in ParaView with a good view.

    paraview --script=view.py             the program, to look at it
    pvpython view.py [picture.png]        a picture of the last state, without a window

Bodies are drawn deformed, as surfaces with edges, in the colours of their von Mises stress, and the contact boundary above them in
those of its pressure. With history.pvd beside this file, the series of the optimization is shown, else
fields.pvd.
"""

import os
import sys

from paraview import simple

# The largest displacement is drawn as this share of the size of the bodies.
SHOWN_DISPLACEMENT = 0.05


def part(source, name):
    """The bodies or the contact boundary of a series, as a part of its own."""
    extracted = simple.ExtractBlock(Input=source)
    extracted.Selectors = [f"/Root/{name}"]
    return simple.MergeBlocks(Input=extracted)


def largest(source, array):
    low, high = source.PointData[array].GetRange(-1)
    return max(abs(low), abs(high))


def show(source, view, array, association, title):
    display = simple.Show(source, view)
    simple.ColorBy(display, (association, array))
    display.RescaleTransferFunctionToDataRange(False, True)
    simple.GetColorTransferFunction(array).ApplyPreset("Viridis (matplotlib)", True)
    display.SetScalarBarVisibility(view, True)
    bar = simple.GetScalarBar(simple.GetColorTransferFunction(array), view)
    bar.Title, bar.ComponentTitle, bar.HorizontalTitle = title, "", 1
    bar.TitleFontSize = bar.LabelFontSize = 12
    bar.RangeLabelFormat = "%.4g"
    # Shadows would change the colours.
    display.Ambient, display.Diffuse, display.EdgeColor = 0.7, 0.3, [0.3, 0.3, 0.3]
    return display


def main(picture):
    folder = os.path.dirname(os.path.abspath(sys.argv[0] if "__file__" not in globals() else __file__))
    names = [name for name in ("history.pvd", "fields.pvd") if os.path.exists(os.path.join(folder, name))]
    if not names:
        raise SystemExit(f"{folder}: neither history.pvd nor fields.pvd is there")
    reader = simple.PVDReader(FileName=os.path.join(folder, names[0]))
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.GoToLast()
    view = simple.GetActiveViewOrCreate("RenderView")
    if picture:
        view.ViewSize = [1200, 900]
    simple.UpdatePipeline(time=scene.TimeKeeper.Time, proxy=reader)

    bodies, contact = part(reader, "bodies"), part(reader, "contact")
    for source in (bodies, contact):
        simple.UpdatePipeline(time=scene.TimeKeeper.Time, proxy=source)
    bounds = bodies.GetDataInformation().GetBounds()
    size = max(bounds[2 * axis + 1] - bounds[2 * axis] for axis in range(3))
    displacement = largest(bodies, "displacement")
    factor = SHOWN_DISPLACEMENT * size / displacement if displacement > 0 else 1

    warped = []
    for source in (bodies, contact):
        warp = simple.WarpByVector(Input=source)
        warp.Vectors, warp.ScaleFactor = ["POINTS", "displacement"], factor
        warped.append(warp)
    shown = show(warped[0], view, "von_mises", "CELLS", "von Mises stress (MPa)")
    shown.SetRepresentationType("Surface With Edges")
    # The contact boundary lies between the bodies: it is lifted above them.
    lifted = simple.Transform(Input=warped[1])
    lifted.Transform.Translate = [0, 0, 0.3 * size + bounds[5] - contact.GetDataInformation().GetBounds()[4]]
    show(lifted, view, "pressure", "POINTS", "contact pressure (MPa)")

    view.CameraPosition = [bounds[0] - 2 * size, bounds[2] - 2.5 * size, bounds[5] + 1.2 * size]
    view.CameraFocalPoint = [(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 for axis in range(3)]
    view.CameraViewUp = [0, 0, 1]
    simple.ResetCamera(view)
    simple.Render(view)
    print(f"{names[0]}: time {scene.TimeKeeper.Time}, displacements magnified {factor:.3g} times")
    if picture:
        simple.SaveScreenshot(picture, view)


main(sys.argv[1] if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None)
