"""The pictures of docs/tutorial_bracket.md."""

import matplotlib.pyplot as plt
import meshio
import numpy as np
from drawing import columns
from matplotlib.collections import PolyCollection
from matplotlib.colors import BoundaryNorm, to_rgb
from matplotlib.patches import Patch

CASES = ["upright", "forward", "back"]
SHAPES = ["initial", "optimal"]
WORDS = {"initial": "start", "optimal": "optimum"}
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
LIMITED = 2  # the case whose stress is shown
# Faces of the mesh: colour and what acts there.
NAMED = {
    "seat": ("#4a9d74", "seat: contact with the shaft"),
    "eye": ("#d1593b", "eye: force"),
    "stop": ("#8266a3", "stop: u₁ = 0"),
    "symmetry": ("#9fbad6", "symmetry: u₂ = 0"),
    "free": ("#c8ccd2", "free"),
}


def draw_pressures(file, results):
    """Start and optimum on one scale, whose steps are finer where the pressures of the optimum lie."""
    found = {shape: [columns(results / f"pressure_{shape}_case_{case}.csv") for case in (1, 2, 3)] for shape in SHAPES}
    top = max(table["pressure_MPa"].max() for tables in found.values() for table in tables)
    levels = [0, 1, 5, 10, 15, 20, 25, 30, 60, 90, 120, 150, np.ceil(top / 10) * 10]
    norm = BoundaryNorm(levels, plt.get_cmap().N)
    figure, axes = plt.subplots(2, 3, figsize=(7.4, 2.9), sharex=True, sharey=True, layout="constrained")
    for row, shape in zip(axes, SHAPES):
        for axis, name, table in zip(row, CASES, found[shape]):
            pressure = table["pressure_MPa"]
            drawn = axis.tricontourf(table["x1_mm"], table["x2_mm"], pressure, levels=levels, norm=norm)
            axis.set_title(f"{WORDS[shape]}, {name}: peak {pressure.max():.1f}", fontsize=9)
            axis.set_aspect("equal")
        row[0].set_ylabel("x₂, mm")
    figure.colorbar(drawn, ax=axes, format="%.0f", ticks=levels, label="MPa")
    for axis in axes[1]:
        axis.set_xlabel("x₁, mm")
    figure.savefig(file, dpi=100)


def skin(cells):
    """Corners of the faces that one tetrahedron alone has, seen from outside counterclockwise."""
    faces = np.concatenate([cells[:, face] for face in FACES])
    keys = np.sort(faces, axis=1)
    _, index, counts = np.unique(keys, axis=0, return_index=True, return_counts=True)
    return faces[index[counts == 1]]


class Eye:
    """Looks along x₂, turned about x₃ to the right and raised, by angles in degrees."""

    def __init__(self, turn, rise):
        turn, rise = np.radians(turn), np.radians(rise)
        self.right = np.array([np.cos(turn), np.sin(turn), 0.0])
        self.depth = np.array([-np.sin(turn) * np.cos(rise), np.cos(turn) * np.cos(rise), -np.sin(rise)])

    def seen(self, corners):
        """Numbers of the triangles that face the eye, the farthest first; their places in the picture; their shades."""
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        order = np.argsort(-(corners.mean(axis=1) @ self.depth))
        order = order[normals[order] @ self.depth < 0]
        up = np.cross(self.right, self.depth)
        light = (0.5 * self.right + up - 1.5 * self.depth) / np.sqrt(3.5)
        shades = 0.6 + 0.4 * np.clip(normals[order] @ light, 0, 1)
        return order, np.stack([corners[order] @ self.right, corners[order] @ up], axis=2), shades


def bare(axis, title):
    axis.autoscale_view()
    axis.set_aspect("equal")
    axis.axis("off")
    axis.set_title(title, fontsize=10)


def draw_stresses(file, results):
    figure, axes = plt.subplots(1, 2, figsize=(7.4, 3.0), layout="constrained")
    meshes = [meshio.read(results / "vtk" / f"{shape}_case_{LIMITED}_bodies.vtu") for shape in SHAPES]
    top = max(mesh.point_data["von_mises_nodal"].max() for mesh in meshes)
    for axis, shape, mesh in zip(axes, SHAPES, meshes):
        stress, triangles = mesh.point_data["von_mises_nodal"], skin(mesh.cells[0].data)
        order, flat, _ = Eye(20, 15).seen(mesh.points[triangles])
        colors = stress[triangles].mean(axis=1)[order]
        drawn = PolyCollection(flat, array=colors, cmap="inferno_r", clim=(0, top), edgecolors="face", linewidths=0.3)
        axis.add_collection(drawn)
        bare(axis, f"{WORDS[shape]}: largest {stress.max():.0f} MPa")
    figure.colorbar(drawn, ax=axes, label="von Mises stress, mean at the nodes, MPa")
    figure.savefig(file, dpi=100)


def draw_mesh(file, mesh_file):
    mesh = meshio.read(mesh_file)
    names = {number: name for name, (number, dimension) in mesh.field_data.items() if dimension == 2}
    named = {}
    for block, numbers in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
        if block.type == "triangle6":
            named |= {tuple(sorted(face[:3])): names[number] for face, number in zip(block.data, numbers)}
    triangles = skin(np.concatenate([block.data for block in mesh.cells if block.type == "tetra10"]))
    colors = np.array([to_rgb(NAMED[named[tuple(sorted(face))]][0]) for face in triangles])
    figure, axes = plt.subplots(1, 2, figsize=(7.4, 3.8), layout="constrained")
    views = {"from the plane of symmetry and the stop": Eye(-35, 20), "from below": Eye(35, -25)}
    for axis, (title, eye) in zip(axes, views.items()):
        order, flat, shades = eye.seen(mesh.points[triangles])
        shaded = colors[order] * shades[:, None]
        axis.add_collection(PolyCollection(flat, facecolors=shaded, edgecolors=0.7 * shaded, linewidths=0.3))
        bare(axis, title)
    figure.legend(handles=[Patch(color=color, label=words) for color, words in NAMED.values()],
                  loc="outside lower center", ncols=5, fontsize=8, frameon=False, handlelength=1.2, columnspacing=1.2)
    figure.savefig(file, dpi=100)
