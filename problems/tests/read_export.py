"""Reads what `export` writes with readers of other programs. Optional: needs `pip install cadquery-ocp vtk numpy`.

    cargo run --release -p problems --bin hertz3d -- export --out FOLDER
    python3 problems/tests/read_export.py FOLDER [TOLERANCE]

Checks, by OpenCASCADE: surface.step is one face and lower_body.step a valid solid; both are in mm; 1 000 random points of
surface.csv, which the program computes without the files, lie within 1e-6 mm of both. By VTK: bodies as triangles are closed
and oriented outwards; points on the triangles of surface.stl lie within TOLERANCE of the surface in surface.step, by default
0.05 mm, what bricks of the example leave of its curvature; the volumes of both forms of the lower body agree.
"""

import sys
from pathlib import Path

import numpy as np
import vtk
from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from vtk.util.numpy_support import vtk_to_numpy

# OpenCASCADE moved its cast functions; both places are in use.
as_face = getattr(TopoDS, "Face_s", None) or TopoDS.Face


def read_step(path):
    reader = STEPControl_Reader()
    assert str(reader.ReadFile(str(path))).endswith("IFSelect_RetDone"), path
    reader.TransferRoots()
    shape = reader.OneShape()
    assert BRepCheck_Analyzer(shape).IsValid(), f"{path}: not valid"
    return shape


def parts(shape, kind):
    explorer, found = TopExp_Explorer(shape, kind), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def spline(shape):
    surfaces = [getattr(BRep_Tool, "Surface_s", None)(as_face(face)) for face in parts(shape, TopAbs_FACE)]
    found = [surface for surface in surfaces if "BSpline" in surface.DynamicType().Name()]
    assert len(found) == 1, surfaces
    return found[0]


def distance(surface, point):
    return GeomAPI_ProjectPointOnSurf(gp_Pnt(*map(float, point)), surface).LowerDistance()


def read_stl(path):
    reader = vtk.vtkSTLReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def open_edges(mesh):
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(mesh)
    edges.FeatureEdgesOff()
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


def volume(mesh):
    corners = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    a, b, c = (corners[cells[:, corner]] for corner in range(3))
    return (a * np.cross(b, c)).sum() / 6


def main(folder, tolerance):
    random = np.random.default_rng(1)
    table = np.loadtxt(folder / "surface.csv", delimiter=",", comments="#", skiprows=4)
    points = table[random.choice(len(table), 1000, replace=False)]
    face, body = read_step(folder / "surface.step"), read_step(folder / "lower_body.step")
    assert (len(parts(face, TopAbs_FACE)), len(parts(body, TopAbs_FACE)), len(parts(body, TopAbs_SOLID))) == (1, 6, 1)
    for name, shape in (("surface.step", face), ("lower_body.step", body)):
        surface = spline(shape)
        largest = max(distance(surface, point) for point in points)
        print(f"{name}: 1000 points within {largest:.1e} mm")
        assert largest <= 1e-6
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(body, properties, 1e-9)
    exact = properties.Mass()

    for name in ("lower_body.stl", "upper_body.stl"):
        if (folder / name).exists():
            mesh = read_stl(folder / name)
            print(f"{name}: {mesh.GetNumberOfCells()} triangles, {open_edges(mesh)} open edges, volume {volume(mesh):.6f} mm³")
            assert open_edges(mesh) == 0 and volume(mesh) > 0
    triangles = volume(read_stl(folder / "lower_body.stl"))
    print(f"volume of the lower body: {exact:.6f} mm³ as a solid, {triangles:.6f} mm³ as triangles")
    base = table[:, 0].max() * table[:, 1].max()
    assert abs(triangles - exact) <= tolerance * base

    mesh, surface, largest = read_stl(folder / "surface.stl"), spline(face), 0.0
    corners = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    for cell in cells[random.choice(len(cells), min(3000, len(cells)), replace=False)]:
        largest = max(largest, distance(surface, random.dirichlet([1, 1, 1]) @ corners[cell]))
    print(f"surface.stl: points on its triangles within {largest:.1e} mm, allowed {tolerance:g} mm")
    assert largest <= tolerance


main(Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 0.05)
