"""`export --step` of a mesh, read back by the OpenCASCADE kernel of Gmsh."""

import json
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

SCENES = Path(__file__).parents[2] / "problems" / "scenes"

# Of every surface of a STEP file, in the order of the file, the largest distance of the points in an array, and the cosine
# between its normals there and the vectors in another.
MEASURE = """
import json, sys
import gmsh, numpy as np
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.importShapes(sys.argv[1])
gmsh.model.occ.synchronize()
found = []
for (_, surface), points in zip(gmsh.model.getEntities(2), json.load(sys.stdin), strict=True):
    closest, parameters = gmsh.model.getClosestPoint(2, surface, np.ravel(points))
    distances = np.linalg.norm(np.reshape(closest, (-1, 3)) - points, axis=1)
    normals = np.reshape(gmsh.model.getNormal(surface, parameters), (-1, 3))
    found.append({"kind": gmsh.model.getType(2, surface), "distance": distances.max(), "normals": normals.tolist()})
print(json.dumps(found))
"""

# Where Gmsh's package lacks libraries of the graphical desktop, it cannot be loaded; .ci/python installs them.
LOADED = subprocess.run([sys.executable, "-c", "import gmsh"], capture_output=True).returncode == 0
pytestmark = pytest.mark.skipif(not LOADED, reason="Gmsh's package cannot be loaded here")


def exported(contact3d, scene, folder, size):
    """The files of a shape with uneven controls: folder and record."""
    first, out, controls = folder / "first", folder / "out", folder / "controls.json"

    def export(out, *options):
        command = [contact3d, SCENES / scene, "export", *options, "--out", out, "--json"]
        return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)

    export(first, "--csv")
    count = len(json.loads((first / "controls.json").read_text()))
    controls.write_text(json.dumps([size * np.sin(1.7 * index) for index in range(count)]))
    return out, export(out, "--step", "--msh", "--controls", controls)


def on_face(file, name):
    """The nodes of a face and the mean normals of its triangles or quadrilaterals there, outwards."""
    mesh = meshio.read(file)
    tag = mesh.field_data[name][0]
    normals = np.zeros_like(mesh.points)
    for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True):
        if block.type in ("triangle6", "quad"):
            corners = block.data[tags == tag]
            a, b, c = (mesh.points[corners[:, k]] for k in range(3))
            np.add.at(normals, corners, np.cross(b - a, c - a)[:, None, :])
    nodes = np.flatnonzero(np.linalg.norm(normals, axis=1))
    return mesh.points[nodes], normals[nodes] / np.linalg.norm(normals[nodes], axis=1)[:, None]


@pytest.mark.parametrize(
    ("scene", "size", "body", "face"),
    [
        ("lug_tet10.toml", 0.3, "", "nose"),
        ("bracket.toml", 0.15, "", "seat"),
        ("ball_socket.toml", 0.02, "socket_", "seat"),
        ("taper.toml", 0.02, "stem_", "taper"),
        ("roller.toml", 0.01, "roller_", "rolling"),
    ],
)
def test_nodes_of_the_shape_lie_on_the_surface_that_opencascade_reads(contact3d, tmp_path, scene, size, body, face):
    out, record = exported(contact3d, scene, tmp_path, size)
    assert "left_out" not in record
    (step,) = [file for file in record["files"] if file["file"] == f"{body}faces.step"]
    faces = step["faces"]
    number = [own["face"] for own in faces].index(face)
    points, outward = on_face(out / f"{body}body.msh", face)
    assert faces[number]["nodes"] == len(points)
    # The other surfaces are measured at a point anywhere.
    places = [points.tolist() if own == number else [[0.0, 0.0, 0.0]] for own in range(len(faces))]
    measured = subprocess.run(
        [sys.executable, "-c", MEASURE, out / step["file"]], input=json.dumps(places), capture_output=True, text=True
    )
    assert measured.returncode == 0, measured.stderr
    surfaces = json.loads(measured.stdout)
    assert {surface["kind"] for surface in surfaces} == {"BSpline surface"}
    found, stated = surfaces[number]["distance"], faces[number]["distance"]
    # OpenCASCADE's nearest points are good to 1e-7 mm.
    assert found < stated + 1e-6 and stated < faces[number]["allowed"]
    # Facets beside a node are inclined to the surface by less than 30 degrees: those of the roller turn by 31.
    assert np.sum(surfaces[number]["normals"] * outward, axis=1).min() > 0.866
