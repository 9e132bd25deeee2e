"""The pictures of docs/tutorial_taper.md."""

import matplotlib.pyplot as plt
import meshio
import numpy as np
from drawing import OPTIMUM, OTHER, along, columns
from matplotlib.collections import LineCollection, PolyCollection

MATCHED = "tab:orange"
MOUTH, TIP = 3.0, 17.0
HEIGHT = "x₃, mm (3: mouth of the head, 17: tip of the stem)"


def draw_pressures(file, optimized, matched):
    figure, axis = plt.subplots(figsize=(8, 4.5), layout="constrained")
    x = np.linspace(MOUTH, TIP, 200)
    axis.plot(x, 40.9 * (1 - ((x - 10) / 7) ** 6), color="0.6", linewidth=5, label="wanted")
    curves = [
        ("start: bore opens by 4′ more", optimized / "pressure_initial.csv", OTHER, "--"),
        ("matched cones", matched / "pressure_shape.csv", MATCHED, "-."),
        ("optimum", optimized / "pressure_optimal.csv", OPTIMUM, "-"),
    ]
    for label, table, color, style in curves:
        found = along(table, "x3_mm")
        axis.plot(found["x3_mm"], found["pressure_MPa"], style, color=color, label=label)
    peak = columns(curves[0][1])["pressure_MPa"].max()
    axis.text(16.4, 122, f"{peak:.0f} MPa", color=OTHER, ha="right")
    axis.set(xlim=(MOUTH - 0.1, TIP + 0.1), ylim=(0, 130), xlabel=HEIGHT, ylabel="contact pressure, MPa")
    axis.legend(frameon=False, loc="upper center")
    axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(file, dpi=80)


def draw_profiles(file, optimized, matched):
    tables = [optimized / "pressure_initial.csv", optimized / "pressure_optimal.csv", matched / "pressure_shape.csv"]
    start, *others = (along(table, "x3_mm") for table in tables)
    heights = start["x3_mm"]
    optimum, cones = (1e3 * (other["x1_mm"] - start["x1_mm"]) for other in others)
    figure, axis = plt.subplots(figsize=(8, 4), layout="constrained")
    axis.axhline(0, color="0.8", linewidth=1)
    axis.plot(heights, optimum, color=OPTIMUM, label="optimum")
    axis.plot(heights, cones, "-.", color=MATCHED, label="matched cones")
    axis.plot(heights, optimum - cones, ":", color="black", label="difference: the crown")
    axis.set(xlim=(MOUTH, TIP), xlabel=HEIGHT, ylabel="change of the radius, µm")
    axis.legend(frameon=False, loc="upper right")
    axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(file, dpi=80)


def section(mesh_file, name):
    """Corners (x₁, x₃) of the faces of a named surface in the plane x₂ = 0, or of its edges there, mirrored too."""
    mesh = meshio.read(mesh_file)
    number, _ = mesh.field_data[name]
    blocks = zip(mesh.cells, mesh.cell_data["gmsh:physical"])
    faces = np.concatenate([block.data[numbers == number] for block, numbers in blocks if block.type == "quad"])
    flat = np.abs(mesh.points[:, 1]) < 1e-9
    kept = [face[flat[face]] for face in faces if flat[face].sum() >= 2]
    places = mesh.points[np.array(kept)][:, :, [0, 2]]
    return np.concatenate([places, places * [-1, 1]])


def draw_sketch(file, stem, head):
    figure, axis = plt.subplots(figsize=(6, 4.6), layout="constrained")
    for mesh, color in ((head, "#d9d9d9"), (stem, "#9ecae1")):
        axis.add_collection(PolyCollection(section(mesh, "side1"), facecolors=color, edgecolors=color))
    axis.add_collection(LineCollection(section(stem, "taper"), colors=OTHER, linewidths=3, capstyle="projecting"))
    axis.plot([0, 0], [-1, 26], "-.", color="black", linewidth=0.8)
    top = section(head, "top")[:, :, 0].max()
    supports = np.linspace(-top, top, 7)
    axis.plot(supports, np.full(7, 24.6), "v", markerfacecolor="white", markeredgecolor="black", markersize=9)
    for x in (-4.5, -1.5, 1.5, 4.5):
        axis.annotate("", (x, 0), (x, -3), arrowprops={"arrowstyle": "->"})
    axis.annotate("", (17.5, 0), (17.5, 17), arrowprops={"arrowstyle": "<->"})
    notes = [
        ("tip, x₃ = 17", (3, 17), (12, 22.5)),
        ("mouth, x₃ = 3", (-6.9, 3), (-19, -1.5)),
        ("⌀ 32 mm", (-16, 11), (-22, 3)),
        ("⌀ 14 mm", (7, 0), (9, -1.5)),
    ]
    for words, place, beside in notes:
        axis.annotate(words, place, beside, arrowprops={"arrowstyle": "-", "linewidth": 0.6})
    axis.annotate("contact,\n14 mm", (6.5, 12), (10, 12), color=OTHER, arrowprops={"arrowstyle": "-", "color": OTHER})
    for words, x, y in (("17 mm", 20, 8.5), ("head\nCoCr", -11, 10), ("stem\nTi-6Al-4V", -3.2, 9)):
        axis.text(x, y, words, ha="center", va="center")
    axis.text(0, 26.3, "held along the axis", ha="center")
    axis.text(0, -3.4, "4 kN on the base of the stem", ha="center", va="top")
    axis.set(xlim=(-23, 22.5), ylim=(-5, 28), aspect="equal")
    axis.axis("off")
    figure.savefig(file, dpi=80)
