"""Reads the files that `vtk_files` makes with VTK's own readers and with meshio. Optional: needs `pip install vtk meshio==5.3.5`.

    cargo run --release -p problems --example fields -- FOLDER
    python3 problems/tests/read_vtu.py FOLDER
    cargo run --release -p problems --bin signorini3d -- --mesh 6 --vtk-history --out RUN
    python3 problems/tests/read_vtu.py RUN/vtk

Checks, for every file that FOLDER/fields.pvd and, if there is one, FOLDER/history.pvd list: readers report no error, arrays have their components and no NaN, all
hexahedra have a positive scaled Jacobian and together the volume inside the outer surface, quadrilaterals point upwards, the von
Mises stress is that of the stress tensor in VTK's order, and the normal force Σ pressure·area is what the mean vertical stress
of the lower body passes on (by the stress at the centres, hence to 2 %, in a history to 5 %; for scenes whose lower body is loaded by contact and a
plane bottom only). The active arrays are von Mises stress or pressure, and displacement. In a history, times are the numbers of the
evaluations that the files name, the objective falls from file to file, and its unit is said. meshio finds the numbers that VTK finds.
"""

import sys
import xml.etree.ElementTree as tree
from pathlib import Path

import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

errors = []


def read(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda *_: errors.append(f"{path}: the reader complains"))
    reader.SetFileName(str(path))
    reader.Update()
    grid, other = reader.GetOutput(), meshio.read(path)
    assert (vtk_to_numpy(grid.GetPoints().GetData()) == other.points).all()
    assert other.point_data.keys() == arrays(grid.GetPointData()).keys()
    for name, values in arrays(grid.GetPointData()).items():
        assert (other.point_data[name] == values).all(), name
    for name, values in arrays(grid.GetCellData()).items():
        assert (other.cell_data[name][0] == values).all(), name
    assert unit(grid.GetPointData().GetArray("displacement")) == "mm"
    return grid


def unit(array):
    return array.GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL())


def arrays(data):
    found = {data.GetArrayName(index): vtk_to_numpy(data.GetArray(index)) for index in range(data.GetNumberOfArrays())}
    for name, values in found.items():
        assert np.isfinite(values).all(), name
    return found


def shapes(found):
    return {name: values.shape[1:] for name, values in found.items()}


def active(data, scalars, vectors):
    found = [array and array.GetName() for array in (data.GetScalars(), data.GetVectors())]
    assert found == [scalars, vectors], found


def bodies(grid):
    active(grid.GetPointData(), "von_mises_nodal", "displacement")
    active(grid.GetCellData(), "von_mises", None)
    cells, points = arrays(grid.GetCellData()), arrays(grid.GetPointData())
    assert shapes(cells) == {"body": (), "subdomain": (), "stress": (6,), "von_mises": ()}
    assert shapes(points) == {"displacement": (3,), "von_mises_nodal": ()}
    assert set(grid.GetCell(index).GetCellType() for index in range(grid.GetNumberOfCells())) == {vtk.VTK_HEXAHEDRON}
    names = [grid.GetCellData().GetArray("stress").GetComponentName(index) for index in range(6)]
    assert names == ["XX", "YY", "ZZ", "XY", "YZ", "XZ"], names

    quality = vtk.vtkMeshQuality()
    quality.SetInputData(grid)
    quality.SetHexQualityMeasureToScaledJacobian()
    quality.Update()
    jacobian = vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality"))
    assert jacobian.min() > 0, jacobian.min()

    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    volume = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
    assert volume.min() > 0

    xx, yy, zz, xy, yz, xz = cells["stress"].T
    mises = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + xz**2))
    assert np.allclose(mises, cells["von_mises"], rtol=1e-12)
    assert points["von_mises_nodal"].max() <= cells["von_mises"].max()

    # Outer surface and its volume by the divergence theorem, an independent check of orientation and completeness.
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(surface.GetOutputPort())
    mass = vtk.vtkMassProperties()
    mass.SetInputConnection(triangles.GetOutputPort())
    mass.Update()
    assert abs(mass.GetVolume() / volume.sum() - 1) < 2e-3, (mass.GetVolume(), volume.sum())

    lower = cells["body"] == 1
    # ∫ σ₃₃ dV = −force × height, where the force passes through the whole height.
    bounds = grid.GetBounds()
    base = (bounds[1] - bounds[0]) * (bounds[3] - bounds[2])
    force = -(zz[lower] * volume[lower]).sum() / (volume[lower].sum() / base)
    print(
        f"  {grid.GetNumberOfCells()} hexahedra, volume {volume.sum():.6f}, by the surface {mass.GetVolume():.6f}, "
        f"smallest scaled Jacobian {jacobian.min():.4f}, von Mises up to {mises.max():.1f}"
    )
    return force


