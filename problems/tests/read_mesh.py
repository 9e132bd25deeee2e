"""Reads the meshes that `export` writes with VTK's own reader and with meshio. Optional: needs `pip install vtk meshio==5.3.5`.

    cargo run --release -p problems --bin contact3d -- problems/scenes/lug_tet10.toml export --out FOLDER
    python3 problems/tests/read_mesh.py FOLDER

Checks that both find the same points, cells and changes in body.vtu, that body.msh has the same points and cells,
and that all cells have a positive volume.
"""

import sys
from pathlib import Path

import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def main(folder):
    errors = []
    reader = vtk.vtkXMLUnstructuredGridReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda *_: errors.append("the reader complains"))
    reader.SetFileName(str(folder / "body.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    vtu, msh = meshio.read(folder / "body.vtu"), meshio.read(folder / "body.msh")
    assert not errors, errors
    points = vtk_to_numpy(grid.GetPoints().GetData())
    assert (points == vtu.points).all() and (points == msh.points).all()
    change = vtk_to_numpy(grid.GetPointData().GetArray("change"))
    assert (change == vtu.point_data["change"]).all()
    for block in vtu.cells:
        assert (block.data == msh.cells_dict[block.type]).all(), block.type
    assert grid.GetNumberOfCells() == sum(len(block.data) for block in vtu.cells)
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    volume = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
    assert volume.min() > 0
    names = ", ".join(sorted(msh.field_data))
    print(f"{len(points)} points, {grid.GetNumberOfCells()} cells, volume {volume.sum():.6f} mm³, change up to {np.abs(change).max():.6f} mm, names {names}")


main(Path(sys.argv[1]))
