"""problems/scenes/from_step.py: from a STEP file, which this test writes, to a mesh that a scene can use."""

import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

SCENES = Path(__file__).parents[2] / "problems" / "scenes"

# A block of 40 x 30 x 20 mm with a groove of radius 12 mm along x2.
PART = """
import sys, gmsh
gmsh.initialize()
occ = gmsh.model.occ
block, rod = occ.addBox(0, 0, 0, 40, 30, 20), occ.addCylinder(20, -1, 20, 0, 32, 0, 12)
occ.cut([(3, block)], [(3, rod)])
occ.synchronize()
gmsh.write(sys.argv[1])
"""


# Where Gmsh's package lacks libraries of the graphical desktop, it cannot be loaded; .ci/python installs them.
LOADED = subprocess.run([sys.executable, "-c", "import gmsh"], capture_output=True).returncode == 0
pytestmark = pytest.mark.skipif(not LOADED, reason="Gmsh's package cannot be loaded here")


def run(*arguments):
    return subprocess.run([sys.executable, *map(str, arguments)], capture_output=True, text=True)


@pytest.fixture(scope="module")
def part(tmp_path_factory):
    file = tmp_path_factory.mktemp("step") / "part.step"
    written = run("-c", PART, file)
    assert written.returncode == 0, written.stderr
    return file


def faces(part):
    """The lines of the list of faces: number, kind, area, radius."""
    listed = run(SCENES / "from_step.py", part)
    assert listed.returncode == 0, listed.stderr
    return [line.split() for line in listed.stdout.splitlines()[2:]]


def test_faces_are_listed_with_kind_area_radius_and_centre(part):
    found = faces(part)
    assert len(found) == 8
    (groove,) = [face for face in found if face[1] == "Cylinder"]
    assert float(groove[2]) == pytest.approx(np.pi * 12 * 30, rel=1e-4)
    assert float(groove[3]) == pytest.approx(12, rel=1e-4)
    bottom = [face for face in found if " ".join(face[4:]) == "(20, 15, 0)"]
    assert [float(face[2]) for face in bottom] == [1200]


def test_a_mesh_has_the_names_and_finer_edges_on_contact_faces(part):
    found = faces(part)
    groove = next(face[0] for face in found if face[1] == "Cylinder")
    bottom = next(face[0] for face in found if " ".join(face[4:]) == "(20, 15, 0)")
    file = part.with_name("part.msh")
    names = ["--face", f"groove={groove}", "--face", f"bottom={bottom}", "--contact", "groove"]
    made = run(SCENES / "from_step.py", part, file, "--size", "5", *names)
    assert made.returncode == 0, made.stderr
    mesh = meshio.read(file)
    assert set(mesh.cells_dict) == {"tetra10", "triangle6"}
    assert set(mesh.field_data) == {"groove", "bottom", "body"}
    triangles, groups = mesh.cells_dict["triangle6"], mesh.cell_data_dict["gmsh:physical"]["triangle6"]

    def edge(name):
        corners = mesh.points[triangles[groups == mesh.field_data[name][0], :3]]
        return np.linalg.norm(corners[:, 0] - corners[:, 1], axis=1).mean()

    # An eighth of the radius, 1.5 mm, on the groove; the edges of the bottom have grown.
    assert 1.0 < edge("groove") < 2.0
    assert edge("bottom") > 1.5 * edge("groove")
    # All nodes of the groove lie on the cylinder, those in the middles of edges included.
    nodes = mesh.points[np.unique(triangles[groups == mesh.field_data["groove"][0]])]
    assert np.abs(np.hypot(nodes[:, 0] - 20, nodes[:, 2] - 20) - 12).max() < 1e-6


def test_wrong_arguments_are_refused_with_what_is_allowed(part):
    mesh = part.with_name("refused.msh")
    cases = [
        (["--face", "seat=99"], "there is no face 99; the solid has 1, 2, 3, 4, 5, 6, 7, 8"),
        (["--face", "seat"], "allowed is NAME=NUMBER"),
        (["--face", "a=1", "--face", "b=1"], 'face 1 is in "a" already'),
        (["--contact", "seat"], "no --face has this name"),
        (["--size", "-1"], "allowed are finite numbers > 0"),
        (["--solid", "7"], "--solid 7: the file has 1"),
    ]
    for arguments, words in cases:
        refused = run(SCENES / "from_step.py", part, mesh, *arguments)
        assert refused.returncode == 1 and words in refused.stderr, refused.stderr
    missing = run(SCENES / "from_step.py", part.with_name("none.step"))
    assert missing.returncode == 1 and "error: Gmsh" in missing.stderr
    assert not mesh.exists()
