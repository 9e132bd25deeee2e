"""Pictures of docs/tutorial_bracket.md from the results of its optimization: python bracket.py results/bracket [FOLDER].

Needs matplotlib, meshio and numpy; writes bracket_pressure.png and bracket_stress.png into FOLDER, by default that of this script.
"""

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.collections import PolyCollection

CASES = ["upright", "forward", "back"]
SHAPES = ["initial", "optimal"]
WORDS = {"initial": "start", "optimal": "optimum"}
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
TURN, RISE = np.radians(20.0), np.radians(15.0)  # the eye, from the direction −x2
LIMITED = 2  # the case whose stress is shown


def pressures(results, shape, case):
    """x1 and x2 of the nodes of the seat, mm, and their pressures, MPa."""
    with (results / f"pressure_{shape}_case_{case}.csv").open() as file:
        rows = list(csv.DictReader(file))
    return [np.array([float(row[key]) for row in rows]) for key in ("x1_mm", "x2_mm", "pressure_MPa")]


def draw_pressures(results, file):
    figure, axes = plt.subplots(2, 3, figsize=(7.4, 2.9), sharex=True, sharey=True, layout="constrained")
    for row, shape in zip(axes, SHAPES):
        found = [pressures(results, shape, case) for case in (1, 2, 3)]
        top = max(pressure.max() for _, _, pressure in found)
        for axis, name, (x, y, pressure) in zip(row, CASES, found):
            drawn = axis.tricontourf(x, y, pressure, levels=np.linspace(0, top, 17))
            axis.set_title(f"{WORDS[shape]}, {name}: peak {pressure.max():.1f}", fontsize=9)
            axis.set_aspect("equal")
        figure.colorbar(drawn, ax=row, format="%.0f", ticks=np.linspace(0, top, 5), label="MPa")
        row[0].set_ylabel("x₂, mm")
    for axis in axes[1]:
        axis.set_xlabel("x₁, mm")
    figure.savefig(file, dpi=100)


def skin(cells):
    """Corners of the faces that one tetrahedron alone has, seen from outside counterclockwise."""
    faces = np.concatenate([cells[:, face] for face in FACES])
    keys = np.sort(faces, axis=1)
    _, index, counts = np.unique(keys, axis=0, return_index=True, return_counts=True)
    return faces[index[counts == 1]]


def draw_stresses(results, file):
    figure, axes = plt.subplots(1, 2, figsize=(7.4, 3.0), layout="constrained")
    meshes = [meshio.read(results / "vtk" / f"{shape}_case_{LIMITED}_bodies.vtu") for shape in SHAPES]
    top = max(mesh.point_data["von_mises_nodal"].max() for mesh in meshes)
    right = np.array([np.cos(TURN), np.sin(TURN), 0.0])
    depth = np.array([-np.sin(TURN) * np.cos(RISE), np.cos(TURN) * np.cos(RISE), -np.sin(RISE)])
    up = np.cross(right, depth)
    for axis, shape, mesh in zip(axes, SHAPES, meshes):
        stress, triangles = mesh.point_data["von_mises_nodal"], skin(mesh.cells[0].data)
        corners = mesh.points[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        seen = normals @ depth < 0
        corners, triangles = corners[seen], triangles[seen]
        order = np.argsort(-(corners.mean(axis=1) @ depth))
        flat = np.stack([corners @ right, corners @ up], axis=2)[order]
        colors = stress[triangles].mean(axis=1)[order]
        drawn = PolyCollection(flat, array=colors, cmap="inferno_r", clim=(0, top), edgecolors="face", linewidths=0.3)
        axis.add_collection(drawn)
        axis.autoscale_view()
        axis.set_aspect("equal")
        axis.axis("off")
        axis.set_title(f"{WORDS[shape]}: largest {stress.max():.0f} MPa", fontsize=10)
    figure.colorbar(drawn, ax=axes, label="von Mises stress, mean at the nodes, MPa")
    figure.savefig(file, dpi=100)


def main(results, folder):
    draw_pressures(results, folder / "bracket_pressure.png")
    draw_stresses(results, folder / "bracket_stress.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).parent)