def contact(grid):
    active(grid.GetPointData(), "pressure", "displacement")
    points = arrays(grid.GetPointData())
    expected = {"displacement": (3,), "pressure": (), "status": (), "area": (), "gap": (), "remaining_gap": ()}
    optional = {"traction": (3,), "slip": (3,), "sensitivity": ()}
    found = shapes(points)
    assert expected.items() <= found.items() and found.items() <= (expected | optional).items(), found
    assert set(np.unique(points["status"])) <= {0, 1, 2} and points["status"].dtype.kind == "i"
    assert (points["pressure"][points["status"] == 0] == 0).all()
    normals = vtk.vtkPolyDataNormals()
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    normals.SetInputConnection(surface.GetOutputPort())
    normals.ComputeCellNormalsOn()
    normals.ConsistencyOff()
    normals.Update()
    assert vtk_to_numpy(normals.GetOutput().GetCellData().GetNormals())[:, 2].min() > 0
    bounds = grid.GetBounds()
    assert abs(points["area"].sum() / ((bounds[1] - bounds[0]) * (bounds[3] - bounds[2])) - 1) < 1e-12
    force = (points["pressure"] * points["area"]).sum()
    print(f"  {grid.GetNumberOfCells()} quadrilaterals, normal force {force:.6e} N, arrays {', '.join(sorted(found))}")
    return force


def notes(grid):
    """Objective and evaluation that a file of a history names, and the unit of the objective."""
    field = grid.GetFieldData()
    names = [field.GetArrayName(index) for index in range(field.GetNumberOfArrays())]
    assert names == ["objective", "evaluation"], names
    values = [field.GetArray(name) for name in names]
    assert [value.GetNumberOfValues() for value in values] == [1, 1]
    return [*(value.GetValue(0) for value in values), unit(values[0])]


def series(path):
    """All files of a list; whether forces agree at every time."""
    forces, objectives = {}, {}
    is_history = path.name == "history.pvd"
    for entry in tree.parse(path).getroot().iter("DataSet"):
        time, kind, file = entry.get("timestep"), entry.get("name"), path.parent / entry.get("file")
        print(f"time {time}, part {entry.get('part')}, {kind}: {file.name}")
        grid = read(file)
        forces.setdefault(time, []).append({"bodies": bodies, "contact": contact}[kind](grid))
        if is_history:
            objective, evaluation, label = notes(grid)
            assert evaluation == float(time) and label, (evaluation, label)
            assert objectives.setdefault(time, objective) == objective
            print(f"  objective {objective:.6e} {label}")
    for time, (inside, outside) in forces.items():
        print(f"time {time}: force by stress {inside:.4e} N, by pressure {outside:.4e} N")
        # Shapes on the way are steeper, and their stresses at the centres of the bricks less accurate.
        assert abs(inside / outside - 1) < (0.05 if is_history else 0.02)
    falling = list(objectives.values())
    assert all(later < earlier for earlier, later in zip(falling, falling[1:])), falling


def main(folder):
    print("VTK", vtk.vtkVersion().GetVTKVersion())
    series(folder / "fields.pvd")
    if (folder / "history.pvd").exists():
        series(folder / "history.pvd")
    assert not errors, errors


main(Path(sys.argv[1]))
