"""The VTU file that a test of the exchange package holds the writer to is read by meshio."""

from pathlib import Path

import meshio
import numpy as np

WRITTEN = Path(__file__).parents[2] / "problems" / "exchange" / "tests" / "small.vtu"


def test_meshio_reads_points_cells_and_all_arrays():
    mesh = meshio.read(WRITTEN)
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert [(block.type, block.data.tolist()) for block in mesh.cells] == [("quad", [[0, 1, 2, 3]])]
    assert mesh.point_data.keys() == {"pressure"} and mesh.cell_data.keys() == {"area", "body"}
    np.testing.assert_array_equal(mesh.point_data["pressure"], [0.5, 1.0, 2.0, 4.0])
    np.testing.assert_array_equal(mesh.cell_data["area"], [[1.0]])
    np.testing.assert_array_equal(mesh.cell_data["body"], [[1]])
    assert {name: values.tolist() for name, values in mesh.field_data.items()} == {"objective": [4.5e17], "evaluation": [7]}
