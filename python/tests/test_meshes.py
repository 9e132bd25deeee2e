"""Meshes of other programs, by meshio: the names of their sets, and equal states."""

from pathlib import Path

import meshio
import numpy as np
import pytest

contact = pytest.importorskip("nonsmooth.contact")
SCENES = Path(__file__).parents[2] / "problems" / "scenes"


def lug():
    """The lug of tetrahedra as meshio reads it, with its faces as sets of nodes."""
    mesh = meshio.read(SCENES / "lug_tet10.msh")
    solid = [block for block in mesh.cells if block.type == "tetra10"]
    sets = {}
    for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
        for name, (tag, dimension) in mesh.field_data.items():
            if dimension == 2 and block.type == "triangle6" and (tags == tag).any():
                sets[name] = np.unique(np.concatenate([sets.get(name, []), block.data[tags == tag].ravel()])).astype(int)
    return mesh, meshio.Mesh(mesh.points, solid, point_sets=sets)


def solved(arrays):
    scene = contact.Scene.from_mesh(*arrays, SCENES / "lug_tet10.toml", objective={"quantity": "pressure-norm"})
    return scene.evaluate()


@pytest.fixture(scope="module")
def expected():
    return solved(contact.from_meshio(lug()[0]))


@pytest.mark.parametrize("ending", ["inp", "vtu", "bdf"])
def test_a_mesh_has_one_state_in_every_format(tmp_path, expected, ending):
    mesh = lug()[1]
    # meshio writes no number as small as the rounding of a zero for Nastran.
    mesh.points = np.round(mesh.points, 9)
    file = tmp_path / f"lug.{ending}"
    faces = {}
    if ending != "inp":
        # These formats keep no sets.
        mesh.point_sets = {}
        faces = {
            "wall": lambda centres: centres[:, 0] < -19.99,
            "top": lambda centres: centres[:, 2] > 39.99,
            "nose": lambda centres: np.abs(np.hypot(centres[:, 0], centres[:, 2] - 60) - 60) < 0.2,
        }
    meshio.write(file, mesh)
    state = solved(contact.from_meshio(meshio.read(file), faces))
    assert state.theta == pytest.approx(expected.theta, rel=1e-6)
    assert state.total_force == pytest.approx(expected.total_force, rel=1e-9)


def test_what_has_no_place_in_a_body_is_refused():
    corners = [[x, y, z] for z in (0.0, 10.0) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
    wedge = meshio.Mesh(corners, [("wedge", [[0, 1, 2, 4, 5, 6]])])
    with pytest.raises(ValueError, match="wedge"):
        contact.from_meshio(wedge)
    with pytest.raises(ValueError, match="allowed is one of"):
        contact.from_meshio(meshio.Mesh(corners, [("quad", [[0, 1, 2, 3]])]))
    cube = meshio.Mesh(corners, [("hexahedron", [range(8)])])
    with pytest.raises(ValueError, match="'head'.*no facet"):
        contact.from_meshio(cube, {"head": lambda centres: centres[:, 2] > 20})


def test_nodes_without_a_cell_are_left_out():
    corners = [[x, y, z] for z in (0.0, 10.0) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
    mesh = meshio.Mesh([[50.0, 0.0, 0.0], *corners], [("hexahedron", [range(1, 9)])], point_sets={"head": [0, 5, 6, 7, 8]})
    nodes, cells, faces = contact.from_meshio(mesh)
    assert nodes.shape == (8, 3) and cells.tolist() == [list(range(8))] and faces["head"].tolist() == [[4, 5, 6, 7]]
